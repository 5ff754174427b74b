//! Where the camera of a frame stands, found by laying the frame over a view of the model.

use super::frame::{FrameLevel, levels};
use super::step::{Gate, Sums};
use super::{Lost, Model, Readings, TrackOptions, TsdfError, Unplaced};
use crate::geom::Pose;

/// Places one frame after the other.
#[derive(Debug, Clone)]
pub struct Tracker {
    options: TrackOptions,
    /// The last frames placed, the newest last, and how many frames lay between them.
    last: Option<Pose>,
    /// How the camera moved in its own frame, from the last frame but one to the last.
    motion: Pose,
    n_lost: usize,
}

/// A frame placed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracked {
    /// Where its camera stands.
    pub world_from_camera: Pose,
    /// Which share of it lies on the model.
    pub overlap: f64,
}

/// A frame with fewer pixels on surfaces is not tried.
const LEAST_PIXELS: usize = 200;
/// Steps smaller than this end a level [rad and mm].
const SMALL: [f64; 2] = [1e-5, 0.01];
/// What is turned or shifted less than this between the guess and the answer is no new view [rad, mm].
const NEARBY: [f64; 2] = [0.02, 15.0];

impl Tracker {
    /// A tracker whose first frame is wherever [`Tracker::begin`] says.
    pub fn new(options: &TrackOptions) -> Result<Self, TsdfError> {
        options.check()?;
        let motion = Pose::identity();
        Ok(Self { options: options.clone(), last: None, motion, n_lost: 0 })
    }

    /// Takes `world_from_camera` for the place of the frame before the next.
    pub fn begin(&mut self, world_from_camera: &Pose) {
        *self = Self {
            options: self.options.clone(),
            last: Some(*world_from_camera),
            motion: Pose::identity(),
            n_lost: 0,
        };
    }

    /// Places a frame over the model: from where it should be if the camera moves on as before, and if
    /// that fails from where it was. Neither the model nor, if it fails, the tracker learn anything from
    /// a frame that is lost.
    pub fn place(&mut self, model: &mut Model, readings: &Readings) -> Result<Tracked, Unplaced> {
        let levels = levels(&readings.depth(), &readings.camera, &self.options);
        let n_pixels = levels.first().map_or(0, |level| level.n_pixels);
        if n_pixels < LEAST_PIXELS {
            self.n_lost += 1;
            return Err(Lost::NoSurface { n_pixels, least: LEAST_PIXELS }.into());
        }
        let last = self.last.unwrap_or_default();
        // After a frame that was lost nobody knows how the camera moves.
        let guess = if self.n_lost == 0 { unit(last * self.motion) } else { last };
        let mut found = self.lay_over(model, &levels, &guess);
        if matches!(found, Err(Unplaced::Lost(_))) && guess != last {
            found = self.lay_over(model, &levels, &last);
        }
        match &found {
            Ok(tracked) => {
                let moved = last.inverse() * tracked.world_from_camera;
                self.motion = if self.n_lost == 0 { moved } else { Pose::identity() };
                self.last = Some(tracked.world_from_camera);
                self.n_lost = 0;
            }
            Err(_) => self.n_lost += 1,
        }
        found
    }

    fn lay_over(
        &self,
        model: &mut Model,
        levels: &[FrameLevel],
        guess: &Pose,
    ) -> Result<Tracked, Unplaced> {
        let found = self.lay_over_view(model, levels, guess)?;
        let off = guess.inverse() * found.world_from_camera;
        let is_nearby =
            off.rotation.angle() < NEARBY[0] && off.translation.vector.norm() < NEARBY[1];
        // From farther away the model looked otherwise.
        let found = if is_nearby {
            found
        } else {
            self.lay_over_view(model, levels, &found.world_from_camera)?
        };
        self.refuse_jumps(&found)?;
        Ok(found)
    }

    /// Lays the frame over the model as it looks from `guess`.
    fn lay_over_view(
        &self,
        model: &mut Model,
        levels: &[FrameLevel],
        guess: &Pose,
    ) -> Result<Tracked, Unplaced> {
        let finest = &levels[0];
        let view = model.cast(&finest.camera, guess)?;
        let cosine = self.options.max_angle_deg.to_radians().cos();
        let mut model_from_frame = Pose::identity();
        let mut distance = self.options.max_distance;
        let mut sums = None;
        for level in levels.iter().rev() {
            let gate = Gate { distance, cosine };
            for _ in 0..self.options.iterations {
                let these = Sums::over(level, &view, &model_from_frame, gate);
                sums = Some((these, level.n_pixels));
                let Some(step) = these.motion() else { break };
                model_from_frame = unit(step * model_from_frame);
                let is_small =
                    step.rotation.angle() < SMALL[0] && step.translation.vector.norm() < SMALL[1];
                if is_small {
                    break;
                }
            }
            distance /= 2.0;
        }
        let (held, n_pixels) = sums.map_or((None, 1), |(sums, n)| (Some(sums.held), n));
        let share = held.map_or(0.0, |held| held.n) / n_pixels.max(1) as f64;
        if share < self.options.least_overlap {
            return Err(Lost::TooFewPairs { share, least: self.options.least_overlap }.into());
        }
        let motions = held.map(|held| held.free()).unwrap_or_default();
        if !motions.is_empty() {
            return Err(Lost::Free { motions }.into());
        }
        Ok(Tracked { world_from_camera: unit(guess * model_from_frame), overlap: share })
    }

    fn refuse_jumps(&self, found: &Tracked) -> Result<(), Lost> {
        let Some(last) = self.last else { return Ok(()) };
        let n_frames = self.n_lost + 1;
        let moved = last.inverse() * found.world_from_camera;
        let (shift, turn) = (moved.translation.vector.norm(), moved.rotation.angle());
        let (shift_each, turn_each) = (shift / n_frames as f64, turn / n_frames as f64);
        let turn_deg = turn.to_degrees();
        if shift_each <= self.options.most_moved
            && turn_each.to_degrees() <= self.options.most_turned_deg
        {
            Ok(())
        } else {
            Err(Lost::Jump { shift, turn_deg, n_frames })
        }
    }
}

/// The pose with a rotation of length 1. Each guess is made from poses before it: what rounding adds to
/// their lengths would double from frame to frame.
fn unit(mut pose: Pose) -> Pose {
    pose.rotation.renormalize();
    pose
}
