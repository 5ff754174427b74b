//! A machine from its TOML file: every value checked, every error with its line and column.
//!
//! `machines/*.toml` explain the keys. Degrees become radians here and nowhere else.

use super::file::{AxisFile, ClampingFile, MachineFile, ObstaclesFile};
use super::follow::follow;
use super::read_axis::axis;
use super::{
    Axis, AxisKind, Carries, Clamping, Dogs, MAX_AXES, Machine, MachineError, Mount, Obstacles,
};
use crate::tool::{Place, ToolError, ToolLibrary, printable};
use std::ops::Range;
use toml::Spanned;

/// Directions this close to square, or to parallel, are so: what is left of rounding in a file.
const SQUARE: f64 = 1e-6;

impl Machine {
    /// Reads a machine from `text`; errors call it `file`.
    pub fn parse(text: &str, file: &str) -> Result<Self, MachineError> {
        read(text).map_err(|Flaw { span, problem }| MachineError::At {
            place: Place::new(text, file, span),
            problem: Box::new(problem),
        })
    }
}

/// What is wrong, and between which bytes.
pub(super) struct Flaw {
    span: Range<usize>,
    problem: MachineError,
}

pub(super) fn flaw<T>(value: &Spanned<T>, problem: MachineError) -> Flaw {
    Flaw { span: value.span(), problem }
}

fn read(text: &str) -> Result<Machine, Flaw> {
    let file: MachineFile = toml::from_str(text).map_err(|error| Flaw {
        span: error.span().unwrap_or_default(),
        problem: MachineError::Syntax(printable(error.message())),
    })?;
    check_letters(&file.axis)?;
    let mut axes = file.axis.iter().map(axis).collect::<Result<Vec<_>, _>>()?;
    for (i, axis) in file.axis.iter().enumerate() {
        axes[i].follows = follow(axis, &file.axis)?;
    }
    let attack = attack(&file, &axes)?;
    let spindle = spindle(&file, &axes, attack)?;
    let machine = Machine {
        name: name("name", &file.name)?,
        title: title(&file.title)?,
        axes,
        attack,
        spindle,
        mount: *file.mount.get_ref(),
        clamping: clamping(&file.clamping)?,
        dialect: name("dialect", &file.dialect)?,
        default_tool: file.default_tool.get_ref().clone(),
        clearance: positive("clearance", &file.clearance)?,
        blocks_per_second: positive("blocks-per-second", &file.blocks_per_second)?,
        tool_changes: file.tool_changes,
        look_ahead_blocks: file.look_ahead_blocks.as_ref().map(look_ahead).transpose()?,
        obstacles: file
            .obstacles
            .as_ref()
            .map_or_else(|| Ok(Obstacles::default()), |given| obstacles(given, &file.clamping))?,
    };
    check_default_tool(&machine, &file.default_tool)?;
    Ok(machine)
}

fn check_letters(axes: &[AxisFile]) -> Result<(), Flaw> {
    for (i, axis) in axes.iter().enumerate() {
        let (letter, kind) = (*axis.letter.get_ref(), *axis.kind.get_ref());
        let fitting = match kind {
            AxisKind::Linear => "XYZUVW",
            AxisKind::Rotary => "ABC",
        };
        if !fitting.contains(letter) {
            return Err(flaw(&axis.letter, MachineError::Letter { letter, kind }));
        }
        if axes[..i].iter().any(|before| *before.letter.get_ref() == letter) {
            return Err(flaw(&axis.letter, MachineError::LetterTwice { letter }));
        }
        if MAX_AXES <= i {
            return Err(flaw(&axis.letter, MachineError::TooManyAxes { letter }));
        }
    }
    Ok(())
}

/// Index of the axis `letter`, which the file names under `key`.
pub(super) fn named(
    axes: &[AxisFile],
    key: &'static str,
    letter: &Spanned<char>,
) -> Result<usize, Flaw> {
    let wanted = *letter.get_ref();
    axes.iter().position(|axis| *axis.letter.get_ref() == wanted).ok_or_else(|| {
        let axes = axes.iter().map(|axis| axis.letter.get_ref().to_string()).collect();
        flaw(letter, MachineError::NoAxis { key, letter: wanted, axes })
    })
}

fn attack(file: &MachineFile, axes: &[Axis]) -> Result<usize, Flaw> {
    let index = named(&file.axis, "attack", &file.attack)?;
    let Axis { letter, kind, carries, direction, .. } = axes[index];
    let refuse = |problem| Err(flaw(&file.attack, problem));
    if kind != AxisKind::Linear {
        return refuse(MachineError::AttackNotLinear { letter });
    }
    if axes[index].follows.is_some() {
        return refuse(MachineError::NotDriven { key: "attack", letter });
    }
    let turning = axes[..index].iter().find(|before| before.kind == AxisKind::Rotary);
    if let (Carries::Part, Some(rotary)) = (carries, turning) {
        return refuse(MachineError::AttackTurns { letter, rotary: rotary.letter });
    }
    if *file.mount.get_ref() == Mount::Across && SQUARE < direction.x.abs() {
        return refuse(MachineError::AttackNotSquare { letter, along: "the wheel's axis" });
    }
    Ok(index)
}

fn spindle(file: &MachineFile, axes: &[Axis], attack: usize) -> Result<Option<usize>, Flaw> {
    let Some(given) = &file.spindle else { return Ok(None) };
    let index = named(&file.axis, "spindle", given)?;
    let Axis { letter, kind, direction, .. } = axes[index];
    let refuse = |problem| Err(flaw(given, problem));
    if kind != AxisKind::Rotary {
        return refuse(MachineError::SpindleNotRotary { letter });
    }
    if axes[index].follows.is_some() {
        return refuse(MachineError::NotDriven { key: "spindle", letter });
    }
    if SQUARE < direction.y.hypot(direction.z) {
        return refuse(MachineError::SpindleNotAlongX { letter });
    }
    if SQUARE < axes[attack].direction.x.abs() {
        let letter = axes[attack].letter;
        return Err(flaw(
            &file.attack,
            MachineError::AttackNotSquare { letter, along: "the spindle" },
        ));
    }
    Ok(Some(index))
}

fn clamping(file: &ClampingFile) -> Result<Clamping, Flaw> {
    Ok(match file {
        ClampingFile::Table => Clamping::Table,
        ClampingFile::Nibs { radius, length } => Clamping::Nibs {
            radius: positive("radius", radius)?,
            length: positive("length", length)?,
        },
        ClampingFile::Cone { radius, length, gap } => Clamping::Cone {
            radius: positive("radius", radius)?,
            length: positive("length", length)?,
            gap: positive("gap", gap)?,
        },
    })
}

/// Only what is there beside a part held like that.
fn obstacles(file: &ObstaclesFile, clamping: &ClampingFile) -> Result<Obstacles, Flaw> {
    let foreign = |key, beside| MachineError::Obstacle { key, beside };
    let mut obstacles = Obstacles::default();
    if let Some(given) = &file.dogs {
        if !matches!(clamping, ClampingFile::Nibs { .. }) {
            return Err(flaw(given, foreign("dogs", "between dogs, by [clamping.nibs]")));
        }
        let dogs = given.get_ref();
        obstacles.dogs = Some(Dogs {
            radius: positive("radius", &dogs.radius)?,
            length: positive("length", &dogs.length)?,
        });
    }
    if let Some(given) = &file.table_radius {
        if !matches!(clamping, ClampingFile::Table) {
            return Err(flaw(given, foreign("table-radius", "by clamping = \"table\"")));
        }
        obstacles.table_radius = Some(positive("table-radius", given)?);
    }
    Ok(obstacles)
}

/// A control that sees one block alone stops after each; that is none for paths of small steps.
fn look_ahead(given: &Spanned<i64>) -> Result<usize, Flaw> {
    let blocks = *given.get_ref();
    let enough = usize::try_from(blocks).ok().filter(|blocks| *blocks >= 2);
    enough.ok_or_else(|| number(given, "look-ahead-blocks", blocks as f64, "2 or more"))
}

/// A default tool from another library than the embedded one is checked when it is looked up.
fn check_default_tool(machine: &Machine, given: &Spanned<String>) -> Result<(), Flaw> {
    match ToolLibrary::builtin().find(given.get_ref()) {
        Ok(tool) => machine.check_tool(&tool).map_err(|problem| flaw(given, problem)),
        Err(ToolError::Unknown { .. }) => name("default-tool", given).map(|_| ()),
        Err(error) => Err(flaw(given, MachineError::Tool(error))),
    }
}

fn name(key: &'static str, given: &Spanned<String>) -> Result<String, Flaw> {
    let value = given.get_ref().clone();
    let good = value.starts_with(|first: char| first.is_ascii_alphabetic())
        && value.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
    if good { Ok(value) } else { Err(flaw(given, MachineError::Name { key, value })) }
}

fn title(given: &Spanned<String>) -> Result<String, Flaw> {
    if given.get_ref().chars().any(char::is_control) {
        return Err(flaw(given, MachineError::Title));
    }
    Ok(given.get_ref().clone())
}

pub(super) fn positive(key: &'static str, given: &Spanned<f64>) -> Result<f64, Flaw> {
    let value = finite(key, given)?;
    if 0.0 < value { Ok(value) } else { Err(number(given, key, value, "greater than 0")) }
}

pub(super) fn finite(key: &'static str, given: &Spanned<f64>) -> Result<f64, Flaw> {
    let value = *given.get_ref();
    if value.is_finite() { Ok(value) } else { Err(number(given, key, value, "a finite number")) }
}

pub(super) fn number<T>(
    given: &Spanned<T>,
    key: &'static str,
    value: f64,
    rule: &'static str,
) -> Flaw {
    flaw(given, MachineError::Number { key, value, rule })
}
