//! The motion between two frames by their surfaces alone: the thesis' ICP.

use super::{Doubt, Look, Motion, OdometryOptions};
use crate::geom::{Point3, Pose};
use crate::progress::{Cancelled, Progress};
use crate::register::icp::{
    Alignment, Beside, IcpError, IcpOptions, Metric, Settled, align_views_beside,
};

/// Neighbours a normal is taken from.
pub(super) const NEIGHBOURS: usize = 20;
/// The first distance of a pair, in voxels.
const FAR: f64 = 7.5;

/// Lays the surface of `next` over that of `previous`, beginning at `guess`.
pub(super) fn motion(
    previous: &Look,
    next: &Look,
    guess: &Pose,
    options: &OdometryOptions,
    progress: &dyn Progress,
) -> Result<Motion, Cancelled> {
    match aligned(previous, next, guess, (None, options), progress) {
        Ok(found) => {
            let reasons = found.reasons.iter().cloned().map(Doubt::Surface).collect();
            let overlap = found.overlap[1];
            let information = found.information_about(&Point3::origin());
            Ok(Motion::new(found.target_from_source, reasons, information, overlap))
        }
        Err(IcpError::Cancelled(cancelled)) => Err(cancelled),
        Err(error) => Ok(Motion::failed(guess, Doubt::Unusable(error.to_string()))),
    }
}

/// The same as the surfaces have it, and what else is known `beside` them.
pub(super) fn aligned(
    previous: &Look,
    next: &Look,
    guess: &Pose,
    (beside, options): (Option<&Beside>, &OdometryOptions),
    progress: &dyn Progress,
) -> Result<Alignment, IcpError> {
    let [target, source] = [previous, next].map(Look::surface);
    let (target, source) = (target.map_err(Clone::clone)?, source.map_err(Clone::clone)?);
    let icp = IcpOptions {
        fine: Some(Metric::Generalised),
        voxel: Some(previous.voxel),
        max_distance: Some(FAR * previous.voxel),
        neighbours: NEIGHBOURS,
        seed: options.seed,
        ..IcpOptions::default()
    };
    let settled = Settled::new(&source.cloud, &target.cloud, &icp)?;
    let still = Quiet(progress);
    align_views_beside([&source.view, &target.view], guess, (&settled, &icp), beside, &still)
}

/// Passes the wish to stop on, and keeps stages and counts to itself: a scan has its own.
struct Quiet<'a>(&'a dyn Progress);

impl Progress for Quiet<'_> {
    fn start(&self, _stage: &str, _n_units: u64) {}

    fn advance(&self, _n_units: u64) -> Result<(), Cancelled> {
        self.0.advance(0)
    }
}
