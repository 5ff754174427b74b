//! What is timed: the thesis' loop, our kernels, and our searches by a tree.

use crate::lathe::{RADII, Spiral};
use crate::scan::{Scan, Step, WideScan};
use horma::cam::{Device, Digitizer, Method, Part};
use horma::compute::{Gpu, Precision};
use horma::geom::PointCloud;
use horma::progress::Silent;
use horma::tool::Profile;
use std::time::{Duration, Instant};

/// A contender is run again until it took this long; the best of its runs counts.
const LONG_ENOUGH: Duration = Duration::from_millis(600);
const MOST_RUNS: usize = 5;
/// No wheel comes down so far.
const NOTHING: f64 = -1e30;

/// A surface of points and a way around it, for all contenders.
pub(crate) struct Task {
    scan_f32: Scan<f32>,
    scan_f64: Scan<f64>,
    scan_wide: WideScan,
    part: Part,
    steps: Vec<Step>,
    spiral: Spiral,
}

/// A way to compute all heights of a task.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Contender<'a> {
    /// The thesis' loop in `f32`, one thread.
    CpuSingle,
    /// The same in `f64`.
    CpuDouble,
    /// The same in `f32`, sixteen points side by side.
    CpuWide,
    /// Our search by a tree, one thread.
    CpuTree,
    /// The kernel that tries every point.
    Scan(&'a Gpu, Precision),
    /// The kernel that searches by a tree.
    Tree(&'a Gpu),
}

impl Task {
    pub(crate) fn new(cloud: &PointCloud, spiral: Spiral) -> Self {
        let points: Vec<[f64; 3]> = cloud.points.iter().map(|&point| point.into()).collect();
        Self {
            scan_f32: Scan::new(&points, RADII),
            scan_f64: Scan::new(&points, RADII),
            scan_wide: WideScan::new(&points, RADII),
            part: Part::points(cloud),
            steps: (0..spiral.n).map(|i| spiral.step(i)).collect(),
            spiral,
        }
    }

    /// Seconds each contender needs, the best of its runs. They take turns.
    pub(crate) fn race(&self, contenders: &[Contender]) -> anyhow::Result<Vec<f64>> {
        let mut best = vec![f64::INFINITY; contenders.len()];
        let mut taken = vec![Duration::ZERO; contenders.len()];
        for contender in contenders {
            // Kernels are compiled for their first run.
            if let Contender::Scan(..) | Contender::Tree(_) = contender {
                self.heights(contender, 1)?;
            }
        }
        for _ in 0..MOST_RUNS {
            for ((contender, best), taken) in contenders.iter().zip(&mut best).zip(&mut taken) {
                if *taken < LONG_ENOUGH {
                    let started = Instant::now();
                    self.heights(contender, self.steps.len())?;
                    let time = started.elapsed();
                    *taken += time;
                    *best = best.min(time.as_secs_f64());
                }
            }
        }
        Ok(best)
    }

    /// How far the thesis' loop in `f32` is from itself in `f64` at most [mm], over every 32nd step.
    pub(crate) fn off(&self) -> f64 {
        let steps: Vec<Step> = self.steps.iter().copied().step_by(32).collect();
        let (single, double) = (self.scan_f32.heights(&steps), self.scan_f64.heights(&steps));
        let both = single.into_iter().map(f64::from).zip(double);
        let met = both.filter(|(a, b)| NOTHING < *a && NOTHING < *b);
        met.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// The heights of the first `n` steps; below [`NOTHING`] where the wheel meets nothing.
    pub(crate) fn heights(&self, contender: &Contender, n: usize) -> anyhow::Result<Vec<f64>> {
        let digitizer = |method| {
            let [major_radius, minor_radius] = RADII;
            let cutter = Profile::Wheel { major_radius, minor_radius }.cutter(0.0);
            Digitizer { part: &self.part, cutter, method }
        };
        let on_device = |gpu, precision, method| {
            let device = Device { precision, ..Device::new(gpu) };
            digitizer(method).run_on_gpu(&device, n, |i| self.spiral.pose(i), &Silent)
        };
        let contacts = match contender {
            Contender::CpuSingle => {
                return Ok(widened(one_thread(|| self.scan_f32.heights(&self.steps[..n]))?));
            }
            Contender::CpuWide => {
                return Ok(widened(one_thread(|| self.scan_wide.heights(&self.steps[..n]))?));
            }
            Contender::CpuDouble => return one_thread(|| self.scan_f64.heights(&self.steps[..n])),
            Contender::CpuTree => {
                one_thread(|| digitizer(Method::Indexed).run(n, |i| self.spiral.pose(i), &Silent))??
            }
            Contender::Scan(gpu, precision) => {
                on_device(gpu, *precision, Method::Exhaustive)?.contacts
            }
            Contender::Tree(gpu) => on_device(gpu, Precision::Single, Method::Indexed)?.contacts,
        };
        Ok(contacts.into_iter().map(|c| c.map_or(f64::MIN, |contact| contact.height)).collect())
    }
}

impl<'a> Contender<'a> {
    /// Those of the thesis' charts and ours beside them, as far as the device goes.
    pub(crate) fn all(gpu: Option<&'a Gpu>) -> Vec<Self> {
        let mut all = vec![Self::CpuSingle, Self::CpuDouble, Self::CpuWide];
        if let Some(gpu) = gpu {
            let precisions = [Precision::Single, Precision::Double].into_iter();
            all.extend(precisions.filter(|&p| gpu.has(p)).map(|p| Self::Scan(gpu, p)));
        }
        all.push(Self::CpuTree);
        all.extend(gpu.map(Self::Tree));
        all
    }

    /// What the thesis calls it, or would.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::CpuSingle => "CPU SP",
            Self::CpuDouble => "CPU DP",
            Self::CpuWide => "CPU wide",
            Self::CpuTree => "CPU tree",
            Self::Scan(_, Precision::Single) => "GPU SP",
            Self::Scan(_, Precision::Double) => "GPU DP",
            Self::Tree(_) => "GPU tree",
        }
    }
}

/// What `work` gives on one thread, as the thesis' processor had it.
fn one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> anyhow::Result<T> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(work))
}

fn widened(heights: Vec<f32>) -> Vec<f64> {
    heights.into_iter().map(f64::from).collect()
}
