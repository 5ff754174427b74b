//! `horma last`: a shoe last from a few measures.

use super::Shell;
use clap::Args;
use horma::geom::shapes::{self, LastParameters};
use horma::geom::{Surface, topology};
use horma::io::{self, Overwrite};
use std::fmt::Write;
use std::path::PathBuf;

/// Draw a shoe last from a few measures, closed and as fine as you like.
#[derive(Debug, Args)]
pub(crate) struct LastArgs {
    #[command(flatten)]
    last: LastParameters,
    /// What to write; its extension tells the format: .stl .ply .obj .glb.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Replace the output if it is there already.
    #[arg(long)]
    force: bool,
}

/// Draws, writes, and says how large it came out.
pub(crate) fn run(args: &LastArgs, shell: &Shell) -> anyhow::Result<()> {
    let mesh = shapes::last(&args.last)?;
    let made = topology(&mesh);
    let size: [f64; 3] = mesh.aabb().size().into();
    let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
    io::write_surface(&args.output, &Surface::Mesh(mesh), overwrite)?;
    let report = Report {
        file: &args.output,
        last: &args.last,
        size,
        n_triangles: made.n_triangles,
        area: made.area,
        volume: made.volume,
    };
    let text = report.text();
    shell.report(&report, &text)
}

/// What the JSON holds; lengths in millimetres.
#[derive(serde::Serialize)]
struct Report<'a> {
    file: &'a PathBuf,
    last: &'a LastParameters,
    size: [f64; 3],
    n_triangles: usize,
    area: f64,
    volume: Option<f64>,
}

impl Report<'_> {
    fn text(&self) -> String {
        let [x, y, z] = self.size;
        let mut text = format!("{}: {} triangles\n", self.file.display(), self.n_triangles);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "size    {x:.1} x {y:.1} x {z:.1} mm");
        let _ = writeln!(text, "area    {:.0} mm2", self.area);
        if let Some(volume) = self.volume {
            let _ = writeln!(text, "volume  {:.1} cm3", volume / 1000.0);
        }
        text
    }
}
