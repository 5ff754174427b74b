//! From frames and the poses they are placed by to how late their stamps are.

use super::FuseOptions;
use crate::progress::Progress;
use crate::register::pose_delay::{PoseDelay, PoseDelayError, Sketch, pose_delay};
use crate::rgbd::{Camera, CameraTrajectory, RgbdFrame, SequenceError};

/// Frames looked at, at most.
const MOST_FRAMES: usize = 60;

/// Finds how long before their stamps the depth of frames was taken, by the clock of `along`.
///
/// `read` gives the frame of each of the `stamps`, by its place. Frames that are kept out to measure by are
/// not looked at, nor those that cannot be read.
pub fn find_pose_delay(
    read: impl Fn(usize) -> Result<RgbdFrame, SequenceError>,
    (stamps, camera): (&[f64], &Camera),
    along: &CameraTrajectory,
    options: &FuseOptions,
    progress: &dyn Progress,
) -> Result<PoseDelay, PoseDelayError> {
    let is_kept_out = |i: &usize| options.keep_out.is_some_and(|n| (i + 1).is_multiple_of(n));
    let all: Vec<usize> = (0..stamps.len()).filter(|i| !is_kept_out(i)).collect();
    let stride = all.len().div_ceil(MOST_FRAMES).max(1);
    progress.start("read frames", all.len().div_ceil(stride) as u64);
    let mut sketches = Vec::new();
    for &i in all.iter().step_by(stride) {
        let sketch = |frame: &RgbdFrame| {
            Sketch::new(frame, camera, stamps[i], options.volume.max_depth).ok()
        };
        sketches.extend(read(i).ok().as_ref().and_then(sketch));
        progress.advance(1)?;
    }
    pose_delay(&sketches, along, progress)
}
