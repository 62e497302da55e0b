//! The arrows between the parts of the house go one way; this reads the `use` lines and looks.

use std::fs;
use std::path::{Path, PathBuf};

/// Each part, and the parts it may name.
const ARROWS: &[(&str, &[&str])] = &[
    ("language", &[]),
    ("word", &["language"]),
    ("mesh", &[]),
    ("patch", &["language", "word"]),
    ("curve", &["language", "word"]),
    ("io", &["patch", "curve", "mesh", "word", "tessellate", "language"]),
    ("plan", &["language", "word", "patch", "curve"]),
    ("affine", &["language", "curve", "plan"]),
    ("tessellate", &["language", "patch"]),
    ("cpu", &["language", "patch", "curve", "mesh", "plan", "affine", "tessellate"]),
    ("codegen", &["language", "patch", "curve", "mesh", "plan", "tessellate"]),
    ("gpu", &["language", "patch", "curve", "mesh", "plan", "affine", "tessellate", "codegen"]),
    // The one place where CPU and GPU meet.
    ("conformance", &["language", "patch", "io", "plan", "tessellate", "cpu", "codegen", "gpu"]),
    ("render", &["language", "patch", "plan", "tessellate", "codegen", "gpu", "io"]),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of src") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The parts that a source names, by `crate::part`, in code or in `use`; comments do not count.
fn named(text: &str) -> Vec<(usize, String)> {
    let mut list = Vec::new();
    for (n, line) in text.lines().enumerate() {
        let code = line.split("//").next().unwrap_or("");
        for rest in code.split("crate::").skip(1) {
            let names: Vec<String> = match rest.strip_prefix('{') {
                Some(group) => group.split(',').map(first_name).collect(),
                None => vec![first_name(rest)],
            };
            list.extend(names.into_iter().map(|name| (n + 1, name)));
        }
    }
    list
}

fn first_name(text: &str) -> String {
    text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

fn part_of(path: &Path, src: &Path) -> String {
    let inside = path.strip_prefix(src).expect("below src");
    let first = inside.components().next().expect("a name").as_os_str().to_string_lossy();
    first.trim_end_matches(".rs").to_string()
}

#[test]
fn arrows_go_one_way() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    assert!(files.len() > 20, "the sources were not found");
    let parts: Vec<&str> = ARROWS.iter().map(|a| a.0).collect();
    let mut wrong = Vec::new();
    for path in files {
        let part = part_of(&path, &src);
        let Some((_, allowed)) = ARROWS.iter().find(|a| a.0 == part) else { continue };
        let text = fs::read_to_string(&path).expect("a source");
        for (line, name) in named(&text) {
            if parts.contains(&name.as_str()) && name != part && !allowed.contains(&name.as_str()) {
                wrong.push(format!("{}:{line}: {part} -> {name}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "arrows that go the wrong way:\n{}", wrong.join("\n"));
}

/// How the kind of a word may be asked for: only `plan` does, in `plan/kind` and what is of one kind alone.
const KINDS: [&str; 9] = [
    "system::Kind",
    "Kind::Curve",
    "Kind::Patch",
    "Kind::Mesh",
    "is_ring(",
    "one_piece(",
    "link.is_some(",
    "link.is_none(",
    "net.is_",
];

#[test]
fn backends_and_codegen_ask_for_no_kind_of_word() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    ["cpu", "gpu", "codegen"].iter().for_each(|part| sources(&src.join(part), &mut files));
    assert!(files.len() > 40, "the sources were not found");
    let mut wrong = Vec::new();
    for path in files {
        let text = fs::read_to_string(&path).expect("a source");
        let lines = text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
        for (n, line) in lines.filter(|(_, line)| KINDS.iter().any(|kind| line.contains(kind))) {
            wrong.push(format!("{}:{}: {}", path.display(), n + 1, line.trim()));
        }
    }
    assert!(wrong.is_empty(), "the kind of a word belongs to src/plan/kind:\n{}", wrong.join("\n"));
}

#[test]
fn only_gpu_and_render_name_wgpu() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    for path in files {
        let part = part_of(&path, &src);
        if matches!(part.as_str(), "gpu" | "render" | "lib" | "command") {
            continue;
        }
        let text = fs::read_to_string(&path).expect("a source");
        let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
        assert!(!code.into_iter().any(|l| l.contains("wgpu::")), "{} names wgpu", path.display());
    }
}

#[test]
fn every_part_of_the_house_has_its_arrows() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for entry in fs::read_dir(&src).expect("src") {
        let path = entry.expect("an entry").path();
        let part = part_of(&path, &src);
        let known = ARROWS.iter().any(|a| a.0 == part) || matches!(part.as_str(), "lib" | "main" | "command");
        assert!(known, "src/{part} is in no row of ARROWS");
    }
}
