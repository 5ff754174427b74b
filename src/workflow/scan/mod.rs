//! From the frames of a depth camera to one registered cloud, and where the camera went.

mod gather;
mod options;
mod report;

pub use options::ScanOptions;
pub use report::{FrameReport, LoopReport, LoopResult, LoopsReport, ScanReport, VerdictCounts};

use crate::geom::{Point3, PointCloud, Pose, VoxelError};
use crate::progress::{Cancelled, Progress};
use crate::register::loops::{Closed, KeyFrames, Step, close_loops};
use crate::register::odometry::{Doubt, FrameRole, Hanging, OdometryError, Placed, Tracker, drift};
use crate::register::pose_graph::GraphError;
use crate::rgbd::{
    Camera, CameraTrajectory, NormalOptions, OrganisedCloud, RgbdError, RgbdFrame, SequenceError,
    StampedPose,
};
use gather::Gathered;

/// Every second pixel of every second row goes into the cloud: voxels are larger anyway.
const STEP: usize = 2;

/// How far around a point its neighbours are looked for, if they are asked for by radius [voxels].
const OUTLIER_VOXELS: f64 = 4.0;

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
    /// Loops cannot be weighed against the walk.
    #[error(transparent)]
    Graph(GraphError),
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

/// Places frame after frame, and gathers what those that were placed show. Where the camera comes back to
/// what it has seen, all its way is put right, and the frames are gathered again.
///
/// `frames` begins at the first frame each time it is called. A frame that cannot be read is skipped like
/// one that cannot be placed.
pub fn scan<I>(
    frames: impl Fn() -> I,
    job: &ScanJob,
    progress: &dyn Progress,
) -> Result<Scanned, ScanError>
where
    I: Iterator<Item = Result<RgbdFrame, SequenceError>>,
{
    job.options.check()?;
    job.camera.check()?;
    let mut walk = followed(frames(), job, progress)?;
    walk.tell_drift();
    let closed = walk.close(job, progress)?;
    let mut report = ScanReport::new(job.name.clone(), job.options, walk.told, job.notes.clone());
    let mut poses: Vec<Option<Pose>> =
        walk.steps.iter().map(|step| step.world_from_camera).collect();
    let before = trajectory(&poses, &job.stamps)?;
    if let Some(closed) = closed {
        report.loops = Some(LoopsReport::new(&closed, &poses, &job.stamps));
        if closed.n_closed() > 0 {
            poses = closed.world_from_camera;
            walk.gathered = Some(gathered_again(frames(), &poses, walk.gathered, job, progress)?);
        }
    }
    let trajectory = trajectory(&poses, &job.stamps)?;
    let (cloud, voxel) = walk.gathered.map_or_else(
        || (PointCloud::default(), 0.0),
        |gathered| (gathered.cloud(), gathered.voxel()),
    );
    let radius = OUTLIER_VOXELS * voxel;
    let (cloud, n_outliers) = job.options.filter.apply(cloud, radius, progress)?;
    report.voxel = voxel;
    report.n_outliers = n_outliers;
    report.n_points = cloud.points.len();
    report.measure(&trajectory);
    report.doubt_drift(walk.depth.unwrap_or_default());
    if let Some(truth) = job.truth {
        report.hold_against(truth, &trajectory, &before);
    }
    Ok(Scanned { cloud, trajectory, report })
}

/// What became of the frames, one after the other.
struct Walk {
    told: Vec<FrameReport>,
    steps: Vec<Step>,
    keys: KeyFrames,
    gathered: Option<Gathered>,
    /// The median depth of the first frame that was placed [mm].
    depth: Option<f64>,
}

fn followed(
    frames: impl Iterator<Item = Result<RgbdFrame, SequenceError>>,
    job: &ScanJob,
    progress: &dyn Progress,
) -> Result<Walk, ScanError> {
    let mut tracker = Tracker::new(job.camera, job.options.odometry.clone())?;
    let gathered = job.options.voxel.map(Gathered::new).transpose()?;
    let keys = KeyFrames::default();
    let mut walk = Walk { told: Vec::new(), steps: Vec::new(), keys, gathered, depth: None };
    progress.start("scan", job.stamps.len() as u64);
    let mut n_placed = 0;
    for (frame, &stamp) in frames.zip(&job.stamps) {
        let placed = match frame {
            Ok(frame) => tracker.add(frame, progress)?,
            Err(error) => tracker.miss(stamp, Doubt::Unusable(error.to_string())),
        };
        n_placed += u32::from(placed.world_from_camera.is_some());
        walk.add(&placed, job)?;
        progress.advance(1)?;
        let off = walk.off(job).map_or_else(String::new, |off| format!(", {off:.1} mm off"));
        progress.tell(&format!("{n_placed} of {} placed{off}", walk.steps.len()));
    }
    Ok(walk)
}

impl Walk {
    fn add(&mut self, placed: &Placed, job: &ScanJob) -> Result<(), ScanError> {
        if let (Some(pose), Some(look)) = (placed.world_from_camera, &placed.look) {
            self.depth.get_or_insert(look.median_depth);
            let voxel = look.median_depth / ScanOptions::VOXELS_DEEP;
            let gathered = match &mut self.gathered {
                Some(gathered) => gathered,
                none => none.insert(Gathered::new(voxel)?),
            };
            gathered.add(&seen(&look.frame, &job.camera)?.moved(&pose).to_sparse_cloud(STEP))?;
        }
        if !job.options.loops.no_loops {
            self.keys.note(self.steps.len(), placed);
        }
        self.told.push(FrameReport::of(placed));
        if let Some(link) = placed.link {
            self.told[link.key].role = FrameRole::Key;
        }
        let world_from_camera = placed.world_from_camera;
        self.steps.push(Step { world_from_camera, link: placed.link });
        Ok(())
    }

    /// Tells every frame how far it may be astray.
    fn tell_drift(&mut self) {
        let walk: Vec<Hanging> =
            self.steps.iter().map(|step| (step.world_from_camera, step.link)).collect();
        for (frame, open) in self.told.iter_mut().zip(drift(&walk)) {
            frame.open = open;
        }
    }

    /// How far the last frame is off the truth, the first one that was placed lying on it [mm].
    fn off(&self, job: &ScanJob) -> Option<f64> {
        let known = |i: usize| Some(job.truth?.nearest(job.stamps[i])?.world_from_camera);
        let first = self.steps.iter().position(|step| step.world_from_camera.is_some())?;
        let last = self.steps.len() - 1;
        let found = self.steps[last].world_from_camera?;
        let off = (known(first)?.inverse() * known(last)?).inverse() * found;
        Some(off.translation.vector.norm())
    }

    /// Looks for loops, if they are asked for.
    fn close(
        &mut self,
        job: &ScanJob,
        progress: &dyn Progress,
    ) -> Result<Option<Closed>, ScanError> {
        let options = &job.options.loops;
        if options.no_loops {
            return Ok(None);
        }
        let keys = std::mem::take(&mut self.keys).into_all();
        let closed = close_loops(&self.steps, &keys, (options, &job.options.odometry), progress);
        closed.map(Some).map_err(|error| match error {
            GraphError::Cancelled(cancelled) => cancelled.into(),
            other => ScanError::Graph(other),
        })
    }
}

/// The frames gathered where they have come to be, in the voxels they had `before`.
fn gathered_again(
    frames: impl Iterator<Item = Result<RgbdFrame, SequenceError>>,
    poses: &[Option<Pose>],
    before: Option<Gathered>,
    job: &ScanJob,
    progress: &dyn Progress,
) -> Result<Gathered, ScanError> {
    let voxel = before.map_or(1.0, |before| before.voxel());
    let mut gathered = Gathered::new(voxel)?;
    progress.start("gather", poses.len() as u64);
    for (frame, pose) in frames.zip(poses) {
        // What could not be read before has no pose.
        if let (Ok(frame), Some(pose)) = (frame, pose) {
            gathered.add(&seen(&frame, &job.camera)?.moved(pose).to_sparse_cloud(STEP))?;
        }
        progress.advance(1)?;
    }
    Ok(gathered)
}

fn trajectory(poses: &[Option<Pose>], stamps: &[f64]) -> Result<CameraTrajectory, RgbdError> {
    let stamped = |(pose, &stamp): (&Option<Pose>, &f64)| {
        pose.map(|world_from_camera| StampedPose { stamp, world_from_camera })
    };
    CameraTrajectory::new(poses.iter().zip(stamps).filter_map(stamped).collect())
}

/// What a frame shows, with normals that look at the camera.
fn seen(frame: &RgbdFrame, camera: &Camera) -> Result<OrganisedCloud, RgbdError> {
    let eye = Point3::origin();
    Ok(frame.cloud(camera)?.with_normals(&eye, &NormalOptions::default()))
}

#[cfg(test)]
mod tests;
