//! Two frames of a depth camera laid on each other, and judged by what both cameras looked through.

use super::{FreeSpace, Seen};
use crate::geom::{Point3, Pose, Vector3};
use crate::progress::Progress;
use crate::register::icp::{
    Alignment, FreeMotion, IcpError, IcpOptions, MotionKind, Reason, Role, Settled, align_views,
    view,
};
use crate::rgbd::RgbdError;
use nalgebra::{Translation3, Unit, UnitQuaternion};

/// Above this share of contradicting readings a pose is doubtful.
const SOME: f64 = 0.01;
/// The noise of a Kinect at 1 m; it grows with the square of the depth. Khoshelham and Elberink
/// (2012) [mm].
const NOISE: f64 = 1.4;
/// A reading is known to this share of a voxel.
const MARGIN: f64 = 0.5;

/// Lays the frame `source` on `target`, beginning at `target_from_source`; both are thinned to every
/// `step`th pixel.
///
/// The verdict also heeds free space. Readings that hang where the other camera looked through make
/// the pose doubtful. A motion that the surfaces hold too weakly is held all the same if, had it
/// happened as far as it may, they would hang there.
pub fn align_seen(
    [source, target]: [Seen; 2],
    target_from_source: &Pose,
    options: &IcpOptions,
    step: usize,
    progress: &dyn Progress,
) -> Result<(Alignment, FreeSpace), IcpError> {
    options.check()?;
    let cloud = |seen: Seen| seen.frame.cloud(seen.camera).map(|all| all.to_sparse_cloud(step));
    let clouds = [cloud(source)?, cloud(target)?];
    let settled = Settled::new(&clouds[0], &clouds[1], options)?;
    let ready = |i: usize, seen: Seen, role| {
        view(&clouds[i], role, (&settled, options), Some(*seen.camera), progress)
    };
    let (here, there) =
        rayon::join(|| ready(0, source, Role::Source), || ready(1, target, Role::Target));
    let (here, there) = (here?, there?);
    let mut alignment =
        align_views([&here, &there], target_from_source, &settled, options, progress)?;
    let found = heed_free_space(&mut alignment, [source, target])?;
    Ok((alignment, found))
}

/// Looks at the pose of `alignment` between two frames by what both cameras looked through, and changes
/// its verdict: see [`align_seen`].
pub fn heed_free_space(
    alignment: &mut Alignment,
    [source, target]: [Seen; 2],
) -> Result<FreeSpace, RgbdError> {
    let margin = MARGIN * alignment.settled.voxel;
    let look = |pose: &Pose| FreeSpace::of([source, target], pose, margin, NOISE);
    let found = look(&alignment.target_from_source)?;
    let share = found.share();
    let lever = source.spread();
    let mut held = Vec::new();
    for (i, reason) in alignment.reasons.iter().enumerate() {
        if let Reason::Weak { motions, open } = reason {
            let mut is_held = share <= SOME;
            for motion in motions {
                for way in [-1.0, 1.0] {
                    let moved = shifted(motion, way * open, lever) * alignment.target_from_source;
                    is_held &= look(&moved)?.share() > SOME;
                }
            }
            if is_held {
                held.push(i);
            }
        }
    }
    alignment.withdraw(&held);
    if share > SOME {
        alignment.object(Reason::SeenThrough { share });
    }
    Ok(found)
}

/// A motion of which points `lever` from its axis go `way`.
fn shifted(motion: &FreeMotion, way: f64, lever: f64) -> Pose {
    let slide = Pose::from_parts((motion.along * way).into(), UnitQuaternion::identity());
    if motion.kind == MotionKind::Sliding {
        return slide;
    }
    let turn = UnitQuaternion::from_axis_angle(&Unit::new_normalize(motion.along), way / lever);
    let about: Vector3 = motion.through - Point3::origin();
    let there = Translation3::from(about);
    let turned = there * turn * there.inverse();
    if motion.kind == MotionKind::Screwing { slide * turned } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;
    use crate::register::icp::{Metric, Pairing, Verdict};
    use crate::rgbd::{Camera, Image, RgbdFrame};

    const CAMERA: Camera = Camera::pinhole([160, 120], [160.0, 160.0], [79.5, 59.5]);

    /// A wavy wall at 1 m, seen from `x` [mm] to the right; a board before it, if asked for.
    fn frame(x: f64, waves: f64, has_board: bool) -> RgbdFrame {
        let depth = Image::from_rows(160, 120, 0.0, |v, row: &mut [f32]| {
            for (u, z) in row.iter_mut().enumerate() {
                let [a, b] = CAMERA.ray([u as f64, v as f64]);
                let mut wall = 1000.0;
                for _ in 0..30 {
                    let (px, py) = (x + a * wall, b * wall);
                    wall = 1000.0 + waves * ((px / 90.0).sin() + (py / 70.0 + px / 200.0).cos());
                }
                let (px, py) = (x + a * 700.0, b * 700.0);
                let is_board =
                    has_board && (-80.0..60.0).contains(&px) && (-70.0..50.0).contains(&py);
                *z = if is_board { 700.0 } else { wall as f32 };
            }
        });
        RgbdFrame { stamp: 0.0, color: None, depth, confidence: None }
    }

    fn run(
        source: &RgbdFrame,
        target: &RgbdFrame,
        start: &Pose,
        pairing: Pairing,
    ) -> (Alignment, FreeSpace) {
        let seen = |frame| Seen { camera: &CAMERA, frame };
        let options = IcpOptions {
            voxel: Some(12.0),
            max_distance: Some(80.0),
            fine: Some(Metric::Generalised),
            pairing,
            ..IcpOptions::default()
        };
        align_seen([seen(source), seen(target)], start, &options, 1, &Silent).unwrap()
    }

    #[test]
    fn pairing_by_the_picture_and_by_the_tree_undo_the_same_motion() {
        let (source, target) = (frame(25.0, 30.0, true), frame(0.0, 30.0, true));
        let truth = Pose::translation(25.0, 0.0, 0.0);
        for pairing in [Pairing::KdTree, Pairing::Projective] {
            let (found, space) = run(&source, &target, &Pose::identity(), pairing);
            let error = truth.inverse() * found.target_from_source;
            // A tenth of a voxel at the edges of what both see.
            assert!(error.translation.vector.norm() < 1.5, "{pairing:?}: {error}");
            assert_eq!(found.verdict, Verdict::Ok, "{pairing:?}: {:?}", found.reasons);
            assert!(space.share() < SOME, "{space:?}");
        }
    }

    #[test]
    fn a_pose_that_lays_walls_on_each_other_but_edges_into_the_air_is_not_ok() {
        // The board went to the right with the camera: walls, nearly flat, say there was no motion.
        let (source, target) = (frame(0.0, 4.0, true), frame(0.0, 4.0, false));
        let (found, space) = run(&source, &target, &Pose::identity(), Pairing::KdTree);
        assert!(space.share() > 0.03, "{space:?}");
        let seen_through = |reason: &Reason| matches!(reason, Reason::SeenThrough { .. });
        assert!(found.reasons.iter().any(seen_through), "{:?}", found.reasons);
        assert_ne!(found.verdict, Verdict::Ok);
        let told: Vec<String> = found.reasons.iter().map(ToString::to_string).collect();
        assert!(told.join(" ").contains("looked through"), "{told:?}");
    }

    #[test]
    fn points_go_as_far_as_they_are_open() {
        let motion =
            |kind| FreeMotion { kind, along: Vector3::y(), through: Point3::new(5.0, 0.0, 0.0) };
        let slid = shifted(&motion(MotionKind::Sliding), 2.0, 100.0) * Point3::origin();
        assert!((slid - Point3::new(0.0, 2.0, 0.0)).norm() < 1e-12);
        let turned = shifted(&motion(MotionKind::Turning), 0.1, 100.0);
        assert!((turned * Point3::new(5.0, 7.0, 0.0) - Point3::new(5.0, 7.0, 0.0)).norm() < 1e-12);
        let far = Point3::new(105.0, 0.0, 0.0);
        assert!(((turned * far - far).norm() - 0.1).abs() < 1e-6);
    }
}
