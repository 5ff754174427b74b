//! Progress as a bar on stderr, and Ctrl-C as a request to stop.

use horma::progress::{Cancelled, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// One bar, restarted by every stage.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// A bar on stderr, or none at all when `quiet`; it also listens for Ctrl-C from now on.
    pub(crate) fn new(quiet: bool) -> Self {
        // A second listener is refused by the crate; the first one serves every bar.
        let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style = ProgressStyle::with_template("{msg:<24} {wide_bar} {percent:>3}% {eta:>4}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::with_draw_target(Some(0), target);
        bar.set_style(style);
        Self(bar)
    }
}

impl Progress for Bar {
    fn start(&self, stage: &str, n_units: u64) {
        self.0.reset();
        self.0.set_length(n_units);
        self.0.set_message(stage.to_owned());
    }

    fn advance(&self, n_units: u64) -> Result<(), Cancelled> {
        self.0.inc(n_units);
        if STOP.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
