//! `horma restart`: take a program up again in its midst.

use super::Shell;
use anyhow::bail;
use clap::Args;
use horma::gcode::{self, Violation};
use horma::io::{self, Overwrite};
use std::path::PathBuf;

/// Write the rest of a program from a line on, with a safe approach in front of it.
#[derive(Debug, Args)]
pub(crate) struct RestartArgs {
    /// The program.
    program: PathBuf,
    /// The machine it is for: a name, or a machine file.
    #[arg(long, short, value_name = "MACHINE")]
    machine: String,
    /// The language it is written in: a name (`horma dialect list`) or a dialect file [default: the
    /// machine's].
    #[arg(long, value_name = "DIALECT")]
    dialect: Option<String>,
    /// The first line to carry out again.
    #[arg(long, value_name = "N")]
    line: u32,
    /// Feed down to the part [mm/min; default: that of the program].
    #[arg(long, value_name = "MM/MIN")]
    plunge_feed: Option<f64>,
    /// Where the rest is written to.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Replace the output if it is there already.
    #[arg(long)]
    force: bool,
}

/// What was done, for programs.
#[derive(serde::Serialize)]
struct Restarted<'a> {
    output: &'a PathBuf,
    line: u32,
    seconds: f64,
}

/// Writes the rest of the program, unless its machine would have something against it.
pub(crate) fn run(args: &RestartArgs, shell: &Shell) -> anyhow::Result<()> {
    let machine = io::read_machine(&args.machine)?;
    let dialect = io::read_dialect(args.dialect.as_ref().unwrap_or(&machine.dialect))?;
    let program = io::read_program(&args.program, &machine, &dialect)?;
    let rest = gcode::restart(&program, &machine, args.line, args.plunge_feed)?;
    let check = gcode::check(&rest, &machine);
    if let Some(Violation { kind, .. }) = check.violations.first() {
        let path = args.program.display();
        bail!("{path} must not run on {}: {kind}; `horma check` says in which line", machine.name);
    }
    let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
    io::write_program(&args.output, overwrite, &rest, &dialect)?;
    let done = Restarted { output: &args.output, line: args.line, seconds: check.seconds };
    let (from, to) = (args.program.display(), args.output.display());
    let text =
        format!("{to} takes {from} up at line {}; it runs {:.1} s", args.line, check.seconds);
    shell.report(&done, &text)
}
