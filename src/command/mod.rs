//! The subcommands. Each returns what went wrong as a [`Failure`], which knows the exit status.

mod bench;
mod compare;
mod devices;
mod flags;
mod load;
mod output;
mod run;
mod show;

use clap::{Parser, Subcommand};
use std::io::{IsTerminal, Write};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// Curves, patches and meshes, refined and grown by parallel rewriting on any GPU.
#[derive(Parser)]
#[command(name = "burgeon", version, about, max_term_width = 100, after_help = EXITS)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXITS: &str = "Exit status: 0 done; 1 an input or output file is at fault; 2 wrong usage; \
3 the device or the memory budget; 4 CPU and GPU disagree; 130 stopped by Ctrl-C.";

#[derive(Subcommand)]
enum Command {
    /// Derive a system and write what came of it
    Run(flags::Run),
    /// Parse, check and compile a rule file; say everything that is wrong with it
    Check(flags::Check),
    /// Print the WGSL that a system becomes
    Wgsl(flags::Wgsl),
    /// Derive on the CPU and on the GPU, and compare every pass
    Compare(flags::Compare),
    /// List the adapters, and which one is taken
    Devices(flags::Devices),
    /// Measure CPU and GPU against their memory bandwidth
    Bench(flags::Bench),
}

/// Why a command ended, as its exit status says it.
#[derive(Debug)]
pub enum Failure {
    /// An input or output file is at fault.
    File(String),
    /// Wrong usage.
    Usage(String),
    /// The device, or a limit.
    Device(String),
    /// CPU and GPU disagree.
    Differ(String),
    /// Ctrl-C.
    Stopped(String),
}

impl Failure {
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

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Parses the flags and runs the subcommand.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    // Without a handler Ctrl-C still ends the program, only less cleanly.
    let _ = ctrlc::set_handler(|| STOP.store(true, std::sync::atomic::Ordering::Relaxed));
    let result = match cli.command {
        Command::Run(flags) => run::run(&flags),
        Command::Check(flags) => show::check(&flags),
        Command::Wgsl(flags) => show::wgsl(&flags),
        Command::Compare(flags) => compare::compare(&flags),
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
    // Where stderr is closed nobody can be told.
    let _ = writeln!(std::io::stderr(), "{}", text.trim_end());
}

/// Text to stdout; a reader that has gone away (`burgeon wgsl … | head`) is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::File(format!("cannot write to the standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// Whether messages are coloured.
pub fn colored() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
