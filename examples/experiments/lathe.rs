//! The lathe of the experiments: a foot on the spindle, points sampled from it, a spiral around it.

use crate::scan::Step;
use anyhow::Context as _;
use horma::geom::{Point3, PointCloud, Pose, TriMesh, shapes};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;
use std::fmt;
use std::path::PathBuf;

/// The wheel, torus radii [mm].
pub(crate) const RADII: [f64; 2] = [60.0, 10.0];
/// Of the spiral, along the spindle [mm a turn].
pub(crate) const PITCH: f64 = 4.0;
/// Of what is drawn.
const SEED: u64 = 44;

/// A foot lying along X from 0, its middle on the spindle.
pub(crate) struct Lathe {
    pub(crate) mesh: TriMesh,
    /// Of its surface [mm2].
    pub(crate) area: f64,
    /// Along the spindle [mm].
    length: f64,
    name: &'static str,
}

/// Steps around a part, a turn a pitch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spiral {
    pub(crate) n: usize,
    per_turn: f64,
}

impl Lathe {
    /// With the real foot where `HORMA_DATA` is set, else with a bumpy cylinder.
    pub(crate) fn new() -> anyhow::Result<Self> {
        let (mesh, name) = if let Some(data) = std::env::var_os("HORMA_DATA") {
            let path = PathBuf::from(data).join("lasts/find_foot/foot_mean_left.obj");
            let reading = horma::io::read_surface(&path, None)?;
            (reading.surface.into_mesh().context("the foot is a mesh")?, "the foot")
        } else {
            eprintln!("HORMA_DATA is not set: a bumpy cylinder stands in for the foot");
            (shapes::bumpy_cylinder(128_000), "a bumpy cylinder")
        };
        let (aabb, middle) = (mesh.aabb(), mesh.aabb().center());
        let mesh = mesh.moved(&Pose::translation(-aabb.min.x, -middle.y, -middle.z));
        let area = areas(&mesh).sum();
        Ok(Self { area, length: aabb.size().x, mesh, name })
    }

    /// So many points a square millimetre of its surface, drawn evenly.
    pub(crate) fn points(&self, per_mm2: f64) -> PointCloud {
        let mut draw = Pcg64Mcg::seed_from_u64(SEED);
        let mut sums: Vec<f64> = areas(&self.mesh).collect();
        let mut sum = 0.0;
        for area in &mut sums {
            sum += *area;
            *area = sum;
        }
        let mut point = |_| {
            let at = draw.random_range(0.0..sum);
            let i = sums.partition_point(|&below| below <= at).min(sums.len() - 1);
            let [a, b, c] = self.mesh.corners(i);
            let (u, v) = (draw.random_range(0.0..1.0_f64).sqrt(), draw.random_range(0.0..1.0));
            Point3::from(a.coords * (1.0 - u) + b.coords * (u * (1.0 - v)) + c.coords * (u * v))
        };
        let points = (0..(self.area * per_mm2) as usize).map(&mut point).collect();
        PointCloud { points, ..PointCloud::default() }
    }

    /// A spiral of so many steps a millimetre of the way around the surface.
    pub(crate) fn spiral(&self, per_mm: f64) -> Spiral {
        // What a turn of the way is long, on average: the surface is as wide as it is long.
        let around = self.area / self.length;
        let per_turn = per_mm * around;
        Spiral { n: (self.length / PITCH * per_turn) as usize, per_turn }
    }
}

impl fmt::Display for Lathe {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { name, area, length, .. } = self;
        write!(
            f,
            "{name}, {length:.0} mm long, {area:.0} mm2, wheel R60 r10, pitch {PITCH} mm, seed {SEED}"
        )
    }
}

fn areas(mesh: &TriMesh) -> impl Iterator<Item = f64> {
    (0..mesh.triangles.len()).map(|i| mesh.area_vector(i).norm())
}

impl Spiral {
    pub(crate) fn step(&self, i: usize) -> Step {
        let turns = i as f64 / self.per_turn;
        Step { x: turns * PITCH, turn: turns.fract() * TAU }
    }

    pub(crate) fn pose(&self, i: usize) -> Pose {
        let Step { x, turn } = self.step(i);
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), turn);
        Pose::from_parts(Translation3::new(-x, 0.0, 0.0), rotation)
    }
}
