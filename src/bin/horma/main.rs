//! The `horma` command: reads arguments, calls one function per subcommand, turns errors into
//! words and exit codes.

mod bar;
mod cli;
mod exit;
mod interrupt;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    exit::shorten_panics();
    ExitCode::from(exit::code_of(|| {
        interrupt::take_over()?;
        cli.run()
    }))
}
