//! How horma talks to whoever called: results on stdout, everything else on stderr.

use crate::bar::Bar;
use horma::io::WriteError;
use serde::Serialize;
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
        Ok(self.pool().build_global()?)
    }

    /// Where long work reports to.
    pub(crate) fn progress(&self) -> Bar {
        Bar::new(self.quiet || self.json)
    }

    /// Prints a result: as JSON if asked for, else as `text`; nothing when quiet.
    pub(crate) fn report(&self, value: &impl Serialize, text: &str) -> anyhow::Result<()> {
        match self.answer(value, text)? {
            Some(answer) => print(&answer),
            None => Ok(()),
        }
    }

    fn answer(&self, value: &impl Serialize, text: &str) -> anyhow::Result<Option<String>> {
        if self.json {
            return Ok(Some(serde_json::to_string_pretty(value)?));
        }
        Ok((!self.quiet).then(|| text.to_owned()))
    }

    /// As many threads as the user allows, or as there are cores.
    fn pool(&self) -> rayon::ThreadPoolBuilder {
        let n_threads = self.threads.map_or(0, usize::from);
        rayon::ThreadPoolBuilder::new().num_threads(n_threads)
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

#[cfg(test)]
mod tests {
    use super::*;

    const TALKS: Shell = Shell { json: false, quiet: false, threads: None };

    #[test]
    fn a_report_is_words_or_json_or_nothing() {
        let answer = |shell: &Shell| shell.answer(&[1, 2], "one and two").unwrap();
        assert_eq!(answer(&TALKS).as_deref(), Some("one and two"));
        assert_eq!(answer(&Shell { quiet: true, ..TALKS }), None);
        let json = answer(&Shell { json: true, quiet: true, ..TALKS }).unwrap();
        assert_eq!(serde_json::from_str::<Vec<u32>>(&json).unwrap(), [1, 2]);
    }

    #[test]
    fn work_gets_as_many_threads_as_allowed() {
        let pool = Shell { threads: Some(3), ..TALKS }.pool().build().unwrap();
        assert_eq!(pool.current_num_threads(), 3);
    }
}
