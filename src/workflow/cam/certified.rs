//! The path as it will be written, with what is proved of it.
//!
//! The certificate holds for the program, not only for the path: all words but the attack axis' are
//! rounded as the dialect writes them *before* they are digitized, and half a decimal of the attack
//! axis is kept back from the tolerance.

use super::heights::Heights;
use super::options::{CamOptions, OptionsError};
use crate::cam::{
    Certificate, CertifyOptions, Digitizer, Draft, Grid, Position, Trajectory, certify,
};
use crate::gcode::Dialect;
use crate::machine::{AxisValues, Machine};
use crate::progress::{Cancelled, Progress};

/// The deepest gouge unless told otherwise [mm].
const TOLERANCE: f64 = 0.01;
/// The shortest step unless told otherwise [mm and deg].
const MIN_STEP: f64 = 0.005;

/// What is to be proved, and where words may lie.
pub(super) struct Proof {
    /// Of the program as written [mm].
    tolerance: f64,
    options: CertifyOptions,
}

impl Proof {
    /// What `options` ask for: a proof, unless they do without.
    pub(super) fn asked(
        options: &CamOptions,
        machine: &Machine,
        dialect: &Dialect,
    ) -> Result<Option<Self>, OptionsError> {
        if options.no_certify {
            return Ok(None);
        }
        let decimal = |decimals: u8| 10_f64.powi(-i32::from(decimals));
        let (linear, rotary) = (dialect.decimals.linear, dialect.decimals.rotary);
        let tolerance = options.tolerance.unwrap_or(TOLERANCE);
        let rounding = decimal(linear) / 2.0;
        if tolerance <= rounding {
            return Err(OptionsError::TooFine { tolerance, rounding });
        }
        let min_step = options.min_step.unwrap_or(MIN_STEP);
        let options = CertifyOptions {
            gouge: tolerance - rounding,
            grid: Grid::new(machine, decimal(linear), decimal(rotary).to_radians()),
            least_step: [min_step, min_step.to_radians()],
            thin: options.thin,
        };
        Ok(Some(Self { tolerance, options }))
    }
}

/// The words of position `i` of `way` but for the attack axis.
pub(super) fn words(
    proof: Option<&Proof>,
    machine: &Machine,
    way: &Trajectory,
    i: usize,
) -> AxisValues {
    let words = way.values(i);
    proof.map_or(words, |proof| proof.options.grid.round(machine, &words))
}

/// All positions of the path, and what is proved of them.
pub(super) fn positions(
    proof: Option<&Proof>,
    digitizer: &Digitizer,
    heights: &Heights,
    words: impl Fn(usize) -> AxisValues + Sync,
    progress: &dyn Progress,
) -> Result<(Vec<Position>, Option<Certificate>), Cancelled> {
    let machine = heights.machine;
    let position = |i: usize| {
        let mut words = words(i);
        words[machine.attack] = heights.word(i);
        (words, heights.contacts[i])
    };
    let n_positions = heights.contacts.len();
    let Some(proof) = proof else {
        let as_digitized = |i: usize| {
            let (words, contact) = position(i);
            Position { words, touched: contact.map(|contact| contact.point) }
        };
        return Ok(((0..n_positions).map(as_digitized).collect(), None));
    };
    let draft = Draft { machine, n_positions, position };
    let made = certify(digitizer, &draft, &proof.options, progress)?;
    Ok((made.positions, Some(Certificate { gouge: proof.tolerance, ..made.certificate })))
}
