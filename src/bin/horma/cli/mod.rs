//! The command line: one file per subcommand, each with its arguments and a `run`.

mod machine;
mod table;
mod tool;

use crate::bar::Bar;
use clap::{Args, CommandFactory, Parser, Subcommand};
use clap_complete::Shell as CompletionShell;
use std::io::{ErrorKind, Write};

/// From a scanned part to a lathe program.
#[derive(Debug, Parser)]
#[command(version, about, propagate_version = true, arg_required_else_help = true, after_help = EXIT_CODES)]
pub(crate) struct Cli {
    #[command(flatten)]
    shell: Shell,
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes:
  0   done
  2   the command line is wrong
  65  an input is wrong; the message names it
  70  a bug in horma
  73  an output cannot be written
  75  stopped before the end; try again";

/// How to talk to whoever called.
#[derive(Debug, Args)]
pub(crate) struct Shell {
    /// Print the report as JSON instead of text.
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// No progress bars and no report; errors still appear.
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Threads to work with [default: all cores].
    #[arg(long, global = true, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
}

impl Shell {
    /// Where long work reports to.
    pub(crate) fn progress(&self) -> Bar {
        Bar::new(self.quiet || self.json)
    }

    /// Prints a result: as JSON if asked for, else as `text`; nothing when quiet.
    pub(crate) fn report(&self, value: &impl serde::Serialize, text: &str) -> anyhow::Result<()> {
        if self.json {
            print_whole(&(serde_json::to_string_pretty(value)? + "\n"))
        } else if self.quiet {
            Ok(())
        } else {
            print_whole(&format!("{}\n", text.trim_end()))
        }
    }
}

/// Writes `text` to stdout. A reader who has seen enough, as in `| head`, is no error.
pub(crate) fn print_whole(text: &str) -> anyhow::Result<()> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written?),
    }
}

#[derive(Debug, Subcommand)]
enum Command {
    Machine(machine::MachineArgs),
    Tool(tool::ToolArgs),
    /// Print shell completions.
    Completions {
        /// The shell to complete in.
        shell: CompletionShell,
    },
}

impl Cli {
    /// Runs the chosen subcommand.
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        if let Some(n_threads) = self.shell.threads {
            rayon::ThreadPoolBuilder::new().num_threads(n_threads.get()).build_global()?;
        }
        match &self.command {
            Command::Machine(args) => machine::run(args, &self.shell),
            Command::Tool(args) => tool::run(args, &self.shell),
            Command::Completions { shell } => {
                clap_complete::generate(
                    *shell,
                    &mut Self::command(),
                    "horma",
                    &mut std::io::stdout(),
                );
                Ok(())
            }
        }
    }
}
