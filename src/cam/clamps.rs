//! What holds the part, as closed surfaces the tool must spare.

use crate::geom::shapes;
use crate::geom::{Point3, Pose, Surface, TriMesh, Vector3};
use crate::machine::Clamping;
use nalgebra::{Rotation3, Translation3};
use std::f64::consts::TAU;

/// Sides of a clamp's cylinder, laid around it: it is never thinner than the real one.
const SIDES: usize = 64;
/// Lines around a stub that must all have met the part before the stub may end inside it.
const RIM_LINES: usize = 16;
/// The cone top is what lies within this of the highest point [mm].
const TOP: f64 = 1.0;
/// Points of a sampled clamp are this far apart [mm].
const SAMPLE: f64 = 1.0;

/// Why a part cannot be held.
#[derive(Debug, thiserror::Error)]
pub enum ClampError {
    /// A stub would hold on to nothing.
    #[error(
        "the {end} stub finds no part on the spindle axis (y = {y:.1}, z = {z:.1} in the part set up); \
         choose another spindle axis or centre"
    )]
    AxisMisses {
        /// `heel` or `toe`.
        end: &'static str,
        /// Where the axis passes [mm].
        y: f64,
        /// Where the axis passes [mm].
        z: f64,
    },
}

impl Clamping {
    /// X of the part's heel end [mm].
    pub(super) fn heel_distance(&self) -> f64 {
        match *self {
            Self::Table => 0.0,
            Self::Nibs { length, .. } => length,
            Self::Cone { gap, .. } => gap,
        }
    }
}

/// What holds a part.
pub(super) struct Clamps {
    /// The clamps themselves.
    pub(super) pieces: Vec<TriMesh>,
    /// Ends whose stub is for the most part not inside the part where it ends: `heel`, `toe`.
    pub(super) loose: Vec<&'static str>,
}

/// The clamps of `part`, already in its place on the machine, about the spindle axis through `line`.
pub(super) fn around(
    part: &Surface,
    clamping: &Clamping,
    line: &Point3,
) -> Result<Clamps, ClampError> {
    match *clamping {
        Clamping::Table => Ok(Clamps { pieces: Vec::new(), loose: Vec::new() }),
        Clamping::Nibs { radius, length } => {
            let aabb = part.aabb();
            let ([heel, toe], loose) = stub_ends(part, radius, line)?;
            let to_line = Pose::translation(0.0, line.y, line.z);
            let ends = [[aabb.min.x - length, heel], [toe, aabb.max.x + length]];
            let stub = |[from, to]: [f64; 2]| shapes::stub(SIDES, radius, from, to).moved(&to_line);
            Ok(Clamps { pieces: ends.map(stub).into(), loose })
        }
        Clamping::Cone { radius, length, .. } => {
            Ok(Clamps { pieces: vec![post(part, radius, length)], loose: Vec::new() })
        }
    }
}

/// X at which the stubs end inside the part: where every line of their rim has met it, but no
/// deeper than a stub's diameter behind the first touch; and the ends at which most lines miss it.
fn stub_ends(
    part: &Surface,
    radius: f64,
    line: &Point3,
) -> Result<([f64; 2], Vec<&'static str>), ClampError> {
    let mut lines = vec![[line.y, line.z]];
    for i in 0..RIM_LINES {
        let (sin, cos) = (TAU * i as f64 / RIM_LINES as f64).sin_cos();
        lines.push([line.y + radius * cos, line.z + radius * sin]);
    }
    let met: Vec<[f64; 2]> =
        lines.iter().filter_map(|&at| first_and_last(part, at, radius)).collect();
    let misses = |end| ClampError::AxisMisses { end, y: line.y, z: line.z };
    let (first, deepest) = range(met.iter().map(|x| x[0])).ok_or_else(|| misses("heel"))?;
    let (shallowest, last) = range(met.iter().map(|x| x[1])).ok_or_else(|| misses("toe"))?;
    let limits = [first + 2.0 * radius, last - 2.0 * radius];
    let held = [
        ("heel", met.iter().filter(|x| x[0] <= limits[0]).count()),
        ("toe", met.iter().filter(|x| limits[1] <= x[1]).count()),
    ];
    let loose = held.into_iter().filter(|(_, n_lines)| 2 * n_lines < lines.len());
    let ends = [deepest.min(limits[0]), shallowest.max(limits[1])];
    Ok((ends, loose.map(|(end, _)| end).collect()))
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, x| {
        Some(range.map_or((x, x), |(low, high): (f64, f64)| (low.min(x), high.max(x))))
    })
}

/// The least and greatest X at which a line along X meets the part. A cloud is met where a point
/// lies within the stub's radius of the line.
fn first_and_last(part: &Surface, [y, z]: [f64; 2], radius: f64) -> Option<[f64; 2]> {
    let met = if let Surface::Mesh(mesh) = part {
        range((0..mesh.triangles.len()).filter_map(|i| crossing(&mesh.corners(i), [y, z])))
    } else {
        let near = |p: &&Point3| (p.y - y).hypot(p.z - z) <= radius;
        range(part.points().iter().filter(near).map(|p| p.x))
    };
    met.map(|(first, last)| [first, last])
}

/// X at which the line along X through (y, z) passes through a triangle.
fn crossing(corners: &[Point3; 3], [y, z]: [f64; 2]) -> Option<f64> {
    let side = |a: &Point3, b: &Point3| (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y);
    let [a, b, c] = corners;
    let weights = [side(b, c), side(c, a), side(a, b)];
    let total: f64 = weights.iter().sum();
    let inside = total != 0.0 && weights.iter().all(|weight| weight / total >= 0.0);
    inside.then(|| (weights[0] * a.x + weights[1] * b.x + weights[2] * c.x) / total)
}

/// The post on the cone top: upright on what lies highest, reaching as far into the part as it is
/// thick, `length` out of it.
fn post(part: &Surface, radius: f64, length: f64) -> TriMesh {
    let points = part.points();
    let top = points.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let high: Vec<&Point3> = points.iter().filter(|p| top - TOP <= p.z).collect();
    let foot = high.iter().map(|p| p.coords).sum::<Vector3>() / high.len().max(1) as f64;
    let upright = Rotation3::from_axis_angle(&Vector3::y_axis(), -TAU / 4.0);
    let place = Pose::from_parts(Translation3::new(foot.x, foot.y, top), upright.into());
    shapes::stub(SIDES, radius, -radius, length).moved(&place)
}

/// Points all over a clamp, for the thesis' mode.
pub(super) fn sampled(clamp: &TriMesh) -> Vec<Point3> {
    let mut points = clamp.points.clone();
    for [a, b, c] in (0..clamp.triangles.len()).map(|i| clamp.corners(i)) {
        let n = ((b - a).norm().max((c - a).norm()) / SAMPLE).ceil().clamp(1.0, 1_000.0);
        for i in 0..=n as u32 {
            for j in 0..=(n as u32 - i) {
                points.push(a + (b - a) * (f64::from(i) / n) + (c - a) * (f64::from(j) / n));
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;

    #[test]
    fn a_stub_runs_from_the_dog_into_the_part() {
        let ball = Surface::Mesh(shapes::sphere(&Point3::new(75.0, 0.0, 0.0), 50.0, 64));
        let nibs = Clamping::Nibs { radius: 10.0, length: 25.0 };
        let Clamps { pieces: stubs, loose } = around(&ball, &nibs, &Point3::origin()).unwrap();
        assert!(loose.is_empty(), "{loose:?}");
        let [heel, toe] = [stubs[0].aabb(), stubs[1].aabb()];
        assert!(heel.min.x.abs() < 0.1 && (toe.max.x - 150.0).abs() < 0.1);
        // The rim of radius 10 enters a ball of 50 this far behind its end.
        let sunk = 50.0 - f64::sqrt(2500.0 - 100.0);
        assert!((heel.max.x - 25.0 - sunk).abs() < 0.1, "{}", heel.max.x);
    }

    #[test]
    fn an_axis_beside_the_part_is_refused() {
        let cube = shapes::cuboid(&Aabb { min: Point3::origin(), max: Point3::new(9.0, 9.0, 9.0) });
        let nibs = Clamping::Nibs { radius: 2.0, length: 25.0 };
        let error =
            around(&Surface::Mesh(cube), &nibs, &Point3::new(0.0, 50.0, 0.0)).err().unwrap();
        assert!(error.to_string().contains("heel stub finds no part"), "{error}");
    }

    #[test]
    fn the_post_stands_on_the_highest_place() {
        let cube = shapes::cuboid(&Aabb {
            min: Point3::new(0.0, -20.0, -20.0),
            max: Point3::new(100.0, 20.0, 30.0),
        });
        let cone = Clamping::Cone { radius: 8.0, length: 40.0, gap: 20.0 };
        let posts = around(&Surface::Mesh(cube), &cone, &Point3::origin()).unwrap().pieces;
        let aabb = posts[0].aabb();
        assert!((aabb.max.z - 70.0).abs() < 1e-9 && (aabb.min.z - 22.0).abs() < 1e-9);
        assert!((aabb.center().x - 50.0).abs() < 1e-9);
    }
}
