//! The raw block a part is cut from.

use super::VerifyError;
use crate::cam::Setup;
use crate::geom::{Aabb, Point3, TriMesh, Vector3, shapes};
use crate::machine::{AxisValues, Machine};
use crate::stock::{Layout, Resolution, Stock};
use std::fmt;

/// What a part is cut from.
#[derive(Debug, Clone, PartialEq)]
pub enum RawBlock {
    /// The part and its clamps with so much more all over: what roughing leaves [mm].
    Grown(f64),
    /// A cylinder of this radius about the spindle axis, as long as the part with its clamps [mm].
    Cylinder(f64),
    /// A box around the part, with so much more on every side [mm].
    Box(f64),
    /// A moulded block, in the same place as the part in its file; clamps added.
    Mesh(TriMesh),
}

/// Why a block cannot be.
#[derive(Debug, thiserror::Error)]
pub enum BlockError {
    /// A cylinder on a table, which has no axis.
    #[error("a machine without a spindle cuts no cylinder; give a box or a mesh as stock")]
    NoSpindle,
    /// The cylinder does not hold the part.
    #[error("a cylinder of radius {radius} mm does not hold the part, which reaches {swing:.2} mm")]
    TooThin {
        /// What was given.
        radius: f64,
        /// What the part takes.
        swing: f64,
    },
}

impl RawBlock {
    /// The block where the part stands; a mesh is laid there as the part was.
    pub(super) fn placed(self, setup: &Setup, is_mirrored: bool) -> Self {
        match self {
            Self::Mesh(mesh) => {
                let mesh = if is_mirrored { mesh.mirrored() } else { mesh };
                Self::Mesh(mesh.moved(&setup.machine_from_file))
            }
            other => other,
        }
    }

    /// Rays through all of the block, with the rotary axes as in `values`.
    pub(super) fn layout(
        &self,
        setup: &Setup,
        machine: &Machine,
        values: &AxisValues,
        resolution: Resolution,
    ) -> Result<Layout, VerifyError> {
        let space = self.space(setup)?;
        let x = [space.min.x, space.max.x];
        let axis = machine.spindle.map_or_else(Point3::origin, |i| machine.axes[i].point);
        let points = setup.surface.points().iter();
        let swing = points.map(|p| (p.y - axis.y).hypot(p.z - axis.z)).fold(0.0, f64::max);
        let radius = match self {
            Self::Grown(margin) => Some(swing + margin),
            Self::Cylinder(radius) => Some(radius.max(swing)),
            Self::Box(_) | Self::Mesh(_) => None,
        };
        let round = radius.and_then(|radius| Layout::round(machine, x, radius, resolution));
        Ok(round.unwrap_or_else(|| Layout::new(machine, values, &space, resolution))?)
    }

    /// The box that holds the block, in the part's frame on the machine.
    fn space(&self, setup: &Setup) -> Result<Aabb, BlockError> {
        let part = setup.surface.aabb();
        let grown = |margin: f64| Aabb {
            min: part.min - Vector3::repeat(margin),
            max: part.max + Vector3::repeat(margin),
        };
        // Clamps end where the machine holds them: there is no block beyond.
        let held = |block: Aabb| {
            let is_held = setup.stretch != [setup.part.min.x, setup.part.max.x];
            let [from, to] = if is_held { setup.stretch } else { [block.min.x, block.max.x] };
            Aabb {
                min: Point3::new(from, block.min.y, block.min.z),
                max: Point3::new(to, block.max.y, block.max.z),
            }
        };
        match self {
            Self::Grown(margin) | Self::Box(margin) => Ok(held(grown(*margin))),
            Self::Cylinder(_) if setup.swing <= 0.0 => Err(BlockError::NoSpindle),
            Self::Cylinder(radius) if *radius < setup.swing => {
                Err(BlockError::TooThin { radius: *radius, swing: setup.swing })
            }
            Self::Cylinder(radius) => Ok(Aabb {
                min: Point3::new(part.min.x, -radius, -radius),
                max: Point3::new(part.max.x, *radius, *radius),
            }),
            Self::Mesh(mesh) => {
                let both = mesh.points.iter().fold(part, Aabb::with);
                Ok(held(both))
            }
        }
    }

    /// The block itself.
    pub(super) fn stock(&self, layout: Layout, setup: &Setup, part: &TriMesh) -> Stock {
        match self {
            Self::Grown(margin) => Stock::of_mesh(layout, part).grown(*margin),
            Self::Cylinder(radius) => Stock::cylinder(layout, *radius),
            Self::Box(margin) => {
                let own = &setup.part;
                let block = Aabb {
                    min: own.min - Vector3::repeat(*margin),
                    max: own.max + Vector3::repeat(*margin),
                };
                Self::with_clamps(shapes::cuboid(&block), layout, setup, part)
            }
            Self::Mesh(mesh) => Self::with_clamps(mesh.clone(), layout, setup, part),
        }
    }

    fn with_clamps(mut block: TriMesh, layout: Layout, setup: &Setup, part: &TriMesh) -> Stock {
        let clamps = part.triangles[setup.n_own..].to_vec();
        block.append(TriMesh::new(part.points.clone(), clamps));
        Stock::of_mesh(layout, &block)
    }
}

impl fmt::Display for RawBlock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grown(margin) => write!(f, "the part with {margin} mm more all over"),
            Self::Cylinder(radius) => write!(f, "a cylinder of radius {radius} mm"),
            Self::Box(margin) => write!(f, "a box with {margin} mm around the part"),
            Self::Mesh(mesh) => write!(f, "a body of {} triangles", mesh.triangles.len()),
        }
    }
}
