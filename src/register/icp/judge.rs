//! Looking at a pose that was reached: what speaks against it.

use super::LEAST_PAIRS;
use super::cost::{Cost, Motion};
use super::held::Held;
use super::options::Pairing;
use super::pair::{Pair, Pairs};
use super::settled::Settled;
use super::verdict::{LITTLE_OVERLAP, Reason, Verdict};
use super::view::{View, median};
use crate::geom::{Point3, Pose};
use nalgebra::Matrix6;

/// Points looked at from either side at most.
const LOOKED_AT: usize = 20_000;
/// A motion is free if a pair, on average, opposes it by less than this (squared sine of the angle
/// between motion and surface); noise of the normals opposes any motion by about a tenth of it.
const FREE: f64 = 2e-3;
/// Below this overlap a pose is doubtful.
const SOME_OVERLAP: f64 = 0.3;
/// Surfaces this many times farther apart than they are rough do not coincide.
const MISFIT: f64 = 3.0;
/// A source that was moved farther than this many first distances went beyond its reach.
const REACH: f64 = 3.0;

/// A pose, and what is to be known about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// The motion that lays the source over the target.
    pub target_from_source: Pose,
    /// Whether it may be believed.
    pub verdict: Verdict,
    /// Why it may not, or not quite.
    pub reasons: Vec<Reason>,
    /// What was settled about metric and lengths.
    pub settled: Settled,
    /// Steps taken at all levels.
    pub n_iterations: u32,
    /// True if the last step was small enough.
    pub converged: bool,
    /// Points of source and target, one to a voxel.
    pub n_points: [usize; 2],
    /// Source points with a partner at the end.
    pub n_inliers: usize,
    /// Root mean square of the inliers' residuals, in the metric [mm].
    pub rms: f64,
    /// Root mean square of the inliers' distances from point to point [mm].
    pub point_rms: f64,
    /// Median distance of the inliers from their partners' tangent planes [mm].
    pub plane_distance: f64,
    /// How far neighbours lie off their plane: the greater of both clouds' medians [mm].
    pub roughness: f64,
    /// The share of the source that lies on the target, and of the target on the source.
    pub overlap: [f64; 2],
    /// How far the source was moved from the start, root mean square of its points [mm].
    pub moved: f64,
    /// What the pairs know about a small motion: turn [rad] before shift [mm], about `pivot`.
    ///
    /// The inverse of the covariance, as if every pair erred on its own: real errors are larger.
    pub information: Matrix6<f64>,
    /// What `information` turns about, in the target's frame [mm].
    pub pivot: Point3,
    /// Least share of a motion that the surfaces oppose: 0 where they let it pass.
    pub least_held: f64,
}

/// What happened on the way.
#[derive(Debug, Clone)]
pub(super) struct Course {
    pub(super) pose: Pose,
    pub(super) n_iterations: u32,
    pub(super) converged: bool,
    /// Too few pairs were left.
    pub(super) starved: bool,
    /// Pairs at the start.
    pub(super) first_pairs: Option<usize>,
    /// Turn and shift.
    pub(super) last_step: [f64; 2],
    pub(super) colour_scale: f64,
}

impl Course {
    pub(super) fn at(pose: Pose) -> Self {
        Self {
            pose,
            n_iterations: 0,
            converged: false,
            starved: false,
            first_pairs: None,
            last_step: [f64::INFINITY; 2],
            colour_scale: 0.0,
        }
    }
}

impl Alignment {
    /// Adds what somebody else has to say against the pose.
    pub(in crate::register) fn object(&mut self, reason: Reason) {
        self.verdict = self.verdict.max(reason.verdict());
        self.reasons.push(reason);
    }

    /// Takes back the reasons at these places.
    pub(in crate::register) fn withdraw(&mut self, places: &[usize]) {
        let mut place = 0..;
        self.reasons.retain(|_| place.next().is_none_or(|i| !places.contains(&i)));
        let verdicts = self.reasons.iter().map(Reason::verdict);
        self.verdict = verdicts.max().unwrap_or(Verdict::Ok);
    }

    /// What the pairs know about a small motion from the left, about `origin` of the target's frame
    /// instead of about the pivot: turning by `w` about the pivot `p` is turning about the origin and
    /// shifting by `p × w` more.
    pub(in crate::register) fn information_about(&self, origin: &Point3) -> Matrix6<f64> {
        let mut change = Matrix6::identity();
        let cross = (self.pivot - origin).cross_matrix();
        change.fixed_view_mut::<3, 3>(3, 0).copy_from(&-cross);
        change.transpose() * self.information * change
    }

    /// The covariance of a small motion, turn [rad] before shift [mm], about `pivot`; `None` where
    /// a motion is free. It holds as far as every pair errs on its own: real errors are larger.
    pub fn covariance(&self) -> Option<Matrix6<f64>> {
        let is_free = |reason: &Reason| matches!(reason, Reason::Free(_));
        if self.reasons.iter().any(is_free) { None } else { self.information.try_inverse() }
    }
}

/// Looks at the pose that was reached; poses are about the views' centres.
pub(super) fn judge(
    views: [&View; 2],
    start: &Pose,
    course: &Course,
    settled: &Settled,
) -> Alignment {
    let [source, target] = views;
    let motion = Motion::from(&course.pose);
    let within = settled.final_distance;
    let pairs = all_pairs([source, target], &motion, within);
    let backward = all_pairs([target, source], &Motion::from(&course.pose.inverse()), within);
    let colour_scale = course.colour_scale;
    let cost = Cost { source, target, metric: settled.metric, colour_scale };
    let n = pairs.len().max(1) as f64;
    let mean = |of: &dyn Fn(&Pair) -> f64| pairs.iter().map(of).sum::<f64>() / n;
    let plane = |pair: &Pair| {
        let at = motion.apply(&source.points[pair.source as usize]);
        let j = pair.target as usize;
        target.normals[j].dot(&(at - target.points[j])).abs()
    };
    let square = mean(&|pair| cost.square(&motion, pair));
    let start_motion = Motion::from(start);
    let way = |point: &Point3| (motion.apply(point) - start_motion.apply(point)).norm_squared();
    let held = Held::new(&cost, &motion, &pairs);
    // Exact copies have no residuals; even they are known no better than to rounding.
    let noise = square.max((1e-9 * settled.voxel).powi(2));
    let mut alignment = Alignment {
        target_from_source: course.pose,
        verdict: Verdict::Ok,
        reasons: Vec::new(),
        settled: *settled,
        n_iterations: course.n_iterations,
        converged: course.converged,
        n_points: views.map(View::len),
        n_inliers: pairs.len(),
        rms: square.sqrt(),
        point_rms: mean(&|pair| pair.distance * pair.distance).sqrt(),
        plane_distance: median(&mut pairs.iter().map(plane).collect::<Vec<_>>()),
        roughness: source.roughness.max(target.roughness),
        overlap: [
            pairs.len() as f64 / looked_at(source).len() as f64,
            backward.len() as f64 / looked_at(target).len() as f64,
        ],
        moved: (source.points.iter().map(way).sum::<f64>() / source.len() as f64).sqrt(),
        information: held.information * (n / noise),
        pivot: held.pivot + target.center.coords,
        least_held: held.values[0],
    };
    alignment.reasons = reasons(&alignment, course, &held);
    let verdicts = alignment.reasons.iter().map(Reason::verdict);
    alignment.verdict = verdicts.max().unwrap_or(Verdict::Ok);
    alignment
}

fn reasons(alignment: &Alignment, course: &Course, held: &Held) -> Vec<Reason> {
    let settled = &alignment.settled;
    let overlap = alignment.overlap;
    if course.first_pairs.is_none_or(|n| n < LEAST_PAIRS) {
        return vec![Reason::OutOfReach { within: settled.max_distance }];
    }
    if course.starved {
        return vec![Reason::Starved];
    }
    if overlap[0].max(overlap[1]) < LITTLE_OVERLAP {
        // Of so few pairs nothing else can be told.
        return vec![Reason::LittleOverlap { overlap }];
    }
    let mut reasons = Vec::new();
    let free = held.motions(0.0..FREE);
    // Were the surfaces off all alike, by what they are off in the median, a motion that a pair
    // opposes by `held` could be wrong by that over the root of `held`.
    let weak = held.motions(FREE..(alignment.plane_distance / settled.voxel).powi(2));
    if !free.is_empty() {
        reasons.push(Reason::Free(free));
    }
    if !weak.is_empty() {
        let least = held.values.into_iter().find(|value| *value >= FREE).unwrap_or(1.0);
        let open = alignment.plane_distance / least.sqrt();
        reasons.push(Reason::Weak { motions: weak, open });
    }
    if overlap[0].max(overlap[1]) < SOME_OVERLAP {
        reasons.push(Reason::LittleOverlap { overlap });
    }
    if !course.converged {
        let [turn, shift] = course.last_step;
        reasons.push(Reason::NotConverged { turn_deg: turn.to_degrees(), shift });
    }
    let roughness = alignment.roughness.max(1e-3 * settled.voxel);
    if alignment.plane_distance > MISFIT * roughness {
        reasons.push(Reason::Misfit { distance: alignment.plane_distance, roughness });
    }
    if alignment.moved > REACH * settled.max_distance {
        reasons.push(Reason::WentFar { moved: alignment.moved, within: settled.max_distance });
    }
    reasons
}

/// Which points of a view are looked at, evenly spread.
fn looked_at(view: &View) -> Vec<u32> {
    let stride = view.len().div_ceil(LOOKED_AT).max(1);
    (0..view.len() as u32).step_by(stride).collect()
}

fn all_pairs(views: [&View; 2], motion: &Motion, within: f64) -> Vec<Pair> {
    let mut pairs = Pairs::new(views[0], views[1], Pairing::KdTree);
    pairs.ask(looked_at(views[0]));
    pairs.find(motion, within)
}
