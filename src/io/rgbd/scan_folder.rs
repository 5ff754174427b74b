//! A scan written as a folder in the format of the TUM benchmark: there whole, or not at all.

use super::camera::{self, DepthCamera};
use super::contact::contact_sheet;
use super::{picture, trajectory};
use crate::io::output_folder::OutputFolder;
use crate::io::report::encode_png;
use crate::io::{Overwrite, WriteError};
use crate::rgbd::{CameraTrajectory, RgbdFrame, numbers_from_depth};
use std::fmt::Write as _;
use std::path::Path;

/// What a scan holds, and nothing else: only such a folder is ever replaced.
const CONTENT: [&str; 7] =
    ["rgb", "depth", "rgb.txt", "depth.txt", "groundtruth.txt", "camera.toml", "contact.png"];
/// Frames on the contact sheet at most.
const N_SHOWN: usize = 12;

/// A scan being written, under a temporary name until [`ScanFolder::finish`].
#[derive(Debug)]
pub struct ScanFolder {
    folder: OutputFolder,
    camera: DepthCamera,
    n_frames: usize,
    /// Empty while there is no colour: a list without pictures would be a sequence without frames.
    color_list: String,
    depth_list: String,
    n_written: usize,
    shown: Vec<RgbdFrame>,
}

impl ScanFolder {
    /// Begins a scan of `n_frames` to be called `path`.
    pub fn begin(
        path: &Path,
        camera: &DepthCamera,
        n_frames: usize,
        overwrite: Overwrite,
    ) -> Result<Self, WriteError> {
        let folder = OutputFolder::begin(path, overwrite, &CONTENT)?;
        folder.create_folder("depth")?;
        Ok(Self {
            folder,
            camera: *camera,
            n_frames,
            color_list: String::new(),
            depth_list: head("depth"),
            n_written: 0,
            shown: Vec::new(),
        })
    }

    /// Writes one frame.
    pub fn add(&mut self, frame: RgbdFrame) -> Result<(), WriteError> {
        if frame.color.is_some() && self.color_list.is_empty() {
            self.folder.create_folder("rgb")?;
            self.color_list = head("colour");
        }
        let stamp = format!("{:.6}", frame.stamp);
        let depth_name = format!("depth/{stamp}.png");
        let numbers = numbers_from_depth(&frame.depth, self.camera.depth_scale);
        let folder = &self.folder;
        let write_depth = || {
            let numbers = numbers.map_err(std::io::Error::other);
            folder.write(&depth_name, |out| picture::write_numbers(out, &numbers?))
        };
        let color_name = format!("rgb/{stamp}.png");
        let write_color = || match &frame.color {
            Some(color) => folder.write(&color_name, |out| picture::write_color(out, color)),
            None => Ok(()),
        };
        let (depth, color) = rayon::join(write_depth, write_color);
        depth.and(color)?;
        list(&mut self.depth_list, &stamp, &depth_name);
        if frame.color.is_some() {
            list(&mut self.color_list, &stamp, &color_name);
        }
        // Evenly over the whole scan.
        let place = |i: usize| i * N_SHOWN.min(self.n_frames) / self.n_frames.max(1);
        if self.n_written == 0 || place(self.n_written) != place(self.n_written - 1) {
            self.shown.push(frame);
        }
        self.n_written += 1;
        Ok(())
    }

    /// Writes the lists, the truth, the camera and the contact sheet, and gives the folder its name.
    pub fn finish(self, truth: &CameraTrajectory) -> Result<(), WriteError> {
        let Self { folder, camera, color_list, depth_list, shown, .. } = self;
        let sheet = contact_sheet(&shown);
        if !color_list.is_empty() {
            folder.write("rgb.txt", |out| out.write_all(color_list.as_bytes()))?;
        }
        folder.write("depth.txt", |out| out.write_all(depth_list.as_bytes()))?;
        folder.write("groundtruth.txt", |out| trajectory::write(out, truth))?;
        folder.write("camera.toml", |out| camera::write(out, &camera))?;
        folder.write("contact.png", |out| out.write_all(&encode_png(&sheet)?))?;
        folder.commit()
    }
}

fn head(what: &str) -> String {
    format!("# pictures of {what}, simulated by horma\n# stamp file\n")
}

fn list(lines: &mut String, stamp: &str, name: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(lines, "{stamp} {name}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Pose;
    use crate::io::rgbd::open_sequence;
    use crate::rgbd::{Camera, Image, StampedPose};

    #[test]
    fn a_scan_without_colour_reads_back_without() {
        let around = tempfile::tempdir().unwrap();
        let path = around.path().join("scan");
        let camera = Camera::pinhole([4, 3], [4.0, 4.0], [1.5, 1.0]);
        let camera = DepthCamera { camera, ..DepthCamera::KINECT };
        let mut folder = ScanFolder::begin(&path, &camera, 2, Overwrite::Refuse).unwrap();
        let depth = Image::filled(4, 3, 800.0);
        for i in 0..2 {
            let (stamp, depth) = (f64::from(i) / 32.0, depth.clone());
            folder.add(RgbdFrame { stamp, color: None, depth, confidence: None }).unwrap();
        }
        let world_from_camera = Pose::translation(1.0, 2.0, 3.0);
        let truth = CameraTrajectory::new(vec![StampedPose { stamp: 0.0, world_from_camera }]);
        folder.finish(&truth.unwrap()).unwrap();
        let sequence = open_sequence(&path, None).unwrap();
        assert_eq!((sequence.files.len(), sequence.camera), (2, camera));
        let frame = sequence.frames().nth(1).unwrap().unwrap();
        assert_eq!((frame.stamp, frame.depth, frame.color), (0.031_25, depth, None));
    }
}
