//! The raw block a part is roughed from.

use super::setup::Setup;
use crate::geom::{Aabb, Point3, Pose, TriMesh, Vector3, shapes};
use crate::machine::Machine;
use nalgebra::{Translation3, UnitQuaternion};
use std::fmt;
use std::str::FromStr;

/// Sides of a round block, laid around it: it is nowhere thinner than the real one.
const SIDES: usize = 256;
/// Added around a box where nothing is said [mm].
const MARGIN: f64 = 2.0;

/// What the part is cut from.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A round bar about the spindle axis, or upright on a table [mm].
    Cylinder {
        /// Of the bar; `None` for the least that holds the part.
        radius: Option<f64>,
    },
    /// A square bar, or a box on the table, this much larger than the part all around [mm].
    Box {
        /// Added on every side.
        margin: f64,
    },
    /// Any body, in the frame of the part's file: a moulded block.
    Mesh(TriMesh),
}

/// Why a block is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// A size that cannot be.
    #[error("the block's {what} is {value} mm; it must be {must}")]
    Size {
        /// `radius` or `margin`.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// It is named by no shape.
    #[error("{text:?} is no block; write cylinder, cylinder:60, box or box:5, or name a file")]
    NoShape {
        /// What was given.
        text: String,
    },
    /// The part does not fit into it.
    #[error(
        "the part needs a block of radius {needed:.1} mm with the {allowance} mm left on, and this one has \
         {radius} mm; take a larger one, or centre the part in it"
    )]
    Small {
        /// Radius the part needs [mm].
        needed: f64,
        /// Left on the part [mm].
        allowance: f64,
        /// Of the block [mm].
        radius: f64,
    },
}

impl Block {
    /// The block as a surface around the part as it is set up, which keeps `allowance`.
    ///
    /// A bar reaches over the part and its clamps; on a table a block stands on it.
    pub fn around(
        &self,
        setup: &Setup,
        machine: &Machine,
        allowance: f64,
    ) -> Result<TriMesh, BlockError> {
        let is_bar = machine.spindle.is_some();
        match self {
            Self::Cylinder { radius } => {
                let line = line(setup, machine);
                let radius = round(*radius, swing(setup, &line, is_bar), allowance)?;
                Ok(if is_bar {
                    let [from, to] = setup.stretch;
                    let to_line = Pose::translation(0.0, line.y, line.z);
                    shapes::stub(SIDES, radius, from, to).moved(&to_line)
                } else {
                    let height = setup.part.max.z + allowance - setup.part.min.z;
                    upright(
                        &shapes::stub(SIDES, radius, 0.0, height),
                        &Point3::new(line.x, line.y, setup.part.min.z),
                    )
                })
            }
            &Self::Box { margin } => {
                if !(margin >= allowance && margin.is_finite()) {
                    return Err(size("margin", margin, "no less than what is left on the part"));
                }
                let grow = Vector3::repeat(margin);
                let mut aabb = Aabb { min: setup.part.min - grow, max: setup.part.max + grow };
                if is_bar {
                    [aabb.min.x, aabb.max.x] = setup.stretch;
                } else {
                    aabb.min.z = setup.part.min.z;
                }
                Ok(shapes::cuboid(&aabb))
            }
            Self::Mesh(mesh) => {
                let mesh = mesh.clone();
                let mesh = if setup.is_mirrored { mesh.mirrored() } else { mesh };
                Ok(mesh.moved(&setup.machine_from_file))
            }
        }
    }

    /// The same block with the radius it has around the part as it is set up.
    pub fn sized(
        &self,
        setup: &Setup,
        machine: &Machine,
        allowance: f64,
    ) -> Result<Self, BlockError> {
        let Self::Cylinder { radius } = self else { return Ok(self.clone()) };
        let swing = swing(setup, &line(setup, machine), machine.spindle.is_some());
        Ok(Self::Cylinder { radius: Some(round(*radius, swing, allowance)?) })
    }

    /// As the command line has it, `cylinder:60`; `None` of bodies, which are named by their file.
    pub fn shorthand(&self) -> Option<String> {
        match self {
            Self::Cylinder { radius: None } => Some("cylinder".to_owned()),
            Self::Cylinder { radius: Some(radius) } => Some(format!("cylinder:{radius}")),
            Self::Box { margin } => Some(format!("box:{margin}")),
            Self::Mesh(_) => None,
        }
    }

    /// The radius of a round bar that holds the part with `allowance` on it; `None` of other blocks.
    pub fn bar_radius(
        &self,
        setup: &Setup,
        machine: &Machine,
        allowance: f64,
    ) -> Result<Option<f64>, BlockError> {
        match (self, machine.spindle) {
            (Self::Cylinder { radius }, Some(spindle)) => {
                let line = machine.axes[spindle].point;
                round(*radius, swing(setup, &line, true), allowance).map(Some)
            }
            _ => Ok(None),
        }
    }
}

impl FromStr for Block {
    type Err = BlockError;

    /// `cylinder` or `cylinder:60`, `box` or `box:5`.
    fn from_str(text: &str) -> Result<Self, BlockError> {
        let none = || BlockError::NoShape { text: text.to_owned() };
        let (shape, size) = match text.split_once(':') {
            Some((shape, size)) => (shape, Some(size.parse().map_err(|_| none())?)),
            None => (text, None),
        };
        match shape {
            "cylinder" => Ok(Self::Cylinder { radius: size }),
            "box" => Ok(Self::Box { margin: size.unwrap_or(MARGIN) }),
            _ => Err(none()),
        }
    }
}

impl fmt::Display for Block {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cylinder { radius: None } => f.write_str("the least cylinder"),
            Self::Cylinder { radius: Some(radius) } => {
                write!(f, "a cylinder of radius {radius} mm")
            }
            Self::Box { margin } => write!(f, "a box {margin} mm larger all around"),
            Self::Mesh(mesh) => write!(f, "a body of {} triangles", mesh.triangles.len()),
        }
    }
}

fn size(what: &'static str, value: f64, must: &'static str) -> BlockError {
    BlockError::Size { what, value, must }
}

/// The radius given, or the least whole one, if the part with its allowance has room in it.
fn round(given: Option<f64>, swing: f64, allowance: f64) -> Result<f64, BlockError> {
    let needed = swing + allowance;
    let radius = given.unwrap_or(needed.ceil());
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(size("radius", radius, "above 0"));
    }
    if radius < needed { Err(BlockError::Small { needed, allowance, radius }) } else { Ok(radius) }
}

/// A point of the spindle axis; the middle of the part where there is no spindle.
fn line(setup: &Setup, machine: &Machine) -> Point3 {
    machine.spindle.map_or_else(|| setup.part.center(), |spindle| machine.axes[spindle].point)
}

/// The greatest distance of the part from the line along X, or upright, through `line`.
fn swing(setup: &Setup, line: &Point3, is_bar: bool) -> f64 {
    let far = |p: &Point3| {
        let out = p - line;
        if is_bar { out.y.hypot(out.z) } else { out.x.hypot(out.y) }
    };
    setup.own_points().map(far).fold(0.0, f64::max)
}

/// A body about X, stood on `foot`.
fn upright(body: &TriMesh, foot: &Point3) -> TriMesh {
    let up = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -std::f64::consts::FRAC_PI_2);
    body.clone().moved(&Pose::from_parts(Translation3::from(foot.coords), up))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cam::{SetupOptions, set_up};
    use crate::geom::Surface;

    fn ball_on(machine: &str) -> (Machine, Setup) {
        let machine = Machine::builtin(machine).unwrap();
        let ball = Surface::Mesh(shapes::sphere(&Point3::origin(), 30.0, 24));
        let setup = set_up(ball, &machine, &SetupOptions::default()).unwrap();
        (machine, setup)
    }

    #[test]
    fn a_bar_holds_the_part_and_its_clamps() {
        let (lathe, setup) = ball_on("last-lathe");
        let bar = Block::Cylinder { radius: None }.around(&setup, &lathe, 2.0).unwrap().aabb();
        assert_eq!([bar.min.x, bar.max.x], setup.stretch);
        assert!((bar.max.y - 33.0).abs() < 1.1, "{}", bar.max.y);
        let square = Block::Box { margin: 5.0 }.around(&setup, &lathe, 2.0).unwrap().aabb();
        assert!((square.max.y - 35.0).abs() < 0.3, "{}", square.max.y);
    }

    #[test]
    fn on_a_table_a_block_stands_as_high_as_the_part_and_what_is_left_on_it() {
        let (mill, setup) = ball_on("mill-3axis");
        for block in [Block::Cylinder { radius: Some(40.0) }, Block::Box { margin: 2.0 }] {
            let aabb = block.around(&setup, &mill, 2.0).unwrap().aabb();
            assert!(aabb.min.z.abs() < 1e-9 && (aabb.max.z - setup.part.max.z - 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_block_too_small_says_what_the_part_needs() {
        let (lathe, setup) = ball_on("last-lathe");
        let small = Block::Cylinder { radius: Some(29.0) };
        let error = small.around(&setup, &lathe, 1.0).unwrap_err().to_string();
        assert!(error.starts_with("the part needs a block of radius 3"), "{error}");
        let thin = Block::Box { margin: 0.5 }.around(&setup, &lathe, 1.0).unwrap_err();
        assert!(thin.to_string().contains("the block's margin is 0.5 mm"), "{thin}");
    }

    #[test]
    fn a_moulded_block_is_laid_where_the_part_is_and_mirrored_with_it() {
        let machine = Machine::builtin("last-lathe").unwrap();
        let part = shapes::chiral(3_000);
        for mirror in [false, true] {
            let options = SetupOptions { mirror, ..SetupOptions::default() };
            let setup = set_up(Surface::Mesh(part.clone()), &machine, &options).unwrap();
            let block = Block::Mesh(part.clone()).around(&setup, &machine, 0.0).unwrap();
            for (laid, own) in block.points.iter().zip(setup.own_points()) {
                assert!((laid - own).norm() < 1e-9, "{laid} is not {own}");
            }
        }
    }

    #[test]
    fn a_block_is_named_by_its_shape_and_size() {
        let block = |text: &str| text.parse::<Block>();
        assert_eq!(block("cylinder"), Ok(Block::Cylinder { radius: None }));
        assert_eq!(block("cylinder:60"), Ok(Block::Cylinder { radius: Some(60.0) }));
        assert_eq!(block("box:5"), Ok(Block::Box { margin: 5.0 }));
        for text in ["ball", "box:wide", "cylinder:"] {
            let error = block(text).unwrap_err().to_string();
            assert!(error.starts_with(&format!("{text:?} is no block; write cylinder")), "{error}");
        }
    }
}
