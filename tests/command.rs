//! The command, from the outside: the built binary in folders of its own.

mod bad_input;
mod curves;
#[cfg(feature = "gpu")]
mod devices;
mod formats;
#[cfg(unix)]
mod interrupted;
mod kinds;
mod matrix;
mod output;
mod queries;
#[cfg(feature = "gpu")]
mod readme;
mod tessellate;
mod usage;
mod words;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// No call may take longer, on a busy machine and without optimisation.
const LIMIT: Duration = Duration::from_secs(120);

/// One flat bicubic net.
const NET: &str = "1\n3 3\n0 0 0\n0 1 0\n0 2 0\n0 3 0\n1 0 0\n1 1 0\n1 2 0\n1 3 0\n\
                   2 0 0\n2 1 0\n2 2 0\n2 3 0\n3 0 0\n3 1 0\n3 2 0\n3 3 0\n";

/// Two steps of quartering, from `net.bpt`.
const QUARTERS: &str = "system quarters : patch bezier 3\nmodule P(n: int)\naxiom: P(0) = file \"net.bpt\"\n\
                        rules:\n  P(n) -> [ P(n+1) P(n+1) ; P(n+1) P(n+1) ]\nrun:\n  derive 2\n";

/// The rules of [`QUARTERS`] with others in place of its own.
fn rules(rules: &str) -> String {
    let (head, _) = QUARTERS.split_once("  P(n)").expect("a rule");
    format!("{head}{rules}")
}

/// How a call ended.
struct Ran {
    status: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Ran {
    /// It must end with this status, and say each of `texts` on stderr.
    #[track_caller]
    fn fails(&self, status: i32, texts: &[&str]) -> &Ran {
        assert_eq!(self.status, Some(status), "{self:?}");
        assert_eq!(self.stdout, "", "{self:?}");
        assert!(self.stderr.contains("error"), "{self:?}");
        self.says(texts)
    }

    #[track_caller]
    fn says(&self, texts: &[&str]) -> &Ran {
        for text in texts {
            assert!(self.stderr.contains(text), "no `{text}` in {self:?}");
        }
        self
    }

    #[track_caller]
    fn succeeds(&self) -> &Ran {
        assert_eq!(self.status, Some(0), "{self:?}");
        self
    }
}

impl std::fmt::Debug for Ran {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let (out, err) = (cut(&self.stdout), cut(&self.stderr));
        write!(f, "status {:?}\n--- stdout\n{out}\n--- stderr\n{err}", self.status)
    }
}

fn cut(text: &str) -> &str {
    &text[..text.floor_char_boundary(4000)]
}

/// A folder to run the command in.
struct Folder(TempDir);

impl Folder {
    /// With `net.bpt` and `quarters.burgeon`.
    fn new() -> Folder {
        let folder = Folder(tempfile::tempdir().expect("a folder"));
        folder.write("net.bpt", NET);
        folder.write("quarters.burgeon", QUARTERS);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("a file");
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).expect("UTF-8")
    }

    fn holds(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// All files with their content, hidden ones too.
    fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let entries =
            std::fs::read_dir(self.0.path()).expect("a folder").map(|e| e.expect("an entry").path());
        entries
            .map(|p| (p.clone(), if p.is_file() { std::fs::read(&p).expect("a file") } else { vec![] }))
            .collect()
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_burgeon"));
        command.args(args).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    fn run(&self, args: &[&str]) -> Ran {
        ran(self.command(args))
    }

    /// A run that must leave the folder as it was.
    #[track_caller]
    fn run_in_vain(&self, args: &[&str]) -> Ran {
        let before = self.files();
        let ran = self.run(args);
        assert!(before == self.files(), "{args:?} left something behind: {ran:?}");
        ran
    }
}

/// Runs within [`LIMIT`]; nothing may panic or be coloured.
#[track_caller]
fn ran(mut command: Command) -> Ran {
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts");
    finished(child, &format!("{:?}", command.get_args().collect::<Vec<&OsStr>>()))
}

#[track_caller]
fn finished(mut child: Child, what: &str) -> Ran {
    let reader = |pipe: Option<Box<dyn Read + Send>>| {
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            pipe.map(|mut pipe| pipe.read_to_end(&mut bytes));
            String::from_utf8_lossy(&bytes).into_owned()
        })
    };
    let stdout = reader(child.stdout.take().map(|p| Box::new(p) as Box<dyn Read + Send>));
    let stderr = reader(child.stderr.take().map(|p| Box::new(p) as Box<dyn Read + Send>));
    let start = Instant::now();
    let status = loop {
        match child.try_wait().expect("the command can be waited for") {
            Some(status) => break status,
            None if start.elapsed() > LIMIT => {
                child.kill().expect("the command can be killed");
                panic!("{what} did not end within {LIMIT:?}");
            }
            None => std::thread::sleep(Duration::from_millis(2)),
        }
    };
    let (stdout, stderr) = (stdout.join().expect("stdout"), stderr.join().expect("stderr"));
    let ran = Ran { status: status.code(), stdout, stderr };
    assert!(!ran.stderr.contains("panicked"), "{what}: {ran:?}");
    assert!(!ran.stderr.contains('\x1b') && !ran.stdout.contains('\x1b'), "{what}: {ran:?}");
    ran
}

/// A file of `examples/`.
fn example(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).display().to_string()
}

/// Flags for a run on the adapter that the tests are to use; none if GPU tests are left out by name.
#[cfg(feature = "gpu")]
fn gpu() -> Option<Vec<String>> {
    if std::env::var("BURGEON_SKIP_GPU").is_ok_and(|v| v == "1") {
        return None;
    }
    let named = std::env::var("BURGEON_ADAPTER").ok();
    Some(named.map_or(vec![], |name| vec!["--adapter".to_string(), name]))
}
