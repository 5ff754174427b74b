//! Progress as a bar on stderr, which also carries the request to stop.

use crate::interrupt::{self, Listening};
use horma::progress::{Cancelled, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

const TEMPLATE: &str = "{msg:<24} {wide_bar} {percent:>3}% {eta:>4} {prefix}";

/// One bar, restarted by every stage; while it lives, Ctrl-C is a request to stop.
pub(crate) struct Bar {
    bar: ProgressBar,
    _listening: Listening,
}

impl Bar {
    /// A bar on stderr, or none at all when `quiet` or when stderr is no terminal.
    pub(crate) fn new(quiet: bool) -> Self {
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style =
            ProgressStyle::with_template(TEMPLATE).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::with_draw_target(Some(0), target);
        bar.set_style(style);
        Self { bar, _listening: Listening::begin() }
    }

    /// The last chance to stop, before outputs get their names: who was told that it stops shall not
    /// find them.
    pub(crate) fn stop_if_asked(&self) -> Result<(), Cancelled> {
        self.advance(0)
    }
}

impl Progress for Bar {
    fn start(&self, stage: &str, n_units: u64) {
        self.bar.reset();
        self.bar.set_length(n_units);
        self.bar.set_message(stage.to_owned());
        self.bar.set_prefix("");
    }

    fn advance(&self, n_units: u64) -> Result<(), Cancelled> {
        self.bar.inc(n_units);
        if interrupt::requested() { Err(Cancelled) } else { Ok(()) }
    }

    fn tell(&self, words: &str) {
        self.bar.set_prefix(words.to_owned());
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_one_the_bar_understands() {
        assert!(ProgressStyle::with_template(TEMPLATE).is_ok());
    }

    #[test]
    fn a_quiet_bar_is_hidden_and_still_counts() {
        let bar = Bar::new(true);
        bar.start("digitize", 10);
        bar.advance(4).unwrap();
        assert!(bar.bar.is_hidden());
        assert_eq!(bar.bar.position(), 4);
        bar.start("write", 3);
        assert_eq!(bar.bar.position(), 0);
    }
}
