//! Ctrl-C.

use super::*;

fn interrupt(child: &Child) {
    let pid = child.id().to_string();
    let sent = Command::new("sh").args(["-c", &format!("kill -INT {pid}")]).status();
    assert!(sent.is_ok_and(|s| s.success()));
}

fn start(folder: &Folder, args: &[&str]) -> Child {
    let mut command = folder.command(args);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts")
}

#[test]
fn during_the_derivation() {
    let folder = Folder::new();
    // A million steps over one module: long, and small.
    folder.write("long.burgeon", rules("  P(n) -> P(n+1)\nrun:\n  derive 1000000\n"));
    let before = folder.files();
    let child = start(&folder, &["run", "long.burgeon", "--backend", "cpu", "--out", "a.json"]);
    std::thread::sleep(Duration::from_millis(500));
    let since = Instant::now();
    interrupt(&child);
    let ran = finished(child, "Ctrl-C");
    assert!(since.elapsed() < Duration::from_secs(20), "{:?}", since.elapsed());
    ran.fails(130, &["stopped by Ctrl-C after", "nothing was written"]);
    assert!(before == folder.files());
}

/// Rows that were printed stay; the case that runs ends early.
#[cfg(feature = "gpu")]
#[test]
fn during_the_selftest() {
    let Some(adapter) = gpu() else { return };
    let folder = Folder::new();
    let adapter = adapter.iter().map(String::as_str);
    let child = start(&folder, &["selftest"].into_iter().chain(adapter).collect::<Vec<_>>());
    std::thread::sleep(Duration::from_millis(1500));
    interrupt(&child);
    let ran = finished(child, "Ctrl-C in the selftest");
    assert_eq!(ran.status, Some(130), "{ran:?}");
    assert!(ran.stdout.starts_with("case  ") && ran.stdout.contains("  stopped\n"), "{ran:?}");
    ran.says(&["stopped by Ctrl-C after"]);
}

#[test]
fn while_a_file_is_written() {
    let folder = Folder::new();
    let before = folder.files();
    let big =
        ["run", "quarters.burgeon", "--backend", "cpu", "--grid", "256", "--out", "a.obj", "--out", "a.json"];
    let child = start(&folder, &big);
    // The file grows beside the place where it is to stand.
    let since = Instant::now();
    let hidden =
        |path: &PathBuf| path.file_name().is_some_and(|n| n.as_encoded_bytes().starts_with(b".burgeon-"));
    while !names(&folder).iter().any(hidden) {
        assert!(since.elapsed() < LIMIT, "no file was begun");
        std::thread::sleep(Duration::from_millis(1));
    }
    interrupt(&child);
    let ran = finished(child, "Ctrl-C while writing");
    ran.fails(130, &["stopped by Ctrl-C"]);
    assert!(before == folder.files(), "{:?}", folder.files().keys());
}

fn names(folder: &Folder) -> Vec<PathBuf> {
    std::fs::read_dir(folder.0.path()).expect("a folder").map(|e| e.expect("an entry").path()).collect()
}
