//! What needs an adapter; left out with `BURGEON_SKIP_GPU=1`.

use super::*;

/// A run on the GPU with the flags that name the adapter of the tests.
fn run_gpu(folder: &Folder, adapter: &[String], args: &[&str]) -> Ran {
    let adapter = adapter.iter().map(String::as_str);
    folder.run(&args.iter().copied().chain(adapter).collect::<Vec<_>>())
}

#[test]
fn cpu_and_gpu_write_the_same_word() {
    let Some(adapter) = gpu() else { return };
    let folder = Folder::new();
    let examples: [(&str, &[&str]); 5] = [
        ("sierpinski", &["--set", "depth=4"]),
        ("sierpinski2", &["--steps", "4"]),
        ("holes", &[]),
        ("teapot", &["--set", "levels=2"]),
        ("teapot_lace", &["--set", "depth=1"]),
    ];
    for (name, more) in examples {
        let file = example(&format!("{name}.burgeon"));
        for (backend, out) in [("cpu", "cpu.json"), ("gpu", "gpu.json")] {
            let args = [&["run", &file, "--backend", backend, "--out", out][..], more].concat();
            let ran = run_gpu(&folder, &adapter, &args);
            let said = ran.succeeds().stderr.lines().count();
            assert_eq!(said, usize::from(backend == "gpu"), "{ran:?}");
        }
        assert!(folder.read("cpu.json") == folder.read("gpu.json"), "{name}");
    }
}

#[test]
fn stats_of_the_gpu() {
    let Some(adapter) = gpu() else { return };
    let folder = Folder::new();
    let ran = run_gpu(&folder, &adapter, &["run", "quarters.burgeon", "--backend", "gpu", "--stats"]);
    assert_eq!(ran.succeeds().stdout.lines().count(), 1);
    let stats: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    assert_eq!(stats["backend"], "gpu");
    assert!(stats["adapter"].as_str().is_some_and(|a| !a.is_empty()));
    let steps = stats["steps"].as_array().expect("an array");
    assert_eq!(steps.iter().map(|s| s["modules"].as_u64()).collect::<Vec<_>>(), [Some(4), Some(16)]);
    assert!(stats["compile_ms"].as_f64() > Some(0.0));
}

/// Whether a run can have a GPU without asking for a software one.
fn has_hardware() -> bool {
    burgeon::gpu::adapters().iter().any(|adapter| burgeon::gpu::is_hardware(&adapter.get_info()))
}

fn backend_of(ran: &Ran) -> String {
    let stats: serde_json::Value = serde_json::from_str(&ran.succeeds().stdout).expect("JSON");
    stats["backend"].as_str().expect("a name").to_string()
}

/// Software adapters are slower than the CPU backend, so that they are taken by those alone who ask for them.
#[test]
fn auto_takes_hardware_or_the_cpu_and_says_so() {
    if gpu().is_none() {
        return;
    }
    let folder = Folder::new();
    let [auto, gpu] = ["auto", "gpu"]
        .map(|backend| folder.run_in_vain(&["run", "quarters.burgeon", "--stats", "--backend", backend]));
    match has_hardware() {
        true => assert_eq!((backend_of(&auto).as_str(), &auto.stderr), ("gpu", &gpu.stderr)),
        false => {
            assert_eq!(backend_of(&auto), "cpu");
            auto.says(&["note: on the CPU: there is no hardware adapter, only software: "]);
            gpu.says(&[", software)"]);
        }
    }
    assert_eq!(backend_of(&gpu), "gpu");
    gpu.says(&["note: on "]);
    // Who names one asks for it.
    let name = gpu.stderr.trim_start_matches("note: on ").split(" (").next().expect("a name");
    let named = folder.run_in_vain(&["run", "quarters.burgeon", "--stats", "--adapter", name]);
    assert_eq!(backend_of(&named), "gpu");
    named.says(&["note: on ", name]);
}

#[test]
fn an_adapter_that_does_not_exist() {
    if gpu().is_none() {
        return;
    }
    let folder = Folder::new();
    let adapter = ["--adapter", "no such adapter"];
    for args in [
        &["run", "quarters.burgeon", "--out", "a.json"][..],
        &["run", "quarters.burgeon", "--out", "a.json", "--backend", "gpu"],
        &["run", "quarters.burgeon", "--out", "a.png", "--backend", "cpu"],
        &["compare", "quarters.burgeon"],
        &["selftest"],
    ] {
        let ran = folder.run_in_vain(&[args, &adapter].concat());
        ran.fails(3, &["no adapter's name holds `no such adapter`", "there are: "]);
    }
    // Without its picture the rest is written.
    let outs = ["run", "quarters.burgeon", "--backend", "cpu", "--out", "a.png", "--out", "a.json"];
    folder.run(&[&outs, &adapter[..]].concat()).fails(3, &["a.png"]);
    assert!(folder.holds("a.json") && !folder.holds("a.png"));
}

#[test]
fn pictures() {
    let Some(adapter) = gpu() else { return };
    let folder = Folder::new();
    let file = example("teapot.burgeon");
    for (backend, up, out) in [("cpu", "y", "y.png"), ("gpu", "y", "gpu.png"), ("cpu", "z", "z.png")] {
        let args = ["run", &file, "--backend", backend, "--set", "levels=0", "--up", up, "--out", out];
        run_gpu(&folder, &adapter, &args).succeeds();
        assert!(folder.read(out).starts_with(b"\x89PNG\r\n\x1a\n"));
    }
    assert!(folder.read("y.png") == folder.read("gpu.png"));
    assert!(folder.read("y.png") != folder.read("z.png"));
    // Of nothing, there is an empty picture.
    folder.write("erase.burgeon", rules("  P(n) -> eps\n"));
    run_gpu(&folder, &adapter, &["run", "erase.burgeon", "--backend", "gpu", "--out", "none.png"]).succeeds();
    assert!(folder.read("none.png").starts_with(b"\x89PNG"));
    // A folder that is not there is the file's fault, not the device's.
    run_gpu(&folder, &adapter, &["run", "quarters.burgeon", "--backend", "gpu", "--out", "gone/a.png"])
        .says(&["gone/a.png: there is no folder gone"]);
}

#[test]
fn the_memory_budget_holds_on_the_gpu() {
    let Some(adapter) = gpu() else { return };
    let folder = Folder::new();
    let sure = "  P(n) -> [ P(n) P(n) ; P(n) P(n) ]\nrun:\n  derive 1000000\n";
    let unsure =
        "  P(n) : n < 100 -> [ P(n+1) P(n+1) ; P(n+1) P(n+1) ]\nrun:\n  derive until terminal max 99\n";
    for text in [sure, unsure] {
        folder.write("grow.burgeon", rules(text));
        let before = folder.files();
        let args = ["run", "grow.burgeon", "--backend", "gpu", "--max-memory", "1M", "--out", "a.json"];
        run_gpu(&folder, &adapter, &args).fails(3, &["step 6 needs at least", "budget is 1.00 MiB"]);
        assert!(before == folder.files());
    }
}

#[test]
fn compare_finds_them_equal() {
    let Some(adapter) = gpu() else { return };
    let folder = Folder::new();
    let ran = run_gpu(&folder, &adapter, &["compare", "quarters.burgeon", "--steps", "1", "--in", "net.bpt"]);
    assert!(
        ran.succeeds().stdout.starts_with("quarters: 1 step, 4 modules: equal on the CPU and on "),
        "{ran:?}"
    );
    let holes = example("holes.burgeon");
    let ran = run_gpu(&folder, &adapter, &["compare", &holes, "--set", "depth=2", "--threads", "2"]);
    assert!(ran.succeeds().stdout.starts_with("holes: 3 steps, 32 modules: equal"), "{ran:?}");
}

#[test]
fn devices_are_listed() {
    if gpu().is_none() {
        return;
    }
    let folder = Folder::new();
    let ran = folder.run_in_vain(&["devices"]);
    let auto: Vec<&str> = ran.succeeds().stdout.lines().filter(|line| line.starts_with("auto -> ")).collect();
    assert_eq!(auto.len(), 1, "{ran:?}");
    assert_eq!(auto[0].contains("the CPU backend"), !has_hardware(), "{ran:?}");
    assert!(!auto[0].contains("software"), "{ran:?}");
    assert_eq!(ran.stdout.contains("gpu  -> "), !has_hardware(), "{ran:?}");
    for text in ["driver: ", "largest binding ", " MiB, ", "storage buffers a stage", "the CPU backend"] {
        assert!(ran.stdout.contains(text), "{ran:?}");
    }
}

/// Libraries below complain on stderr where there is no desktop; users of the command do not see it.
#[test]
fn nothing_is_said_about_the_desktop() {
    if gpu().is_none() {
        return;
    }
    let folder = Folder::new();
    for args in
        [&["devices"][..], &["run", "quarters.burgeon", "--backend", "gpu"], &["compare", "quarters.burgeon"]]
    {
        for set in [None, Some("relative")] {
            let mut command = folder.command(args);
            command.env_remove("WAYLAND_DISPLAY").env_remove("XDG_RUNTIME_DIR");
            set.map(|value| command.env("XDG_RUNTIME_DIR", value));
            let ran = ran(command);
            let own = |line: &str| line.starts_with("note: on ");
            assert!(ran.succeeds().stderr.lines().all(own), "{ran:?}");
        }
    }
}
