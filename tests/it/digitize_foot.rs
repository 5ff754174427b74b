//! Virtual digitizing of a real foot of 128,000 triangles, method against method.

use crate::dropping::agreed;
use crate::parts::{mesh, real};
use crate::random_cases::{Draw, in_cube};
use crate::textbook::{Tool, tools};
use horma::cam::Part;
use horma::geom::{Point3, Pose, Vector3};
use horma::io::read_surface;
use nalgebra::{Translation3, UnitQuaternion};
use rand::{RngExt, SeedableRng};
use std::f64::consts::TAU;

const N_POSITIONS: usize = 2000;

#[test]
fn both_methods_touch_a_real_foot_at_the_same_points_by_wheel_and_by_mills() {
    let Some(path) = real("lasts/find_foot/foot_mean_left.obj") else { return };
    let foot = mesh(read_surface(&path, None).unwrap());
    assert!(128_000 <= foot.triangles.len(), "{}", foot.triangles.len());
    let aabb = foot.aabb();
    let center = aabb.center();
    let foot = foot.moved(&Pose::translation(-center.x, -center.y, -center.z));
    let part = Part::triangles(&foot);
    let half = aabb.size() / 2.0;
    for (profile, seed) in tools().into_iter().zip(0..).take(4) {
        let mut draw = Draw::seed_from_u64(seed);
        // Over the foot and a little beyond, lying any way under the tool.
        let poses: Vec<Pose> = (0..N_POSITIONS)
            .map(|i| {
                let about_x = UnitQuaternion::from_axis_angle(
                    &Vector3::x_axis(),
                    draw.random_range(0.0..TAU),
                );
                let tilt = if i % 2 == 0 {
                    UnitQuaternion::identity()
                } else {
                    UnitQuaternion::from_scaled_axis(in_cube(&mut draw))
                };
                let under: Point3 = (in_cube(&mut draw).component_mul(&half) * 1.05).into();
                let rotation = tilt * about_x;
                Pose::from_parts(Translation3::from(-(rotation * under).coords), rotation)
            })
            .collect();
        let found = agreed(&part, &Tool { profile, allowance: 0.0 }, &poses);
        let n_touched = found.iter().flatten().count();
        assert!(n_touched > N_POSITIONS / 2, "{n_touched} of {N_POSITIONS} by {profile:?}");
    }
}
