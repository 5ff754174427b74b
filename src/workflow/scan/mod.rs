//! From the frames of a depth camera to one registered cloud, and where the camera went.

mod gather;
mod options;
mod report;

pub use options::ScanOptions;
pub use report::{FrameReport, ScanReport, VerdictCounts};

use crate::geom::{PointCloud, VoxelError};
use crate::progress::{Cancelled, Progress};
use crate::register::odometry::{Doubt, FrameRole, Look, OdometryError, Tracker};
use crate::register::{Delta, OdometryErrorOptions, Unmatched};
use crate::rgbd::{
    Camera, CameraTrajectory, NormalOptions, RgbdError, RgbdFrame, SequenceError, StampedPose,
};
use crate::workflow::evaluate::evaluate;
use gather::Gathered;

/// Every second pixel of every second row goes into the cloud: voxels are larger anyway.
const STEP: usize = 2;

/// What is scanned.
#[derive(Debug)]
pub struct ScanJob<'a> {
    /// What the sequence is called: most often its folder.
    pub name: String,
    /// What took it.
    pub camera: Camera,
    /// When each frame was taken, those that cannot be read among them [s].
    pub stamps: Vec<f64>,
    /// Where the camera really was, if that is known.
    pub truth: Option<&'a CameraTrajectory>,
    /// What the user must know about the input.
    pub notes: Vec<String>,
    /// How it is done.
    pub options: &'a ScanOptions,
}

/// A scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Scanned {
    /// What was seen, one point for each voxel, in the frame of the first camera; with normals, and
    /// colours if there were any.
    pub cloud: PointCloud,
    /// Where the camera was, without the frames that were skipped.
    pub trajectory: CameraTrajectory,
    /// All about it.
    pub report: ScanReport,
}

/// Why there is no scan.
#[derive(Debug, thiserror::Error)]
pub enum ScanError {
    /// The camera cannot be followed at all.
    #[error(transparent)]
    Odometry(#[from] OdometryError),
    /// The camera or its path cannot be.
    #[error(transparent)]
    Rgbd(#[from] RgbdError),
    /// The voxels of the cloud cannot be.
    #[error(transparent)]
    Voxel(#[from] VoxelError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Places frame after frame, and gathers what those that were placed show.
///
/// A frame that cannot be read is skipped like one that cannot be placed.
pub fn scan(
    frames: impl Iterator<Item = Result<RgbdFrame, SequenceError>>,
    job: ScanJob,
    progress: &dyn Progress,
) -> Result<Scanned, ScanError> {
    job.options.check()?;
    job.camera.check()?;
    let mut tracker = Tracker::new(job.camera, job.options.odometry.clone())?;
    let mut gathered = job.options.voxel.map(Gathered::new).transpose()?;
    let (mut poses, mut told) = (Vec::new(), Vec::new());
    let mut n_placed = 0;
    progress.start("scan", job.stamps.len() as u64);
    for (frame, &stamp) in frames.zip(&job.stamps) {
        let placed = match frame {
            Ok(frame) => tracker.add(frame, progress)?,
            Err(error) => tracker.miss(stamp, Doubt::Unusable(error.to_string())),
        };
        if let (Some(pose), Some(look)) = (placed.world_from_camera, &placed.look) {
            let voxel = look.median_depth / ScanOptions::VOXELS_DEEP;
            let gathered = match &mut gathered {
                Some(gathered) => gathered,
                none => none.insert(Gathered::new(voxel)?),
            };
            gathered.add(&seen(look, &job.camera)?.moved(&pose).to_sparse_cloud(STEP))?;
            poses.push(StampedPose { stamp: placed.stamp, world_from_camera: pose });
            n_placed += 1;
        }
        told.push(FrameReport::of(&placed));
        if let Some(link) = placed.link {
            told[link.key].role = FrameRole::Key;
        }
        progress.advance(1)?;
        progress.tell(&format!("{n_placed} of {} placed", told.len()));
    }
    let trajectory = CameraTrajectory::new(poses)?;
    let (cloud, voxel) = gathered.map_or_else(
        || (PointCloud::default(), 0.0),
        |gathered| (gathered.cloud(), gathered.voxel()),
    );
    let mut report = ScanReport::new(job.name, job.options, told, job.notes);
    report.voxel = voxel;
    report.n_points = cloud.points.len();
    report.measure(&trajectory);
    if let Some(truth) = job.truth {
        match evaluate(&trajectory, truth, &steps_within(&trajectory)) {
            Ok(found) => report.against_truth = Some(found.report),
            Err(Unmatched::MaxDifference(_)) => {}
            Err(error) => report.notes.push(format!("not compared with the truth: {error}")),
        }
    }
    Ok(Scanned { cloud, trajectory, report })
}

/// The usual steps, but for those that are longer than the walk.
fn steps_within(trajectory: &CameraTrajectory) -> OdometryErrorOptions {
    let stamps = trajectory.stamps();
    let lasts = stamps.last().zip(stamps.first()).map_or(0.0, |(last, first)| last - first);
    let mut options = OdometryErrorOptions::default();
    options.deltas.retain(|delta| match delta {
        Delta::Poses(n) => *n < stamps.len(),
        Delta::Seconds(seconds) => *seconds < lasts,
    });
    options
}

/// What a look shows, with normals that look at the camera.
fn seen(look: &Look, camera: &Camera) -> Result<crate::rgbd::OrganisedCloud, RgbdError> {
    let eye = crate::geom::Point3::origin();
    Ok(look.frame.cloud(camera)?.with_normals(&eye, &NormalOptions::default()))
}

#[cfg(test)]
mod tests;
