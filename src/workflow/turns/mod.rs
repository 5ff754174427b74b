//! A part that was turned several times, each time lying otherwise or before another camera height: one
//! surface of it.
//!
//! Each turn is a turntable of its own, calibrated and fused by itself. What that shows is laid on what
//! the other turns show, and then the frames of all turns that lie together make one surface.

mod lay;
mod report;

pub use report::TurnReport;

use super::fuse::{FuseError, FuseJob, FuseOptions, Fused, Placing, fuse};
use super::turntable::{CalibrateError, calibrate_turntable, turntable_report};
use crate::geom::{Pose, TriMesh};
use crate::progress::{Cancelled, Progress};
use crate::register::turntable::{Calibration, Turntable, TurntableError, TurntableOptions};
use crate::register::views::ViewsError;
use crate::rgbd::{Camera, CameraTrajectory, RgbdError, RgbdFrame, SequenceError, StampedPose};
use lay::laid;

/// The frames of a turn, each read when it is asked for.
pub type TurnFrames<'a> = Box<dyn ExactSizeIterator<Item = Result<RgbdFrame, SequenceError>> + 'a>;

/// One turn of the part.
pub struct Turn<'a> {
    /// What it is called: most often its folder.
    pub name: String,
    /// When the depth of each frame was taken, rising [s].
    pub stamps: Vec<f64>,
    /// Its frames, from the first one each time.
    pub frames: Box<dyn Fn() -> TurnFrames<'a> + 'a>,
}

/// What is to become one surface.
pub struct TurnsJob<'a, 'f> {
    /// The turns.
    pub turns: Vec<Turn<'f>>,
    /// What took them.
    pub camera: Camera,
    /// The turntable of all of them, if it is known; else each is calibrated.
    pub turntable: Option<Turntable>,
    /// How they are calibrated.
    pub calibration: &'a TurntableOptions,
    /// What the user must know about the input.
    pub notes: Vec<String>,
    /// How frames become a surface.
    pub options: &'a FuseOptions,
}

/// Why turns do not become a surface.
#[derive(Debug, thiserror::Error)]
pub enum TurnsError {
    /// None shows how it turned, or a surface.
    #[error("none of the {n_turns} turns can be used; the first, {name}: {reason}")]
    NoTurn {
        /// How many there are.
        n_turns: usize,
        /// The first.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A turntable.
    #[error(transparent)]
    Calibrate(#[from] CalibrateError),
    /// A fusion.
    #[error(transparent)]
    Fuse(#[from] FuseError),
    /// Laying turns on each other.
    #[error(transparent)]
    Views(#[from] ViewsError),
    /// Stamps that are none.
    #[error(transparent)]
    Stamps(#[from] RgbdError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Frames of a turn begin this much later than those of the turn before end, if clocks say otherwise [s].
const BETWEEN: f64 = 1.0;

/// Makes one surface of all turns that lie on each other, in the frame of the camera at the first frame of
/// the first of them. A turn that cannot be used, or laid on the others, is left out; the report says why.
pub fn fuse_turns(job: &TurnsJob, progress: &dyn Progress) -> Result<Fused, TurnsError> {
    let (mut seen, mut told) = (Vec::new(), Vec::new());
    for (i, turn) in job.turns.iter().enumerate() {
        let mut report = TurnReport::new(turn);
        match alone(turn, job, progress)? {
            Ok(turn_seen) => {
                report.turntable = Some(turntable_report(&turn_seen.found));
                seen.push((i, turn_seen));
            }
            Err(reason) => report.reasons = vec![reason],
        }
        told.push(report);
    }
    let meshes: Vec<&TriMesh> = seen.iter().map(|(_, seen)| &seen.mesh).collect();
    let laid = match (&meshes[..], told.first()) {
        ([], Some(first)) => {
            let (name, reason) = (first.name.clone(), first.reasons.join("; "));
            return Err(TurnsError::NoTurn { n_turns: told.len(), name, reason });
        }
        _ => laid(&meshes, job.options.volume.voxel, progress)?,
    };
    let mut all = Whole::default();
    for ((i, seen), laid) in seen.iter().zip(laid) {
        let report = &mut told[*i];
        report.lies_on_others = laid.fit;
        match laid.first_from_turn {
            Ok(first_from_turn) => {
                report.place(&first_from_turn);
                all.add(*i, &seen.along, &first_from_turn);
            }
            Err(reasons) => report.reasons = reasons,
        }
    }
    let mut fused = fuse(
        FuseJob {
            frames: all.turns.iter().flat_map(|&i| (job.turns[i].frames)()),
            stamps: all.poses.iter().map(|pose| pose.stamp).collect(),
            camera: job.camera,
            placing: Placing::Along(CameraTrajectory::new(all.poses)?),
            truth: None,
            notes: job.notes.clone(),
            options: job.options,
        },
        progress,
    )?;
    fused.report.turns = told;
    Ok(fused)
}

/// What one turn shows.
struct Seen {
    found: Calibration,
    along: CameraTrajectory,
    mesh: TriMesh,
}

/// A turn by itself; the inner error says why it cannot be used, the outer one concerns all of them.
fn alone(
    turn: &Turn,
    job: &TurnsJob,
    progress: &dyn Progress,
) -> Result<Result<Seen, String>, TurnsError> {
    let options = FuseOptions { keep_out: None, ..job.options.clone() };
    let found = if let Some(turntable) = job.turntable {
        Ok(Calibration::given(turntable))
    } else {
        let (frames, farthest) = ((turn.frames)(), options.volume.max_depth);
        calibrate_turntable(frames, &job.camera, farthest, job.calibration, progress)
    };
    let found = match found {
        Ok(found) => found,
        Err(
            CalibrateError::Cancelled(stop)
            | CalibrateError::Turntable(TurntableError::Cancelled(stop)),
        ) => {
            return Err(stop.into());
        }
        Err(error @ (CalibrateError::Failed { .. } | CalibrateError::Turntable(_))) => {
            return Ok(Err(error.to_string()));
        }
        Err(error @ CalibrateError::Camera(_)) => return Err(error.into()),
    };
    let along = found.turntable.trajectory(&turn.stamps)?;
    let fused = fuse(
        FuseJob {
            frames: (turn.frames)(),
            stamps: turn.stamps.clone(),
            camera: job.camera,
            placing: Placing::Along(along.clone()),
            truth: None,
            notes: Vec::new(),
            options: &options,
        },
        progress,
    );
    match fused {
        Ok(Fused { mesh, .. }) => Ok(Ok(Seen { found, along, mesh })),
        Err(error @ (FuseError::Lost { .. } | FuseError::NoSurface { .. })) => {
            Ok(Err(error.to_string()))
        }
        Err(error) => Err(error.into()),
    }
}

/// The frames of all turns that lie together, one turn after the other.
#[derive(Default)]
struct Whole {
    turns: Vec<usize>,
    poses: Vec<StampedPose>,
}

impl Whole {
    fn add(&mut self, turn: usize, along: &CameraTrajectory, first_from_turn: &Pose) {
        let begin = along.poses().first().map_or(0.0, |pose| pose.stamp);
        let later = match self.poses.last() {
            Some(last) if last.stamp >= begin => last.stamp + BETWEEN - begin,
            _ => 0.0,
        };
        self.turns.push(turn);
        self.poses.extend(along.poses().iter().map(|pose| StampedPose {
            stamp: pose.stamp + later,
            world_from_camera: first_from_turn * pose.world_from_camera,
        }));
    }
}

#[cfg(test)]
mod tests;
