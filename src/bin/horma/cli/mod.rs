//! The command line: one file per subcommand, each with its arguments and a `run`.

mod check;
mod restart;

use crate::bar::Bar;
use clap::{Args, CommandFactory, Parser, Subcommand};
use clap_complete::Shell as CompletionShell;

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
            println!("{}", serde_json::to_string_pretty(value)?);
        } else if !self.quiet {
            println!("{}", text.trim_end());
        }
        Ok(())
    }
}

#[derive(Debug, Subcommand)]
enum Command {
    Check(check::CheckArgs),
    Restart(restart::RestartArgs),
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
            Command::Check(args) => check::run(args, &self.shell),
            Command::Restart(args) => restart::run(args, &self.shell),
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
