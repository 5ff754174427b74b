//! Setting up the part: where it stands on the machine, and what holds it.
//!
//! On a machine with a spindle the part's long axis is laid on the spindle axis, its heel end at
//! the distance the clamping asks for; on a table it stands as it is, centred. What holds the part
//! is added as further surface ("virtually added parts", Morell 2014, 1.4.2.2): digitizing takes
//! the highest touch of all pieces, so no boolean is needed.

mod moved;
mod options;
mod spread;

use super::clamps::{self, ClampError, Clamps};
use crate::geom::{Aabb, Matrix3, Point3, Pose, Surface, TriMesh, Vector3, shapes};
use crate::machine::Machine;
use moved::{mirrored, moved};
use nalgebra::{Rotation3, Translation3, UnitQuaternion};
use spread::Spread;
use std::f64::consts::FRAC_PI_2;

pub use options::{Centre, SetupOptions, SpindleAxis};

/// The part's ends, as a share of its length.
const END: f64 = 0.06;
/// A tool that goes around a part on a table stays off the table by this [mm].
pub const TABLE_GAP: f64 = 1.0;
/// Sides of the plate that stands for the table.
const TABLE_SIDES: usize = 64;

/// A part on its machine, with all that holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The part, then its clamps, in the machine's part frame.
    pub surface: Surface,
    /// How many of the triangles (or points) are the part's own; the rest are clamps.
    pub n_own: usize,
    /// How many of the surface's points (vertices) are the part's own.
    pub n_own_points: usize,
    /// The part alone [mm].
    pub part: Aabb,
    /// Greatest distance of the part from the spindle axis [mm]; 0 without a spindle.
    pub swing: f64,
    /// True if it is the mirror image of what the file has.
    pub is_mirrored: bool,
    /// The part's frame on the machine from the frame of the file (after mirroring).
    pub machine_from_file: Pose,
    /// The stretch of X the part and its clamps take up [mm].
    pub stretch: [f64; 2],
    /// Ends whose stub is for the most part not inside the part where it ends: `heel`, `toe`.
    pub loose: Vec<&'static str>,
}

/// Why a part cannot be set up.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// There is nothing to set up.
    #[error("the part has no extent; it needs at least one triangle or point")]
    Empty,
    /// The direction given is no direction.
    #[error(
        "the spindle axis {0} is no direction; give x, y, z or three numbers such as \"1 0 0.2\""
    )]
    NoAxis(String),
    /// It cannot be held.
    #[error(transparent)]
    Clamp(#[from] ClampError),
}

impl Setup {
    /// How long the clamps are beyond the part's ends, the shorter of them [mm].
    pub fn clamp_length(&self) -> f64 {
        (self.part.min.x - self.stretch[0]).min(self.stretch[1] - self.part.max.x)
    }

    /// Adds the table a part is turned on, so that the tool spares it: a plate of `radius` about
    /// the line through `middle` along Z, [`TABLE_GAP`] above where the part stands.
    pub fn add_table(&mut self, middle: &Point3, radius: f64) {
        let upright = Rotation3::from_axis_angle(&Vector3::y_axis(), -FRAC_PI_2);
        let place = Translation3::new(middle.x, middle.y, self.part.min.z);
        let plate = shapes::stub(TABLE_SIDES, radius, -1.0, TABLE_GAP);
        add_clamp(&mut self.surface, plate.moved(&Pose::from_parts(place, upright.into())));
    }

    /// The points of the part alone.
    pub fn own_points(&self) -> impl Iterator<Item = &Point3> {
        self.surface.points()[..self.n_own_points].iter()
    }
}

/// Lays `surface` on `machine`.
pub fn set_up(
    surface: Surface,
    machine: &Machine,
    options: &SetupOptions,
) -> Result<Setup, SetupError> {
    let surface = if options.mirror { mirrored(surface) } else { surface };
    let Some(spread) = Spread::of(&surface) else { return Err(SetupError::Empty) };
    let turn = match machine.spindle {
        Some(_) => turn_onto_spindle(&spread, options),
        None => Rotation3::from_axis_angle(&Vector3::z_axis(), options.start_angle),
    };
    let turn = match (machine.spindle, options.centre) {
        (Some(_), Centre::Ends) => onto_ends(&surface, &turn) * turn,
        _ => turn,
    };
    let turned = moved(surface, &Pose::from_parts(Translation3::identity(), turn.into()));
    let middle = match options.centre {
        Centre::Centroid => turn * spread.centroid,
        Centre::Box => turned.aabb().center(),
        Centre::Ends => ends(turned.points())[0],
        Centre::Origin => Point3::origin(),
    };
    let place = place(&turned, machine, &middle, options.centre);
    let machine_from_file = Pose::from_parts(place, turn.into());
    let mut surface = moved(turned, &Pose::from_parts(place, UnitQuaternion::identity()));
    let part = surface.aabb();
    let line = spindle_line(machine);
    let swing = match machine.spindle {
        Some(_) => farthest(&surface, &line),
        None => 0.0,
    };
    let n_own = match &surface {
        Surface::Mesh(mesh) => mesh.triangles.len(),
        other => other.points().len(),
    };
    let n_own_points = surface.points().len();
    let Clamps { pieces, loose } = clamps::around(&surface, &machine.clamping, &line)?;
    let stretch = pieces
        .iter()
        .flat_map(|clamp| &clamp.points)
        .fold([part.min.x, part.max.x], |[low, high], p| [low.min(p.x), high.max(p.x)]);
    for clamp in pieces {
        add_clamp(&mut surface, clamp);
    }
    Ok(Setup {
        surface,
        n_own,
        n_own_points,
        part,
        swing,
        is_mirrored: options.mirror,
        machine_from_file,
        stretch,
        loose,
    })
}

/// A point of the spindle axis; the middle of the table where there is no spindle.
fn spindle_line(machine: &Machine) -> Point3 {
    machine.spindle.map_or_else(Point3::origin, |index| machine.axes[index].point)
}

/// The rotation that lays the chosen axis along X, rolls the part as little as that allows (its Z
/// stays as near to Z as it can), then turns it by the start angle.
fn turn_onto_spindle(spread: &Spread, options: &SetupOptions) -> Rotation3<f64> {
    let along = match options.axis {
        SpindleAxis::Auto => spread.principal_axis(),
        SpindleAxis::Along(axis) => axis,
    };
    let x = if options.flip { -along } else { along };
    let up = if x.z.abs() < 0.999 { Vector3::z() } else { Vector3::y() };
    let z = (up - x * x.dot(&up)).normalize();
    let y = z.cross(&x);
    let onto = Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]);
    Rotation3::from_axis_angle(&Vector3::x_axis(), options.start_angle)
        * Rotation3::from_matrix_unchecked(onto)
}

/// The small rotation that, after `turn`, brings the middles of both ends onto a line along X.
fn onto_ends(surface: &Surface, turn: &Rotation3<f64>) -> Rotation3<f64> {
    let turned: Vec<Point3> = surface.points().iter().map(|point| turn * point).collect();
    let [heel, toe] = ends(&turned);
    Rotation3::rotation_between(&(toe - heel), &Vector3::x()).unwrap_or_else(Rotation3::identity)
}

/// The middles of the boxes around what lies near the least and the greatest X.
fn ends(points: &[Point3]) -> [Point3; 2] {
    let aabb = Aabb::around(points);
    let near = END * aabb.size().x;
    let around =
        |is_near: &dyn Fn(&&Point3) -> bool| Aabb::around(points.iter().filter(is_near)).center();
    [around(&|p| p.x <= aabb.min.x + near), around(&|p| aabb.max.x - near <= p.x)]
}

/// Where the turned part goes.
fn place(
    turned: &Surface,
    machine: &Machine,
    middle: &Point3,
    centre: Centre,
) -> Translation3<f64> {
    let aabb = turned.aabb();
    let line = spindle_line(machine);
    match machine.spindle {
        Some(_) => Translation3::new(
            machine.clamping.heel_distance() - aabb.min.x,
            line.y - middle.y,
            line.z - middle.z,
        ),
        None if centre == Centre::Origin => Translation3::identity(),
        // The part stands on the table, its lowest point at height 0.
        None => Translation3::new(-middle.x, -middle.y, -aabb.min.z),
    }
}

/// A clamp as triangles, or, under a cloud, as the points that bound it.
fn add_clamp(surface: &mut Surface, clamp: TriMesh) {
    match surface {
        Surface::Mesh(mesh) => mesh.append(clamp),
        Surface::Points(cloud) => {
            cloud.points.extend(clamps::sampled(&clamp));
            cloud.normals = None;
            cloud.colors = None;
        }
        Surface::Sections(_) => {}
    }
}

fn farthest(surface: &Surface, line: &Point3) -> f64 {
    let points = surface.points().iter();
    points.map(|p| (p.y - line.y).hypot(p.z - line.z)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::shapes;

    fn lathe() -> Machine {
        Machine::builtin("last-lathe").unwrap()
    }

    fn rod() -> Surface {
        let rod = shapes::cuboid(&Aabb {
            min: Point3::new(-10.0, 0.0, -100.0),
            max: Point3::new(10.0, 30.0, 100.0),
        });
        Surface::Mesh(rod)
    }

    #[test]
    fn the_longest_axis_goes_on_the_spindle_with_room_for_the_stub() {
        let setup = set_up(rod(), &lathe(), &SetupOptions::default()).unwrap();
        assert!((setup.part.min.x - 25.0).abs() < 1e-9);
        assert!((setup.part.max.x - 225.0).abs() < 1e-9);
        assert!((setup.swing - 10_f64.hypot(15.0)).abs() < 1e-9);
        assert!((setup.stretch[0]).abs() < 1e-9 && (setup.stretch[1] - 250.0).abs() < 1e-9);
    }

    #[test]
    fn a_given_axis_and_flip_decide_which_end_is_the_heel() {
        let tip = |options: &SetupOptions| {
            let setup = set_up(rod(), &lathe(), options).unwrap();
            (setup.machine_from_file * Point3::new(0.0, 0.0, 100.0)).x
        };
        let options = SetupOptions { axis: "z".parse().unwrap(), ..Default::default() };
        assert!((tip(&options) - 225.0).abs() < 1e-9);
        assert!((tip(&SetupOptions { flip: true, ..options }) - 25.0).abs() < 1e-9);
    }

    #[test]
    fn the_mirror_image_is_the_other_foot() {
        let chiral = Surface::Mesh(shapes::chiral(2_000));
        let options = SetupOptions { axis: "x".parse().unwrap(), ..Default::default() };
        let one = set_up(chiral.clone(), &lathe(), &options).unwrap();
        let other = set_up(chiral, &lathe(), &SetupOptions { mirror: true, ..options }).unwrap();
        let (a, b) = (&one.surface.points()[7], &other.surface.points()[7]);
        assert!((a.x - b.x).abs() < 1e-9 && (a.y + b.y).abs() < 1e-9 && (a.z - b.z).abs() < 1e-9);
    }

    #[test]
    fn centred_on_its_ends_a_slanting_rod_lies_along_the_spindle() {
        let slant = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.1);
        let fine = (0..5).fold(rod().into_mesh().unwrap(), |mesh, _| shapes::subdivide(&mesh));
        let rod = fine.moved(&Pose::from_parts(Translation3::identity(), slant.into()));
        let axis = "z".parse().unwrap();
        let options = SetupOptions { axis, centre: Centre::Ends, ..Default::default() };
        let setup = set_up(Surface::Mesh(rod), &lathe(), &options).unwrap();
        assert!((setup.swing - 10_f64.hypot(15.0)).abs() < 0.6, "{}", setup.swing);
        assert!(setup.loose.is_empty());
    }
}
