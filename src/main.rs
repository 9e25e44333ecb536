//! `dose`: the command. Parsing and dispatch are in `cli`, everything else is in the library.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run(std::env::args_os())
}
