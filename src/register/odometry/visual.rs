//! The motion between two frames by visual features, alone or before surfaces: the thesis' VF and
//! VF + ICP.

use super::agreement::agreement;
use super::motion::FEW;
use super::sightings::Sightings;
use super::{Doubt, Look, Motion, OdometryOptions, by_icp};
use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};
use crate::register::features::MatchOptions;
use crate::register::icp::Verdict;
use crate::register::ransac::{Consensus, RansacOptions, ransac};
use nalgebra::Matrix6;

/// With fewer there is doubt.
const SOME: usize = 25;
/// The share of the matches that must agree.
const LEAST_SHARE: f64 = 0.25;
/// What may be left open of a motion that is believed [mm, deg]: half of what would be too much.
pub(super) const OPEN: [f64; 2] = [10.0, 0.5];
/// What the two halves of the sightings may differ by [mm, deg].
pub(super) const UNSTEADY: [f64; 2] = [20.0, 1.0];
/// Surfaces must bring brightness nearer by this share to be believed more than features.
const NEARER: f64 = 0.01;

/// The motion that explains where the features went.
pub(super) fn motion(
    previous: &Look,
    next: &Look,
    guess: &Pose,
    options: &OdometryOptions,
) -> Motion {
    match consensus(previous, next, options) {
        Ok((seen, found)) => judged(&seen, &found),
        Err(doubt) => Motion::failed(guess, doubt),
    }
}

/// What both frames see, and the motion that most of it agrees on; or why there is none.
pub(super) fn consensus(
    previous: &Look,
    next: &Look,
    options: &OdometryOptions,
) -> Result<(Sightings, Consensus<Pose>), Doubt> {
    let Some(seen) = Sightings::of(previous, next, &MatchOptions::default()) else {
        let why = "the frame has no colours to look for features in; use --method icp";
        return Err(Doubt::Unusable(why.to_owned()));
    };
    let few = |n: usize, of: usize| Doubt::FewInliers { n, of, least: FEW };
    if seen.all.len() < FEW {
        return Err(few(seen.all.len(), seen.n_matches));
    }
    let tries = RansacOptions { seed: options.seed, ..RansacOptions::default() };
    let Some(found) = ransac(&seen, &tries) else { return Err(few(0, seen.all.len())) };
    if found.inliers.len() < FEW {
        return Err(few(found.inliers.len(), seen.all.len()));
    }
    Ok((seen, found))
}

/// The same, laid over by surfaces then; that is taken only if the pictures agree better, which
/// surfaces know nothing of. Where features fail, surfaces begin at the guess.
pub(super) fn motion_then_icp(
    previous: &Look,
    next: &Look,
    guess: &Pose,
    options: &OdometryOptions,
    progress: &dyn Progress,
) -> Result<Motion, Cancelled> {
    let visual = motion(previous, next, guess, options);
    let start = visual.previous_from_next;
    let surface = by_icp::motion(previous, next, &start, options, progress)?;
    if visual.verdict == Verdict::Failed {
        return Ok(surface);
    }
    let pictures = [start, surface.previous_from_next].map(|pose| agreement(previous, next, &pose));
    let is_better = match pictures {
        [Some(before), Some(after)] => {
            after.brightness < before.brightness * (1.0 - NEARER)
                && after.seen_through <= before.seen_through
        }
        _ => false,
    };
    if surface.verdict == Verdict::Ok && is_better {
        // What features know is known still, and what surfaces know besides.
        let information = visual.information + surface.information;
        return Ok(Motion::new(
            surface.previous_from_next,
            visual.reasons,
            information,
            visual.overlap,
        ));
    }
    Ok(visual)
}

/// What the features that agree hold, and what speaks against their motion.
pub(super) fn judged(seen: &Sightings, found: &Consensus<Pose>) -> Motion {
    let (pose, inliers) = (&found.hypothesis, &found.inliers);
    let (n, of) = (inliers.len(), seen.all.len());
    let mut reasons: Vec<Doubt> = few(n, of).into_iter().collect();
    let information = seen.information(pose, inliers);
    let open = open(&information);
    if !is_within(open, OPEN) {
        let [moved, turned_deg] = open;
        reasons.push(Doubt::Open { moved, turned_deg });
    }
    let halves = [0, 1].map(|k| {
        let half: Vec<usize> = inliers.iter().copied().skip(k).step_by(2).collect();
        seen.fitted(&half)
    });
    let apart = match halves {
        [Some(one), Some(other)] => between(&one, &other),
        _ => [f64::INFINITY; 2],
    };
    if !is_within(apart, UNSTEADY) {
        let [moved, turned_deg] = apart;
        reasons.push(Doubt::Unsteady { moved, turned_deg });
    }
    Motion::new(*pose, reasons, information, n as f64 / of as f64)
}

/// The doubt that `n` features that agree, of all that matched, are too few.
pub(super) fn few(n: usize, of: usize) -> Option<Doubt> {
    let least = SOME.max((LEAST_SHARE * of as f64).ceil() as usize);
    (n < least).then_some(Doubt::FewInliers { n, of, least })
}

/// Three standard deviations of where the camera is and how it is turned [mm, deg].
pub(super) fn open(information: &Matrix6<f64>) -> [f64; 2] {
    let Some(covariance) = information.try_inverse() else { return [f64::INFINITY; 2] };
    let greatest = |at: usize| {
        let block = covariance.fixed_view::<3, 3>(at, at).into_owned();
        3.0 * block.symmetric_eigenvalues().max().max(0.0).sqrt()
    };
    [greatest(3), greatest(0).to_degrees()]
}

pub(super) fn between(one: &Pose, other: &Pose) -> [f64; 2] {
    let off = one.inverse() * other;
    [off.translation.vector.norm(), off.rotation.angle().to_degrees()]
}

/// A comparison that NaN fails.
pub(super) fn is_within([moved, turned]: [f64; 2], most: [f64; 2]) -> bool {
    moved <= most[0] && turned <= most[1]
}
