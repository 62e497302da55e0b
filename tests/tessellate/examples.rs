//! The examples of embedding: short enough to be read, and run as they were built.

use crate::device;
use std::path::Path;
use std::process::Command;

#[test]
fn a_device_of_ones_own_takes_at_most_60_lines() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/own_device.rs");
    let text = std::fs::read_to_string(file).expect("the example");
    let lines = text.lines().count();
    assert!(lines <= 60, "{lines} lines");
    // And reads nothing of the tessellation.
    assert!(!text.contains(".read()") && !text.contains("status"));
}

/// Builds an example, which costs nothing where `cargo test` did, and runs it in a folder; what it prints. None only
/// if GPU tests are left out by name.
fn run(name: &str, arguments: &[&str], folder: &Path) -> Option<String> {
    device::headless()?;
    let root = env!("CARGO_MANIFEST_DIR");
    let build =
        Command::new(env!("CARGO")).args(["build", "--quiet", "--example", name]).current_dir(root).output();
    let build = build.expect("cargo");
    assert!(build.status.success(), "{}", String::from_utf8_lossy(&build.stderr));
    let test = std::env::current_exe().expect("this test");
    let profile = test.ancestors().nth(2).expect("the folder of the profile");
    let file = profile.join("examples").join(name).with_extension(std::env::consts::EXE_EXTENSION);
    let output = Command::new(file).args(arguments).current_dir(folder).output().expect("an example");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The share of a picture that is no background.
fn drawn(path: &Path) -> f64 {
    let file = std::fs::File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut pixels).expect("a picture");
    let surface = pixels.chunks_exact(4).filter(|p| p[2] < 200).count();
    surface as f64 / (pixels.len() / 4) as f64
}

#[test]
fn a_device_of_ones_own_draws_the_teapot() {
    let folder = tempfile::tempdir().expect("a folder");
    if run("own_device", &[], folder.path()).is_some() {
        let share = drawn(&folder.path().join("own_device.png"));
        assert!((0.2..0.6).contains(&share), "{share} of the picture");
    }
}

#[test]
fn what_moves_is_drawn_in_every_frame_and_gets_the_room_that_it_needs() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(said) = run("animated", &["--frames", "7", "--out", "frames"], folder.path()) else { return };
    assert!(said.contains("grows") && said.contains("triangles in frame"), "{said}");
    for frame in 0..7 {
        let share = drawn(&folder.path().join(format!("frames/{frame:03}.png")));
        assert!((0.1..0.8).contains(&share), "{share} of frame {frame}\n{said}");
    }
}

#[test]
fn rules_that_run_with_each_frame_grow_a_lace_and_are_loaded_anew() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(said) = run("growing", &["--frames", "8", "--out", "frames"], folder.path()) else { return };
    for words in
        ["the old rules go on", "rows have 2 and 1 cells", "other rules", "the room grows", "frame 7: "]
    {
        assert!(said.contains(words), "{said}");
    }
    let shares: Vec<f64> = (0..8).map(|n| drawn(&folder.path().join(format!("frames/{n:03}.png")))).collect();
    assert!(shares.iter().all(|share| (0.02..0.8).contains(share)), "{shares:?}\n{said}");
    assert!(shares[7] < 0.7 * shares[4], "{shares:?}: the lace is open");
}
