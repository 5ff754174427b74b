//! What of a tool does not cut and must not touch: arbor or shank, holder, spindle.

use super::{Shape, Tool};
use serde::{Deserialize, Serialize};

/// What of a tool does not cut, as far as its library says; what it leaves out is not looked at.
/// [`Tool::length`] is where the spindle begins.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Body {
    /// Of a wheel's arbor with its flanges and nut [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arbor_diameter: Option<f64>,
    /// From a wheel's centre to where its arbor ends, nut and all, on the side away from the
    /// spindle [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nut_length: Option<f64>,
    /// On which side of a wheel its spindle is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spindle_side: Option<Side>,
    /// Of an end mill's shank [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shank_diameter: Option<f64>,
    /// From an end mill's tip to where its flutes end and its shank begins [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flute_length: Option<f64>,
    /// Of what holds an end mill: collet, nut, chuck [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holder_diameter: Option<f64>,
    /// From an end mill's tip to where it leaves its holder [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stick_out: Option<f64>,
    /// Of the spindle, from its nose on [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spindle_diameter: Option<f64>,
}

/// A direction along X.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// Towards -X.
    Heel,
    /// Towards +X.
    Toe,
}

/// A part of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BodyPart {
    /// What carries a wheel.
    Arbor,
    /// An end mill above its flutes.
    Shank,
    /// What holds an end mill.
    Holder,
    /// The spindle, from its nose on.
    Spindle,
}

/// A part of a body as a cylinder about the tool's own axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Which part it is.
    pub part: BodyPart,
    /// How the tool's axis lies.
    pub axle: Axle,
    /// Of the cylinder [mm].
    pub radius: f64,
    /// Where it begins and ends, from the programmed point along the axle; may be infinite [mm].
    pub stretch: [f64; 2],
}

/// How a tool's own axis lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axle {
    /// Along X: a wheel.
    X,
    /// Along the attack axis, away from the part: an end mill.
    Attack,
}

/// Why a body cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BodyError {
    /// A size out of range.
    #[error("{key} is {value}: it must be {rule}")]
    Size {
        /// The key.
        key: &'static str,
        /// What was given [mm].
        value: f64,
        /// What is possible.
        rule: String,
    },
    /// A key that says nothing without another one.
    #[error("{key} says where something is only together with {partner}; give both or none")]
    Alone {
        /// The key.
        key: &'static str,
        /// What it needs.
        partner: &'static str,
    },
    /// A key of other tools.
    #[error("a {} has no {key}; its body is made of {}", shape.word(), keys(*shape).join(", "))]
    Foreign {
        /// The kind of profile.
        shape: Shape,
        /// The key.
        key: &'static str,
    },
}

const WHEEL_KEYS: [&str; 4] = ["arbor-diameter", "nut-length", "spindle-side", "spindle-diameter"];
const MILL_KEYS: [&str; 5] =
    ["shank-diameter", "flute-length", "holder-diameter", "stick-out", "spindle-diameter"];

fn keys(shape: Shape) -> &'static [&'static str] {
    if shape == Shape::Wheel { &WHEEL_KEYS } else { &MILL_KEYS }
}

impl Body {
    /// Refuses a body that no tool of this `shape` and `length` can have.
    pub fn check(&self, shape: Shape, length: f64) -> Result<(), BodyError> {
        let sizes = self.sizes();
        for (key, value) in sizes {
            let Some(value) = value else { continue };
            if !keys(shape).contains(&key) {
                return Err(BodyError::Foreign { shape, key });
            }
            if !(value > 0.0 && value.is_finite()) {
                return Err(BodyError::Size { key, value, rule: "greater than 0".into() });
            }
        }
        if self.spindle_side.is_some() && shape != Shape::Wheel {
            return Err(BodyError::Foreign { shape, key: "spindle-side" });
        }
        self.check_partners(shape)?;
        let ends = [("flute-length", self.flute_length), ("stick-out", self.stick_out)];
        for (key, value) in ends.into_iter().filter_map(|(key, value)| Some((key, value?))) {
            if value > length {
                let rule = format!("at most the tool's length, {length}");
                return Err(BodyError::Size { key, value, rule });
            }
        }
        match (self.flute_length, self.stick_out) {
            (Some(value), Some(stick_out)) if value > stick_out => {
                let rule = format!("at most the stick-out, {stick_out}");
                Err(BodyError::Size { key: "flute-length", value, rule })
            }
            _ => Ok(()),
        }
    }

    fn sizes(&self) -> [(&'static str, Option<f64>); 7] {
        [
            ("arbor-diameter", self.arbor_diameter),
            ("nut-length", self.nut_length),
            ("shank-diameter", self.shank_diameter),
            ("flute-length", self.flute_length),
            ("holder-diameter", self.holder_diameter),
            ("stick-out", self.stick_out),
            ("spindle-diameter", self.spindle_diameter),
        ]
    }

    /// A size alone is no place, and a place alone no size.
    fn check_partners(&self, shape: Shape) -> Result<(), BodyError> {
        let is_given = |key: &str| match key {
            "spindle-side" => self.spindle_side.is_some(),
            key => self.sizes().into_iter().any(|(own, value)| own == key && value.is_some()),
        };
        let pairs: &[[&'static str; 2]] = match shape {
            Shape::Wheel => &[
                ["arbor-diameter", "nut-length"],
                ["nut-length", "arbor-diameter"],
                ["arbor-diameter", "spindle-side"],
                ["spindle-diameter", "spindle-side"],
            ],
            _ => &[
                ["shank-diameter", "flute-length"],
                ["flute-length", "shank-diameter"],
                ["holder-diameter", "stick-out"],
                ["stick-out", "holder-diameter"],
            ],
        };
        let alone = pairs.iter().find(|[key, partner]| is_given(key) && !is_given(partner));
        alone.map_or(Ok(()), |&[key, partner]| Err(BodyError::Alone { key, partner }))
    }
}

impl BodyPart {
    /// What people call it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Arbor => "arbor",
            Self::Shank => "shank",
            Self::Holder => "holder",
            Self::Spindle => "spindle",
        }
    }
}

impl Tool {
    /// What of it does not cut, as cylinders; none if its library does not say.
    pub fn cylinders(&self) -> Vec<Cylinder> {
        let Some(body) = &self.body else { return Vec::new() };
        if self.profile.shape() == Shape::Wheel {
            // Along X, the spindle's side first; turned round if that is the heel's.
            let side = if body.spindle_side == Some(Side::Heel) { -1.0 } else { 1.0 };
            let cylinder = |part, diameter: f64, from: f64, to: f64| Cylinder {
                part,
                axle: Axle::X,
                radius: diameter / 2.0,
                stretch: [(side * from).min(side * to), (side * from).max(side * to)],
            };
            let arbor = body
                .arbor_diameter
                .zip(body.nut_length)
                .map(|(diameter, nut)| cylinder(BodyPart::Arbor, diameter, -nut, self.length));
            let spindle = body
                .spindle_diameter
                .map(|wide| cylinder(BodyPart::Spindle, wide, self.length, f64::INFINITY));
            return arbor.into_iter().chain(spindle).collect();
        }
        let cylinder = |part, diameter: f64, from: f64, to: f64| Cylinder {
            part,
            axle: Axle::Attack,
            radius: diameter / 2.0,
            stretch: [from, to],
        };
        let held = body.stick_out.unwrap_or(self.length);
        let shank = body.shank_diameter.zip(body.flute_length);
        let shank = shank.map(|(wide, from)| cylinder(BodyPart::Shank, wide, from, held));
        let holder = body.holder_diameter;
        let holder = holder.map(|wide| cylinder(BodyPart::Holder, wide, held, self.length));
        let spindle = body.spindle_diameter;
        let spindle =
            spindle.map(|wide| cylinder(BodyPart::Spindle, wide, self.length, f64::INFINITY));
        [shank, holder, spindle].into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wheel(side: Side) -> Tool {
        let body = Body {
            arbor_diameter: Some(40.0),
            nut_length: Some(30.0),
            spindle_side: Some(side),
            spindle_diameter: Some(90.0),
            ..Body::default()
        };
        Tool { body: Some(body), length: 45.0, ..Tool::from_shorthand("wheel:60,10").unwrap() }
    }

    #[test]
    fn a_wheel_sits_between_its_nut_and_its_spindle() {
        let stretches =
            |side| wheel(side).cylinders().iter().map(|part| part.stretch).collect::<Vec<_>>();
        assert_eq!(stretches(Side::Toe), [[-30.0, 45.0], [45.0, f64::INFINITY]]);
        assert_eq!(stretches(Side::Heel), [[-45.0, 30.0], [f64::NEG_INFINITY, -45.0]]);
    }

    #[test]
    fn an_end_mill_is_flutes_then_shank_then_holder_then_spindle() {
        let body = Body {
            shank_diameter: Some(6.0),
            flute_length: Some(13.0),
            holder_diameter: Some(32.0),
            stick_out: Some(30.0),
            spindle_diameter: Some(60.0),
            ..Body::default()
        };
        let mill = Tool { body: Some(body), ..Tool::from_shorthand("ball:3").unwrap() };
        let parts: Vec<_> =
            mill.cylinders().iter().map(|c| (c.part, c.radius, c.stretch)).collect();
        assert_eq!(
            parts,
            [
                (BodyPart::Shank, 3.0, [13.0, 30.0]),
                (BodyPart::Holder, 16.0, [30.0, 50.0]),
                (BodyPart::Spindle, 30.0, [50.0, f64::INFINITY]),
            ]
        );
        assert_eq!(Tool::from_shorthand("ball:3").unwrap().cylinders(), []);
    }

    #[test]
    fn a_body_that_cannot_be_is_refused_with_its_key_and_the_remedy() {
        let said = |body: Body, shape| body.check(shape, 50.0).unwrap_err().to_string();
        let size = Body { stick_out: Some(60.0), holder_diameter: Some(9.0), ..Body::default() };
        assert_eq!(
            said(size, Shape::Ball),
            "stick-out is 60: it must be at most the tool's length, 50"
        );
        let flutes = Body {
            stick_out: Some(20.0),
            flute_length: Some(25.0),
            shank_diameter: Some(6.0),
            ..size
        };
        assert_eq!(
            said(flutes, Shape::Ball),
            "flute-length is 25: it must be at most the stick-out, 20"
        );
        let negative = Body { spindle_diameter: Some(-1.0), ..Body::default() };
        assert_eq!(
            said(negative, Shape::Flat),
            "spindle-diameter is -1: it must be greater than 0"
        );
        assert_eq!(
            said(size, Shape::Wheel),
            "a wheel has no holder-diameter; its body is made of arbor-diameter, nut-length, \
             spindle-side, spindle-diameter"
        );
        let alone = Body { spindle_diameter: Some(80.0), ..Body::default() };
        assert_eq!(
            said(alone, Shape::Wheel),
            "spindle-diameter says where something is only together with spindle-side; give both or \
             none"
        );
        assert_eq!(alone.check(Shape::Ball, 50.0), Ok(()));
    }
}
