//! A cloud in, fewer points that say the same out.

use crate::geom::{CloudParts, PointCloud};
use crate::progress::Progress;
use crate::represent::gng::{GngError, GngOptions, LearnedOn, NeuronGraph, Stopped, grow};
use crate::represent::octree::{Octree, OctreeCell};
use crate::represent::voxel::{CellSize, Reached, ReduceError, Rule, voxel_grid};
use crate::represent::{MeanError, MeanErrorError, PolishOptions, mean_error, polish};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// What stands for a cloud.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct ReduceOptions {
    /// What stands for the cloud.
    #[arg(long, value_name = "METHOD", default_value = "voxel")]
    pub method: Method,
    /// As many points as this: for cells their size is looked for.
    #[arg(long, value_name = "N", conflicts_with = "size")]
    pub count: Option<u64>,
    /// Side of the cells [mm].
    #[arg(long, value_name = "MM")]
    pub size: Option<f64>,
    /// Which point stands for a cell [default: centroid; octree: centre].
    #[arg(long, value_name = "RULE")]
    pub rule: Option<Rule>,
    /// Write the cells of this level of the octree; the root is level 0 [default: the leaves].
    #[arg(long, value_name = "N")]
    pub level: Option<usize>,
}

/// What stands for a cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// A point for each cell of a grid.
    Voxel,
    /// The same, with all coarser levels.
    Octree,
    /// The neurons of a growing neural gas: nearest to the cloud for their number.
    Gng,
}

impl Default for ReduceOptions {
    fn default() -> Self {
        Self { method: Method::Voxel, count: None, size: None, rule: None, level: None }
    }
}

/// A cloud to be reduced.
pub struct ReduceJob<'a> {
    /// The cloud.
    pub parts: &'a mut dyn CloudParts,
    /// What is to stand for it.
    pub options: &'a ReduceOptions,
    /// How a network learns.
    pub gng: &'a GngOptions,
    /// What is done to the points at last.
    pub polish: &'a PolishOptions,
    /// A network to grow on.
    pub begin: Option<&'a NeuronGraph>,
}

/// What stands for the cloud.
#[derive(Debug, Clone, PartialEq)]
pub enum Reduced {
    /// Points.
    Cloud(PointCloud),
    /// Points and what joins them.
    Network(NeuronGraph),
}

impl Reduced {
    /// The points.
    pub fn cloud(&self) -> &PointCloud {
        match self {
            Self::Cloud(cloud) => cloud,
            Self::Network(graph) => &graph.neurons,
        }
    }
}

/// How reducing went, as numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ReduceReport {
    /// What stands for the cloud.
    pub method: Method,
    /// Points of the cloud.
    pub n_points: u64,
    /// Points that stand for it.
    pub n_representatives: usize,
    /// Side of the cells [mm].
    pub cell: Option<f64>,
    /// Whether the count asked for was reached.
    pub reached: Option<Reached>,
    /// Levels of the octree below its root, and that which was taken.
    pub levels: Option<[usize; 2]>,
    /// How a network learned.
    pub learned: Option<LearnedReport>,
    /// Time all that took, without reading and measuring [s].
    pub seconds: f64,
    /// How far the cloud is from the points [mm].
    pub error: MeanError,
}

/// How a network learned, as numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LearnedReport {
    /// Edges of the network.
    pub n_edges: usize,
    /// Their mean length [mm].
    pub mean_edge: Option<f64>,
    /// Signals it learned from.
    pub n_signals: u64,
    /// Why it stopped.
    pub stopped: Stopped,
    /// Where it learned.
    pub on: LearnedOn,
    /// Time a signal took [ns].
    pub ns_per_signal: f64,
}

/// Why a cloud could not be reduced.
#[derive(Debug, thiserror::Error)]
pub enum ReduceJobError {
    /// Neither count nor size.
    #[error("nothing says how many points there are to be; give --count N or --size MM")]
    NoSize,
    /// An option of another method.
    #[error("{option} is not for --method {method}; leave it out{instead}")]
    NotFor {
        /// The option.
        option: &'static str,
        /// The method asked for.
        method: &'static str,
        /// What may be meant.
        instead: &'static str,
    },
    /// A level that is not there.
    #[error("the octree has levels 0 to {depth}; --level {level} is none of them")]
    NoLevel {
        /// The level asked for.
        level: usize,
        /// The level of the leaves.
        depth: usize,
    },
    /// Cells.
    #[error(transparent)]
    Cells(#[from] ReduceError),
    /// A network.
    #[error(transparent)]
    Gng(#[from] GngError),
    /// What was measured.
    #[error(transparent)]
    Error(#[from] MeanErrorError),
}

/// Reduces the cloud and measures what stands for it.
pub fn reduce(
    job: ReduceJob<'_>,
    progress: &dyn Progress,
) -> Result<(Reduced, ReduceReport), ReduceJobError> {
    job.check()?;
    let ReduceJob { parts, options, gng, polish: finish, begin } = job;
    let n_points = parts.n_points();
    let begun = Instant::now();
    let mut found = match options.method {
        Method::Voxel => by_voxels(parts, options, progress)?,
        Method::Octree => by_octree(parts, options, progress)?,
        Method::Gng => by_gng(parts, begin, options, gng, progress)?,
    };
    let mut seconds = begun.elapsed().as_secs_f64();
    let cloud = match &mut found.reduced {
        Reduced::Cloud(cloud) => cloud,
        Reduced::Network(graph) => &mut graph.neurons,
    };
    // Cells have the means of their points already.
    let error = if options.method == Method::Gng || 0 < finish.sweeps {
        let begun = Instant::now();
        let error = polish(cloud, parts, finish, progress).map_err(MeanErrorError::from)?;
        seconds += if 0 < finish.sweeps { begun.elapsed().as_secs_f64() } else { 0.0 };
        error.ok_or(MeanErrorError::NoPoints)?
    } else {
        mean_error(&cloud.points, parts, progress)?
    };
    let report = ReduceReport {
        method: options.method,
        n_points,
        n_representatives: cloud.points.len(),
        cell: found.cell,
        reached: found.reached,
        levels: found.levels,
        learned: found.learned,
        seconds,
        error,
    };
    Ok((found.reduced, report))
}

struct Found {
    reduced: Reduced,
    cell: Option<f64>,
    reached: Option<Reached>,
    levels: Option<[usize; 2]>,
    learned: Option<LearnedReport>,
}

fn by_voxels(
    parts: &mut dyn CloudParts,
    options: &ReduceOptions,
    progress: &dyn Progress,
) -> Result<Found, ReduceJobError> {
    let rule = options.rule.unwrap_or(Rule::Centroid);
    let voxels = voxel_grid(parts, options.cell_size()?, rule, progress)?;
    Ok(Found {
        reduced: Reduced::Cloud(voxels.cloud),
        cell: Some(voxels.cells.side),
        reached: voxels.reached,
        levels: None,
        learned: None,
    })
}

fn by_octree(
    parts: &mut dyn CloudParts,
    options: &ReduceOptions,
    progress: &dyn Progress,
) -> Result<Found, ReduceJobError> {
    let octree = Octree::build(parts, options.cell_size()?, progress)?;
    let depth = octree.depth();
    let level = options.level.unwrap_or(depth);
    let Some(cell) = octree.level(level).next().map(|cell| cell.side) else {
        return Err(ReduceJobError::NoLevel { level, depth });
    };
    let at = |cell: OctreeCell| match options.rule {
        Some(Rule::Centroid) => cell.mean,
        _ => cell.middle,
    };
    Ok(Found {
        reduced: Reduced::Cloud(octree.to_cloud(level, at)),
        cell: Some(cell),
        reached: octree.reached.filter(|_| level == depth),
        levels: Some([depth, level]),
        learned: None,
    })
}

fn by_gng(
    parts: &mut dyn CloudParts,
    begin: Option<&NeuronGraph>,
    options: &ReduceOptions,
    gng: &GngOptions,
    progress: &dyn Progress,
) -> Result<Found, ReduceJobError> {
    let count = options.count.map(|count| usize::try_from(count).unwrap_or(usize::MAX));
    let begun = Instant::now();
    let grown = grow(parts, begin, count, gng, progress)?;
    let learned = LearnedReport {
        n_edges: grown.graph.edges.len(),
        mean_edge: grown.graph.mean_edge(),
        n_signals: grown.n_signals,
        stopped: grown.stopped,
        on: grown.learned_on,
        ns_per_signal: begun.elapsed().as_nanos() as f64 / grown.n_signals.max(1) as f64,
    };
    Ok(Found {
        reduced: Reduced::Network(grown.graph),
        cell: None,
        reached: None,
        levels: None,
        learned: Some(learned),
    })
}

impl ReduceOptions {
    fn cell_size(&self) -> Result<CellSize, ReduceJobError> {
        match (self.size, self.count) {
            (Some(side), _) => Ok(CellSize::Side(side)),
            (None, Some(count)) => Ok(CellSize::Count(count)),
            (None, None) => Err(ReduceJobError::NoSize),
        }
    }
}

impl ReduceJob<'_> {
    /// Refuses options of other methods.
    fn check(&self) -> Result<(), ReduceJobError> {
        let options = self.options;
        let is_gng = options.method == Method::Gng;
        let is_octree = options.method == Method::Octree;
        let is_of_points = matches!(options.rule, Some(Rule::Nearest | Rule::Median));
        let wrong = [
            (
                is_gng && options.size.is_some(),
                "--size",
                "; a network takes --count or --target-error",
            ),
            (is_gng && options.rule.is_some(), "--rule", "; a network takes --polish-to"),
            (!is_octree && options.level.is_some(), "--level", "; only an octree has levels"),
            (
                is_octree && is_of_points,
                "--rule nearest or median",
                "; voxels of the same size take it",
            ),
            (!is_gng && self.begin.is_some(), "--from", "; only a network grows on"),
            (
                !is_gng && *self.gng != GngOptions::default(),
                "what a network learns by (--preset to --target-error)",
                ", or give --method gng",
            ),
        ];
        let method = match options.method {
            Method::Voxel => "voxel",
            Method::Octree => "octree",
            Method::Gng => "gng",
        };
        match wrong.into_iter().find(|(is_wrong, _, _)| *is_wrong) {
            Some((_, option, instead)) => Err(ReduceJobError::NotFor { option, method, instead }),
            None => Ok(()),
        }
    }
}
