//! The `horma` command: reads arguments, calls one function per subcommand, turns errors into
//! words and exit codes.

mod bar;
mod cli;
mod exit;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    exit::code_of(|| cli.run())
}
