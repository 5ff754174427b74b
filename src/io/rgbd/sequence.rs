//! Sequences of frames in folders: TUM's with their lists, and plain ones with pictures by name.
//!
//! TUM: `rgb.txt` and `depth.txt` list the pictures with their stamps, `groundtruth.txt` has the poses.
//! Plain: `depth/NAME.png`, where there is colour `color/NAME.png` (or `rgb/`), where the sensor tells how
//! sure it is `confidence/NAME.png`, and `poses.txt` in the format of TUM's trajectories. Names that are
//! numbers with a decimal point are stamps; other pictures are counted at the camera's rate. Either may
//! have a `camera.toml`.

use super::camera::{DepthCamera, read_camera};
use super::list::read_lines;
use super::picture::{read_color, read_confidence, read_depth, read_numbers};
use super::trajectory::read_trajectory;
use crate::io::fault::{Fault, ReadError};
use crate::io::raw::counted;
use crate::rgbd::{CameraTrajectory, Image, RgbdFrame, SequenceError, associate};
use std::path::{Path, PathBuf};

/// Colour and depth are one frame if their stamps differ by no more than this [s].
const FARTHEST: f64 = 0.02;

/// The files of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFiles {
    /// When it was taken [s]: its colour, if it has one, as is the custom with this benchmark.
    pub stamp: f64,
    /// When its depth was taken [s].
    pub depth_stamp: f64,
    /// Depth.
    pub depth: PathBuf,
    /// Colour.
    pub color: Option<PathBuf>,
    /// How sure the sensor is.
    pub confidence: Option<PathBuf>,
}

/// A sequence of frames, none of them read yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// What took it.
    pub camera: DepthCamera,
    /// Its frames, stamps rising.
    pub files: Vec<FrameFiles>,
    /// Where the camera was, if the folder says.
    pub truth: Option<CameraTrajectory>,
    /// Pictures of depth without one of colour near enough.
    pub n_depth_alone: usize,
    /// Pictures of colour without one of depth near enough.
    pub n_color_alone: usize,
    /// What the user must know.
    pub notes: Vec<String>,
}

/// Opens the sequence in `folder`, taken by `camera`, or by what its `camera.toml` says, or else by a
/// Kinect (and a note says so).
pub fn open_sequence(folder: &Path, camera: Option<DepthCamera>) -> Result<Sequence, ReadError> {
    let mut notes = Vec::new();
    let description = folder.join("camera.toml");
    let camera = match camera {
        Some(camera) => camera,
        None if description.is_file() => read_camera(&description)?,
        None => {
            notes.push(
                "no camera.toml in it: taken for a Kinect as drivers assume it (fx 525, depth in 1/5000 m); \
                 a calibrated camera (--camera) makes results much better"
                    .to_owned(),
            );
            DepthCamera::KINECT
        }
    };
    let is_listed = ["depth.txt", "rgb.txt"].iter().any(|list| folder.join(list).is_file());
    let sequence = if is_listed { listed(folder, camera)? } else { named(folder, camera)? };
    if sequence.files.is_empty() {
        return Err(ReadError { path: folder.into(), fault: Fault::NoFrames });
    }
    notes.extend(sequence.left_over());
    Ok(Sequence { notes, ..sequence })
}

impl Sequence {
    /// The frames, each read when it is asked for.
    pub fn frames(&self) -> impl ExactSizeIterator<Item = Result<RgbdFrame, SequenceError>> + '_ {
        (0..self.files.len()).map(|i| self.frame(i))
    }

    /// The frame at a place, counted from 0.
    ///
    /// # Panics
    ///
    /// If there are not as many.
    pub fn frame(&self, i: usize) -> Result<RgbdFrame, SequenceError> {
        let problem = |error: ReadError| SequenceError { number: i + 1, problem: error.into() };
        self.read(&self.files[i]).map_err(problem)
    }

    /// One frame; its pictures must be as large as the camera's.
    pub fn read(&self, files: &FrameFiles) -> Result<RgbdFrame, ReadError> {
        let read_depth = || self.read_depth(&files.depth);
        let read_color = || files.color.as_deref().map(read_color).transpose();
        let (depth, color) = rayon::join(read_depth, read_color);
        let confidence = files.confidence.as_deref().map(read_confidence).transpose()?;
        let frame = RgbdFrame { stamp: files.stamp, depth: depth?, color: color?, confidence };
        let fault = |error| ReadError { path: files.depth.clone(), fault: Fault::Rgbd(error) };
        frame.check(&self.camera.camera).map_err(fault)?;
        Ok(frame)
    }

    fn read_depth(&self, path: &Path) -> Result<Image<f32>, ReadError> {
        let Some(kinect) = self.camera.disparity else {
            return read_depth(path, self.camera.depth_scale);
        };
        let fault = |error| ReadError { path: path.into(), fault: Fault::Rgbd(error) };
        kinect.depth_image(&read_numbers(path)?).map_err(fault)
    }

    fn left_over(&self) -> Option<String> {
        let alone = |n: usize, what: &str| (n > 0).then(|| counted(n, what));
        let depth = alone(self.n_depth_alone, "depth picture");
        let color = alone(self.n_color_alone, "colour picture");
        let all: Vec<String> = depth.into_iter().chain(color).collect();
        (!all.is_empty()).then(|| {
            format!("{} left out: none of the other kind within {FARTHEST} s", all.join(" and "))
        })
    }
}

fn listed(folder: &Path, camera: DepthCamera) -> Result<Sequence, ReadError> {
    let depth = read_list(&folder.join("depth.txt"), folder)?;
    let colors = folder.join("rgb.txt");
    let truth = truth(&folder.join("groundtruth.txt"))?;
    let mut sequence = Sequence {
        camera,
        files: Vec::new(),
        truth,
        n_depth_alone: 0,
        n_color_alone: 0,
        notes: Vec::new(),
    };
    if !colors.is_file() {
        let alone = |(stamp, depth)| {
            let (color, confidence) = (None, None);
            FrameFiles { stamp, depth_stamp: stamp, depth, color, confidence }
        };
        sequence.files = depth.into_iter().map(alone).collect();
        return Ok(sequence);
    }
    let color = read_list(&colors, folder)?;
    let stamps = |list: &[(f64, PathBuf)]| list.iter().map(|entry| entry.0).collect::<Vec<_>>();
    let pairs = associate(&stamps(&depth), &stamps(&color), FARTHEST);
    sequence.n_depth_alone = depth.len() - pairs.len();
    sequence.n_color_alone = color.len() - pairs.len();
    let one = |&(i, j): &(usize, usize)| {
        let (depth_stamp, depth) = depth[i].clone();
        let (stamp, color) = color[j].clone();
        FrameFiles { stamp, depth_stamp, depth, color: Some(color), confidence: None }
    };
    sequence.files = pairs.iter().map(one).collect();
    Ok(sequence)
}

/// Stamps and the files they name.
fn read_list(path: &Path, folder: &Path) -> Result<Vec<(f64, PathBuf)>, ReadError> {
    let fault = |fault| ReadError { path: path.into(), fault };
    let lines = read_lines(path, 2, "stamp file").map_err(fault)?;
    let entry = |line: super::list::Line| {
        let name = String::from_utf8_lossy(&line.rest[0]).into_owned();
        (line.stamp, folder.join(name))
    };
    Ok(lines.into_iter().map(entry).collect())
}

fn truth(path: &Path) -> Result<Option<CameraTrajectory>, ReadError> {
    if path.is_file() { read_trajectory(path).map(Some) } else { Ok(None) }
}

fn named(folder: &Path, camera: DepthCamera) -> Result<Sequence, ReadError> {
    let fault = |fault| ReadError { path: folder.into(), fault };
    let depths = pictures(&folder.join("depth")).map_err(fault)?;
    if depths.is_empty() {
        return Err(fault(Fault::NoSequence));
    }
    let beside =
        |kinds: &[&str]| kinds.iter().map(|kind| folder.join(kind)).find(|folder| folder.is_dir());
    let colors = beside(&["color", "rgb"]);
    let confidences = beside(&["confidence"]);
    let stamps = stamps(&depths, camera.rate_hz);
    let twin = |of: &Path, among: &Option<PathBuf>| {
        let Some(among) = among else { return Ok(None) };
        let path = among.join(of.file_name().unwrap_or_default());
        if path.is_file() {
            return Ok(Some(path));
        }
        let missing = std::io::Error::from(std::io::ErrorKind::NotFound);
        Err(ReadError { path, fault: Fault::System(missing) })
    };
    let mut files = Vec::with_capacity(depths.len());
    for (depth, stamp) in depths.into_iter().zip(stamps) {
        let color = twin(&depth, &colors)?;
        let confidence = twin(&depth, &confidences)?;
        files.push(FrameFiles { stamp, depth_stamp: stamp, depth, color, confidence });
    }
    let truth = truth(&folder.join("poses.txt"))?;
    Ok(Sequence { camera, files, truth, n_depth_alone: 0, n_color_alone: 0, notes: Vec::new() })
}

/// The PNG files in `folder`, by their numbers if all have one, else by name; none if it is not there.
fn pictures(folder: &Path) -> Result<Vec<PathBuf>, Fault> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
            paths.push(path);
        }
    }
    paths.sort();
    if paths.iter().all(|path| number(path).is_some()) {
        paths.sort_by(|a, b| number(a).unwrap_or(0.0).total_cmp(&number(b).unwrap_or(0.0)));
    }
    Ok(paths)
}

/// The stamps that names are, or those of frames at an even rate.
fn stamps(paths: &[PathBuf], rate_hz: f64) -> Vec<f64> {
    let stamp = |path: &PathBuf| {
        let is_seconds = path.file_stem()?.to_str()?.contains('.');
        number(path).filter(|_| is_seconds)
    };
    let told: Option<Vec<f64>> = paths.iter().map(stamp).collect();
    let rising = |stamps: &Vec<f64>| stamps.windows(2).all(|w| w[0] < w[1]);
    told.filter(rising).unwrap_or_else(|| (0..paths.len()).map(|i| i as f64 / rate_hz).collect())
}

fn number(path: &Path) -> Option<f64> {
    path.file_stem()?.to_str()?.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_a_decimal_point_are_stamps_and_others_are_counted() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        assert_eq!(stamps(&paths(&["d/1.25.png", "d/1.5.png"]), 30.0), [1.25, 1.5]);
        assert_eq!(stamps(&paths(&["d/007.png", "d/009.png"]), 10.0), [0.0, 0.1]);
        assert_eq!(stamps(&paths(&["d/a.png", "d/1.5.png"]), 10.0), [0.0, 0.1]);
    }

    #[test]
    fn pictures_come_by_number_where_all_have_one() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["10.png", "9.png", "100.PNG", "note.txt"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let names = || {
            let paths = pictures(folder.path()).unwrap();
            paths.iter().map(|p| p.file_stem().unwrap().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(names(), ["9", "10", "100"]);
        std::fs::write(folder.path().join("x.png"), "").unwrap();
        assert_eq!(names(), ["10", "100", "9", "x"]);
    }
}
