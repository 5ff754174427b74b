//! Frames of a depth camera made one surface: how well and how fast.
//! `HORMA_DATA=... cargo bench --bench fuse [-- WORDS]`; with words, only parts whose names hold one of
//! them (truth, tracked, last). On two threads. Reading is not timed.

use horma::compute::Compute;
use horma::geom::{distances_from_mesh, shapes};
use horma::io::rgbd::{DepthCamera, Sequence, open_sequence};
use horma::progress::Silent;
use horma::register::tsdf::{Model, Readings, TsdfOptions};
use horma::register::{OdometryErrorOptions, odometry_error};
use horma::rgbd::simulated::{NoiseKind, SimulationOptions};
use horma::rgbd::{Camera, CameraTrajectory, RgbdFrame, SequenceError};
use horma::workflow::fuse::{FuseJob, FuseOptions, Placing, fuse};
use horma::workflow::simulate_scan::{SimulateScanJob, Subject, simulate_scan};
use std::path::PathBuf;
use std::time::Instant;

const CUTS: [&str; 2] = ["tum_fr1_rpy_cut", "tum_fr1_rpy_fast_cut"];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let wanted =
        |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word.as_str()));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool");
    let data = std::env::var_os("HORMA_DATA").map(PathBuf::from);
    for cut in CUTS {
        let Some(data) = &data else {
            eprintln!("HORMA_DATA is not set: {cut} is left out");
            continue;
        };
        let folder = data.join("rgbd").join(cut);
        let sequence = open_sequence(&folder, Some(DepthCamera::FREIBURG1)).expect("the sequence");
        let frames: Vec<RgbdFrame> = sequence.frames().map(|f| f.expect("a frame")).collect();
        if wanted("truth") {
            pool.install(|| with_truth(cut, &sequence, &frames));
        }
        if wanted("tracked") {
            pool.install(|| tracked(cut, &sequence, &frames));
        }
    }
    if wanted("last") {
        pool.install(last);
    }
}

fn given(frames: &[RgbdFrame]) -> impl ExactSizeIterator<Item = Result<RgbdFrame, SequenceError>> {
    frames.iter().cloned().map(Ok)
}

fn stamps(sequence: &Sequence) -> Vec<f64> {
    sequence.files.iter().map(|files| files.depth_stamp).collect()
}

fn options(voxel: f64) -> FuseOptions {
    let mut options = FuseOptions::default();
    options.volume.voxel = voxel;
    options
}

/// How long before its stamp a frame was taken: as the stamps have it, and as it seems to be [s].
const DELAYS: [f64; 2] = [0.0, 0.025];
/// Farther away a Kinect is good for little.
const MAX_DEPTH: f64 = 3000.0;

/// Every fifth frame kept out, and the time of all of them.
fn with_truth(cut: &str, sequence: &Sequence, frames: &[RgbdFrame]) {
    let truth = sequence.truth.clone().expect("truth");
    let mut options = FuseOptions { keep_out: Some(5), ..options(10.0) };
    options.volume.max_depth = MAX_DEPTH;
    for pose_delay in DELAYS {
        let options = FuseOptions { pose_delay, ..options.clone() };
        let job = FuseJob {
            frames: given(frames),
            stamps: stamps(sequence),
            camera: sequence.camera.camera,
            placing: Placing::Along(truth.clone()),
            truth: None,
            notes: Vec::new(),
            options: &options,
        };
        let report = fuse(job, &Silent).expect("a surface").report;
        println!("{cut} truth, {pose_delay} s before the stamps: {:?}", report.kept_out);
    }
    let on_gpu = Compute::gpu(None).inspect_err(|error| eprintln!("left out: {error}")).ok();
    for compute in [Some(Compute::Cpu), on_gpu].into_iter().flatten() {
        timed(cut, sequence, frames, (&truth, &options.volume), &compute);
    }
}

/// Integration, and casts of half the size as tracking has them.
fn timed(
    cut: &str,
    sequence: &Sequence,
    frames: &[RgbdFrame],
    (truth, options): (&CameraTrajectory, &TsdfOptions),
    compute: &Compute,
) {
    let mut model = Model::new(options, compute).expect("a model");
    let camera = sequence.camera.camera;
    let mut each: [Vec<f64>; 3] = Default::default();
    for (frame, stamp) in frames.iter().zip(stamps(sequence)) {
        let Some(pose) = truth.at(stamp) else { continue };
        let mut begin = Instant::now();
        let mut lap = |times: &mut Vec<f64>| {
            times.push(begin.elapsed().as_secs_f64() * 1e3);
            begin = Instant::now();
        };
        let readings = Readings::new(frame, &camera, options).expect("readings");
        lap(&mut each[0]);
        model.integrate(&readings, &pose).expect("room");
        lap(&mut each[1]);
        model.cast(&camera.halved(), &pose).expect("a view");
        lap(&mut each[2]);
    }
    let [readings, fused, cast] = each.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    let begin = Instant::now();
    let mesh = model.mesh().expect("a mesh");
    println!(
        "{cut} on {}: median {:.1} ms to fuse (readings {readings:.1}, blocks {fused:.1}), {cast:.1} ms to cast; \
         {} blocks; surface {:.0} ms for {} vertices",
        compute.name(),
        readings + fused,
        model.n_blocks(),
        begin.elapsed().as_secs_f64() * 1e3,
        mesh.points.len()
    );
}

fn tracked(cut: &str, sequence: &Sequence, frames: &[RgbdFrame]) {
    let options = options(10.0);
    let job = FuseJob {
        frames: given(frames),
        stamps: stamps(sequence),
        camera: sequence.camera.camera,
        placing: Placing::Tracked,
        truth: None,
        notes: Vec::new(),
        options: &options,
    };
    let begin = Instant::now();
    let fused = fuse(job, &Silent).expect("a surface");
    let ms = begin.elapsed().as_secs_f64() * 1e3 / frames.len() as f64;
    let truth = sequence.truth.clone().expect("truth");
    let error = odometry_error(&fused.trajectory, &truth, &OdometryErrorOptions::default())
        .expect("common stamps");
    println!(
        "{cut} tracked: ATE {:.1} mm, {} of {} frames, {ms:.0} ms each; RPE {:?}",
        error.absolute.statistics.rmse,
        fused.report.n_fused,
        fused.report.n_frames,
        error
            .relative
            .iter()
            .map(|r| [r.translation.rmse, r.rotation.rmse.to_degrees()])
            .collect::<Vec<_>>()
    );
    for skipped in &fused.report.skipped {
        println!("  frame {}: {}", skipped.number, skipped.reason);
    }
}

/// The demo's last on a turntable: two turns of 72 views from 35 degrees above and below, noise of 1 mm
/// at 0.8 m.
fn last() {
    let mesh = shapes::last(&shapes::LastParameters::default()).expect("a last");
    for (noise, options) in [
        (NoiseKind::Gaussian, options(2.0)),
        (NoiseKind::Kinect, options(2.0)),
        (NoiseKind::None, options(2.0)),
    ] {
        let simulation = SimulationOptions {
            noise,
            views: 72,
            elevations: vec![35.0, -35.0],
            ..SimulationOptions::default()
        };
        let subject = Subject::Mesh(mesh.clone());
        let job =
            SimulateScanJob { subject, camera: Camera::KINECT, along: None, options: &simulation };
        let scan = simulate_scan(job).expect("a scan");
        let stamps = scan.truth.stamps();
        let frames: Vec<RgbdFrame> = scan.frames().collect();
        let job = FuseJob {
            frames: given(&frames),
            stamps,
            camera: Camera::KINECT,
            placing: Placing::Along(scan.truth.clone()),
            truth: None,
            notes: Vec::new(),
            options: &options,
        };
        let begin = Instant::now();
        let fused = fuse(job, &Silent).expect("a surface");
        let ms = begin.elapsed().as_secs_f64() * 1e3 / frames.len() as f64;
        let mut off = distances_from_mesh(&mesh, &fused.mesh.points);
        off.sort_by(f64::total_cmp);
        let at = |share: f64| off[((off.len() - 1) as f64 * share) as usize];
        println!(
            "last, {noise:?}: {ms:.0} ms a frame, median {:.3} mm, 90 % {:.3}, 99 % {:.3}, most {:.2}; {:?}",
            at(0.5),
            at(0.9),
            at(0.99),
            at(1.0),
            fused.report.mesh
        );
    }
}
