//! Trajectory errors against the reference tools, and `horma evaluate`.

use crate::command::horma;
use crate::parts::real;
use horma::geom::{Pose, Vector3};
use horma::io::Overwrite;
use horma::io::rgbd::{open_sequence, read_trajectory, write_trajectory};
use horma::register::{Delta, OdometryErrorOptions, Statistics, TruthAt, odometry_error};
use horma::rgbd::{CameraTrajectory, StampedPose};
use std::path::Path;

/// Against the reference [mm, deg]: files round places to 1e-6 mm and quaternions to 1e-9.
const TOLERANCE: f64 = 2e-5;

/// A curved walk [s, m, rad].
fn curve(t: f64) -> (Vector3, Vector3) {
    let place = Vector3::new(t, 0.3 * (2.0 * t).sin(), 0.05 * t * t);
    (place, Vector3::new(0.1 * t, 0.3 * t.cos(), 0.2))
}

/// A small error of the `i`th pose [m, rad].
fn error(i: f64) -> (Vector3, Vector3) {
    let wave = |size: f64, rate: f64, phase: f64| size * (rate * i + phase).sin();
    let quarter = std::f64::consts::FRAC_PI_2;
    (
        Vector3::new(wave(0.010, 0.7, 0.0), wave(0.008, 1.3, quarter), wave(0.006, 2.1, 1.0)),
        Vector3::new(wave(0.010, 0.9, 0.0), wave(0.012, 0.5, quarter), wave(0.008, 1.7, 0.0)),
    )
}

fn pose((place, turn): (Vector3, Vector3)) -> Pose {
    Pose::new(place * 1000.0, turn)
}

/// The true walk at 100 Hz, and an estimate of it at 30 Hz.
fn walks() -> (CameraTrajectory, CameraTrajectory) {
    let truth = |i: i32| {
        let stamp = f64::from(i) * 0.01;
        StampedPose { stamp, world_from_camera: pose(curve(stamp)) }
    };
    let estimate = |i: i32| {
        let stamp = 0.013 + f64::from(i) / 30.0;
        let (shift, turn) = error(f64::from(i));
        let exact = pose(curve(stamp));
        let place = exact.translation.vector + shift * 1000.0;
        let world_from_camera =
            Pose::from_parts(place.into(), exact.rotation * pose((shift, turn)).rotation);
        // As the file has it: a microsecond is a thousandth of a millimetre at this speed.
        StampedPose { stamp: (stamp * 1e6).round() / 1e6, world_from_camera }
    };
    let walk = |poses| CameraTrajectory::new(poses).unwrap();
    (walk((0..400).map(truth).collect()), walk((0..110).map(estimate).collect()))
}

/// The six numbers, in order.
fn numbers(s: Statistics) -> [f64; 6] {
    [s.rmse, s.mean, s.median, s.std, s.min, s.max]
}

fn assert_numbers(found: Statistics, expected: [f64; 6], what: &str) {
    for (a, b) in numbers(found).into_iter().zip(expected) {
        assert!((a - b).abs() < TOLERANCE, "{what}: {found:?} is not {expected:?}");
    }
}

/// Of `evo` 1.38.1 on the files of these two walks: RPE with `delta` 1 and 30 frames, all pairs, as
/// translation [mm] and angle [deg], then the translation of APE aligned without scale [mm].
const BY_NEAREST: [[f64; 6]; 5] = [
    [12.700_786_7, 12.253_317_2, 11.918_993_7, 3.341_586_7, 4.019_673_6, 21.022_422_8],
    [0.649_960_3, 0.627_869_7, 0.647_207_7, 0.168_012_0, 0.182_919_9, 0.894_834_7],
    [18.132_741_7, 17.346_283_7, 18.045_539_1, 5.282_306_8, 3.809_961_4, 28.939_915_4],
    [1.148_192_3, 1.099_444_2, 1.141_986_6, 0.331_010_3, 0.155_357_9, 1.614_810_4],
    [10.580_795_1, 10.070_001_6, 9.919_169_8, 3.247_813_6, 1.399_200_5, 16.449_828_8],
];
/// The same with `--sync_method interpolation`.
const BETWEEN: [[f64; 6]; 5] = [
    [11.165_693_2, 10.877_087_6, 11.173_090_6, 2.522_235_5, 4.325_849_3, 15.322_124_9],
    [0.647_593_6, 0.626_377_9, 0.645_636_7, 0.164_402_4, 0.134_711_5, 0.906_414_5],
    [18.042_753_6, 17.275_941_9, 17.888_593_5, 5.204_112_9, 3.400_068_9, 26.246_031_3],
    [1.147_758_1, 1.099_238_4, 1.145_230_2, 0.330_187_4, 0.194_138_2, 1.612_796_9],
    [9.990_722_0, 9.695_571_0, 9.902_219_2, 2.410_483_1, 3.140_479_7, 13.813_391_9],
];

fn assert_agrees(
    estimate: &CameraTrajectory,
    truth: &CameraTrajectory,
    truth_at: TruthAt,
    expected: &[[f64; 6]; 5],
) {
    let options = OdometryErrorOptions {
        deltas: vec![Delta::Poses(1), Delta::Poses(30)],
        truth_at,
        ..OdometryErrorOptions::default()
    };
    let found = odometry_error(estimate, truth, &options).unwrap();
    for (relative, expected) in found.relative.iter().zip(expected.chunks(2)) {
        assert_numbers(relative.translation, expected[0], "RPE [mm]");
        assert_numbers(relative.rotation.map(f64::to_degrees), expected[1], "RPE [deg]");
    }
    assert_numbers(found.absolute.statistics, expected[4], "ATE [mm]");
}

#[test]
fn errors_are_those_of_the_reference_tool() {
    let (truth, estimate) = walks();
    assert_agrees(&estimate, &truth, TruthAt::Nearest, &BY_NEAREST);
    assert_agrees(&estimate, &truth, TruthAt::Interpolated, &BETWEEN);
}

/// Of the same tool on `tum_fr1_rpy_cut`: the truth between its poses at the stamps of `depth.txt`, with
/// the errors above and a drift.
const NOISY_TRUTH: [[f64; 6]; 5] = [
    [11.224_399_7, 10.914_902_3, 11.177_086_4, 2.617_643_6, 4.423_223_3, 15.879_915_0],
    [0.667_892_2, 0.641_264_9, 0.679_606_3, 0.186_706_2, 0.156_126_8, 1.151_616_3],
    [21.221_199_8, 19.694_394_1, 18.259_625_4, 7.903_807_0, 8.138_558_3, 33.815_239_8],
    [1.135_731_1, 1.079_516_1, 1.127_246_5, 0.352_888_1, 0.391_601_0, 1.670_381_4],
    [12.389_601_7, 11.470_183_8, 10.979_054_1, 4.683_707_4, 1.957_897_9, 24.844_096_1],
];

#[test]
fn errors_are_those_of_the_reference_tool_on_a_real_walk() {
    let Some(folder) = real("rgbd/tum_fr1_rpy_cut") else { return };
    let sequence = open_sequence(&folder, None).unwrap();
    let truth = sequence.truth.unwrap();
    let noisy = |(i, stamp): (usize, f64)| {
        let exact = truth.at(stamp).unwrap();
        let (shift, turn) = error(i as f64);
        let drift = Vector3::new(0.0004, -0.0002, 0.0003) * i as f64;
        let place = exact.translation.vector + (shift + drift) * 1000.0;
        let turned = exact.rotation * pose((shift, turn)).rotation;
        StampedPose { stamp, world_from_camera: Pose::from_parts(place.into(), turned) }
    };
    let stamps = sequence.files.iter().map(|files| files.depth_stamp).enumerate();
    let estimate = CameraTrajectory::new(stamps.map(noisy).collect()).unwrap();
    assert_agrees(&estimate, &truth, TruthAt::Nearest, &NOISY_TRUTH);
}

#[test]
fn the_nearest_truth_has_a_floor_and_a_camera_that_stands_still_an_error() {
    // RPE per frame [mm, deg] and over 30 frames [mm], ATE [mm] of the truth between its poses against the
    // nearest one; then RPE of a camera that does not move at all.
    for (name, floor, still) in [
        ("rgbd/tum_fr1_rpy_cut", [0.258, 0.127, 0.315, 0.191], [2.954, 1.568, 71.66]),
        ("rgbd/tum_fr1_rpy_fast_cut", [0.611, 0.479, 0.413, 0.380], [3.810, 3.065, 81.553]),
    ] {
        let Some(folder) = real(name) else { return };
        let sequence = open_sequence(&folder, None).unwrap();
        let truth = sequence.truth.unwrap();
        let walk = |pose: &dyn Fn(f64) -> Pose| {
            let poses = sequence.files.iter().map(|files| StampedPose {
                stamp: files.stamp,
                world_from_camera: pose(files.stamp),
            });
            CameraTrajectory::new(poses.collect()).unwrap()
        };
        let options = OdometryErrorOptions {
            deltas: vec![Delta::Poses(1), Delta::Poses(30)],
            ..OdometryErrorOptions::default()
        };
        let of = |estimate: &CameraTrajectory| {
            let error = odometry_error(estimate, &truth, &options).unwrap();
            let [one, second] = &error.relative[..] else { panic!("two steps") };
            let turned = one.rotation.rmse.to_degrees();
            [one.translation.rmse, turned, second.translation.rmse, error.absolute.statistics.rmse]
        };
        let near = |found: &[f64], expected: &[f64]| {
            let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
            assert!(
                off.fold(0.0, f64::max) < 6e-4 * expected[expected.len() - 1].max(1.0),
                "{found:?}"
            );
        };
        near(&of(&walk(&|stamp| truth.at(stamp).unwrap())), &floor);
        near(&of(&walk(&|_| Pose::identity()))[..3], &still);
    }
}

fn put(folder: &Path, name: &str, walk: &CameraTrajectory) -> String {
    let path = folder.join(name);
    write_trajectory(&path, walk, Overwrite::Refuse).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_comparison_is_told_as_text_as_json_and_as_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (truth, estimate) = walks();
    let (truth, estimate) =
        (put(folder.path(), "truth.txt", &truth), put(folder.path(), "estimate.txt", &estimate));
    let plot = folder.path().join("errors.svg");
    let output = horma(&["evaluate", &estimate, &truth, "--plot", plot.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("110 of 110 poses have a true one\n"), "{text}");
    assert!(text.contains("ATE [mm]               10.581  10.070"), "{text}");
    assert!(text.contains("RPE over 1 pose [mm]") && text.contains("RPE over 1 s [deg]"), "{text}");
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(svg.starts_with("<svg xmlns=") && svg.contains("seen from above"));
    let output = horma(&["evaluate", &estimate, &truth, "--delta", "30", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rmse = json["rpe"][0]["translation-mm"]["rmse"].as_f64().unwrap();
    assert!((rmse - BY_NEAREST[2][0]).abs() < TOLERANCE, "{rmse}");
    assert_eq!((&json["rpe"][0]["delta"], &json["rpe"][0]["n-steps"]), (&"30".into(), &80.into()));
    let again = horma(&["evaluate", &estimate, &truth, "--plot", plot.to_str().unwrap()]);
    assert_eq!(again.status.code(), Some(73), "a plot is not overwritten");
}

#[test]
fn what_cannot_be_compared_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (truth, _) = walks();
    let later = truth.poses().iter().map(|p| StampedPose { stamp: p.stamp + 100.0, ..*p });
    let later = CameraTrajectory::new(later.collect()).unwrap();
    let (good, late) = (put(folder.path(), "good", &truth), put(folder.path(), "late", &later));
    let broken = folder.path().join("broken");
    std::fs::write(&broken, "1 0 0 0 0 0 1\n").unwrap();
    for (arguments, code, message) in [
        (vec![&*late, &*good], 65, "0 of 400 poses have a true one within 0.02 s"),
        (vec![broken.to_str().unwrap(), &*good], 65, "line 1: 7 columns where there must be 8"),
        (vec!["no-such-file", &*good], 65, "\"no-such-file\""),
        (vec![&*good, &*good, "--delta", "0"], 2, "\"0\" is no step"),
        (vec![&*good, &*good, "--delta", "9999"], 65, "no two of 400 poses lie 9999 apart"),
        (vec![&*good, &*good, "--max-difference=-1"], 65, "--max-difference is -1"),
        (vec![&*good], 2, "<TRUTH>"),
    ] {
        let output = horma(&[&["evaluate"], &arguments[..]].concat());
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {told}");
        assert!(told.contains(message), "{arguments:?}: {told}");
    }
}

#[test]
fn a_trajectory_that_is_read_and_written_stays_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let (truth, _) = walks();
    let first = put(folder.path(), "first", &truth);
    let again = read_trajectory(Path::new(&first)).unwrap();
    let second = put(folder.path(), "second", &again);
    let third = put(folder.path(), "third", &read_trajectory(Path::new(&second)).unwrap());
    assert_eq!(std::fs::read(second).unwrap(), std::fs::read(third).unwrap());
}
