//! `horma mesh`: from a cloud to a surface that can be cut.

use super::Shell;
use anyhow::{Context, bail};
use clap::Args;
use horma::geom::{LengthUnit, PointCloud, Surface, TriMesh};
use horma::io::{self, Format, OutputSet, Overwrite, Reading};
use horma::represent::gng::GngOptions;
use horma::represent::surface::{Rim, SurfaceOptions};
use horma::workflow::mesh::{MeshJob, MeshSource, Meshed, MeshedReport, mesh};
use std::path::{Path, PathBuf};

/// Rims told one by one.
const MOST_RIMS: usize = 8;

/// Make a surface of a cloud of points, or of the network that stands for one: closed where the part was scanned all around, open where it was not.
///
/// A growing neural gas learns the cloud, and its neurons become the corners of triangles. No edge has more
/// than two of them, all are wound alike, and holes with a short rim are closed.
#[derive(Debug, Args)]
#[command(after_help = "For example:
  horma mesh scan.ply -o part.stl
  horma reduce scan.ply --method gng --count 20000 -o net.ply && horma mesh net.ply --cloud scan.ply -o part.stl
  horma mesh scan.ply --count 50000 --close 60 -o part.ply && horma cam part.ply -m last-lathe -o part.ngc
  horma mesh front.pcd --preset thesis --lambda 500 -o front.stl --json")]
pub(crate) struct MeshArgs {
    /// The cloud: PLY, PCD, OBJ or a list of points (of a mesh the vertices are taken); or a network that
    /// `horma reduce --method gng` wrote as PLY.
    source: PathBuf,
    /// The cloud a network stands for: it says where the network has gaps, and the surface is measured against it.
    #[arg(long, value_name = "FILE")]
    cloud: Option<PathBuf>,
    /// Where the surface goes, in millimetres; .stl, .ply, .obj or .glb (in metres).
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// How many neurons stand for the cloud [default: a third of the points, at most 20,000].
    #[arg(long, value_name = "N")]
    count: Option<usize>,
    /// The unit of the cloud [default: what it declares, else by its extent].
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
    /// Replace the output if it is there already.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    options: SurfaceOptions,
    #[command(flatten)]
    gng: GngOptions,
}

/// Reads, learns, triangulates, writes and tells.
pub(crate) fn run(args: &MeshArgs, shell: &Shell) -> anyhow::Result<()> {
    args.options.check()?;
    args.gng.check()?;
    args.files(TriMesh::default())?;
    let graph = io::read_network(&args.source, args.units)?;
    let (cloud, notes) = args.read_cloud(graph.is_some())?;
    let source = match (&graph, &cloud) {
        (Some(graph), cloud) => MeshSource::Network { graph, cloud: cloud.as_ref() },
        (None, Some(cloud)) => MeshSource::Cloud { cloud, n_neurons: args.count, gng: &args.gng },
        (None, None) => bail!("{} is no network", args.source.display()),
    };
    let bar = shell.progress();
    let Meshed { mesh, report } = mesh(MeshJob { source, options: &args.options, notes }, &bar)
        .with_context(|| format!("while making a surface of {}", args.source.display()))?;
    let files = args.files(mesh)?;
    bar.stop_if_asked()?;
    files.commit()?;
    drop(bar);
    shell.report(&report, &format!("{}\nwrote    {}", summary(&report), args.output.display()))
}

impl MeshArgs {
    /// The cloud, if there is one, and what is to be said of the inputs.
    fn read_cloud(&self, is_network: bool) -> anyhow::Result<(Option<PointCloud>, Vec<String>)> {
        let source = self.source.display();
        let path = match (&self.cloud, is_network) {
            (Some(_), false) => bail!(
                "{source} is no network, and --cloud is for one; leave it out, or give what `horma reduce --method gng -o net.ply` wrote"
            ),
            (None, true) => return Ok((None, vec![format!("{source}: a network")])),
            (Some(cloud), true) => cloud,
            (None, false) => &self.source,
        };
        let reading = io::read_surface(path, self.units)?;
        let mut notes = notes(path, &reading);
        if is_network {
            notes.insert(0, format!("{source}: a network"));
        }
        Ok((Some(reading.surface.into_points()), notes))
    }

    /// What is to be written; refused if it cannot be.
    fn files(&self, mesh: TriMesh) -> anyhow::Result<OutputSet> {
        let surface = Surface::Mesh(mesh);
        if matches!(Format::to_write(&self.output, &surface), Some(Format::Points)) {
            let path = self.output.display();
            bail!("{path} would hold points alone; give a name ending in .stl, .ply, .obj or .glb");
        }
        let overwrite = if self.force { Overwrite::Replace } else { Overwrite::Refuse };
        let mut files = OutputSet::new(overwrite);
        files.add_surface(&self.output, &surface)?;
        Ok(files)
    }
}

fn notes(path: &Path, reading: &Reading) -> Vec<String> {
    let Reading { format, unit, unit_from, surface, .. } = reading;
    let mut notes = vec![format!("{}: {format}, units {unit}, {unit_from}", path.display())];
    if !matches!(surface, Surface::Points(_)) {
        notes.push(format!("it is a {}: only its vertices are used", surface.kind()));
    }
    notes.extend(reading.notes.iter().cloned());
    notes
}

fn summary(report: &MeshedReport) -> String {
    let line = |head: &str, text: String| format!("{head:<9}{text}");
    let topology = &report.topology;
    let shape = if report.is_closed { "closed" } else { "open" };
    let mut lines = vec![
        line(
            "surface",
            format!(
                "{shape}, {} triangles in {}, Euler number {}, {:.0} mm2",
                topology.n_triangles,
                pieces(topology.n_components),
                report.euler,
                topology.area
            ),
        ),
        line("network", format!("{} neurons, {:.3} mm apart", report.n_neurons, report.spacing)),
        line(
            "gaps",
            format!(
                "{} filled; rims up to {:.1} mm were closed",
                report.n_filled, report.longest_rim
            ),
        ),
    ];
    for (i, rim) in report.rims.iter().take(MOST_RIMS).enumerate() {
        lines.push(line(if i == 0 { "rims" } else { "" }, rim_text(rim)));
    }
    if MOST_RIMS < report.rims.len() {
        lines.push(line("", format!("and {} shorter ones", report.rims.len() - MOST_RIMS)));
    }
    if let Some(fit) = &report.fit {
        let [there, back] = [fit.cloud_to_mesh, fit.mesh_to_cloud];
        let text = |what: &str, d: horma::represent::surface::Distances| {
            format!("{what}: {:.4} mm on average, {:.4} mm at most", d.mean, d.max)
        };
        lines.push(line("fit", text("from the points to the surface", there)));
        lines.push(line("", text("from the surface to the points", back)));
    }
    lines.extend(report.notes.iter().map(|note| line("note", note.clone())));
    lines.join("\n")
}

fn pieces(n: usize) -> String {
    if n == 1 { "one piece".to_owned() } else { format!("{n} pieces") }
}

fn rim_text(rim: &Rim) -> String {
    let [x, y, z] = rim.middle;
    format!("{} edges, {:.1} mm long, about ({x:.1}, {y:.1}, {z:.1})", rim.n_edges, rim.length)
}
