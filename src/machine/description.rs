//! A machine from its TOML file: every value checked, every error with its line and column.
//!
//! `machines/*.toml` explain the keys. Degrees become radians here and nowhere else.

use super::file::{AxisFile, ClampingFile, MachineFile};
use super::follow::follow;
use super::{Axis, AxisKind, Carries, Clamping, MAX_AXES, Machine, MachineError, Mount};
use crate::geom::{Point3, Vector3};
use crate::tool::{Place, ToolError, ToolLibrary};
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
        problem: MachineError::Syntax(error.message().to_owned()),
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

/// The axis without what it follows.
fn axis(file: &AxisFile) -> Result<Axis, Flaw> {
    let (letter, kind) = (*file.letter.get_ref(), *file.kind.get_ref());
    if kind == AxisKind::Rotary && *file.carries.get_ref() == Carries::Tool {
        return Err(flaw(&file.carries, MachineError::RotaryTool { letter }));
    }
    let inside = |value: f64| if kind == AxisKind::Rotary { value.to_radians() } else { value };
    let zero = file.required("zero-mm", &file.zero_mm, "zero-deg", &file.zero_deg)?;
    let velocity = file.required(
        "velocity-mm-per-s",
        &file.velocity_mm_per_s,
        "velocity-deg-per-s",
        &file.velocity_deg_per_s,
    )?;
    let acceleration = file.required(
        "acceleration-mm-per-s2",
        &file.acceleration_mm_per_s2,
        "acceleration-deg-per-s2",
        &file.acceleration_deg_per_s2,
    )?;
    Ok(Axis {
        letter,
        kind,
        carries: *file.carries.get_ref(),
        direction: direction(file)?,
        point: point(file)?,
        sign: sign(&file.sign)?,
        zero: inside(finite("zero", zero)?),
        limits: limits(file)?.map(|both| both.map(inside)),
        velocity: inside(positive("velocity", velocity)?),
        acceleration: inside(positive("acceleration", acceleration)?),
        follows: None,
    })
}

impl AxisFile {
    /// The value given in the unit of this axis' kind; the other unit is refused.
    fn in_unit<'a, T>(
        &self,
        mm_key: &'static str,
        mm: &'a Option<Spanned<T>>,
        deg_key: &'static str,
        deg: &'a Option<Spanned<T>>,
    ) -> Result<Option<&'a Spanned<T>>, Flaw> {
        let kind = *self.kind.get_ref();
        let (wanted, own, given, other) = match kind {
            AxisKind::Linear => (mm_key, mm, deg_key, deg),
            AxisKind::Rotary => (deg_key, deg, mm_key, mm),
        };
        if let Some(value) = other {
            let (letter, remedy) = (*self.letter.get_ref(), format!("write {wanted}"));
            return Err(flaw(value, MachineError::OtherKind { letter, kind, given, remedy }));
        }
        Ok(own.as_ref())
    }

    fn required<'a, T>(
        &self,
        mm_key: &'static str,
        mm: &'a Option<Spanned<T>>,
        deg_key: &'static str,
        deg: &'a Option<Spanned<T>>,
    ) -> Result<&'a Spanned<T>, Flaw> {
        let (letter, kind) = (*self.letter.get_ref(), *self.kind.get_ref());
        let key = if kind == AxisKind::Linear { mm_key } else { deg_key };
        self.in_unit(mm_key, mm, deg_key, deg)?
            .ok_or_else(|| flaw(&self.letter, MachineError::Missing { letter, kind, key }))
    }
}

fn direction(file: &AxisFile) -> Result<Vector3, Flaw> {
    let given = *file.direction.get_ref();
    // Scaled first: a length of 1e-200 is a direction too, and 1e200 does not overflow.
    let largest = given.iter().fold(0.0, |max: f64, value| max.max(value.abs()));
    if 0.0 < largest && given.iter().all(|value| value.is_finite()) {
        return Ok((Vector3::from(given) / largest).normalize());
    }
    let letter = *file.letter.get_ref();
    Err(flaw(&file.direction, MachineError::Direction { letter, direction: given }))
}

fn point(file: &AxisFile) -> Result<Point3, Flaw> {
    let (letter, kind) = (*file.letter.get_ref(), *file.kind.get_ref());
    match (kind, &file.point) {
        (AxisKind::Linear, None) => Ok(Point3::origin()),
        (AxisKind::Linear, Some(point)) => {
            let remedy = "leave it out".to_owned();
            let given = "point";
            Err(flaw(point, MachineError::OtherKind { letter, kind, given, remedy }))
        }
        (AxisKind::Rotary, None) => {
            Err(flaw(&file.letter, MachineError::Missing { letter, kind, key: "point" }))
        }
        (AxisKind::Rotary, Some(point)) => match point.get_ref().iter().find(|v| !v.is_finite()) {
            None => Ok(Point3::from(*point.get_ref())),
            Some(&value) => Err(number(point, "point", value, "a finite number")),
        },
    }
}

fn sign(given: &Spanned<i64>) -> Result<f64, Flaw> {
    match *given.get_ref() {
        1 => Ok(1.0),
        -1 => Ok(-1.0),
        other => Err(number(given, "sign", other as f64, "1 or -1")),
    }
}

fn limits(file: &AxisFile) -> Result<Option<[f64; 2]>, Flaw> {
    let (letter, kind) = (*file.letter.get_ref(), *file.kind.get_ref());
    let given = file.in_unit("limits-mm", &file.limits_mm, "limits-deg", &file.limits_deg)?;
    match given {
        Some(given) => {
            let limits = *given.get_ref();
            let travel = limits[0] < limits[1] && limits.iter().all(|limit| limit.is_finite());
            let error = || flaw(given, MachineError::Limits { letter, limits });
            if travel { Ok(Some(limits)) } else { Err(error()) }
        }
        // Only a turning axis can do without an end.
        None if kind == AxisKind::Rotary => Ok(None),
        None => Err(flaw(&file.letter, MachineError::Missing { letter, kind, key: "limits-mm" })),
    }
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

fn positive(key: &'static str, given: &Spanned<f64>) -> Result<f64, Flaw> {
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
