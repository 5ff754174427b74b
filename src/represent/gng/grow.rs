//! A cloud in, a network out.

use super::error::GngError;
use super::gpu::{OnDevice, learn_on_device, ns_per_signal};
use super::graph::NeuronGraph;
use super::learn::{Lesson, Stopped, learn};
use super::network::{Network, Place};
use super::options::{GngOptions, Search};
use super::signals::{Signals, place};
use super::winners::{Grid, Nobody, Scan};
use crate::compute::{ComputeChoice, Gpu};
use crate::geom::{Aabb, CloudParts, PointCloud, Vector3, box_of_parts};
use crate::progress::Progress;
use serde::Serialize;
use std::time::Instant;

/// What growing led to.
#[derive(Debug, Clone, PartialEq)]
pub struct Grown {
    /// The network; its neurons have neither normals nor colours yet.
    pub graph: NeuronGraph,
    /// How many signals it learned from.
    pub n_signals: u64,
    /// Why it no longer grows.
    pub stopped: Stopped,
    /// Where it learned: the processor first, and a device from so many neurons on.
    pub learned_on: LearnedOn,
}

/// Where a network learned.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LearnedOn {
    /// The processor.
    Cpu {
        /// Why, where the choice was left open.
        why: Option<String>,
    },
    /// A device.
    Device {
        /// What it is called.
        name: String,
        /// How many neurons the network had when it went there.
        n_neurons: usize,
    },
}

/// Grows a network over a cloud, from two neurons or from `begin`, to `n_neurons` or until the options stop it.
pub fn grow(
    parts: &mut dyn CloudParts,
    begin: Option<&NeuronGraph>,
    n_neurons: Option<usize>,
    options: &GngOptions,
    progress: &dyn Progress,
) -> Result<Grown, GngError> {
    options.check()?;
    check_count(parts.n_points(), n_neurons, options)?;
    let aabb = box_of_parts(parts)?;
    if aabb.size().max() == 0.0 {
        return Ok(in_one_place(&aabb));
    }
    let origin = aabb.center();
    let mut signals = Signals::new(parts, &aabb, options.seed)?;
    let network = if let Some(graph) = begin {
        Network::of_graph(graph, &origin)?
    } else {
        let mut first = [[0.0; 3]; 2];
        signals.fill(&mut first)?;
        Network::of_two(first)
    };
    let n_neurons = n_neurons.unwrap_or(usize::MAX);
    let n_more = n_neurons.saturating_sub(network.neurons.len()).min(u32::MAX as usize);
    progress.start("growing", n_more as u64);
    let lesson = Lesson::new(signals, options);
    let mut growth = Growth { network, corners: corners(&aabb), lesson, progress };
    let (stopped, learned_on) = match options.compute {
        ComputeChoice::Cpu => (growth.on_cpu(n_neurons)?, LearnedOn::Cpu { why: None }),
        ComputeChoice::Gpu => {
            let gpu = Gpu::open(options.adapter.as_deref())?;
            let learned_on = growth.named(&gpu);
            (growth.on_device(&gpu, n_neurons)?, learned_on)
        }
        ComputeChoice::Auto => match Gpu::open(options.adapter.as_deref()) {
            Ok(gpu) => growth.where_faster(&gpu, n_neurons)?,
            Err(error) => {
                (growth.on_cpu(n_neurons)?, LearnedOn::Cpu { why: Some(error.to_string()) })
            }
        },
    };
    let n_signals = growth.lesson.course.n_signals;
    Ok(Grown { graph: growth.network.to_graph(&origin), n_signals, stopped, learned_on })
}

/// With fewer neurons than this it takes less to try them all.
const FEW: usize = 512;
/// Neurons from which on it is worth asking where a signal takes less.
const FIRST_ASKED: usize = 1024;
/// Signals tried on the device.
const TRIED: usize = 256;

/// A network as it grows.
struct Growth<'a> {
    network: Network,
    /// Lowest and highest corner of the cloud.
    corners: [Place; 2],
    lesson: Lesson<'a>,
    progress: &'a dyn Progress,
}

impl Growth<'_> {
    fn on_cpu(&mut self, n_neurons: usize) -> Result<Stopped, GngError> {
        let n_by_scan = match self.lesson.options.search {
            Search::Scan => n_neurons,
            Search::Grid => n_neurons.min(FEW),
        };
        if self.network.neurons.len() < n_by_scan || n_by_scan == n_neurons {
            let stopped = self.by_scan(n_by_scan)?;
            if stopped != Stopped::Count || n_by_scan == n_neurons {
                return Ok(stopped);
            }
            self.insert()?;
        }
        let Self { network, lesson, progress, corners: [low, high] } = self;
        let mut winners = Grid::over(*low, *high, &network.neurons);
        learn(network, &mut winners, lesson, n_neurons, *progress)
    }

    fn by_scan(&mut self, n_neurons: usize) -> Result<Stopped, GngError> {
        let Self { network, lesson, progress, .. } = self;
        let mut winners = Scan::over(&network.neurons);
        learn(network, &mut winners, lesson, n_neurons, *progress)
    }

    /// The neuron that is due when a network goes on elsewhere.
    fn insert(&mut self) -> Result<(), GngError> {
        self.network.insert(&self.lesson.rates, &mut Nobody);
        Ok(self.progress.advance(1)?)
    }

    fn on_device(&mut self, gpu: &Gpu, n_neurons: usize) -> Result<Stopped, GngError> {
        let Self { network, lesson, progress, .. } = self;
        if lesson.options.batch.is_some() {
            let mut winners = OnDevice::over(gpu, &network.neurons);
            learn(network, &mut winners, lesson, n_neurons, *progress)
        } else {
            learn_on_device(network, gpu, lesson, n_neurons, *progress)
        }
    }

    /// On the processor as long as a signal takes less there; asked whenever there are twice as many neurons.
    /// Morell (2014), section 4.3.2.4.
    fn where_faster(
        &mut self,
        gpu: &Gpu,
        n_neurons: usize,
    ) -> Result<(Stopped, LearnedOn), GngError> {
        let mut next = FIRST_ASKED.max(2 * self.network.neurons.len());
        let mut why = format!("fewer than {next} neurons: {} was not asked", gpu.name());
        loop {
            let (begin, n_before) = (Instant::now(), self.lesson.course.n_signals);
            let stopped = self.on_cpu(n_neurons.min(next))?;
            if stopped != Stopped::Count || n_neurons <= next {
                return Ok((stopped, LearnedOn::Cpu { why: Some(why) }));
            }
            let n_signals = self.lesson.course.n_signals - n_before;
            let on_cpu = begin.elapsed().as_nanos() as f64 / n_signals as f64;
            // Not signals that are drawn: the network shall be the same if it stays.
            let tried: Vec<Place> = self.network.neurons.iter().take(TRIED).map(|n| n.at).collect();
            let on_device = ns_per_signal(&self.network, gpu, self.lesson.rates, &tried);
            self.insert()?;
            match on_device {
                Ok(on_device) if on_device < on_cpu => {
                    let learned_on = self.named(gpu);
                    return Ok((self.on_device(gpu, n_neurons)?, learned_on));
                }
                Ok(on_device) => {
                    why = format!(
                        "with {next} neurons a signal took {on_cpu:.0} ns, on {} {on_device:.0} ns",
                        gpu.name()
                    );
                    next *= 2;
                }
                Err(error) => {
                    let why = Some(error.to_string());
                    return Ok((self.on_cpu(n_neurons)?, LearnedOn::Cpu { why }));
                }
            }
        }
    }

    fn named(&self, gpu: &Gpu) -> LearnedOn {
        let n_neurons = self.network.neurons.len();
        LearnedOn::Device { name: gpu.name().to_owned(), n_neurons }
    }
}

fn check_count(
    n_points: u64,
    n_neurons: Option<usize>,
    options: &GngOptions,
) -> Result<(), GngError> {
    let GngOptions { max_signals, max_seconds, target_error, .. } = options;
    let is_endless = max_signals.is_none() && max_seconds.is_none() && target_error.is_none();
    match n_neurons {
        _ if n_points == 0 => Err(GngError::Empty),
        None if is_endless => Err(GngError::Endless),
        Some(n_neurons) if n_neurons < 2 && 1 < n_points => Err(GngError::TooFew { n_neurons }),
        Some(n_neurons) if n_points < n_neurons as u64 => {
            Err(GngError::TooMany { n_neurons, n_points })
        }
        _ => Ok(()),
    }
}

/// The lowest and the highest corner, from the middle.
fn corners(aabb: &Aabb) -> [[f32; 3]; 2] {
    let half: Vector3 = aabb.size() / 2.0;
    let middle = aabb.center();
    [middle - half, middle + half].map(|corner| place(&corner, &middle))
}

/// All points in one place: one neuron says it all.
fn in_one_place(aabb: &Aabb) -> Grown {
    let neurons = PointCloud { points: vec![aabb.center()], ..PointCloud::default() };
    let graph = NeuronGraph { neurons, edges: Vec::new(), errors: vec![0.0] };
    Grown {
        graph,
        n_signals: 0,
        stopped: Stopped::OnePlace,
        learned_on: LearnedOn::Cpu { why: None },
    }
}
