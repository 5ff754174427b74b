//! `horma check`: what a machine would have against a program.

use super::Shell;
use anyhow::bail;
use clap::Args;
use horma::{gcode, io};
use std::path::PathBuf;

/// Read a program again and report bounds, limits, programmed time and every violation by line.
#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// The program.
    program: PathBuf,
    /// The machine it is for: a name, or a machine file.
    #[arg(long, short, value_name = "MACHINE")]
    machine: String,
    /// The language it is written in: a name (`horma dialect list`) or a dialect file [default: the
    /// machine's].
    #[arg(long, value_name = "DIALECT")]
    dialect: Option<String>,
}

/// Prints the report; a program with violations is a bad input.
pub(crate) fn run(args: &CheckArgs, shell: &Shell) -> anyhow::Result<()> {
    let machine = io::read_machine(&args.machine)?;
    let dialect = io::read_dialect(args.dialect.as_ref().unwrap_or(&machine.dialect))?;
    let program = io::read_program(&args.program, &machine, &dialect)?;
    let report = gcode::check(&program, &machine);
    shell.report(&report, &report.to_string())?;
    if report.is_clean() {
        return Ok(());
    }
    let (path, n_violations) = (args.program.display(), report.violations.len());
    bail!("{path} must not run on {}; violations: {n_violations}", machine.name)
}
