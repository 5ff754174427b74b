//! From the frames of a depth camera to one surface, and the camera's way.

mod computing;
mod delay;
mod frames;
mod fusion;
mod kept_out;
mod options;
mod report;

pub use delay::find_pose_delay;
pub use frames::FusedFrame;
pub use kept_out::KeptOutReport;
pub use options::FuseOptions;
pub use report::{FuseReport, MeshSummary, Skipped};

use crate::geom::{TriMesh, without_small_pieces};
use crate::progress::{Cancelled, Progress};
use crate::register::tsdf::TsdfError;
use crate::rgbd::{Camera, CameraTrajectory, RgbdError, RgbdFrame, SequenceError};
use crate::workflow::evaluate::{evaluate, steps_within};
use fusion::Fusion;

/// If a smaller share of the frames can be placed, there is no surface to be believed.
const LEAST_PLACED: f64 = 0.5;

/// What is to be fused.
#[derive(Debug)]
pub struct FuseJob<'a, F> {
    /// The frames, each read when it is asked for.
    pub frames: F,
    /// When the depth of each was taken, rising [s].
    pub stamps: Vec<f64>,
    /// What took them.
    pub camera: Camera,
    /// How they are placed.
    pub placing: Placing,
    /// Where the camera really was, if that is known: what tracking is held against.
    pub truth: Option<&'a CameraTrajectory>,
    /// What the user must know about the input.
    pub notes: Vec<String>,
    /// How it is done.
    pub options: &'a FuseOptions,
}

/// How frames are placed.
#[derive(Debug, Clone, PartialEq)]
pub enum Placing {
    /// By laying each over what is there; the world is the frame of the first camera.
    Tracked,
    /// Where a trajectory says, between its poses.
    Along(CameraTrajectory),
}

/// The result.
#[derive(Debug, Clone, PartialEq)]
pub struct Fused {
    /// The surface, in the world.
    pub mesh: TriMesh,
    /// Where the frames that made it were taken.
    pub trajectory: CameraTrajectory,
    /// What is told about it.
    pub report: FuseReport,
}

/// Why frames cannot become a surface.
#[derive(Debug, thiserror::Error)]
pub enum FuseError {
    /// Options or memory.
    #[error(transparent)]
    Tsdf(#[from] TsdfError),
    /// The stamps are none.
    #[error(transparent)]
    Stamps(#[from] RgbdError),
    /// A frame shows nothing a depth camera sees.
    #[error("frame {number}: {problem}")]
    Frame {
        /// The frame, counted from 1.
        number: usize,
        /// What is wrong with it.
        problem: RgbdError,
    },
    /// Too few frames could be placed.
    #[error(
        "{n_placed} of {n_frames} frames could be placed, at least half must be; the first that could not, \
         frame {first}: {reason}"
    )]
    Lost {
        /// Frames placed.
        n_placed: usize,
        /// All frames.
        n_frames: usize,
        /// The first that was not, counted from 1.
        first: usize,
        /// Why.
        reason: String,
    },
    /// Readings never crossed a surface.
    #[error(
        "{n_frames} frames were fused, but no surface came of them: check the depth scale, the unit of the \
         poses (metres) and --max-depth"
    )]
    NoSurface {
        /// Frames fused.
        n_frames: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Places and fuses frame by frame, and draws the surface.
///
/// A frame that cannot be read is left out like one that cannot be placed.
pub fn fuse<F>(job: FuseJob<'_, F>, progress: &dyn Progress) -> Result<Fused, FuseError>
where
    F: Iterator<Item = Result<RgbdFrame, SequenceError>>,
{
    job.options.check(&job.placing)?;
    let mut fusion = Fusion::new(&job)?;
    let n_frames = job.stamps.len();
    progress.start("fuse", n_frames as u64);
    for ((frame, &stamp), number) in job.frames.zip(&job.stamps).zip(1..) {
        let taken = match frame {
            Ok(frame) => fusion.take(&frame, stamp, number)?,
            Err(unreadable) => Err(unreadable.problem.to_string()),
        };
        if let Err(reason) = taken {
            fusion.skipped.push(Skipped { number, stamp, reason });
        }
        progress.advance(1)?;
        progress.tell(&fusion.told());
    }
    let n_placed = n_frames - fusion.skipped.len();
    if let Some(first) = fusion.skipped.first()
        && (n_placed as f64) < LEAST_PLACED * n_frames as f64
    {
        let (first, reason) = (first.number, first.reason.clone());
        return Err(FuseError::Lost { n_placed, n_frames, first, reason });
    }
    let no_surface = FuseError::NoSurface { n_frames: fusion.fused.len() };
    let Some((model, compute)) = fusion.model.take() else { return Err(no_surface) };
    progress.start("draw the surface", 1);
    let (mesh, n_small_pieces) = without_small_pieces(&model.mesh()?, job.options.least_piece());
    progress.advance(1)?;
    if mesh.triangles.is_empty() {
        return Err(no_surface);
    }
    let kept_out = fusion.kept_out.as_ref().map(|kept_out| kept_out.measured(&mesh));
    let frames = fusion.frames(&mesh);
    let trajectory = CameraTrajectory::new(fusion.fused)?;
    let mut report = FuseReport {
        n_frames,
        n_fused: trajectory.poses().len(),
        tracked: fusion.tracker.is_some(),
        turntable: None,
        pose_delay: None,
        turns: Vec::new(),
        skipped: fusion.skipped,
        frames,
        voxel: job.options.volume.voxel,
        truncation: job.options.volume.truncation(),
        n_blocks: model.n_blocks(),
        memory_mb: model.memory() as f64 / f64::from(1 << 20),
        mesh: MeshSummary::of(&mesh),
        n_small_pieces,
        compute,
        kept_out,
        against_truth: None,
        notes: job.notes,
    };
    if let Some(truth) = job.truth.filter(|_| report.tracked) {
        match evaluate(&trajectory, truth, &steps_within(&trajectory)) {
            Ok(found) => {
                for frame in &mut report.frames {
                    frame.off = found.error.absolute.at(frame.stamp);
                }
                report.against_truth = Some(found.report);
            }
            Err(error) => report.notes.push(format!("not compared with the truth: {error}")),
        }
    }
    Ok(Fused { mesh, trajectory, report })
}

#[cfg(test)]
mod tests;
