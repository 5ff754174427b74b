//! How a growing neural gas learns, and when it stops.

use crate::compute::ComputeChoice;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How a growing neural gas learns, and when it stops: as soon as any of what is asked for is reached.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct GngOptions {
    /// Rates to begin with; options below replace single ones.
    #[arg(long, value_name = "PRESET", default_value = "standard")]
    pub preset: Preset,
    /// Signals between two new neurons.
    #[arg(long, value_name = "N", default_value_t = Self::default().lambda)]
    pub lambda: u32,
    /// How far the winner goes towards the signal, of the way [preset: 0.1].
    #[arg(long, value_name = "SHARE")]
    pub winner_rate: Option<f64>,
    /// How far the winner's neighbours go [preset: 0.001].
    #[arg(long, value_name = "SHARE")]
    pub neighbour_rate: Option<f64>,
    /// Edges not confirmed for longer than this many wins of their ends are cut [preset: 250].
    #[arg(long, value_name = "N")]
    pub max_age: Option<u32>,
    /// What is left of the error of two neurons that get a new one between them [preset: 0.5].
    #[arg(long, value_name = "SHARE")]
    pub split_error: Option<f64>,
    /// When all errors decay [preset: insertion; thesis: signal].
    #[arg(long, value_name = "WHEN")]
    pub decay: Option<Decay>,
    /// What is left of an error when it decays [preset: 0.95].
    #[arg(long, value_name = "SHARE")]
    pub decay_rate: Option<f64>,
    /// What draws the signals: the same seed, the same network.
    #[arg(long, value_name = "N", default_value_t = Self::default().seed)]
    pub seed: u64,
    /// How winners are found; the network is the same.
    #[arg(long, value_name = "HOW", default_value = "grid")]
    pub search: Search,
    /// Where the network learns; `auto` begins on the processor and goes on where a signal takes less.
    #[arg(long, value_name = "WHERE", default_value = "cpu")]
    pub compute: ComputeChoice,
    /// The device to learn on: part of its name, as `horma devices` tells it [default: the fastest kind].
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Find the winners of this many signals at once, on all cores, and let the network learn them after
    /// another: another network, nearly as good [default: one at a time].
    #[arg(long, value_name = "N")]
    pub batch: Option<usize>,
    /// Stop after this many signals.
    #[arg(long, value_name = "N")]
    pub max_signals: Option<u64>,
    /// Stop after this time [s]; where it stops depends on the machine.
    #[arg(long, value_name = "S")]
    pub max_seconds: Option<f64>,
    /// Stop growing when signals are no farther than this from their neurons on average [mm].
    #[arg(long, value_name = "MM")]
    pub target_error: Option<f64>,
}

/// Named rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Those of the thesis, errors decaying with every new neuron.
    Standard,
    /// Those of Morell (2014), section 4.3.3.3, errors decaying with every signal.
    Thesis,
}

/// When all errors decay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Decay {
    /// After every signal. Fritzke (1995), step 9.
    Signal,
    /// After every new neuron: the network remembers thousands of signals and grows where it is worst.
    Insertion,
}

/// How winners are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// In the cells around the signal, once there are some hundred neurons.
    Grid,
    /// Among all neurons, many side by side.
    Scan,
}

/// What a signal changes, with every preset resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rates {
    pub(super) winner: f32,
    pub(super) neighbour: f32,
    pub(super) max_age: u32,
    pub(super) split_error: f64,
    pub(super) decay: Decay,
    pub(super) decay_rate: f64,
}

/// An option, its value, what is true of good ones, and in words.
type Rule = (&'static str, Option<f64>, fn(&f64) -> bool, &'static str);

/// An option that means nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{option} is {value}; give {must}")]
pub struct OptionError {
    /// Its name.
    pub option: &'static str,
    /// What was given.
    pub value: f64,
    /// What can be given.
    pub must: &'static str,
}

impl Default for GngOptions {
    fn default() -> Self {
        Self {
            preset: Preset::Standard,
            lambda: 1000,
            winner_rate: None,
            neighbour_rate: None,
            max_age: None,
            split_error: None,
            decay: None,
            decay_rate: None,
            seed: 1,
            search: Search::Grid,
            compute: ComputeChoice::Cpu,
            adapter: None,
            batch: None,
            max_signals: None,
            max_seconds: None,
            target_error: None,
        }
    }
}

impl GngOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), OptionError> {
        let is_share = |x: &f64| 0.0 < *x && *x <= 1.0;
        let is_above = |x: &f64| 0.0 < *x && x.is_finite();
        let is_count = |x: &f64| 1.0 <= *x;
        let share = "a number above 0, at most 1";
        let count = "a whole number above 0";
        let rules: [Rule; 10] = [
            ("--winner-rate", self.winner_rate, is_share, share),
            ("--neighbour-rate", self.neighbour_rate, is_share, share),
            ("--split-error", self.split_error, is_share, share),
            ("--decay-rate", self.decay_rate, is_share, share),
            ("--max-age", self.max_age.map(f64::from), is_count, count),
            ("--lambda", Some(f64::from(self.lambda)), is_count, count),
            ("--batch", self.batch.map(|n| n as f64), is_count, count),
            ("--max-signals", self.max_signals.map(|n| n as f64), is_count, count),
            ("--max-seconds", self.max_seconds, is_above, "a time above 0"),
            ("--target-error", self.target_error, is_above, "a length above 0"),
        ];
        for (option, value, is_good, must) in rules {
            if let Some(value) = value.filter(|value| !is_good(value)) {
                return Err(OptionError { option, value, must });
            }
        }
        Ok(())
    }

    /// What a signal changes.
    pub(super) fn rates(&self) -> Rates {
        let decay = match self.preset {
            Preset::Standard => Decay::Insertion,
            Preset::Thesis => Decay::Signal,
        };
        Rates {
            winner: self.winner_rate.unwrap_or(0.1) as f32,
            neighbour: self.neighbour_rate.unwrap_or(0.001) as f32,
            max_age: self.max_age.unwrap_or(250),
            split_error: self.split_error.unwrap_or(0.5),
            decay: self.decay.unwrap_or(decay),
            decay_rate: self.decay_rate.unwrap_or(0.95),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_options_replace_what_a_preset_says() {
        let thesis = GngOptions { preset: Preset::Thesis, ..GngOptions::default() };
        assert_eq!(thesis.rates(), Rates { decay: Decay::Signal, ..GngOptions::default().rates() });
        let other = GngOptions { decay: Some(Decay::Insertion), max_age: Some(9), ..thesis };
        assert_eq!((other.rates().decay, other.rates().max_age), (Decay::Insertion, 9));
    }

    #[test]
    fn numbers_that_mean_nothing_are_refused_by_name() {
        let good = GngOptions::default();
        assert_eq!(good.check(), Ok(()));
        for (bad, name) in [
            (GngOptions { winner_rate: Some(0.0), ..good.clone() }, "--winner-rate"),
            (GngOptions { neighbour_rate: Some(1.5), ..good.clone() }, "--neighbour-rate"),
            (GngOptions { decay_rate: Some(f64::NAN), ..good.clone() }, "--decay-rate"),
            (GngOptions { max_age: Some(0), ..good.clone() }, "--max-age"),
            (GngOptions { lambda: 0, ..good.clone() }, "--lambda"),
            (GngOptions { batch: Some(0), ..good.clone() }, "--batch"),
            (GngOptions { max_seconds: Some(-1.0), ..good.clone() }, "--max-seconds"),
            (GngOptions { target_error: Some(f64::INFINITY), ..good.clone() }, "--target-error"),
        ] {
            let error = bad.check().unwrap_err().to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}
