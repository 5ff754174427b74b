//! The description of a turntable: `axis`, `through` and `step-deg`, as TOML.

use crate::geom::{Point3, Vector3};
use crate::io::fault::{Fault, ReadError};
use crate::register::turntable::Turntable;
use crate::tool::Place;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;

/// The largest description read [bytes].
const LARGEST: u64 = 1 << 20;

/// Reads the turntable described in the file `path`.
pub fn read_turntable(path: &Path) -> Result<Turntable, ReadError> {
    read(path).map_err(|fault| ReadError { path: path.into(), fault })
}

/// The description of `turntable`, as [`read_turntable`] reads it.
pub fn turntable_text(turntable: &Turntable) -> String {
    let Turntable { axis, through, step } = turntable;
    format!(
        "# A turntable before a camera that stands still; camera x right, y down, z forward\n\
         # The part turns about this axis as a right-handed screw does\n\
         axis = [{:?}, {:?}, {:?}]\n\
         # A point of the axis [mm]\n\
         through = [{:?}, {:?}, {:?}]\n\
         # From view to view [deg]\n\
         step-deg = {:?}\n",
        axis.x,
        axis.y,
        axis.z,
        through.x,
        through.y,
        through.z,
        step.to_degrees()
    )
}

/// A description as it is written; values keep their places.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct TurntableFile {
    axis: Spanned<[f64; 3]>,
    through: Spanned<[f64; 3]>,
    step_deg: Spanned<f64>,
}

fn read(path: &Path) -> Result<Turntable, Fault> {
    let mut text = String::new();
    File::open(path)?.take(LARGEST).read_to_string(&mut text)?;
    parse(&text, &path.display().to_string())
}

fn parse(text: &str, file: &str) -> Result<Turntable, Fault> {
    let at = |span: Range<usize>, problem: String| {
        let place = Place::new(text, file, span);
        let excerpt = place.excerpt().to_owned();
        Fault::Description { excerpt, place: place.to_string(), problem }
    };
    let said: TurntableFile = toml::from_str(text)
        .map_err(|error| at(error.span().unwrap_or(0..0), error.message().trim_end().to_owned()))?;
    let step_deg = *said.step_deg.get_ref();
    // A comparison that NaN fails.
    let is_turn = step_deg.abs() < 360.0;
    if !is_turn {
        let problem = format!("step-deg is {step_deg}: it must be below 360 degrees");
        return Err(at(said.step_deg.span(), problem));
    }
    let axis = Vector3::from(*said.axis.get_ref());
    let through = Point3::from(*said.through.get_ref());
    Turntable::new(axis, through, step_deg.to_radians())
        .map_err(|error| at(said.axis.span(), error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turntable_comes_back_as_it_was_written() {
        let axis = Vector3::new(0.01, -0.8, 0.6);
        let written = Turntable::new(axis, Point3::new(3.25, -40.0, 812.5), 0.0873).unwrap();
        let read = parse(&turntable_text(&written), "t.toml").unwrap();
        assert!((read.axis - written.axis).norm() < 1e-15 && read.through == written.through);
        assert!((read.step - written.step).abs() < 1e-15);
    }

    #[test]
    fn faults_name_line_and_column() {
        let good = "axis = [0, -2, 0]\nthrough = [0, 0, 800]\nstep-deg = 5\n";
        assert_eq!(parse(good, "t.toml").unwrap().axis, -Vector3::y());
        for (text, message) in [
            (good.replace("-2", "0"), "t.toml:1:8: the axis 0 0 0 through 0 0 800"),
            (good.replace("800", "inf"), "every number finite"),
            (good.replace("5\n", "nan\n"), "t.toml:3:12: step-deg is NaN: it must be below 360"),
            (good.replace("through", "at"), "t.toml:2:1: unknown field `at`"),
            (good.replace("[0, 0, 800]", "[0, 800]"), "t.toml:2:"),
        ] {
            let fault = parse(&text, "t.toml").unwrap_err().to_string();
            assert!(fault.contains(message), "{fault}");
        }
    }
}
