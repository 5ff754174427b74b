//! A fusion under way: a frame comes, is placed, and is taken in or held against the model.

use super::computing::Computing;
use super::frames::Sample;
use super::kept_out::KeptOut;
use super::{FuseError, FuseJob, Placing, Skipped};
use crate::geom::{Point3, Pose};
use crate::register::tsdf::{Model, Readings, Tracker, TsdfError, TsdfOptions, Unplaced};
use crate::rgbd::{Camera, CameraTrajectory, RgbdError, RgbdFrame, StampedPose};
use crate::workflow::cam::ComputeReport;

/// Frames farther in time than this from any pose have none [s].
const FARTHEST: f64 = 0.05;
/// Stamps nearer than this are the same but for rounding [s].
const SAME: f64 = 1e-7;

/// A fusion under way.
pub(super) struct Fusion {
    camera: Camera,
    computing: Computing,
    options: TsdfOptions,
    /// None before the first frame.
    pub(super) model: Option<(Model, ComputeReport)>,
    /// None where a trajectory places the frames.
    pub(super) tracker: Option<Tracker>,
    along: CameraTrajectory,
    /// How long before its stamp a frame was taken [s].
    delay: f64,
    pub(super) kept_out: Option<KeptOut>,
    pub(super) fused: Vec<StampedPose>,
    /// Of each frame that was fused.
    pub(super) samples: Vec<Sample>,
    pub(super) skipped: Vec<Skipped>,
}

impl Fusion {
    pub(super) fn new<F>(job: &FuseJob<'_, F>) -> Result<Self, FuseError> {
        job.camera.check()?;
        let tracker = Tracker::new(&job.options.track)?;
        let (tracker, along) = match &job.placing {
            Placing::Tracked => (Some(tracker), CameraTrajectory::default()),
            Placing::Along(along) => (None, along.clone()),
        };
        Ok(Self {
            camera: job.camera,
            computing: Computing::asked(job.options).map_err(TsdfError::from)?,
            options: job.options.volume.clone(),
            model: None,
            tracker,
            along,
            delay: job.options.pose_delay,
            kept_out: job.options.keep_out.map(|every| KeptOut::new(every, &job.options.volume)),
            fused: Vec::new(),
            samples: Vec::new(),
            skipped: Vec::new(),
        })
    }

    /// Places and fuses a frame; the inner error says why it is skipped.
    pub(super) fn take(
        &mut self,
        frame: &RgbdFrame,
        stamp: f64,
        number: usize,
    ) -> Result<Result<(), String>, FuseError> {
        match frame.check_depth() {
            Ok(()) => {}
            // Nothing good came before it: more likely it is the scale than the frame.
            Err(problem @ RgbdError::Scale { .. }) if self.fused.is_empty() => {
                return Err(FuseError::Frame { number, problem });
            }
            Err(problem) => return Ok(Err(problem.to_string())),
        }
        let readings = match Readings::new(frame, &self.camera, &self.options) {
            Ok(readings) => readings,
            Err(problem) => return Ok(Err(problem.to_string())),
        };
        let (world_from_camera, overlap) = match self.place(&readings, stamp)? {
            Ok(placed) => placed,
            Err(reason) => return Ok(Err(reason)),
        };
        if let Some(kept_out) = &mut self.kept_out
            && kept_out.wants(number)
        {
            kept_out.add(&readings, &world_from_camera);
            return Ok(Ok(()));
        }
        self.model(&readings)?.integrate(&readings, &world_from_camera)?;
        self.fused.push(StampedPose { stamp, world_from_camera });
        self.samples.push(Sample::new(number, overlap, &readings, &world_from_camera));
        Ok(Ok(()))
    }

    /// How it goes, in a few words.
    pub(super) fn told(&self) -> String {
        format!("{} fused, {} left out", self.fused.len(), self.skipped.len())
    }

    /// The model; before the first frame one of nothing.
    fn model(&mut self, readings: &Readings) -> Result<&mut Model, TsdfError> {
        let model = match self.model.take() {
            Some(model) => model,
            None => self.computing.model(&self.options, readings)?,
        };
        Ok(&mut self.model.insert(model).0)
    }

    /// Where a frame was taken, and which share of it lies on the model, if that is how it was placed; the
    /// inner error says why nobody knows.
    fn place(
        &mut self,
        readings: &Readings,
        stamp: f64,
    ) -> Result<Result<(Pose, Option<f64>), String>, TsdfError> {
        let Some(tracker) = &mut self.tracker else {
            let missing = || format!("no pose within {FARTHEST} s of its stamp, {stamp:.6} s");
            let pose = pose_at(&self.along, stamp - self.delay);
            return Ok(pose.map(|pose| (pose, None)).ok_or_else(missing));
        };
        let Some((model, _)) = &mut self.model else {
            let first = Pose::identity();
            tracker.begin(&first);
            return Ok(Ok((first, None)));
        };
        match tracker.place(model, readings) {
            Ok(placed) => Ok(Ok((placed.world_from_camera, Some(placed.overlap)))),
            Err(Unplaced::Lost(lost)) => Ok(Err(lost.to_string())),
            Err(Unplaced::Model(error)) => Err(error),
        }
    }
}

/// The pose at a stamp; none across a gap in the trajectory, and none before and after it.
fn pose_at(along: &CameraTrajectory, stamp: f64) -> Option<Pose> {
    let nearest = along.nearest(stamp)?;
    let off = (nearest.stamp - stamp).abs();
    if off < SAME {
        return Some(nearest.world_from_camera);
    }
    (off <= FARTHEST).then(|| along.at(stamp))?
}

/// Every `step`th reading of every `step`th row, in the world.
pub(super) fn sparse_points(
    readings: &Readings,
    step: usize,
    world_from_camera: &Pose,
) -> Vec<Point3> {
    let mut points = Vec::new();
    for y in (0..readings.pixels.height()).step_by(step) {
        for (x, reading) in readings.pixels.row(y).iter().enumerate().step_by(step) {
            if reading.depth > 0.0 {
                let seen = readings.camera.unproject([x as f64, y as f64], reading.depth.into());
                points.push(world_from_camera * seen);
            }
        }
    }
    points
}
