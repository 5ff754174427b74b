//! Loops of a walk: where the camera sees again what it saw long before, and what that says of all that
//! lies between.
//!
//! Key frames that look alike ([`KeyFrames`]), or that are near each other by what the walk says, are laid
//! over each other without regard to the walk: features by consensus, then whatever the walk is followed
//! by. A loop counts if nothing speaks against it but that it is weakly held; with the walk it makes a pose graph, in which loops
//! that do not fit are given no weight. Frames that are no key frames hang on theirs.

mod candidates;
mod keys;
mod options;

pub use keys::{KeyFrame, KeyFrames};
pub use options::LoopOptions;

use super::icp::Verdict;
use super::odometry::{Doubt, Link, Method, Motion, OdometryOptions, motion};
use super::pose_graph::{Edge, EdgeKind, GraphError, PoseGraph, Settled, settle};
use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};
use candidates::{Candidate, candidates};
use nalgebra::{Matrix6, Vector6};

/// What features and surfaces may differ by [mm, deg].
const CONTRADICTED: [f64; 2] = [30.0, 1.5];
/// A loop this near another one (in key frames, at both ends) adds nothing.
const SAME: usize = 2;
/// What a step and a loop are off at least, whatever was found [rad; share of the depth]. A shutter that
/// rolls, and depth and colour that are not of one moment, bend a frame as a whole: that makes the step to
/// it wrong and the step from it by the opposite, so that a walk does not add it up; but a loop has it
/// once at either end.
const STEP_OFF: f64 = 0.0008;
const LOOP_OFF: f64 = 0.004;
/// So many loops may outvote the walk,
const VOTERS: usize = 3;
/// and have its steps off by so many times more than they say.
const WORSE: [f64; 3] = [3.0, 10.0, 30.0];

/// A loop that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// The frame that was seen again, counted from 0.
    pub earlier: usize,
    /// The frame that sees it again.
    pub later: usize,
    /// What became of it.
    pub outcome: LoopOutcome,
}

/// What became of a loop.
#[derive(Debug, Clone, PartialEq)]
pub enum LoopOutcome {
    /// It holds the walk together.
    Closed {
        /// How far it is off what was settled [standard deviations].
        off: f64,
    },
    /// What was found is not believed.
    Refused(Vec<Doubt>),
    /// It does not fit the others.
    Dropped {
        /// How far it is off what was settled [standard deviations].
        off: f64,
    },
}

/// A frame of a walk, as far as loops go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Where the camera was; `None` if the frame was skipped.
    pub world_from_camera: Option<Pose>,
    /// What it hangs on.
    pub link: Option<Link>,
}

/// A walk with its loops.
#[derive(Debug, Clone, PartialEq)]
pub struct Closed {
    /// Where the camera was at every step; as before where no loop closed.
    pub world_from_camera: Vec<Option<Pose>>,
    /// Loops that were tried.
    pub loops: Vec<Loop>,
}

impl Closed {
    /// How many loops hold the walk together.
    pub fn n_closed(&self) -> usize {
        let is_closed = |tried: &&Loop| matches!(tried.outcome, LoopOutcome::Closed { .. });
        self.loops.iter().filter(is_closed).count()
    }
}

/// Looks for loops among the key frames of a walk, and settles the walk with those that are found.
pub fn close_loops(
    walk: &[Step],
    keys: &[KeyFrame],
    (options, odometry): (&LoopOptions, &OdometryOptions),
    progress: &dyn Progress,
) -> Result<Closed, GraphError> {
    let as_before = || walk.iter().map(|step| step.world_from_camera).collect();
    let found = found(keys, (options, odometry), progress)?;
    if found.iter().all(|(_, motion)| !is_believed(motion)) {
        let loops = found.iter().map(|(candidate, motion)| refused(keys, candidate, motion));
        return Ok(Closed { world_from_camera: as_before(), loops: loops.collect() });
    }
    let (graph, nodes) = graph(walk, keys, &found);
    let settled = outvoted(&graph, options, progress)?;
    Ok(Closed {
        world_from_camera: moved(walk, &nodes, &settled),
        loops: outcomes(keys, &found, &graph, &settled),
    })
}

/// Candidates and the motion from the later to the earlier one of each.
fn found(
    keys: &[KeyFrame],
    (options, odometry): (&LoopOptions, &OdometryOptions),
    progress: &dyn Progress,
) -> Result<Vec<(Candidate, Motion)>, Cancelled> {
    let mut found: Vec<(Candidate, Motion)> = Vec::new();
    let candidates = candidates(keys, options.loop_gap);
    progress.start("loops", candidates.len() as u64);
    for candidate in candidates {
        let is_near = |known: &Candidate| {
            known.earlier.abs_diff(candidate.earlier) < SAME
                && known.later.abs_diff(candidate.later) < SAME
        };
        if !found.iter().any(|(known, motion)| is_near(known) && is_believed(motion)) {
            let ends = [&keys[candidate.earlier], &keys[candidate.later]];
            found.push((candidate, laid(ends, odometry, progress)?));
        }
        progress.advance(1)?;
        let n_believed = found.iter().filter(|(_, motion)| is_believed(motion)).count();
        progress.tell(&format!("{n_believed} found"));
    }
    Ok(found)
}

/// Lays the later key frame over the earlier one, wherever the walk says that they are.
fn laid(
    [earlier, later]: [&KeyFrame; 2],
    odometry: &OdometryOptions,
    progress: &dyn Progress,
) -> Result<Motion, Cancelled> {
    let expected = earlier.world_from_camera.inverse() * later.world_from_camera;
    let by = |method: Method, start: &Pose| {
        let anywhere = OdometryOptions {
            method,
            most_moved: f64::INFINITY,
            most_turned_deg: f64::INFINITY,
            ..odometry.clone()
        };
        motion(&earlier.look, &later.look, start, &anywhere, progress)
    };
    if odometry.method != Method::Dvo {
        return by(odometry.method, &expected);
    }
    let features = by(Method::Visual, &expected)?;
    let has_start = features.verdict != Verdict::Failed;
    let start = if has_start { features.previous_from_next } else { expected };
    let found = by(Method::Dvo, &start)?;
    let off = features.previous_from_next.inverse() * found.previous_from_next;
    let (moved, turned_deg) = (off.translation.vector.norm(), off.rotation.angle().to_degrees());
    let agrees = moved <= CONTRADICTED[0] && turned_deg <= CONTRADICTED[1];
    let is_told = is_believed(&features);
    Ok(if is_told && !agrees {
        found.doubted(Doubt::Contradicted { moved, turned_deg })
    } else {
        found
    })
}

/// True if nothing speaks against a motion but that it is weakly held: the graph weighs it by that.
fn is_believed(motion: &Motion) -> bool {
    motion.verdict != Verdict::Failed && motion.reasons.iter().all(Doubt::is_weakness)
}

/// The graph settled. Where most of several loops do not fit the walk, they agree that it is the walk that
/// errs by more than it says, as where every step errs alike: then steps are taken for more wrong, as far
/// as it takes for most loops to fit.
fn outvoted(
    graph: &PoseGraph,
    options: &LoopOptions,
    progress: &dyn Progress,
) -> Result<Settled, GraphError> {
    let is_loop = |edge: &Edge| edge.kind == EdgeKind::Loop;
    let n_loops = graph.edges.iter().filter(|edge| is_loop(edge)).count();
    let first = settle(graph, &options.graph, progress)?;
    let fits = |settled: &Settled| {
        let loops = graph.edges.iter().zip(&settled.weights).filter(|(edge, _)| is_loop(edge));
        2 * loops.filter(|(_, weight)| **weight > 0.0).count() > n_loops
    };
    if n_loops < VOTERS || fits(&first) {
        return Ok(first);
    }
    for worse in WORSE {
        let mut looser = graph.clone();
        let steps = looser.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Step);
        steps.for_each(|edge| edge.information /= worse * worse);
        let settled = settle(&looser, &options.graph, progress)?;
        if fits(&settled) {
            return Ok(settled);
        }
    }
    Ok(first)
}

/// The walk's key frames and what was measured between them; and which frame each node is.
fn graph(
    walk: &[Step],
    keys: &[KeyFrame],
    found: &[(Candidate, Motion)],
) -> (PoseGraph, Vec<usize>) {
    let hung_on = walk.iter().filter_map(|step| Some(step.link?.key));
    let mut nodes: Vec<usize> = hung_on.chain(keys.iter().map(|key| key.number)).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let place = |number: usize| nodes.binary_search(&number).ok();
    let depth = |number: usize| {
        let after = keys.partition_point(|key| key.number < number).min(keys.len() - 1);
        keys[after].look.median_depth
    };
    let poses = nodes.iter().filter_map(|&number| walk[number].world_from_camera).collect();
    let step = |&number: &usize| {
        let link = walk[number].link?;
        let information = no_better(&link.information, STEP_OFF, depth(number));
        let (a, b) = (place(link.key)?, place(number)?);
        Some(Edge { a, b, a_from_b: link.key_from_camera, information, kind: EdgeKind::Step })
    };
    let closing = |(candidate, motion): &(Candidate, Motion)| {
        let ends = [candidate.earlier, candidate.later].map(|i| place(keys[i].number));
        let [Some(a), Some(b)] = ends else { return None };
        let depth = keys[candidate.later].look.median_depth;
        let information = no_better(&motion.information, LOOP_OFF, depth);
        let a_from_b = motion.previous_from_next;
        is_believed(motion).then_some(Edge { a, b, a_from_b, information, kind: EdgeKind::Loop })
    };
    let edges = nodes.iter().filter_map(step).chain(found.iter().filter_map(closing)).collect();
    (PoseGraph { world_from_node: poses, edges, fixed: 0 }, nodes)
}

/// What is known of a motion if it is `off` besides.
fn no_better(information: &Matrix6<f64>, off: f64, depth: f64) -> Matrix6<f64> {
    let (turn, shift) = (off.powi(2), (off * depth).powi(2));
    let off = Matrix6::from_diagonal(&Vector6::new(turn, turn, turn, shift, shift, shift));
    // The inverse of the sum of both covariances, without the inverse of what may have none.
    let both = Matrix6::identity() + off * information;
    let known = both.try_inverse().map_or_else(Matrix6::zeros, |inverse| information * inverse);
    (known + known.transpose()) / 2.0
}

/// Every frame where its key frame has come to be.
fn moved(walk: &[Step], nodes: &[usize], settled: &Settled) -> Vec<Option<Pose>> {
    let of_node = |number: usize| {
        let place = nodes.binary_search(&number).ok()?;
        Some(settled.world_from_node[place])
    };
    let of = |(number, step): (usize, &Step)| {
        let own = step.world_from_camera?;
        let hanging = || {
            let link = step.link?;
            Some(of_node(link.key)? * link.key_from_camera)
        };
        Some(of_node(number).or_else(hanging).unwrap_or(own))
    };
    walk.iter().enumerate().map(of).collect()
}

fn refused(keys: &[KeyFrame], candidate: &Candidate, motion: &Motion) -> Loop {
    let [earlier, later] = [candidate.earlier, candidate.later].map(|i| keys[i].number);
    Loop { earlier, later, outcome: LoopOutcome::Refused(motion.reasons.clone()) }
}

fn outcomes(
    keys: &[KeyFrame],
    found: &[(Candidate, Motion)],
    graph: &PoseGraph,
    settled: &Settled,
) -> Vec<Loop> {
    // Loops come last among the edges, in the order in which they were found.
    let mut edges = (0..graph.edges.len()).filter(|&i| graph.edges[i].kind == EdgeKind::Loop);
    let outcome = |(candidate, motion): &(Candidate, Motion)| {
        let tried = refused(keys, candidate, motion);
        let Some(i) = is_believed(motion).then(|| edges.next()).flatten() else { return tried };
        let off = settled.off[i];
        let is_dropped = settled.weights[i] == 0.0;
        let outcome =
            if is_dropped { LoopOutcome::Dropped { off } } else { LoopOutcome::Closed { off } };
        Loop { outcome, ..tried }
    };
    found.iter().map(outcome).collect()
}

#[cfg(test)]
mod tests;
