//! The command `burgeon`: flags in, library calls, text out.
#![forbid(unsafe_code)]

mod command;

fn main() -> std::process::ExitCode {
    command::main()
}
