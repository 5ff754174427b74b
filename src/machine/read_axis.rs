//! One axis from its part of a machine file: every value checked, degrees made radians.

use super::description::{Flaw, finite, flaw, number, positive};
use super::file::AxisFile;
use super::{Axis, AxisKind, Carries, MachineError};
use crate::geom::{Point3, Vector3};
use toml::Spanned;

/// The axis without what it follows.
pub(super) fn axis(file: &AxisFile) -> Result<Axis, Flaw> {
    let (letter, kind) = (*file.letter.get_ref(), *file.kind.get_ref());
    if kind == AxisKind::Rotary && *file.carries.get_ref() == Carries::Tool {
        return Err(flaw(&file.carries, MachineError::RotaryTool { letter }));
    }
    let inside = |value: f64| if kind == AxisKind::Rotary { value.to_radians() } else { value };
    let zero = Quantity::new(("zero-mm", &file.zero_mm), ("zero-deg", &file.zero_deg));
    let velocity = Quantity::new(
        ("velocity-mm-per-s", &file.velocity_mm_per_s),
        ("velocity-deg-per-s", &file.velocity_deg_per_s),
    );
    let acceleration = Quantity::new(
        ("acceleration-mm-per-s2", &file.acceleration_mm_per_s2),
        ("acceleration-deg-per-s2", &file.acceleration_deg_per_s2),
    );
    Ok(Axis {
        letter,
        kind,
        carries: *file.carries.get_ref(),
        direction: direction(file)?,
        point: point(file)?,
        sign: sign(&file.sign)?,
        zero: zero.required(file).and_then(|(key, value)| finite(key, value)).map(inside)?,
        limits: limits(file)?.map(|both| both.map(inside)),
        velocity: velocity.required(file).and_then(|(key, v)| positive(key, v)).map(inside)?,
        acceleration: acceleration
            .required(file)
            .and_then(|(key, value)| positive(key, value))
            .map(inside)?,
        follows: None,
    })
}

/// A key of a file, and what stands behind it.
type Entry<'a, T> = (&'static str, &'a Option<Spanned<T>>);

/// What a linear axis has in millimetres and a rotary one in degrees.
struct Quantity<'a, T> {
    mm: Entry<'a, T>,
    deg: Entry<'a, T>,
}

impl<'a, T> Quantity<'a, T> {
    fn new(mm: Entry<'a, T>, deg: Entry<'a, T>) -> Self {
        Self { mm, deg }
    }

    /// The key and value in the unit of the axis; a value in the other unit is refused.
    fn of(&self, file: &AxisFile) -> Result<Entry<'a, T>, Flaw> {
        let kind = *file.kind.get_ref();
        let (own, (given, other)) = match kind {
            AxisKind::Linear => (self.mm, self.deg),
            AxisKind::Rotary => (self.deg, self.mm),
        };
        let Some(value) = other else { return Ok(own) };
        let (letter, remedy) = (*file.letter.get_ref(), format!("write {}", own.0));
        Err(flaw(value, MachineError::OtherKind { letter, kind, given, remedy }))
    }

    fn required(&self, file: &AxisFile) -> Result<(&'static str, &'a Spanned<T>), Flaw> {
        let (key, value) = self.of(file)?;
        value.as_ref().map(|value| (key, value)).ok_or_else(|| missing(file, key))
    }
}

fn missing(file: &AxisFile, key: &'static str) -> Flaw {
    let (letter, kind) = (*file.letter.get_ref(), *file.kind.get_ref());
    flaw(&file.letter, MachineError::Missing { letter, kind, key })
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
        (AxisKind::Rotary, None) => Err(missing(file, "point")),
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
    let limits = Quantity::new(("limits-mm", &file.limits_mm), ("limits-deg", &file.limits_deg));
    match (limits.of(file)?, kind) {
        ((_, Some(given)), _) => {
            let limits = *given.get_ref();
            if limits[0] < limits[1] && limits.iter().all(|limit| limit.is_finite()) {
                return Ok(Some(limits));
            }
            Err(flaw(given, MachineError::Limits { letter, limits }))
        }
        // Only a turning axis can do without an end.
        ((_, None), AxisKind::Rotary) => Ok(None),
        ((key, None), AxisKind::Linear) => Err(missing(file, key)),
    }
}
