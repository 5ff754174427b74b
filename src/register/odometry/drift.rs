//! How far a walk may have gone astray: what its steps leave open, added up.

use super::Link;
use crate::geom::Pose;
use crate::register::small_motion::adjoint;
use nalgebra::{Matrix3x6, Matrix6};

/// Where the camera was, and what it hangs on; nothing of a frame that was skipped.
pub type Hanging = (Option<Pose>, Option<Link>);

/// How far the camera of each frame may be from where the walk has it, seen from the first one, by what the
/// motions leave open that lead there: three standard deviations [mm]. `None` of frames that were skipped.
///
/// Each motion is taken for right but for what is known of it; what all of them are off alike is not in it.
pub fn drift(walk: &[Hanging]) -> Vec<Option<f64>> {
    let mut covariances: Vec<Option<Matrix6<f64>>> = Vec::with_capacity(walk.len());
    for (pose, link) in walk {
        let covariance = match (pose, link) {
            (None, _) => None,
            (Some(_), None) => Some(Matrix6::zeros()),
            (Some(_), Some(link)) => beyond(walk, &covariances, link),
        };
        covariances.push(covariance);
    }
    let open = |((pose, _), covariance): (&Hanging, &Option<Matrix6<f64>>)| {
        let place = (*pose)?.translation.vector;
        let mut by_step = Matrix3x6::zeros();
        by_step.fixed_view_mut::<3, 3>(0, 0).copy_from(&-place.cross_matrix());
        by_step.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        let of_place = by_step * (*covariance)? * by_step.transpose();
        Some(3.0 * of_place.symmetric_eigenvalues().max().max(0.0).sqrt())
    };
    walk.iter().zip(&covariances).map(open).collect()
}

/// What is open of a frame that hangs on a key frame by `link`: a small step from the left, in the world.
fn beyond(
    walk: &[Hanging],
    covariances: &[Option<Matrix6<f64>>],
    link: &Link,
) -> Option<Matrix6<f64>> {
    let (world_from_key, _) = walk.get(link.key)?;
    let carry = adjoint(&(*world_from_key)?);
    let open = link.information.try_inverse()?;
    Some((*covariances.get(link.key)?)? + carry * open * carry.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vector3;
    use nalgebra::Vector6;

    /// A walk along x by steps of 100 mm, each known to 1 mm and `turn` radians.
    fn walk(n: usize, turn: f64) -> Vec<Hanging> {
        let step = Pose::new(Vector3::new(100.0, 0.0, 0.0), Vector3::zeros());
        let known = 1.0 / (turn * turn);
        let information = Matrix6::from_diagonal(&Vector6::new(known, known, known, 1.0, 1.0, 1.0));
        let link = |i: usize| {
            let key = i.checked_sub(1)?;
            Some(Link { key, key_from_camera: step, information, overlap: 1.0 })
        };
        let pose = |i: usize| Pose::translation(100.0 * i as f64, 0.0, 0.0);
        (0..n).map(|i| (Some(pose(i)), link(i))).collect()
    }

    #[test]
    fn shifts_add_up_like_a_random_walk_and_turns_with_their_lever() {
        let open = drift(&walk(10, 1e-9));
        assert_eq!(open[0], Some(0.0));
        assert!((open[4].unwrap() - 3.0 * 2.0).abs() < 1e-6, "{open:?}");
        assert!((open[9].unwrap() - 3.0 * 3.0).abs() < 1e-6, "{open:?}");
        // The turn of each step swings all that comes after it: 100, 200, 300 mm away.
        let open = drift(&walk(4, 0.01)).pop().flatten().unwrap();
        let squares = 3.0 + 1.0 + 4.0 + 9.0;
        assert!((open - 3.0 * f64::sqrt(squares)).abs() < 1e-6, "{open}");
    }

    #[test]
    fn what_was_skipped_or_hangs_on_nothing_known_has_none() {
        let mut walk = walk(4, 0.01);
        walk[2] = (None, None);
        assert_eq!(drift(&walk)[2..], [None, None]);
        let (_, link) = &mut walk[1];
        link.as_mut().unwrap().information = Matrix6::zeros();
        assert_eq!(drift(&walk)[1], None);
    }
}
