//! The options of a job: flags of the command line and keys of a job file alike.

mod check;
mod over;
mod roughing;

use crate::cam::{Centre, Method, SetupError, SetupOptions, SpindleAxis, Strategy};
use crate::compute::ComputeChoice;
use crate::gcode::Coolant;
use serde::{Deserialize, Serialize};

/// How a part is cut. Every option may be left out; what is said on the command line wins over the
/// job file.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
pub struct CamOptions {
    /// The tool: a name or number of the tool library, or a shape such as wheel:60,10 or ball:3
    /// [default: the machine's own].
    #[arg(long, value_name = "TOOL")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool: Option<String>,
    /// How the tool runs over the part [default: helix around it, raster on a table]. On a table held
    /// at an angle (--hold A=60) helix, rings and lines turn the part about the table's own axis.
    #[arg(long, value_name = "STRATEGY")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strategy: Option<Strategy>,
    /// Distance of turns, rings or rows [mm; default: 2].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch: Option<f64>,
    /// Positions per turn, or lines around the part [default: 360].
    #[arg(long, value_name = "N")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points_per_turn: Option<u32>,
    /// Distance of positions along a line [mm; default: half the pitch].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Positions per millimetre of path; sets the step, the positions per turn and, unless given,
    /// the pitch.
    #[arg(long, value_name = "N", conflicts_with_all = ["points_per_turn", "step"])]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points_per_mm: Option<f64>,
    /// Height of the ridges left between turns; sets the pitch, finer where the part is steep [mm].
    #[arg(long, value_name = "MM", conflicts_with = "pitch")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scallop: Option<f64>,
    /// Material to leave on the part [mm; default: 0].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub allowance: Option<f64>,
    /// How far the tool runs beyond the part's ends [mm; default: so far that it cuts them whole].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overrun: Option<f64>,
    /// The part's direction along the spindle, heel to toe: auto, x, -x, y, z or "1 0 0.2"
    /// [default: auto, its longest principal axis].
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// Swap heel and toe.
    #[arg(long)]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub flip: bool,
    /// Which point lies on the spindle axis [default: centroid].
    #[arg(long, value_name = "POINT")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre: Option<Centre>,
    /// Turn of the part before the first step [deg; default: 0].
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_angle: Option<f64>,
    /// Cut the mirror image: the other foot.
    #[arg(long)]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub mirror: bool,
    /// Cutting feed at the contact [mm/min; default: the tool's].
    #[arg(long, value_name = "MM/MIN")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feed: Option<f64>,
    /// Turn the part at this constant speed, however fast the contact then is: helix and rings
    /// [rpm; default: the cutting feed at the contact].
    #[arg(long, value_name = "RPM", conflicts_with = "feed")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rpm: Option<f64>,
    /// Spindle speed of the cutter [rpm; default: the tool's].
    #[arg(long, value_name = "RPM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<f64>,
    /// Depth of material the first cut may meet [mm; default: what the tool's nose takes].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stock: Option<f64>,
    /// Rough with this tool first, from the block down: a name or number of the tool library, or a
    /// shape. One program does both where the machine changes tools within programs, or where the tool
    /// stays the same; else a second one, in OUTPUT with .rough before its extension, goes first.
    #[arg(long, value_name = "TOOL")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rough_with: Option<String>,
    /// How roughing before finishing runs over the part [default: as finishing does].
    #[arg(long, value_name = "STRATEGY")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rough_strategy: Option<Strategy>,
    /// Distance of turns, rings or rows of roughing before finishing [mm; default: 4].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rough_pitch: Option<f64>,
    /// What roughing leaves on the part for the finishing after it [mm; default: 1].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rough_allowance: Option<f64>,
    /// What is roughed: cylinder or cylinder:RADIUS, box or box:MARGIN, or the file of a moulded block
    /// that lies about the part as the part's file has it [default: cylinder].
    #[arg(long, value_name = "BLOCK")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub block: Option<String>,
    /// What the roughing tool may take at once [mm; default: what its nose takes].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_depth: Option<f64>,
    /// Height of positions at which the tool meets nothing [default: hold].
    #[arg(long, value_name = "RULE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_part: Option<OffPart>,
    /// The deepest gouge allowed anywhere on the path, between positions too; steps are put in until
    /// that is proved [mm; default: 0.01].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// No step put in is shorter than this; where the height jumps the attack axis is lifted instead
    /// [mm and deg; default: 0.005].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min_step: Option<f64>,
    /// Leave out steps that the tolerance does not need.
    #[arg(long, conflicts_with = "no_certify")]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub thin: bool,
    /// Take the path as digitized: nothing is proved of what lies between positions.
    #[arg(long, conflicts_with_all = ["tolerance", "min_step"])]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub no_certify: bool,
    /// What is digitized [default: triangles; points for a cloud].
    #[arg(long, value_name = "MODE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mode: Option<Mode>,
    /// How contacts are found; the answers are the same [default: indexed].
    #[arg(long, value_name = "METHOD")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
    /// What finds the contacts; the program is the same, bit for bit. auto times a small batch on the
    /// processor and on a device and takes the faster; the report says which [default: cpu].
    #[arg(long, value_name = "WHAT")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compute: Option<ComputeChoice>,
    /// The device to compute on, by its name or a part of it (`horma devices`) [default: the first of
    /// the fastest kind there is].
    #[arg(long, value_name = "NAME")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapter: Option<String>,
    /// Words of axes the strategy does not drive, such as A=30 on a five-axis mill [mm or deg].
    #[arg(long, value_name = "AXIS=WORD", value_delimiter = ',', allow_hyphen_values = true)]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hold: Vec<String>,
    /// The language of the control: a name (`horma dialect list`) or a dialect file [default: the
    /// machine's].
    #[arg(long, value_name = "DIALECT")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dialect: Option<String>,
    /// By how much the control may round corners off, where it can be told [mm; default: 0.01].
    #[arg(long, value_name = "MM")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corner_tolerance: Option<f64>,
    /// What cools the cut [default: off].
    #[arg(long, value_name = "COOLANT")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coolant: Option<Coolant>,
    /// What the program is called, where the control wants a number: 1 to 9999 [default: 1].
    #[arg(long, value_name = "N")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub program_number: Option<u32>,
    /// Split a program larger than this into parts that run one after the other [bytes; default:
    /// what the dialect says].
    #[arg(long, value_name = "BYTES")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split_bytes: Option<usize>,
}

/// What height a position gets at which the tool meets nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum OffPart {
    /// That of the last position that met the part; before the first, that of the first.
    #[default]
    Hold,
    /// Clear of the part.
    Clear,
}

/// What is digitized.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// The surface, exactly.
    Triangles,
    /// Its points alone, as in the thesis: between them the tool may sink in.
    Points,
}

/// An option that cannot be.
#[derive(Debug, thiserror::Error)]
pub enum OptionsError {
    /// A number out of its range.
    #[error("{option} is {value}; it must be {must}")]
    OutOfRange {
        /// The option's flag or key.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A bound finer than words are.
    #[error(
        "--tolerance is {tolerance} mm, and a word is rounded by up to {rounding} mm: ask for more than \
         that"
    )]
    TooFine {
        /// What was asked for [mm].
        tolerance: f64,
        /// Half the last decimal of the dialect's words [mm].
        rounding: f64,
    },
    /// A held axis that is none, or no number.
    #[error("hold {text:?} is no axis and word of {machine}; write for example A=30")]
    Hold {
        /// What was given.
        text: String,
        /// The machine.
        machine: String,
    },
    /// A strategy's options contradict each other.
    #[error("{0}")]
    Conflict(&'static str),
    /// A rotation for a strategy that does not turn the part through.
    #[error(
        "--rpm turns the part at a constant speed, and {strategy:?} does not turn it while cutting; \
         use --feed, or --strategy helix or rings"
    )]
    NotTurning {
        /// The strategy.
        strategy: Strategy,
    },
    /// The spindle axis is none.
    #[error(transparent)]
    Axis(#[from] SetupError),
}

impl CamOptions {
    /// The options of the setup among these.
    pub fn setup(&self) -> Result<SetupOptions, SetupError> {
        Ok(SetupOptions {
            axis: self.axis.as_deref().map_or(Ok(SpindleAxis::Auto), str::parse)?,
            flip: self.flip,
            centre: self.centre.unwrap_or_default(),
            start_angle: self.start_angle.unwrap_or(0.0).to_radians(),
            mirror: self.mirror,
        })
    }
}

impl OffPart {
    /// The rule as reports put it.
    pub(super) fn in_words(self) -> &'static str {
        match self {
            Self::Hold => {
                "hold: a position that meets nothing keeps the height of the last that did"
            }
            Self::Clear => "clear: a position that meets nothing is clear of the part",
        }
    }
}
