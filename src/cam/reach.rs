//! What of the part the tool can reach at all, whatever the trajectory: undercuts along the attack
//! axis, and hollows too narrow for the tool.
//!
//! Every triangle is laid under the tool so that the tool would touch it in its middle, and the
//! tool is brought down: where something else holds it off, it stays off by that much. On a machine
//! with a spindle the pose follows in closed form for tools that look the same from all around the
//! spindle (wheel, ball): the centre of the tool lies on the contact's normal and must be turned
//! into the attack plane. Other tools are turned so that the normal faces them.

use super::digitize::Digitizer;
use crate::geom::{Point3, Pose, TriMesh, Vector3};
use crate::machine::{AxisValues, Machine};
use crate::progress::{Cancelled, Progress};
use crate::tool::Cutter;
use nalgebra::{Rotation3, Translation3, UnitQuaternion};
use serde::Serialize;

/// A tool no farther off than this still cuts the surface as the trade asks, to a tenth [mm].
const TOUCHES: f64 = 0.1;
/// A few slivers with stray normals must not decide how deep the hollows are.
const MOST: f64 = 0.95;
/// A facet less open to the tool than this is seen edge-on: rounding of its normal.
const EDGE_ON: f64 = 1e-9;
/// At most this many triangles are tried, evenly picked.
const MOST_TRIANGLES: usize = 100_000;

/// How much of the part's surface the tool can and cannot touch.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ReachReport {
    /// The whole surface [mm2].
    pub area: f64,
    /// Turned away from the tool in every pose that would bring it there [mm2].
    pub undercut: f64,
    /// In hollows the tool is too large for [mm2].
    pub hollow: f64,
    /// Under a clamp or its neighbourhood [mm2].
    pub clamped: f64,
    /// On 95 % of the hollows' area the tool keeps off by no more than this, along the normal; what
    /// it takes away from elsewhere is not counted [mm].
    pub deepest: f64,
    /// The places tried, for the map; not in files.
    #[serde(skip)]
    pub places: Vec<Place>,
}

/// A machine with the words of the axes no trajectory drives.
#[derive(Debug, Clone, Copy)]
pub struct Stand<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// Words of all axes at rest.
    pub rest: AxisValues,
}

/// One place of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Where, in the part's frame on the machine [mm].
    pub point: Point3,
    /// How far the tool stays off along the normal [mm]; infinite on an undercut.
    pub off: f64,
}

/// Tries every triangle of the first `n_own` of `mesh`; the others are clamps.
pub fn reach(
    digitizer: &Digitizer,
    stand: &Stand,
    mesh: &TriMesh,
    n_own: usize,
    progress: &dyn Progress,
) -> Result<ReachReport, Cancelled> {
    let stride = n_own.div_ceil(MOST_TRIANGLES).max(1);
    let tried: Vec<usize> = (0..n_own).step_by(stride).collect();
    let poses: Vec<Option<Facing>> =
        tried.iter().map(|&i| Facing::of(mesh, i, stand, &digitizer.cutter)).collect();
    // An undercut is digitized too, at rest, and its answer not looked at.
    let pose = |i: usize| poses[i].map_or_else(Pose::identity, |facing| facing.attack_from_part);
    let contacts = digitizer.run(tried.len(), pose, progress)?;
    let mut report = ReachReport::empty(tried.len());
    let mut hollows = Vec::new();
    for ((&i, facing), contact) in tried.iter().zip(&poses).zip(&contacts) {
        let area = mesh.area_vector(i).norm();
        let off = if let (Some(facing), Some(contact)) = (facing, contact) {
            let off = ((contact.height - facing.height) * facing.normal_y).max(0.0);
            let is_clamp = n_own <= contact.primitive as usize;
            match off > TOUCHES {
                true if is_clamp => report.clamped += area,
                true => hollows.push((off, area)),
                false => {}
            }
            off
        } else {
            report.undercut += area;
            f64::INFINITY
        };
        report.area += area;
        report.places.push(Place { point: middle(mesh, i), off });
    }
    report.hollow = hollows.iter().map(|(_, area)| area).sum();
    report.deepest = quantile(hollows, MOST);
    report.scale_to((0..n_own).map(|i| mesh.area_vector(i).norm()).sum());
    Ok(report)
}

impl ReachReport {
    fn empty(n_places: usize) -> Self {
        let places = Vec::with_capacity(n_places);
        Self { area: 0.0, undercut: 0.0, hollow: 0.0, clamped: 0.0, deepest: 0.0, places }
    }

    /// The triangles left out are like those tried.
    fn scale_to(&mut self, area: f64) {
        let scale = if self.area > 0.0 { area / self.area } else { 0.0 };
        for part in [&mut self.area, &mut self.undercut, &mut self.hollow, &mut self.clamped] {
            *part *= scale;
        }
    }
}

/// The value that this share of the weight stays below.
fn quantile(mut weighted: Vec<(f64, f64)>, share: f64) -> f64 {
    weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = share * weighted.iter().map(|(_, weight)| weight).sum::<f64>();
    let crossing = weighted.iter().find(|(_, weight)| {
        left -= weight;
        left <= 0.0
    });
    crossing.or(weighted.last()).map_or(0.0, |(value, _)| *value)
}

fn middle(mesh: &TriMesh, i: usize) -> Point3 {
    let [a, b, c] = mesh.corners(i);
    Point3::from((a.coords + b.coords + c.coords) / 3.0)
}

/// The pose that brings the middle of a triangle under the tool.
#[derive(Debug, Clone, Copy)]
struct Facing {
    attack_from_part: Pose,
    /// Attack height at which the tool would touch the triangle's middle [mm].
    height: f64,
    /// Slope of the triangle there: 1 faces the tool.
    normal_y: f64,
}

impl Facing {
    /// `None` for an undercut, and for a triangle without area.
    fn of(mesh: &TriMesh, i: usize, stand: &Stand, cutter: &Cutter) -> Option<Self> {
        let normal = mesh.area_vector(i).try_normalize(0.0)?;
        let at_rest = stand.machine.attack_from_part(&stand.rest);
        let (point, normal) = (at_rest * middle(mesh, i), at_rest * normal);
        let turn = match stand.machine.spindle {
            Some(_) => turn_under(&point, &normal, cutter),
            None => Rotation3::identity(),
        };
        let (point, normal) = (turn * point, turn * normal);
        if normal.y < EDGE_ON {
            return None;
        }
        let programmed = point - cutter.support(&normal);
        let shift = Translation3::new(-programmed.x, 0.0, -programmed.z);
        let turn = Pose::from_parts(Translation3::identity(), UnitQuaternion::from(turn));
        Some(Self {
            attack_from_part: shift * turn * at_rest,
            height: programmed.y,
            normal_y: normal.y,
        })
    }
}

/// The turn about x that brings the tool's centre, out on the normal of the contact, into the attack
/// plane z = 0 on the attack side.
fn turn_under(point: &Point3, normal: &Vector3, cutter: &Cutter) -> Rotation3<f64> {
    let out = match cutter {
        Cutter::Wheel(wheel) => {
            let turned = normal.y.hypot(normal.z);
            if turned == 0.0 { 0.0 } else { wheel.minor + wheel.major / turned }
        }
        // Far out: the normal itself is turned to face the tool. A ball's centre is near enough
        // to the spindle's own distance for its radius to count.
        Cutter::Mill(mill) => mill.ball_radius().unwrap_or(1e6),
    };
    let (y, z) = (point.y + out * normal.y, point.z + out * normal.z);
    Rotation3::from_axis_angle(&Vector3::x_axis(), -z.atan2(y))
}

#[cfg(test)]
mod tests {
    use super::super::digitize::{Method, Part};
    use super::*;
    use crate::geom::{Aabb, shapes};
    use crate::progress::Silent;
    use crate::tool::Profile;

    fn reach_of(mesh: &TriMesh, machine: &str, profile: Profile) -> ReachReport {
        let part = Part::triangles(mesh);
        let cutter = profile.cutter(0.0);
        let digitizer = Digitizer { part: &part, cutter, method: Method::Indexed };
        let machine = Machine::builtin(machine).unwrap();
        let stand = Stand { machine: &machine, rest: machine.at_rest() };
        reach(&digitizer, &stand, mesh, mesh.triangles.len(), &Silent).unwrap()
    }

    const WHEEL: Profile = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 };

    #[test]
    fn a_wheel_reaches_all_of_a_ball() {
        let ball = shapes::sphere(&Point3::new(60.0, 0.0, 0.0), 40.0, 64);
        let report = reach_of(&ball, "last-lathe", WHEEL);
        assert!(report.hollow + report.undercut < 0.01 * report.area, "{report:?}");
    }

    #[test]
    fn on_a_table_the_underside_is_an_undercut() {
        let cube = shapes::cuboid(&Aabb { min: Point3::origin(), max: Point3::new(9.0, 9.0, 9.0) });
        let report = reach_of(&cube, "mill-3axis", Profile::Ball { radius: 3.0 });
        assert!((report.area - 6.0 * 81.0).abs() < 1e-9);
        // The underside and, seen edge-on, the four walls.
        assert!((report.undercut - 5.0 * 81.0).abs() < 1e-9, "{}", report.undercut);
    }

    #[test]
    fn a_groove_narrower_than_the_wheel_is_a_hollow() {
        let mut part = shapes::stub(64, 40.0, 0.0, 50.0);
        part.append(shapes::stub(64, 20.0, 50.0, 60.0));
        part.append(shapes::stub(64, 40.0, 60.0, 110.0));
        // The floor of the groove is two triangles a side over its whole width: finer, to be tried
        // in its middle.
        let report = reach_of(&shapes::subdivide(&part), "last-lathe", WHEEL);
        assert!(report.hollow > 0.9 * std::f64::consts::TAU * 20.0 * 10.0, "{}", report.hollow);
        assert!(report.deepest > 15.0, "{}", report.deepest);
    }
}
