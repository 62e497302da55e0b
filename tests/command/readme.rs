//! The README's commands run as pasted, and write what they name.

use super::*;

/// Its lines of shell that call burgeon.
fn commands() -> Vec<String> {
    let readme = include_str!("../../README.md");
    let blocks = readme.split("```sh\n").skip(1).filter_map(|block| block.split("```").next());
    let lines = blocks.flat_map(str::lines).filter(|line| line.starts_with("burgeon "));
    lines.map(|line| line.split(" #").next().unwrap_or(line).trim().to_string()).collect()
}

/// These take minutes, and have tests of their own.
const LONG: [&str; 2] = ["selftest", "bench"];

#[test]
fn the_commands_of_the_readme_run_as_pasted() {
    let folder = Folder::new();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for (from, to) in [("", "examples"), ("data", "examples/data")] {
        std::fs::create_dir_all(folder.path(to)).expect("a folder");
        for entry in std::fs::read_dir(examples.join(from)).expect("the examples").flatten() {
            if entry.path().is_file() {
                let to = folder.path(to).join(entry.file_name());
                std::fs::copy(entry.path(), to).expect("a copy");
            }
        }
    }
    let commands = commands();
    assert!(commands.len() > 10, "{commands:?}");
    for command in commands {
        let words: Vec<&str> = command.split_whitespace().skip(1).collect();
        if LONG.contains(&words[0]) {
            continue;
        }
        folder.run(&words).succeeds();
        for pair in words.windows(2).filter(|pair| pair[0] == "--out") {
            let name = pair[1].replace("{}", "0");
            assert!(folder.holds(&name), "{command} did not write {name}");
        }
    }
}
