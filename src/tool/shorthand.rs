//! Tools on the command line: `wheel:60,10` instead of an entry in a library.

use super::{Profile, Shape, Tool, ToolError, Turns};
use std::fmt::{Display, Formatter};

/// The T word of a tool that stands in no library: high, to stay clear of the numbers in use.
const NUMBER: u32 = 99;
/// From the spindle nose to the programmed point, unless a library says otherwise [mm].
const LENGTH: f64 = 50.0;

impl Tool {
    /// A tool from its shape alone: `wheel:60,10`, `ball:3`, `flat:5`, `bull:6,1`, `cone:5,30`,
    /// `ball-cone:5,1,15`; radii in mm and half angles in degrees, in the order of
    /// [`Shape::keys`].
    ///
    /// What the shape does not say are careful defaults, to be replaced by a library entry: T99,
    /// length 50 mm, clockwise; a wheel 6,000 rpm, feed 150 mm/s, plunge 15 mm/s; an end mill
    /// 12,000 rpm, feed 30 mm/s, plunge 8 mm/s. Nothing is known of what does not cut.
    pub fn from_shorthand(text: &str) -> Result<Self, ToolError> {
        let profile = profile(text)?;
        profile.check().map_err(|error| refuse(text, error.to_string()))?;
        let (speed_rpm, feed, plunge_feed) = match profile.shape() {
            Shape::Wheel => (6_000.0, 150.0, 15.0),
            _ => (12_000.0, 30.0, 8.0),
        };
        Ok(Self {
            number: NUMBER,
            name: profile.to_string(),
            profile,
            length: LENGTH,
            speed_rpm,
            turns: Turns::Clockwise,
            feed,
            plunge_feed,
            body: None,
        })
    }
}

/// Prints as the command line has it: `wheel:60,10`.
impl Display for Profile {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        let dimensions: Vec<String> = self.dimensions().iter().map(f64::to_string).collect();
        write!(f, "{}:{}", self.shape().word(), dimensions.join(","))
    }
}

fn profile(text: &str) -> Result<Profile, ToolError> {
    let Some((word, numbers)) = text.split_once(':') else {
        return Err(refuse(text, "there is no colon in it"));
    };
    let Some(shape) = Shape::from_word(word) else {
        let words = Shape::ALL.map(Shape::word).join(", ");
        return Err(refuse(text, format!("{word:?} is no shape; there are {words}")));
    };
    let dimensions = numbers
        .split(',')
        .map(|number| number.trim().parse::<f64>())
        .collect::<Result<Vec<f64>, _>>()
        .map_err(|_| refuse(text, format!("{numbers:?} are not numbers between commas")))?;
    shape.profile(&dimensions).ok_or_else(|| {
        let keys = shape.keys().join(", ");
        refuse(text, format!("a {word} has {} dimension(s): {keys}", shape.keys().len()))
    })
}

fn refuse(text: &str, problem: impl Into<String>) -> ToolError {
    ToolError::Shorthand { text: text.to_owned(), problem: problem.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_can_be_written_on_the_command_line() {
        let half_angle = 30.0_f64.to_radians();
        for (text, profile) in [
            ("wheel:60,10", Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }),
            ("ball:3", Profile::Ball { radius: 3.0 }),
            ("flat:5", Profile::Flat { radius: 5.0 }),
            ("bull:6,1.5", Profile::Bull { radius: 6.0, corner_radius: 1.5 }),
            ("cone:5,30", Profile::Cone { radius: 5.0, half_angle }),
            ("ball-cone:5,1,30", Profile::BallCone { radius: 5.0, tip_radius: 1.0, half_angle }),
        ] {
            let tool = Tool::from_shorthand(text).unwrap();
            assert_eq!(tool.profile, profile);
            assert_eq!(tool.name, text);
            assert_eq!(tool.profile.to_string(), text);
        }
    }

    #[test]
    fn a_shorthand_that_cannot_be_read_says_why_and_how_to_write_it() {
        let how = "; write a shape and its dimensions in mm and degrees, as in wheel:60,10 ball:3 \
                   flat:5 bull:6,1 cone:5,30 ball-cone:5,1,15";
        for (text, problem) in [
            ("wheel", "there is no colon in it"),
            ("disc:5", "\"disc\" is no shape; there are wheel, ball, flat, bull, cone, ball-cone"),
            ("ball:3mm", "\"3mm\" are not numbers between commas"),
            ("wheel:60", "a wheel has 2 dimension(s): major-radius, minor-radius"),
            ("ball:3,4", "a ball has 1 dimension(s): radius"),
            (
                "ball:-3",
                "a ball cannot have a radius of -3: it must be greater than 0 and at most 10000 mm",
            ),
            (
                "ball:nan",
                "a ball cannot have a radius of NaN: it must be greater than 0 and at most 10000 mm",
            ),
        ] {
            assert_eq!(
                Tool::from_shorthand(text).unwrap_err().to_string(),
                format!("{text:?} is not a tool: {problem}{how}")
            );
        }
    }
}
