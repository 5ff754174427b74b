//! Trajectories in the format of the TUM benchmark: `stamp tx ty tz qx qy qz qw`, in metres.

use super::list::{Line, finite, read_lines};
use crate::geom::Pose;
use crate::io::fault::{Fault, ReadError};
use crate::io::{Overwrite, WriteError, write_file};
use crate::rgbd::{CameraTrajectory, StampedPose};
use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use std::io::Write;
use std::path::Path;

/// A quaternion may be this much longer or shorter than 1: files round to few decimals.
const LENGTH_OFF: f64 = 0.01;

/// Reads the trajectory in the file `path`, in the TUM format.
pub fn read_trajectory(path: &Path) -> Result<CameraTrajectory, ReadError> {
    read(path).map_err(|fault| ReadError { path: path.into(), fault })
}

/// Writes `trajectory` to the file `path`, in the TUM format.
pub fn write_trajectory(
    path: &Path,
    trajectory: &CameraTrajectory,
    overwrite: Overwrite,
) -> Result<(), WriteError> {
    write_file(path, overwrite, |out| write(out, trajectory))
}

/// `trajectory` in the TUM format.
pub fn trajectory_text(trajectory: &CameraTrajectory) -> String {
    let mut text = Vec::new();
    // Memory takes all that is written, and it is all ASCII.
    let _ = write(&mut text, trajectory);
    String::from_utf8_lossy(&text).into_owned()
}

pub(super) fn write(out: &mut dyn Write, trajectory: &CameraTrajectory) -> std::io::Result<()> {
    writeln!(
        out,
        "# world_from_camera; metres, unit quaternion; camera x right, y down, z forward"
    )?;
    writeln!(out, "# stamp tx ty tz qx qy qz qw")?;
    for StampedPose { stamp, world_from_camera } in trajectory.poses() {
        let t = world_from_camera.translation.vector / 1000.0;
        let q = world_from_camera.rotation.coords;
        // As many digits as it takes to read the same numbers again.
        writeln!(out, "{stamp:.6} {} {} {} {} {} {} {}", t.x, t.y, t.z, q.x, q.y, q.z, q.w)?;
    }
    Ok(())
}

fn read(path: &Path) -> Result<CameraTrajectory, Fault> {
    let lines = read_lines(path, 8, "stamp tx ty tz qx qy qz qw")?;
    if lines.is_empty() {
        return Err(Fault::NoPoses);
    }
    Ok(CameraTrajectory::new(lines.iter().map(pose).collect::<Result<_, _>>()?)?)
}

fn pose(line: &Line) -> Result<StampedPose, Fault> {
    let mut values = [0.0; 7];
    for (value, word) in values.iter_mut().zip(&line.rest) {
        *value = finite(word, line.place)?;
    }
    let [x, y, z, i, j, k, w] = values;
    let turn = Quaternion::new(w, i, j, k);
    let length = turn.norm();
    if (length - 1.0).abs() > LENGTH_OFF {
        return Err(Fault::Malformed {
            place: line.place,
            problem: format!("the quaternion {i} {j} {k} {w} has the length {length:.4}, not 1"),
            remedy: "check the order of the columns: stamp tx ty tz qx qy qz qw",
        });
    }
    let place = Translation3::new(x * 1000.0, y * 1000.0, z * 1000.0);
    let world_from_camera = Pose::from_parts(place, UnitQuaternion::from_quaternion(turn));
    Ok(StampedPose { stamp: line.stamp, world_from_camera })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vector3;

    fn read_text(text: &str) -> Result<CameraTrajectory, ReadError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("poses.txt");
        std::fs::write(&path, text).unwrap();
        read_trajectory(&path)
    }

    #[test]
    fn a_trajectory_comes_back_as_it_was_written() {
        let pose = |i: i32| StampedPose {
            stamp: 1_305_031_237.5 + f64::from(i) / 32.0,
            world_from_camera: Pose::new(
                Vector3::new(1.0 / 3.0, 0.1 * f64::from(i), -812.3),
                Vector3::new(0.1, -0.2, 0.3) * f64::from(i),
            ),
        };
        let written = CameraTrajectory::new((0..5).map(pose).collect()).unwrap();
        let mut text = Vec::new();
        write(&mut text, &written).unwrap();
        let read = read_text(std::str::from_utf8(&text).unwrap()).unwrap();
        for (a, b) in written.poses().iter().zip(read.poses()) {
            assert_eq!(a.stamp, b.stamp);
            let off = a.world_from_camera.inverse() * b.world_from_camera;
            assert!(off.translation.vector.norm() < 1e-12 && off.rotation.angle() < 1e-15);
        }
    }

    #[test]
    fn metres_become_millimetres_and_rounded_quaternions_unit_ones() {
        let text = "# truth\n1.25 1.3033 0.6208 1.5821 0.5773 0.5493 -0.4063 -0.4472\n";
        let trajectory = read_text(text).unwrap();
        let pose = trajectory.poses()[0].world_from_camera;
        assert!((pose.translation.vector - Vector3::new(1303.3, 620.8, 1582.1)).norm() < 1e-9);
        assert!((pose.rotation.norm() - 1.0).abs() < 1e-15 && pose.rotation.k < -0.4);
    }

    #[test]
    fn faults_name_line_and_value() {
        for (text, message) in [
            ("1 0 0 0 0 0 0\n", "line 1: 7 columns where there must be 8 (stamp tx ty tz qx"),
            ("1 0 0 inf 0 0 0 1\n", "line 1: \"inf\" where a finite number must be"),
            (
                "1 0 0 0 0 0 0 1\n2 0 0 0 1 0 0 1\n",
                "line 2: the quaternion 1 0 0 1 has the length 1.4142",
            ),
            ("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "line 2: the stamp 1 does not come after 2"),
            ("# nothing\n", "there are no poses in it"),
        ] {
            let error = read_text(text).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
