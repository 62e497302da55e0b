//! The subcommands. Each returns what went wrong as a [`Failure`], which knows the exit status.

mod axiom;
mod bench;
mod compare;
mod curve;
mod devices;
mod flags;
mod kinds;
mod load;
mod matrix;
mod output;
mod progress;
mod quiet;
mod run;
mod selftest;
mod show;
mod source;
mod stop;
mod tessellate;
mod values;
mod words;

use clap::{Parser, Subcommand};
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

/// Curves, patches and meshes, refined and grown by parallel rewriting on any GPU.
#[derive(Parser)]
#[command(name = "burgeon", version, about, max_term_width = 100, after_help = EXITS)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXITS: &str = "\
Exit status:
    0  done
    1  an input or output file is at fault
    2  wrong usage
    3  the device or a limit, such as the memory budget
    4  CPU and GPU disagree (compare, selftest)
  130  stopped by Ctrl-C";

#[derive(Subcommand)]
enum Command {
    /// Derive a system and write what came of it
    #[command(after_help = flags::RUN_EXAMPLES)]
    Run(flags::Run),
    /// Make one watertight triangle mesh of patches, as fine as a tolerance asks
    #[command(after_help = flags::TESSELLATE_EXAMPLES)]
    Tessellate(flags::Tessellate),
    /// Parse, check and compile a rule file; say everything that is wrong with it
    Check(flags::Check),
    /// Print the WGSL that a system becomes
    Wgsl(flags::Wgsl),
    /// Print the subdivision matrix of a curve rule, and what follows from it
    #[command(after_help = flags::MATRIX_EXAMPLES)]
    Matrix(flags::Matrix),
    /// Print the rule that has a subdivision matrix
    #[command(after_help = flags::INFER_EXAMPLES)]
    Infer(flags::Infer),
    /// Derive on the CPU and on the GPU, and compare every pass
    Compare(flags::Compare),
    /// Run the conformance suite: does the GPU do what the CPU does?
    Selftest(flags::Selftest),
    /// List the adapters, and what --backend auto takes
    Devices(flags::Devices),
    /// Measure CPU and GPU against their memory bandwidth
    Bench(flags::Bench),
}

impl Command {
    fn looks_for_adapters(&self) -> bool {
        match self {
            Command::Run(flags) => {
                flags.backend != flags::Backend::Cpu || output::needs_adapter(&flags.out, flags.format)
            }
            Command::Tessellate(flags) => {
                flags.backend != flags::Backend::Cpu || output::needs_adapter(&flags.out, flags.format)
            }
            Command::Compare(_) | Command::Selftest(_) | Command::Devices(_) | Command::Bench(_) => true,
            Command::Check(_) | Command::Wgsl(_) | Command::Matrix(_) | Command::Infer(_) => false,
        }
    }
}

/// Why a command ended, as its exit status says it. The text is what stderr shows.
#[derive(Debug)]
pub enum Failure {
    /// An input or output file is at fault.
    File(String),
    /// Wrong usage.
    Usage(String),
    /// The device, or a limit.
    Device(String),
    /// CPU and GPU disagree.
    #[cfg_attr(not(feature = "gpu"), expect(dead_code))]
    Differ(String),
    /// Ctrl-C.
    Stopped(String),
}

impl Failure {
    /// This failure, saying what the other says, too.
    fn and(self, other: Failure) -> Failure {
        let text = format!("{}\n{}", self.parts().1.trim_end(), other.parts().1);
        match self {
            Failure::File(_) => Failure::File(text),
            Failure::Usage(_) => Failure::Usage(text),
            Failure::Device(_) => Failure::Device(text),
            Failure::Differ(_) => Failure::Differ(text),
            Failure::Stopped(_) => Failure::Stopped(text),
        }
    }

    fn parts(&self) -> (u8, &str) {
        match self {
            Failure::File(text) => (1, text),
            Failure::Usage(text) => (2, text),
            Failure::Device(text) => (3, text),
            Failure::Differ(text) => (4, text),
            Failure::Stopped(text) => (130, text),
        }
    }
}

/// All that was said; the first failure decides what is at fault.
pub fn joined(failures: Vec<Failure>) -> Result<(), Failure> {
    let mut failures = failures.into_iter();
    let Some(first) = failures.next() else { return Ok(()) };
    Err(failures.fold(first, Failure::and))
}

/// Parses the flags and runs the subcommand.
pub fn main() -> ExitCode {
    let command = Cli::parse().command;
    if command.looks_for_adapters() {
        quiet::without_wayland();
    }
    let result = match command {
        Command::Run(flags) => run::run(&flags),
        Command::Tessellate(flags) => tessellate::tessellate(&flags),
        Command::Check(flags) => show::check(&flags),
        Command::Wgsl(flags) => show::wgsl(&flags),
        Command::Matrix(flags) => matrix::matrix(&flags),
        Command::Infer(flags) => matrix::infer_rule(&flags),
        Command::Compare(flags) => compare::compare(&flags),
        Command::Selftest(flags) => selftest::selftest(&flags),
        Command::Devices(flags) => devices::devices(&flags),
        Command::Bench(flags) => bench::bench(&flags),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let (status, text) = failure.parts();
            say(text);
            ExitCode::from(status)
        }
    }
}

/// A message to stderr.
pub fn say(text: &str) {
    let text = text.trim_end();
    let text = match (colored(), text.strip_prefix("error:")) {
        (true, Some(rest)) => format!("\x1b[1;31merror\x1b[0m:{rest}"),
        _ => text.to_string(),
    };
    // Where stderr is closed nobody can be told.
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Text to stdout; a reader that has gone away (`burgeon wgsl … | head`) is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::File(format!("error: cannot write to the standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// Whether messages are coloured.
pub fn colored() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}

/// What agrees with so many: `1 word differs`, `2 words differ`.
pub fn agreeing<'a>(n: u64, one: &'a str, several: &'a str) -> &'a str {
    if n == 1 { one } else { several }
}

/// `1 step`, `2 steps`.
pub fn counted(n: u64, noun: &str) -> String {
    let n_nouns = |nouns: &str| format!("{} {nouns}", indicatif::HumanCount(n));
    match noun {
        _ if n == 1 => n_nouns(noun),
        "patch" => n_nouns("patches"),
        "vertex" => n_nouns("vertices"),
        _ => n_nouns(&format!("{noun}s")),
    }
}
