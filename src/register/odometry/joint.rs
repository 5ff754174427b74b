//! The motion between two frames by features and surfaces at once: RGBD-ICP.
//!
//! Features alone are few, and surfaces alone slide. Features find where to begin, and which of them
//! agree; then what those are off in the pictures and what the surfaces are off is made small
//! together. Henry, Krainin, Herbst, Ren and Fox (2012), *RGB-D mapping: using Kinect-style depth
//! cameras for dense 3D modeling of indoor environments*, section 4.

use super::sightings::Sightings;
use super::visual::{self, OPEN, UNSTEADY, between, is_within, open};
use super::{Doubt, Look, Motion, OdometryOptions, by_icp};
use crate::geom::{Point3, Pose};
use crate::progress::{Cancelled, Progress};
use crate::register::icp::{Alignment, Beside, Evidence, IcpError, Normal, Reason};
use crate::register::ransac::Consensus;

/// What the surfaces count for where features count for 1. Between 0.1 and 1 little changes: more takes
/// the turn from the features, less the shift from the surfaces.
const SURFACES: f64 = 0.3;
/// No feature is found again to less than this [variances of a sighting].
const LEAST_VARIANCE: f64 = 0.1;

/// The motion that features and surfaces agree on: of surfaces alone, from the guess, where features
/// fail, and of features alone where surfaces do.
pub(super) fn motion(
    previous: &Look,
    next: &Look,
    guess: &Pose,
    options: &OdometryOptions,
    progress: &dyn Progress,
) -> Result<Motion, Cancelled> {
    let Ok((seen, found)) = visual::consensus(previous, next, options) else {
        return by_icp::motion(previous, next, guess, options, progress);
    };
    let evidence = Agreeing::new(&seen, &found);
    let beside = Beside { evidence: &evidence, surfaces: SURFACES };
    let start = &found.hypothesis;
    match by_icp::aligned(previous, next, start, (Some(&beside), options), progress) {
        Ok(surfaces) if has_pairs(&surfaces) => Ok(judged(&seen, &found, &surfaces)),
        Err(IcpError::Cancelled(cancelled)) => Err(cancelled),
        Ok(_) | Err(_) => Ok(visual::judged(&seen, &found)),
    }
}

/// The features that agree, as evidence beside surfaces.
struct Agreeing<'a> {
    seen: &'a Sightings,
    inliers: &'a [usize],
    /// What their squares are by themselves, in the mean.
    variance: f64,
}

impl<'a> Agreeing<'a> {
    fn new(seen: &'a Sightings, found: &'a Consensus<Pose>) -> Self {
        let square = seen.mean_square(&found.hypothesis, &found.inliers).cost;
        Self { seen, inliers: &found.inliers, variance: square.max(LEAST_VARIANCE) }
    }
}

impl Evidence for Agreeing<'_> {
    fn mean_square(&self, previous_from_next: &Pose) -> Normal {
        self.seen.mean_square(previous_from_next, self.inliers) * (1.0 / self.variance)
    }
}

fn has_pairs(surfaces: &Alignment) -> bool {
    let is_without =
        |reason: &Reason| matches!(reason, Reason::OutOfReach { .. } | Reason::Starved);
    !surfaces.reasons.iter().any(is_without)
}

/// The joint motion, with what either has against it: but what one leaves open, the other may hold.
fn judged(seen: &Sightings, found: &Consensus<Pose>, surfaces: &Alignment) -> Motion {
    let pose = surfaces.target_from_source;
    let of_features = visual::judged(seen, found);
    let mut reasons = of_features.reasons;
    reasons.retain(|doubt| !doubt.is_weakness());
    let held = |reason: &&Reason| !matches!(reason, Reason::Free(_) | Reason::Weak { .. });
    reasons.extend(surfaces.reasons.iter().filter(held).cloned().map(Doubt::Surface));
    let [moved, turned_deg] = between(&found.hypothesis, &pose);
    if !is_within([moved, turned_deg], UNSTEADY) {
        reasons.push(Doubt::Contradicted { moved, turned_deg });
    }
    let of_features = seen.information(&pose, &found.inliers);
    let of_surfaces = surfaces.information_about(&Point3::origin());
    let [moved, turned_deg] = open(&(of_features + of_surfaces * alike(surfaces)));
    if !is_within([moved, turned_deg], OPEN) {
        reasons.push(Doubt::Open { moved, turned_deg });
    }
    Motion::new(pose, reasons, of_features + of_surfaces, surfaces.overlap[1])
}

/// What is left of the surfaces' information if they are off all alike, and three standard deviations of
/// that are what they are apart in the median.
fn alike(surfaces: &Alignment) -> f64 {
    let share = 3.0 * surfaces.rms / surfaces.plane_distance;
    (share.powi(2) / surfaces.n_inliers as f64).min(1.0)
}
