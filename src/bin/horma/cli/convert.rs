//! `horma convert`: a part from one format to another, in millimetres.

use super::Shell;
use anyhow::bail;
use horma::geom::{LengthUnit, Surface, UnitSource};
use horma::io::{self, Format, Overwrite, WriteError};
use std::path::PathBuf;

/// What to convert.
#[derive(Debug, clap::Args)]
pub(crate) struct ConvertArgs {
    /// The part: STL, PLY, OBJ, glTF/GLB, PCD, points (XYZ, ASC, TXT, CSV) or a section grid (CSV).
    from: PathBuf,
    /// What to write; its extension tells the format: .stl .ply .obj .glb .xyz .asc .txt .csv.
    to: PathBuf,
    /// The unit of the input [default: what it declares, else by its extent]. The output is in
    /// millimetres, a GLB in metres.
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
    /// Write an STL as text.
    #[arg(long)]
    ascii: bool,
    /// Replace the output if it is there already.
    #[arg(long)]
    force: bool,
}

/// Reads, fits, writes, and says what did not survive.
pub(crate) fn run(args: &ConvertArgs, shell: &Shell) -> anyhow::Result<()> {
    let reading = io::read_surface(&args.from, args.units)?;
    let format = match Format::to_write(&args.to, &reading.surface) {
        Some(Format::StlBinary) if args.ascii => Format::StlAscii,
        Some(_) if args.ascii => bail!("--ascii is for .stl; {} is none", args.to.display()),
        Some(format) => format,
        None => return Err(WriteError::UnknownExtension { path: args.to.clone() }.into()),
    };
    let mut notes = reading.notes;
    let (surface, note) = fitted(reading.surface, format);
    notes.extend(note);
    let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
    io::write_surface_as(&args.to, &surface, format, overwrite)?;
    let report = Report {
        from: args.from.clone(),
        from_format: reading.format,
        unit: reading.unit,
        unit_from: reading.unit_from,
        to: args.to.clone(),
        to_format: format,
        kind: surface.kind(),
        n_points: surface.points().len(),
        notes,
    };
    shell.report(&report, &report.text())
}

/// What the JSON holds.
#[derive(serde::Serialize)]
struct Report {
    from: PathBuf,
    from_format: Format,
    unit: LengthUnit,
    unit_from: UnitSource,
    to: PathBuf,
    to_format: Format,
    kind: &'static str,
    n_points: usize,
    notes: Vec<String>,
}

impl Report {
    fn text(&self) -> String {
        let (from, to) = (self.from.display(), self.to.display());
        let mut lines = vec![
            format!("{from}: {}, units {}, {}", self.from_format, self.unit, self.unit_from),
            format!("{to}: {}, {} of {} points", self.to_format, self.kind, self.n_points),
        ];
        lines.extend(self.notes.iter().map(|note| format!("note: {note}")));
        lines.join("\n")
    }
}

/// `surface` as `format` can hold it, and what was lost on the way; as it is where nothing helps.
fn fitted(surface: Surface, format: Format) -> (Surface, Option<String>) {
    match (surface, format) {
        (Surface::Mesh(mesh), Format::Points) => {
            let note =
                format!("{} triangles left out: only vertices written", mesh.triangles.len());
            (Surface::Points(Surface::Mesh(mesh).into_points()), Some(note))
        }
        (Surface::Sections(grid), Format::Points) => {
            let note = "rows and columns left out: only points written".to_owned();
            (Surface::Points(Surface::Sections(grid).into_points()), Some(note))
        }
        (Surface::Sections(grid), format) if format != Format::Sections => {
            let note = "sections joined by triangles, their ends left open".to_owned();
            (Surface::Mesh(grid.to_mesh()), Some(note))
        }
        (surface, _) => (surface, None),
    }
}
