//! How much of the planes a pose lays on each other, and the pose that suits all those best.

use super::{PARALLEL, Walls};
use crate::geom::{Matrix3, Pose, Vector3};
use crate::register::align::turn;
use crate::register::coarse::matching::Hypothesis;
use nalgebra::UnitQuaternion;

/// Patches with middles farther apart than this many times the spread of both, squared, lie beside
/// each other: two even strips that only touch have 6.
const BESIDE: f64 = 6.0;
/// Times a pose is fitted again to the planes that agree with it.
const REFITS: usize = 3;
/// What a direction that no plane knows anything of is held by, to where it was.
const HOLD: f64 = 1e-6;

/// All planes of both clouds that are parallel under a turn.
pub(super) struct Meetings {
    turn: UnitQuaternion<f64>,
    pub(super) all: Vec<Meeting>,
}

/// A plane of the source, turned, and one of the target that is parallel to it.
pub(super) struct Meeting {
    /// Which planes: of the source, of the target.
    pub(super) places: [usize; 2],
    /// Of the source, turned, and of the target, to the same side.
    normals: [Vector3; 2],
    /// Between both.
    pub(super) normal: Vector3,
    /// From the turned middle of the source's to that of the target's.
    pub(super) gap: Vector3,
    /// The lesser area.
    pub(super) weight: f64,
    spreads: [Matrix3; 2],
    /// The inverse of the spread of both.
    inverse: Matrix3,
}

impl Meetings {
    /// Those of `walls` under `turn`, by their places in the source.
    pub(super) fn new(walls: &Walls, turn: UnitQuaternion<f64>) -> Self {
        let matrix = turn.to_rotation_matrix().into_inner();
        let mut all = Vec::new();
        for (i, from) in walls.source.iter().enumerate() {
            let turned = matrix * from.normal;
            for (k, onto) in walls.target.iter().enumerate() {
                let cosine = turned.dot(&onto.normal);
                let is_turned_over = walls.is_oriented && cosine < 0.0;
                if is_turned_over || turned.cross(&onto.normal).norm() > PARALLEL {
                    continue;
                }
                let spreads = [matrix * from.covariance * matrix.transpose(), onto.covariance];
                // Flat patches: what is too far off the plane, the tolerance says.
                let thick = Matrix3::from_diagonal_element(walls.tolerance.powi(2));
                let Some(inverse) = (spreads[0] + spreads[1] + thick).try_inverse() else {
                    continue;
                };
                let normals = [turned * cosine.signum(), onto.normal];
                all.push(Meeting {
                    places: [i, k],
                    normals,
                    normal: (normals[0] + normals[1]).normalize(),
                    gap: onto.middle - turn * from.middle,
                    weight: from.area.min(onto.area),
                    spreads,
                    inverse,
                });
            }
        }
        Self { turn, all }
    }

    /// The pose with a shift, and how much it lays on each other.
    pub(super) fn hypothesis(&self, shift: Vector3, tolerance: f64) -> Hypothesis {
        let best = self.agreeing(&shift, tolerance);
        let score = best.iter().map(|(_, weight)| weight).sum();
        Hypothesis { pose: Pose::from_parts(shift.into(), self.turn), score }
    }

    /// Every plane of the source with the one of the target that it lies on most, and by how much.
    pub(super) fn agreeing(&self, shift: &Vector3, tolerance: f64) -> Vec<(&Meeting, f64)> {
        let mut best: Vec<(&Meeting, f64)> = Vec::new();
        for meeting in &self.all {
            let weight = meeting.agreement(shift, tolerance);
            if weight <= 0.0 {
                continue;
            }
            match best.last_mut() {
                Some(last) if last.0.places[0] == meeting.places[0] => {
                    if last.1 < weight {
                        *last = (meeting, weight);
                    }
                }
                _ => best.push((meeting, weight)),
            }
        }
        best
    }
}

impl Meeting {
    /// How far apart the planes are after a shift, the farther at either's middle.
    pub(super) fn apart(&self, shift: &Vector3) -> f64 {
        let out = self.gap - shift;
        self.normals.iter().map(|normal| normal.dot(&out).abs()).fold(0.0, f64::max)
    }

    /// How much they lie over each other after a shift, and not only in one plane: 1 where their middles
    /// meet, 0 where they lie side by side.
    pub(super) fn overlap(&self, shift: &Vector3) -> f64 {
        let out = self.gap - shift;
        let along = out - self.normal * self.normal.dot(&out);
        (1.0 - along.dot(&(self.inverse * along)) / BESIDE).max(0.0)
    }

    /// How much of them comes to lie on each other: all of the lesser one at best.
    fn agreement(&self, shift: &Vector3, tolerance: f64) -> f64 {
        let apart = self.apart(shift);
        if apart >= tolerance {
            return 0.0;
        }
        self.weight * (1.0 - (apart / tolerance).powi(2)) * self.overlap(shift)
    }

    /// How far from the middles the ends along a direction are apart when the middles are not.
    pub(super) fn half_length(&self, along: &Vector3) -> f64 {
        let [from, onto] = self.spreads.map(|spread| (3.0 * along.dot(&(spread * along))).sqrt());
        onto - from
    }
}

impl Walls {
    /// A pose fitted to the planes that agree with it, as long as that makes it better.
    pub(super) fn refitted(&self, first: Hypothesis) -> Hypothesis {
        let mut best = first;
        for _ in 0..REFITS {
            let meetings = Meetings::new(self, best.pose.rotation);
            let shift = best.pose.translation.vector;
            let pairs: Vec<([usize; 2], f64)> = meetings
                .agreeing(&shift, self.tolerance)
                .into_iter()
                .map(|(meeting, weight)| (meeting.places, weight / meeting.weight))
                .collect();
            if pairs.is_empty() {
                break;
            }
            let pose = self.fitted(&pairs, &best.pose);
            let again = Meetings::new(self, pose.rotation);
            let fitted = again.hypothesis(pose.translation.vector, self.tolerance);
            if fitted.score <= best.score {
                break;
            }
            best = fitted;
        }
        best
    }

    /// The pose that suits planes best, each weighed by how well it is known and by how much it counts;
    /// where they say nothing, `before`.
    fn fitted(&self, pairs: &[([usize; 2], f64)], before: &Pose) -> Pose {
        let old = before.rotation.to_rotation_matrix().into_inner();
        let both = |[i, k]: [usize; 2]| (&self.source[i], &self.target[k]);
        // Wahba's problem, solved like Horn's.
        let mut normals = Matrix3::zeros();
        for &(places, share) in pairs {
            let (from, onto) = both(places);
            let side = onto.normal.dot(&(old * from.normal)).signum();
            let weight = share / (from.tilt + onto.tilt);
            normals += onto.normal * from.normal.transpose() * (side * weight);
        }
        let rotation = turn(&(normals + old * (HOLD * normals.norm())));
        let matrix = rotation.to_rotation_matrix().into_inner();
        let shift = before.translation.vector;
        let mut known = Matrix3::zeros();
        let mut wanted = Vector3::zeros();
        for &(places, share) in pairs {
            let (from, onto) = both(places);
            let gap = onto.middle - rotation * from.middle - shift;
            let side = onto.normal.dot(&(matrix * from.normal)).signum();
            let normal = (onto.normal + matrix * from.normal * side).normalize();
            // Half a patch away, a normal's error is an offset's.
            let weight =
                share / (from.off + onto.off + (from.tilt + onto.tilt) * gap.norm_squared());
            known += normal * normal.transpose() * weight;
            wanted += normal * (weight * normal.dot(&gap));
        }
        let held = known + Matrix3::from_diagonal_element(HOLD * known.trace());
        let step = held.try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * wanted);
        Pose::from_parts((shift + step).into(), rotation)
    }
}
