//! How horma talks to whoever called: results on stdout, everything else on stderr.

use crate::bar::Bar;
use horma::io::WriteError;
use std::io::{ErrorKind, Write};

/// How to talk to whoever called.
#[derive(Debug, clap::Args)]
pub(crate) struct Shell {
    /// Print the report as JSON instead of text.
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// No progress bars and no report in words; errors and --json still appear.
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Threads to work with [default: all cores].
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Shell {
    /// Gives the work as many threads as the user allows; call it once.
    pub(crate) fn start_threads(&self) -> anyhow::Result<()> {
        if let Some(n_threads) = self.threads {
            rayon::ThreadPoolBuilder::new().num_threads(n_threads.into()).build_global()?;
        }
        Ok(())
    }

    /// Where long work reports to.
    pub(crate) fn progress(&self) -> Bar {
        Bar::new(self.quiet || self.json)
    }

    /// Prints a result: as JSON if asked for, else as `text`; nothing when quiet.
    pub(crate) fn report(&self, value: &impl serde::Serialize, text: &str) -> anyhow::Result<()> {
        if self.json {
            print(&serde_json::to_string_pretty(value)?)
        } else if self.quiet {
            Ok(())
        } else {
            print(text)
        }
    }
}

/// Prints what was asked for. Unlike `println!`, it takes a reader that has seen enough, as in
/// `horma info part.stl | head -1`, for an answer and not for a bug.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(WriteError::System { path: "standard output".into(), source: error }.into())
        }
        _ => Ok(()),
    }
}
