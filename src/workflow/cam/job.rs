//! What a job is made from, what it makes, and why it cannot be done.

use super::options::{CamOptions, OptionsError};
use super::report::CamReport;
use super::spacing::SpacingError;
use crate::cam::{BlockError, DigitizeError, FitError, RoughError, SetupError, TrajectoryError};
use crate::compute::GpuError;
use crate::gcode::{Dialect, PostError, SplitError};
use crate::geom::{Point3, Surface};
use crate::machine::{Machine, MachineError};
use crate::progress::Cancelled;
use crate::stock::StockError;
use crate::tool::{Tool, ToolError};

/// What a job is made from.
#[derive(Debug, Clone)]
pub struct Job<'a> {
    /// What the part is called: most often its file.
    pub name: String,
    /// The part, in millimetres.
    pub surface: Surface,
    /// What reading it had to say.
    pub notes: Vec<String>,
    /// The machine it is cut on.
    pub machine: &'a Machine,
    /// The tool that cuts it.
    pub tool: Tool,
    /// The language of the control.
    pub dialect: &'a Dialect,
    /// How it is cut.
    pub options: &'a CamOptions,
    /// Keep what the pictures show.
    pub keep_scene: bool,
}

/// What a job makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The program, as the bytes of its file; they were read back and give the path.
    pub text: Vec<u8>,
    /// The same in parts that run one after the other, if it is too large for its control.
    pub parts: Vec<Vec<u8>>,
    /// What there is to say about it.
    pub report: CamReport,
    /// What there is to see, unless it was not asked for.
    pub scene: Option<Scene>,
}

/// What the pictures of a report show, in the part's frame on the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The part, then its clamps.
    pub surface: Surface,
    /// How many triangles (or points) are the part's own.
    pub n_own: usize,
    /// Where the tool touches, position by position (missed positions are left out).
    pub path: Vec<Point3>,
    /// Attack height over the position's number, thinned.
    pub heights: Vec<[f64; 2]>,
}

/// Why a job cannot be done.
#[derive(Debug, thiserror::Error)]
pub enum CamError {
    /// An option cannot be.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// The tool cannot be.
    #[error(transparent)]
    Tool(#[from] ToolError),
    /// The tool does not sit on the machine.
    #[error(transparent)]
    Machine(#[from] MachineError),
    /// The part cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The part does not fit.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The strategy cannot run here.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// No spacing comes of the options.
    #[error(transparent)]
    Spacing(#[from] SpacingError),
    /// The control cannot say it, or an axis would leave its limits.
    #[error(transparent)]
    Post(#[from] PostError),
    /// It does not fit into parts as small as asked for.
    #[error(transparent)]
    Split(#[from] SplitError),
    /// The tool meets the part nowhere.
    #[error("the tool meets the part nowhere on its way; check the spindle axis and the units")]
    Missed,
    /// Exact digitizing was asked for a part without triangles.
    #[error("mode triangles needs triangles, and the part has points alone; use --mode points")]
    NoTriangles,
    /// Contours were asked for around a part without triangles.
    #[error("strategy contour needs triangles to find the outline, and the part has points alone")]
    NoOutline,
    /// It cannot be roughed.
    #[error(transparent)]
    Rough(#[from] RoughError),
    /// Two tools that a program cannot tell apart.
    #[error(
        "the tools {} and {} are both T{number}: one program cannot change from one to the other; give \
         them numbers of their own in a tool library", tools[0], tools[1]
    )]
    SameNumber {
        /// The roughing tool and the finishing tool.
        tools: [String; 2],
        /// Of both.
        number: u32,
    },
    /// The block is none.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// A rapid between two cuts comes too near to the stock.
    #[error(
        "move {i_move} of roughing is a rapid to {axis} {word:.1} that needs {clearance:.1} mm of clearance \
         and goes {depth:.2} mm into the stock as it stands then (less than 0: near it): a block with \
         hollows is taken as filled, so rough it from a box or a cylinder; else this is a bug in horma"
    )]
    Link {
        /// The move, counted from 0.
        i_move: usize,
        /// The attack axis.
        axis: char,
        /// Its word where the rapid ends [mm].
        word: f64,
        /// How deep the tool goes into the stock; less than 0 if it only comes near [mm].
        depth: f64,
        /// What it must keep clear by [mm].
        clearance: f64,
    },
    /// The stock cannot be told.
    #[error(transparent)]
    Stock(#[from] StockError),
    /// The program read back is not the path it was made from: our fault.
    #[error("the program read back leaves the path at move {i_move}: this is a bug in horma")]
    ReadBack {
        /// The first move that differs.
        i_move: usize,
    },
    /// The device asked for cannot be used.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// It found no contacts.
    #[error(transparent)]
    Digitize(#[from] DigitizeError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
