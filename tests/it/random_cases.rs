//! Random tools, triangles and poses, with a liking for what troubles an exact contact.

use crate::textbook::{Reach, Tool};
use horma::geom::{Point3, Pose, Vector3};
use horma::tool::Profile;
use nalgebra::{Translation3, UnitQuaternion};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;

/// Where what is random comes from.
pub(crate) type Draw = Pcg64Mcg;

/// A triangle of a part, a tool and where the part lies under it.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) triangle: [Point3; 3],
    pub(crate) tool: Tool,
    pub(crate) attack_from_part: Pose,
}

impl Case {
    /// Case `i`, drawn from its own seed.
    pub(crate) fn draw(i: u64) -> Self {
        let mut draw = Draw::seed_from_u64(i);
        let tool = draw_tool(&mut draw);
        let seen = draw_triangle(&tool, &mut draw);
        let attack_from_part = draw_pose(&mut draw);
        let triangle = seen.map(|corner| attack_from_part.inverse() * Point3::from(corner));
        Self { triangle, tool, attack_from_part }
    }

    /// How far rounding may have moved the triangle under the tool.
    pub(crate) fn slack(&self) -> f64 {
        self.tool.slack(&self.triangle, &self.attack_from_part)
    }
}

/// Ten to a power drawn from `exponents`.
fn power(draw: &mut Draw, exponents: std::ops::Range<f64>) -> f64 {
    10f64.powf(draw.random_range(exponents))
}

fn sign(draw: &mut Draw) -> f64 {
    if draw.random() { 1.0 } else { -1.0 }
}

pub(crate) fn in_cube(draw: &mut Draw) -> Vector3 {
    Vector3::from_fn(|_, _| draw.random_range(-1.0..1.0))
}

pub(crate) fn draw_tool(draw: &mut Draw) -> Tool {
    let radius = power(draw, -0.5..1.7);
    let half_angle = draw.random_range(0.02..1.55);
    let share = if draw.random_bool(0.1) { 1.0 } else { draw.random_range(0.001..1.0) };
    let profile = match draw.random_range(0..6) {
        0 => {
            let major_radius = if draw.random_bool(0.05) { 0.0 } else { power(draw, -1.0..2.0) };
            Profile::Wheel { major_radius, minor_radius: radius }
        }
        1 => Profile::Ball { radius },
        2 => Profile::Flat { radius },
        3 => Profile::Bull { radius, corner_radius: radius * share },
        4 => Profile::Cone { radius, half_angle },
        _ => Profile::BallCone { radius, tip_radius: radius * share, half_angle },
    };
    let allowance = if draw.random() { 0.0 } else { power(draw, -6.0..0.7) };
    assert_eq!(profile.check(), Ok(()));
    Tool { profile, allowance }
}

/// From not at all to any way turned and far shifted.
pub(crate) fn draw_pose(draw: &mut Draw) -> Pose {
    let shift = in_cube(draw) * power(draw, 0.0..3.0);
    let angle = draw.random_range(0.0..TAU);
    let rotation = match draw.random_range(0..4) {
        0 => return Pose::identity(),
        1 => UnitQuaternion::identity(),
        2 => UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle),
        _ => UnitQuaternion::from_scaled_axis(in_cube(draw) * 3.0),
    };
    Pose::from_parts(Translation3::from(shift), rotation)
}

/// A triangle in the attack frame.
pub(crate) fn draw_triangle(tool: &Tool, draw: &mut Draw) -> [Vector3; 3] {
    let size = tool.profile.reach() + tool.allowance;
    let anywhere = in_cube(draw) * size * 1.2;
    // From much smaller to much larger than the tool.
    let side = size * power(draw, -3.0..2.5);
    let [a, b, c] = [(); 3].map(|()| anywhere + in_cube(draw) * side);
    let little = sign(draw) * power(draw, -14.0..-2.0);
    let mut corners = match draw.random_range(0..12) {
        // A sliver.
        0 => [a, b, a + (b - a) * draw.random_range(-0.5..1.5) + in_cube(draw) * little],
        // Without area.
        1 => match draw.random_range(0..3) {
            0 => [a, a, a],
            1 => [a, b, a],
            _ => [a, b, (a + b) / 2.0],
        },
        // Vertical, exactly or nearly.
        2 => [a, b, Vector3::new(a.x, c.y, a.z)],
        3 => [a, b, Vector3::new(a.x + little, c.y, a.z)],
        // Level, exactly or nearly.
        4 => [a, Vector3::new(b.x, a.y, b.z), Vector3::new(c.x, a.y + little, c.z)],
        5 => [a, b, c].map(|corner| Vector3::new(corner.x, a.y, corner.z)),
        6 => draw_grazing([a, b, c], little, tool, draw),
        7 => draw_along_flank(c * side / size, little, tool, draw),
        8..10 => draw_under(side, tool, draw),
        _ => [a, b, c],
    };
    corners.shuffle(draw);
    corners
}

/// A triangle with an edge tangent to the rim of the shadow, exactly or `little` out or in.
fn draw_grazing(
    [a, b, c]: [Vector3; 3],
    little: f64,
    tool: &Tool,
    draw: &mut Draw,
) -> [Vector3; 3] {
    let (rim, along) = draw_rim(tool, draw);
    let rim = rim + rim.normalize() * if draw.random() { little } else { 0.0 };
    let mut end = |y, way: f64| {
        Vector3::new(rim.x, y, rim.z) + along * (way * (a - b).norm() * draw.random::<f64>())
    };
    [end(a.y, 1.0), end(b.y, -1.0), c]
}

/// A triangle with an edge as steep as the tool's flank or flat, exactly or by `little`.
fn draw_along_flank(aside: Vector3, little: f64, tool: &Tool, draw: &mut Draw) -> [Vector3; 3] {
    let size = tool.profile.reach();
    let steepness = match tool.profile {
        Profile::Cone { half_angle, .. } | Profile::BallCone { half_angle, .. } => {
            1.0 / half_angle.tan()
        }
        _ => 0.0,
    };
    let slope = steepness + if draw.random() { little } else { 0.0 };
    let (sin, cos) = draw.random_range(0.0..TAU).sin_cos();
    let way = Vector3::new(cos, slope, sin) * size;
    let foot = if draw.random() { in_cube(draw) * size } else { Vector3::zeros() };
    let a = foot + way * draw.random_range(-1.5..0.5);
    let b = foot + way * draw.random_range(0.0..1.5);
    [a, b, a + Vector3::new(-sin, draw.random_range(-1.0..0.0), cos) * aside.norm()]
}

/// A triangle about the point where the tool touches its plane, mostly a sliver.
fn draw_under(side: f64, tool: &Tool, draw: &mut Draw) -> [Vector3; 3] {
    let mut normal = in_cube(draw);
    normal.y = match draw.random_range(0..4) {
        0 => power(draw, -14.0..-1.0),
        1 => 1.0 / power(draw, -2.0..12.0),
        _ => draw.random(),
    };
    let normal = normal.normalize();
    let contact = tool.support(&normal) + Vector3::y() * draw.random_range(-20.0..20.0);
    let along = normal.cross(&in_cube(draw)).normalize();
    let across = normal.cross(&along);
    let width = side * power(draw, -13.0..0.0);
    let at = |u: f64, v: f64| contact + along * (u * side) + across * (v * width);
    let mut share = || draw.random_range(0.01..1.0);
    [at(-share(), -share()), at(-share(), share()), at(share(), 0.0)]
}

/// A point of the rim of the shadow, and the direction of the rim there.
fn draw_rim(tool: &Tool, draw: &mut Draw) -> (Vector3, Vector3) {
    let angle: f64 = draw.random_range(0.0..TAU);
    let (sin, cos) = angle.sin_cos();
    let (out, along) = (Vector3::new(cos, 0.0, sin), Vector3::new(-sin, 0.0, cos));
    match tool.profile {
        Profile::Wheel { major_radius, minor_radius } => {
            let center = Vector3::z() * (major_radius * sin.signum());
            (center + out * (minor_radius + tool.allowance), along)
        }
        profile => (out * (profile.reach() + tool.allowance), along),
    }
}
