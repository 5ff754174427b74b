//! Dense visual odometry on real sequences: how far off it ends, how long a frame takes, and what it says
//! of pairs of frames. `HORMA_DATA=... cargo bench --bench dense`. Pictures are read before; making
//! pyramids and aligning are timed. On two threads.

use horma::geom::Pose;
use horma::io::rgbd::{DepthCamera, Sequence, open_sequence};
use horma::progress::Silent;
use horma::register::dense::{DenseOptions, Pyramid, Residuals, align_frames};
use horma::register::icp::Verdict;
use horma::register::odometry::{OdometryOptions, Placed, Tracker};
use horma::register::{Delta, OdometryErrorOptions, odometry_error};
use horma::rgbd::{CameraTrajectory, RgbdFrame, StampedPose};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How far a pose may be off in the list of gaps.
const GAP_SHIFT: f64 = 20.0;
const GAP_TURN_DEG: f64 = 1.0;

/// How late a picture is stamped, by what turns fastest [s].
const LATE: f64 = 0.01;

fn main() {
    let Some(data) = std::env::var_os("HORMA_DATA").map(PathBuf::from) else {
        eprintln!("HORMA_DATA is not set: there is nothing to follow");
        return;
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool");
    pool.install(|| {
        for cut in ["tum_fr1_rpy_cut", "tum_fr1_rpy_fast_cut"] {
            let sequence = open(&data, cut);
            let frames: Vec<RgbdFrame> = sequence.frames().map(|f| f.expect("a frame")).collect();
            for residuals in [Residuals::BrightnessAndDepth, Residuals::Brightness] {
                follow(cut, &sequence, &frames, residuals);
            }
        }
        gaps(&data);
        kinect_pairs(&data);
    });
}

fn open(data: &Path, cut: &str) -> Sequence {
    open_sequence(&data.join("rgbd").join(cut), Some(DepthCamera::FREIBURG1)).expect("a sequence")
}

fn truth(sequence: &Sequence) -> &CameraTrajectory {
    sequence.truth.as_ref().expect("a truth")
}

fn follow(cut: &str, sequence: &Sequence, frames: &[RgbdFrame], residuals: Residuals) {
    let dense = DenseOptions { residuals, ..DenseOptions::default() };
    let options = OdometryOptions { dense, ..OdometryOptions::default() };
    let begin = Instant::now();
    let mut tracker = Tracker::new(sequence.camera.camera, options).expect("options");
    // Frames are dropped when they are no longer needed, as a scan does.
    let told = |placed: Placed| (placed.stamp, placed.world_from_camera, placed.verdict);
    let placed =
        frames.iter().map(|frame| told(tracker.add(frame.clone(), &Silent).expect("told")));
    let placed: Vec<_> = placed.collect();
    let ms = begin.elapsed().as_secs_f64() * 1e3 / frames.len() as f64;
    let pose = |&(stamp, pose, _): &(f64, Option<Pose>, Verdict)| {
        pose.map(|world_from_camera| StampedPose { stamp, world_from_camera })
    };
    let track = CameraTrajectory::new(placed.iter().filter_map(pose).collect()).expect("a track");
    let deltas = vec![Delta::Poses(1), Delta::Poses(30)];
    let judged = OdometryErrorOptions { deltas, ..OdometryErrorOptions::default() };
    let error = odometry_error(&track, truth(sequence), &judged).expect("an error");
    println!(
        "{cut:21} {residuals:18?} RPE {:.2} mm {:.3} deg, 1 s {:.1} mm, ATE {:.2} mm, {ms:.0} ms a frame, \
         {} of {} placed, {} ok",
        error.relative[0].translation.rmse,
        error.relative[0].rotation.rmse.to_degrees(),
        error.relative[1].translation.rmse,
        error.absolute.statistics.rmse,
        track.poses().len(),
        frames.len(),
        placed.iter().filter(|(_, _, verdict)| *verdict == Verdict::Ok).count(),
    );
}

fn gaps(data: &Path) {
    let sequence = open(data, "tum_fr1_rpy_cut");
    let list = std::fs::read_to_string(data.join("pairs/gaps_tum_fr1_rpy_cut.csv")).expect("pairs");
    let options = DenseOptions::default();
    let camera = &sequence.camera.camera;
    let (mut right, mut wrong, mut refused) = (0, 0, 0);
    for line in list.lines().skip(1) {
        let columns: Vec<&str> = line.split(',').collect();
        let [into, from] = [columns[2], columns[3]].map(|name| {
            let is_named = |color: &PathBuf| color.ends_with(name);
            let named = sequence.files.iter().find(|f| f.color.as_ref().is_some_and(is_named));
            let files = named.expect("the frame of the pair");
            let frame = sequence.read(files).expect("a frame");
            let pose = truth(&sequence).at(files.stamp).expect("a true pose");
            (Pyramid::new(&frame, camera, &options).expect("a pyramid"), pose)
        });
        let motion = align_frames(&from.0, &into.0, &Pose::identity(), &options).expect("a motion");
        let off = (into.1.inverse() * from.1).inverse() * motion.next_from_reference;
        let (shift, turn) = (off.translation.vector.norm(), off.rotation.angle().to_degrees());
        let is_right = shift < GAP_SHIFT && turn < GAP_TURN_DEG;
        match (motion.verdict, is_right) {
            (Verdict::Ok, true) => right += 1,
            (Verdict::Ok, false) => wrong += 1,
            _ => refused += 1,
        }
        let reasons: Vec<String> = motion.reasons.iter().map(ToString::to_string).collect();
        println!(
            "{:3}-{:3} {} {:8} {shift:7.1} mm {turn:6.2} deg {}",
            columns[0],
            columns[1],
            if is_right { "right" } else { "WRONG" },
            motion.verdict.to_string(),
            reasons.join("; "),
        );
    }
    println!("gaps: {right} ok and right, {wrong} ok and wrong, {refused} doubtful or failed");
}

/// The Kinect pairs of `pairs/icp.csv`: how far the points of the source end from where they belong, by
/// the truth at the depth's stamps (the list's), at the colour's, and `LATE` before: stamps are given
/// when a picture arrives, not when it is taken.
fn kinect_pairs(data: &Path) {
    let sequence = open(data, "tum_fr1_rpy_cut");
    let list = std::fs::read_to_string(data.join("pairs/icp.csv")).expect("pairs");
    let camera = &sequence.camera.camera;
    for residuals in [Residuals::BrightnessAndDepth, Residuals::Brightness] {
        let options = DenseOptions { residuals, ..DenseOptions::default() };
        for name in list.lines().filter_map(|line| line.split(',').next()) {
            let Some((into, gap)) =
                name.strip_prefix("tum_fr1_rpy_cut-f").and_then(|n| n.split_once('+'))
            else {
                continue;
            };
            let into: usize = into.parse().expect("a number");
            let from = into + gap.parse::<usize>().expect("a number");
            let [(into, a), (from, b)] = [into, from].map(|i| {
                let files = &sequence.files[i];
                (sequence.read(files).expect("a frame"), files)
            });
            let pyramid =
                |frame: &RgbdFrame| Pyramid::new(frame, camera, &options).expect("a pyramid");
            let motion =
                align_frames(&pyramid(&from), &pyramid(&into), &Pose::identity(), &options)
                    .expect("a motion");
            let cloud = from.cloud(camera).expect("a cloud");
            let points = cloud.to_sparse_cloud(2).points;
            let off = |truth: Pose| {
                let sum: f64 = points
                    .iter()
                    .map(|p| (truth * p - motion.next_from_reference * p).norm_squared())
                    .sum();
                (sum / points.len() as f64).sqrt()
            };
            let at = |s| truth(&sequence).at(s).expect("a pose");
            println!(
                "{name:23} {residuals:18?} {:5.1} mm, by the colour's stamps {:5.1}, {LATE} s before {:5.1}, {}",
                off(at(a.depth_stamp).inverse() * at(b.depth_stamp)),
                off(at(a.stamp).inverse() * at(b.stamp)),
                off(at(a.stamp - LATE).inverse() * at(b.stamp - LATE)),
                motion.verdict,
            );
        }
    }
}
