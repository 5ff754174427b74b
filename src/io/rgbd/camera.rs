//! The description of a depth camera, `camera.toml`.

use crate::io::fault::{Fault, ReadError};
use crate::rgbd::{Camera, Distortion, KinectDisparity, RgbdError};
use crate::tool::Place;
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use toml::Spanned;

/// A camera and what its depth pictures count in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthCamera {
    /// Where points appear.
    pub camera: Camera,
    /// Units of a depth picture to a metre: 5000 in the TUM benchmark, 1000 with most drivers.
    pub depth_scale: f64,
    /// How its pictures become depth, if they hold the disparities of a Kinect and not depth.
    pub disparity: Option<KinectDisparity>,
    /// Frames a second, for pictures that are counted and not stamped.
    pub rate_hz: f64,
}

impl DepthCamera {
    /// A Kinect with the numbers of the TUM benchmark, where nothing better is known.
    pub const KINECT: Self =
        Self { camera: Camera::KINECT, depth_scale: 5000.0, disparity: None, rate_hz: 30.0 };

    /// That of the TUM sequences `freiburg1`, whose distortion it is usual to ignore.
    pub const FREIBURG1: Self = Self {
        camera: Camera {
            distortion: Distortion { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 },
            ..Camera::FREIBURG1
        },
        ..Self::KINECT
    };
}

/// The largest description read [bytes].
const LARGEST: u64 = 1 << 20;

/// The camera called `name_or_path`: `kinect`, `freiburg1` (without its distortion), or a file.
pub fn read_camera(name_or_path: &Path) -> Result<DepthCamera, ReadError> {
    match name_or_path.to_str() {
        Some("kinect") => Ok(DepthCamera::KINECT),
        Some("freiburg1") => Ok(DepthCamera::FREIBURG1),
        _ => read(name_or_path).map_err(|fault| ReadError { path: name_or_path.into(), fault }),
    }
}

/// Writes the description of `camera`.
pub(super) fn write(out: &mut dyn Write, camera: &DepthCamera) -> std::io::Result<()> {
    let Camera { width, height, fx, fy, cx, cy, distortion } = camera.camera;
    writeln!(out, "# A depth camera; pixels, the first one's centre at 0 0")?;
    writeln!(out, "width = {width}\nheight = {height}")?;
    writeln!(out, "fx = {fx:?}\nfy = {fy:?}\ncx = {cx:?}\ncy = {cy:?}")?;
    writeln!(out, "# Units of a depth picture to a metre")?;
    writeln!(out, "depth-scale = {:?}\nrate-hz = {:?}", camera.depth_scale, camera.rate_hz)?;
    if let Some(KinectDisparity { baseline, focal_px, offset }) = camera.disparity {
        writeln!(out, "\n[disparity]\nbaseline = {baseline:?}")?;
        writeln!(out, "focal-px = {focal_px:?}\noffset = {offset:?}")?;
    }
    if !distortion.is_none() {
        let Distortion { k1, k2, p1, p2, k3 } = distortion;
        writeln!(
            out,
            "\n[distortion]\nk1 = {k1:?}\nk2 = {k2:?}\np1 = {p1:?}\np2 = {p2:?}\nk3 = {k3:?}"
        )?;
    }
    Ok(())
}

/// A description as it is written; values keep their places.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct CameraFile {
    width: Spanned<usize>,
    height: Spanned<usize>,
    fx: Spanned<f64>,
    fy: Spanned<f64>,
    cx: Spanned<f64>,
    cy: Spanned<f64>,
    depth_scale: Option<Spanned<f64>>,
    rate_hz: Option<Spanned<f64>>,
    disparity: Option<Spanned<KinectDisparity>>,
    distortion: Option<Spanned<Distortion>>,
}

fn read(path: &Path) -> Result<DepthCamera, Fault> {
    let mut text = String::new();
    File::open(path)?.take(LARGEST).read_to_string(&mut text)?;
    parse(&text, &path.display().to_string())
}

fn parse(text: &str, file: &str) -> Result<DepthCamera, Fault> {
    let at = |span: std::ops::Range<usize>, problem: String| {
        let place = Place::new(text, file, span);
        Fault::Description {
            excerpt: place.excerpt().to_owned(),
            place: place.to_string(),
            problem,
        }
    };
    let said: CameraFile = toml::from_str(text)
        .map_err(|error| at(error.span().unwrap_or(0..0), error.message().trim_end().to_owned()))?;
    let camera = Camera {
        width: *said.width.get_ref(),
        height: *said.height.get_ref(),
        fx: *said.fx.get_ref(),
        fy: *said.fy.get_ref(),
        cx: *said.cx.get_ref(),
        cy: *said.cy.get_ref(),
        distortion: said.distortion.as_ref().map_or(Distortion::default(), |d| *d.get_ref()),
    };
    camera.check().map_err(|error| {
        let span = match &error {
            RgbdError::Number { key: "width", .. } => said.width.span(),
            RgbdError::Number { key: "height", .. } => said.height.span(),
            RgbdError::Number { key: "fx", .. } => said.fx.span(),
            RgbdError::Number { key: "fy", .. } => said.fy.span(),
            RgbdError::Number { key: "cx", .. } => said.cx.span(),
            RgbdError::Number { key: "cy", .. } => said.cy.span(),
            _ => said.distortion.as_ref().map_or(0..0, Spanned::span),
        };
        at(span, error.to_string())
    })?;
    let positive = |key: &str, value: Option<&Spanned<f64>>, usual: f64| match value {
        None => Ok(usual),
        Some(value) if *value.get_ref() > 0.0 && value.get_ref().is_finite() => {
            Ok(*value.get_ref())
        }
        Some(value) => {
            let problem = format!("{key} is {}: it must be a positive number", value.get_ref());
            Err(at(value.span(), problem))
        }
    };
    if let Some(kinect) = &said.disparity {
        kinect.get_ref().check().map_err(|error| at(kinect.span(), error.to_string()))?;
    }
    Ok(DepthCamera {
        camera,
        disparity: said.disparity.map(Spanned::into_inner),
        depth_scale: positive("depth-scale", said.depth_scale.as_ref(), 1000.0)?,
        rate_hz: positive("rate-hz", said.rate_hz.as_ref(), 30.0)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "width = 640\nheight = 480\nfx = 525\nfy = 525.0\ncx = 319.5\ncy = 239.5\n";

    #[test]
    fn a_camera_comes_back_as_it_was_written() {
        let disparity = Some(KinectDisparity { offset: 1084.5, ..KinectDisparity::default() });
        for (camera, disparity) in [(Camera::KINECT, None), (Camera::FREIBURG1, disparity)] {
            let camera = DepthCamera { camera, depth_scale: 5000.0, disparity, rate_hz: 29.97 };
            let mut text = Vec::new();
            write(&mut text, &camera).unwrap();
            assert_eq!(parse(std::str::from_utf8(&text).unwrap(), "c").unwrap(), camera);
        }
        let usual = parse(GOOD, "c").unwrap();
        assert_eq!((usual.camera, usual.depth_scale), (Camera::KINECT, 1000.0));
    }

    #[test]
    fn faults_name_line_and_column() {
        for (text, message) in [
            (GOOD.replace("fx", "focal"), "c.toml:3:1: unknown field `focal`"),
            (GOOD.replace("cx = 319.5\n", ""), "missing field `cx`"),
            (GOOD.replace("525.0", "-525.0"), "c.toml:4:6: fy is -525: it must be a positive"),
            (GOOD.replace("640", "0"), "c.toml:1:9: width is 0: it must be from 1 to 16384"),
            (GOOD.replace("319.5", "nan"), "c.toml:5:6: cx is NaN: it must be a finite number"),
            (format!("{GOOD}depth-scale = 0\n"), "c.toml:7:15: depth-scale is 0: it must be"),
            (format!("{GOOD}[distortion]\nk9 = 1\n"), "c.toml:8:1: unknown field `k9`"),
            (format!("{GOOD}[disparity]\nbaseline = 0\n"), "c.toml:7:1: baseline is 0: it must"),
            ("width = \n".to_owned(), "c.toml:1:"),
        ] {
            let error = parse(&text, "c.toml").unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn cameras_that_are_known_need_no_file() {
        assert_eq!(read_camera(Path::new("kinect")).unwrap(), DepthCamera::KINECT);
        let freiburg = read_camera(Path::new("freiburg1")).unwrap().camera;
        assert!(freiburg.fx == 517.3 && freiburg.distortion.is_none());
        assert!(read_camera(Path::new("nikon")).unwrap_err().to_string().contains("\"nikon\""));
    }
}
