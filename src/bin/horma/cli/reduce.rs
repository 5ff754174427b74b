//! `horma reduce`: fewer points that say the same.

use super::Shell;
use super::mean_error::error_text;
use crate::bar::Bar;
use anyhow::Context;
use clap::Args;
use horma::geom::{CloudParts, LengthUnit, PointCloud, Surface};
use horma::io::{self, CloudFile, OutputSet, Overwrite};
use horma::represent::PolishOptions;
use horma::represent::gng::{GngOptions, LearnedOn, NeuronGraph, Stopped};
use horma::workflow::reduce::{ReduceJob, ReduceOptions, ReduceReport, Reduced, reduce};
use std::path::{Path, PathBuf};

/// Let fewer points stand for a cloud: those of a voxel grid, of an octree, or the neurons of a growing
/// neural gas.
///
/// A voxel grid takes milliseconds. A network takes microseconds for each of the thousand signals a neuron
/// needs, and then lies a tenth to a third nearer to the cloud; its edges say what hangs together, and `horma
/// mesh` makes a surface of it. A PLY of more than 33 million points is read again for each pass and never
/// held in memory.
#[derive(Debug, Args)]
#[command(after_help = "For example:
  horma reduce scan.ply --size 0.5 -o thin.ply
  horma reduce scan.ply --method octree --count 20000 -o middles.ply
  horma reduce scan.ply --method gng --count 20000 --polish 5 -o net.ply
  horma reduce scan.ply --method gng --from net.ply --count 30000 -o larger.ply
  horma reduce scan.ply --method gng --target-error 0.2 -o net.glb --json")]
pub(crate) struct ReduceArgs {
    /// The cloud: PLY, PCD, OBJ, STL, glTF/GLB or a list of points.
    cloud: PathBuf,
    /// What to write: .ply keeps the edges of a network, .glb shows them; .obj, .xyz, .csv hold points.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Let this network, a PLY that this command wrote, grow on.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// The unit of the cloud [default: what it declares, else by its extent].
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
    /// Replace the output if it is there already.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    options: ReduceOptions,
    #[command(flatten)]
    polish: PolishOptions,
    #[command(flatten, next_help_heading = "Growing neural gas")]
    gng: GngOptions,
}

/// Reads, reduces, writes and tells.
pub(crate) fn run(args: &ReduceArgs, shell: &Shell) -> anyhow::Result<()> {
    args.gng.check()?;
    args.try_output()?;
    let begin = args.from.as_deref().map(read_begin).transpose()?;
    let mut file = io::open_cloud(&args.cloud, args.units)?;
    let bar = shell.progress();
    let job = ReduceJob {
        parts: &mut file,
        options: &args.options,
        gng: &args.gng,
        polish: &args.polish,
        begin: begin.as_ref(),
    };
    let (reduced, numbers) =
        reduce(job, &bar).with_context(|| format!("while reducing {}", args.cloud.display()))?;
    args.write(&reduced, &bar)?;
    drop(bar);
    let report = Report { notes: notes(&file), numbers, output: &args.output };
    shell.report(&report, &report.text())
}

impl ReduceArgs {
    /// Refuses an output that cannot be written before the work begins.
    fn try_output(&self) -> anyhow::Result<()> {
        let mut trial = OutputSet::new(self.overwrite());
        Ok(trial.add_surface(&self.output, &Surface::Points(PointCloud::default()))?)
    }

    fn write(&self, reduced: &Reduced, bar: &Bar) -> anyhow::Result<()> {
        let mut files = OutputSet::new(self.overwrite());
        match reduced {
            Reduced::Cloud(cloud) => {
                files.add_surface(&self.output, &Surface::Points(cloud.clone()))?;
            }
            Reduced::Network(graph) => files.add_network(&self.output, graph)?,
        }
        bar.stop_if_asked()?;
        Ok(files.commit()?)
    }

    fn overwrite(&self) -> Overwrite {
        if self.force { Overwrite::Replace } else { Overwrite::Refuse }
    }
}

/// The network to grow on.
fn read_begin(path: &Path) -> anyhow::Result<NeuronGraph> {
    io::read_network(path, None)?.with_context(|| {
        format!(
            "{} is no network: it has no edges; give a PLY that `horma reduce --method gng` wrote",
            path.display()
        )
    })
}

/// What was read, and what is doubtful about it.
pub(super) fn notes(file: &CloudFile) -> Vec<String> {
    let read = format!(
        "{} points, {}, units {}, {}",
        file.n_points(),
        file.format,
        file.unit,
        file.unit_from
    );
    std::iter::once(read).chain(file.notes.iter().cloned()).collect()
}

/// What the JSON holds.
#[derive(serde::Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    numbers: ReduceReport,
    output: &'a Path,
    notes: Vec<String>,
}

impl Report<'_> {
    fn text(&self) -> String {
        let ReduceReport { n_points, n_representatives, seconds, .. } = self.numbers;
        let mut lines = vec![format!(
            "{:<9}{n_representatives} points for {n_points}, in {seconds:.2} s",
            "reduced"
        )];
        let line = |head: &str, text: String| format!("{head:<9}{text}");
        lines.extend(self.cells());
        if let Some(learned) = &self.numbers.learned {
            let edges = match learned.mean_edge {
                Some(mean) => format!("{} edges of {mean:.4} mm on average", learned.n_edges),
                None => "no edges".to_owned(),
            };
            lines.push(line("network", edges));
            let signals = format!(
                "{} signals, {:.0} ns each; {}",
                learned.n_signals,
                learned.ns_per_signal,
                stopped(learned.stopped)
            );
            lines.push(line("learned", signals));
            lines.extend(learned_on(&learned.on).map(|text| line("", text)));
        }
        lines.push(error_text(&self.numbers.error));
        lines.push(line("wrote", self.output.display().to_string()));
        lines.extend(self.notes.iter().map(|note| line("note", note.clone())));
        lines.join("\n")
    }

    fn cells(&self) -> Vec<String> {
        let numbers = &self.numbers;
        let mut lines = Vec::new();
        if let Some(cell) = numbers.cell {
            let level = numbers.levels.map_or_else(String::new, |[depth, level]| {
                format!("; level {level} of an octree with leaves at level {depth}")
            });
            lines.push(format!("{:<9}of {cell:.4} mm{level}", "cells"));
        }
        if let Some(reached) = numbers.reached.filter(|reached| !reached.is_near) {
            lines.push(format!(
                "{:<9}{} points were asked for; no size of cells comes nearer than {}",
                "", reached.asked, reached.count
            ));
        }
        lines
    }
}

/// Where it learned, if there is something to say.
fn learned_on(on: &LearnedOn) -> Option<String> {
    match on {
        LearnedOn::Cpu { why } => why.as_ref().map(|why| format!("on the processor: {why}")),
        LearnedOn::Device { name, n_neurons } => {
            Some(format!("on {name}, from {n_neurons} neurons on"))
        }
    }
}

fn stopped(why: Stopped) -> &'static str {
    match why {
        Stopped::Count => "it has the neurons asked for",
        Stopped::Signals => "stopped after the signals asked for",
        Stopped::Time => "stopped after the time asked for",
        Stopped::MeanError => "stopped at the mean error asked for",
        Stopped::OnePlace => "all points lie in one place: one neuron says it all",
    }
}
