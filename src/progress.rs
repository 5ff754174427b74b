//! How long work reports how far it is, and learns that it should stop.

/// The caller asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped on request; nothing was written")]
pub struct Cancelled;

/// Where long work reports to. Called from many threads at once.
pub trait Progress: Sync {
    /// A stage of `n_units` units of work begins.
    fn start(&self, stage: &str, n_units: u64);

    /// `n_units` more units are done; an error asks the caller to stop.
    fn advance(&self, n_units: u64) -> Result<(), Cancelled>;

    /// How the stage goes, in a few words that replace those before.
    fn tell(&self, _words: &str) {}
}

/// Reports to nobody and never stops.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn start(&self, _stage: &str, _n_units: u64) {}

    fn advance(&self, _n_units: u64) -> Result<(), Cancelled> {
        Ok(())
    }
}
