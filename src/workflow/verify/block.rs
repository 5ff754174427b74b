//! The raw block a part is cut from, as stock.

use super::VerifyError;
use crate::cam::{Block, Setup};
use crate::geom::{Aabb, Point3, Surface, TriMesh, Vector3};
use crate::machine::{AxisValues, Machine};
use crate::stock::{Layout, Resolution, Stock};
use std::fmt;

/// What a part is cut from.
#[derive(Debug, Clone)]
pub enum RawBlock {
    /// The part and its clamps with so much more all over: what roughing leaves [mm].
    Grown(f64),
    /// A body; the clamps stand out of it.
    Body(Block),
    /// What another program left, looked at as finely as it was then.
    Left(Box<Stock>),
}

/// Along which rays a block is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rays<'a> {
    /// The words of all axes where the program first cuts.
    pub(super) values: &'a AxisValues,
    /// The axis of a table that turns the part under a tool of constant tilt.
    pub(super) turner: Option<usize>,
    pub(super) resolution: Resolution,
}

impl RawBlock {
    /// The block around the part as it is set up, looked at along `rays`.
    pub(super) fn stock(
        &self,
        setup: &Setup,
        machine: &Machine,
        rays: &Rays,
    ) -> Result<Stock, VerifyError> {
        let Surface::Mesh(part) = &setup.surface else { return Err(VerifyError::NoTriangles) };
        let all = part.aabb();
        // Rays around an axis, if the block is round about it, are fewer.
        let Rays { values, turner, resolution } = *rays;
        let layout = |radius: Option<f64>, space: &Aabb| {
            if let Some(axis) = turner {
                // Below the part there is the table.
                let min = Point3::new(space.min.x, space.min.y, setup.part.min.z);
                let space = Aabb { min, max: space.max };
                return Layout::about(machine, values, axis, &space, resolution);
            }
            let x = [space.min.x, space.max.x];
            let round = radius.and_then(|radius| Layout::round(machine, x, radius, resolution));
            round.unwrap_or_else(|| Layout::new(machine, values, space, resolution))
        };
        match self {
            Self::Left(stock) => Ok(stock.as_ref().clone()),
            Self::Grown(margin) => {
                let grow = Vector3::repeat(*margin);
                let space = held(setup, Aabb { min: all.min - grow, max: all.max + grow });
                let layout = layout(Some(swing(setup, machine) + margin), &space)?;
                Ok(Stock::of_mesh(layout, part).grown(*margin))
            }
            Self::Body(block) => {
                let mut body = block.around(setup, machine, 0.0)?;
                let space = held(setup, body.points.iter().fold(all, Aabb::with));
                if let Some(radius) = block.bar_radius(setup, machine, 0.0)? {
                    let layout = layout(Some(radius.max(swing(setup, machine))), &space)?;
                    return Ok(Stock::cylinder(layout, radius));
                }
                let clamps = part.triangles[setup.n_own..].to_vec();
                body.append(TriMesh::new(part.points.clone(), clamps));
                Ok(Stock::of_mesh(layout(None, &space)?, &body))
            }
        }
    }
}

/// Clamps end where the machine holds them: there is no block beyond.
fn held(setup: &Setup, block: Aabb) -> Aabb {
    let is_held = setup.stretch != [setup.part.min.x, setup.part.max.x];
    let [from, to] = if is_held { setup.stretch } else { [block.min.x, block.max.x] };
    Aabb {
        min: Point3::new(from, block.min.y, block.min.z),
        max: Point3::new(to, block.max.y, block.max.z),
    }
}

/// The greatest distance of the part and its clamps from the spindle axis.
fn swing(setup: &Setup, machine: &Machine) -> f64 {
    let axis = machine.spindle.map_or_else(Point3::origin, |i| machine.axes[i].point);
    let points = setup.surface.points().iter();
    points.map(|p| (p.y - axis.y).hypot(p.z - axis.z)).fold(0.0, f64::max)
}

impl fmt::Display for RawBlock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grown(margin) => write!(f, "the part with {margin} mm more all over"),
            Self::Body(block) => block.fmt(f),
            Self::Left(_) => f.write_str("what the program before it left"),
        }
    }
}
