//! Free space: a camera that sees a surface has seen that nothing is before it.
//!
//! Surfaces that lie on each other may still be in the wrong place: a table slides along itself, and
//! where it ends, its edge then hangs in the air that the other camera looked through. So every
//! reading of one view is put before the other camera. It contradicts if it lies clearly before all
//! that was seen around its pixel; it agrees if it lies at that depth; hidden behind it, it says
//! nothing.

mod seen;

pub use seen::{align_seen, heed_free_space};

use crate::geom::{Point3, Pose, Vector3};
use crate::rgbd::{Camera, Exposure, Image, RgbdError, RgbdFrame};
use rayon::prelude::*;
use serde::Serialize;

/// Readings looked at from either side, about.
const LOOKED_AT: usize = 40_000;
/// Pixels around a place that must all have been seen behind it: an edge is not sharper than that.
const AROUND: isize = 2;

/// A frame and the camera that took it.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a> {
    /// The camera, at the origin.
    pub camera: &'a Camera,
    /// What it saw.
    pub frame: &'a RgbdFrame,
}

impl<'a> From<&'a Exposure> for Seen<'a> {
    fn from(exposure: &'a Exposure) -> Self {
        Self { camera: &exposure.camera, frame: &exposure.frame }
    }
}

impl Seen<'_> {
    /// How far readings are from their middle, root mean square [mm].
    fn spread(&self) -> f64 {
        let depth = &self.frame.depth;
        let step = sparse(depth);
        let (mut n, mut sum, mut squares) = (0.0, Vector3::zeros(), 0.0);
        for y in (0..depth.height()).step_by(step) {
            for (x, z) in depth.row(y).iter().enumerate().step_by(step) {
                if *z > 0.0 {
                    let place = self.camera.unproject([x as f64, y as f64], (*z).into()).coords;
                    (n, sum, squares) = (n + 1.0, sum + place, squares + place.norm_squared());
                }
            }
        }
        let n = f64::max(n, 1.0);
        (squares / n - (sum / n).norm_squared()).max(0.0).sqrt()
    }
}

/// How two views go together with what each has seen to be free.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FreeSpace {
    /// Readings of the source that lie where the target's camera sees something, and the other way
    /// round.
    pub n_agreeing: [usize; 2],
    /// Readings that lie where the other camera has looked through.
    pub n_contradicting: [usize; 2],
    /// How far before what was seen a reading must lie to contradict, at least [mm].
    pub margin: f64,
}

impl FreeSpace {
    /// Of two views; what lies less than `margin` and three standard deviations of the `noise`
    /// [mm at 1 m, growing with the square of the depth] before a surface lies on it.
    pub fn of(
        [source, target]: [Seen; 2],
        target_from_source: &Pose,
        margin: f64,
        noise: f64,
    ) -> Result<Self, RgbdError> {
        source.frame.check(source.camera)?;
        target.frame.check(target.camera)?;
        let limits = Limits { margin, noise };
        let (there, back) = rayon::join(
            || looked(source, target, target_from_source, limits),
            || looked(target, source, &target_from_source.inverse(), limits),
        );
        Ok(Self { n_agreeing: [there.0, back.0], n_contradicting: [there.1, back.1], margin })
    }

    /// The share of the readings that contradict, of all that agree or contradict: the greater of both
    /// sides; 0 if there are none.
    pub fn share(&self) -> f64 {
        let share = |k: usize| {
            let (agreeing, against) = (self.n_agreeing[k] as f64, self.n_contradicting[k] as f64);
            if against > 0.0 { against / (agreeing + against) } else { 0.0 }
        };
        share(0).max(share(1))
    }
}

#[derive(Debug, Clone, Copy)]
struct Limits {
    margin: f64,
    noise: f64,
}

impl Limits {
    fn at(&self, depth: f64) -> f64 {
        self.margin + 3.0 * self.noise * (depth / 1000.0).powi(2)
    }
}

/// Every how many pixels of every how many rows are looked at.
fn sparse(depth: &Image<f32>) -> usize {
    (depth.pixels().len() as f64 / LOOKED_AT as f64).sqrt().ceil().max(1.0) as usize
}

/// How many readings of `moved` agree with what `still` has seen, and how many contradict.
fn looked(moved: Seen, still: Seen, still_from_moved: &Pose, limits: Limits) -> (usize, usize) {
    let depth = &moved.frame.depth;
    let step = sparse(depth);
    let rows: Vec<usize> = (0..depth.height()).step_by(step).collect();
    let of_row = |&y: &usize| {
        let (mut agreeing, mut against) = (0, 0);
        for x in (0..depth.width()).step_by(step) {
            let z = f64::from(depth[(x, y)]);
            // A comparison that NaN fails, and 0 too.
            let is_seen = z > 0.0;
            if is_seen {
                let point = moved.camera.unproject([x as f64, y as f64], z);
                let point = still_from_moved * point;
                match beside(still, &point, limits.at(point.z.max(z))) {
                    Some(true) => agreeing += 1,
                    Some(false) => against += 1,
                    None => {}
                }
            }
        }
        (agreeing, against)
    };
    rows.par_iter().map(of_row).reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
}

/// True if `point` lies on what was seen, false if clearly before all of it; `None` if it is hidden,
/// or nothing was seen there.
fn beside(still: Seen, point: &Point3, margin: f64) -> Option<bool> {
    let pixel = still.camera.project(point).filter(|pixel| still.camera.sees(*pixel))?;
    let [least, most] = around(&still.frame.depth, pixel)?;
    if point.z < least - margin {
        return Some(false);
    }
    (point.z < most + margin).then_some(true)
}

/// The least and the greatest depth around a pixel; `None` if one of them has none.
fn around(depth: &Image<f32>, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let (x, y) = (x.round() as isize, y.round() as isize);
    let mut found = [f64::INFINITY, 0.0];
    for v in y - AROUND..=y + AROUND {
        for u in x - AROUND..=x + AROUND {
            let place = (usize::try_from(u).ok()?, usize::try_from(v).ok()?);
            let z = f64::from(*depth.get(place.0, place.1)?);
            let is_seen = z > 0.0;
            if !is_seen {
                return None;
            }
            found = [found[0].min(z), found[1].max(z)];
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Camera = Camera::pinhole([80, 60], [80.0, 80.0], [39.5, 29.5]);

    /// A wall at 1 m and a box before it, at 0.7 m, of which the camera sees a square.
    fn frame(shift_px: usize) -> RgbdFrame {
        let depth = Image::from_rows(80, 60, 1000.0, |y, row: &mut [f32]| {
            for (x, z) in row.iter_mut().enumerate() {
                if (20 + shift_px..45 + shift_px).contains(&x) && (15..40).contains(&y) {
                    *z = 700.0;
                }
            }
        });
        RgbdFrame { stamp: 0.0, color: None, depth, confidence: None }
    }

    fn look(source: &RgbdFrame, target: &RgbdFrame, pose: &Pose) -> FreeSpace {
        let seen = |frame| Seen { camera: &CAMERA, frame };
        FreeSpace::of([seen(source), seen(target)], pose, 10.0, 1.4).unwrap()
    }

    #[test]
    fn the_same_view_contradicts_nothing() {
        let found = look(&frame(0), &frame(0), &Pose::identity());
        assert_eq!(found.n_contradicting, [0, 0]);
        assert!(found.n_agreeing[0] > 4000 && found.share() == 0.0);
    }

    #[test]
    fn a_box_that_hangs_where_the_other_camera_looked_through_contradicts() {
        // The box stands eight pixels farther to the right: 70 mm at 0.7 m. Without that motion, a band
        // of the box hangs before the wall.
        let right = Pose::translation(70.0, 0.0, 0.0);
        let wrong = look(&frame(0), &frame(8), &Pose::identity());
        let found = look(&frame(0), &frame(8), &right);
        assert!(wrong.share() > 0.02 && found.share() < 0.002, "{wrong:?} {found:?}");
        // Behind what is seen there is no telling.
        let behind = look(&frame(0), &frame(0), &Pose::translation(0.0, 0.0, 500.0));
        assert!(behind.n_contradicting[0] == 0 && behind.n_agreeing[0] == 0, "{behind:?}");
    }

    #[test]
    fn frames_of_another_size_are_refused() {
        let small = Camera { width: 10, ..CAMERA };
        let frame = frame(0);
        let seen =
            [Seen { camera: &small, frame: &frame }, Seen { camera: &CAMERA, frame: &frame }];
        let error = FreeSpace::of(seen, &Pose::identity(), 1.0, 1.0).unwrap_err();
        assert!(error.to_string().contains("depth image"), "{error}");
    }
}
