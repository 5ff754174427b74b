//! `horma info`: what is in a part file.

use super::Shell;
use horma::geom::{LengthUnit, MeshReport, Surface, UnitSource, topology};
use horma::io::{self, Format, Reading};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What to look at.
#[derive(Debug, clap::Args)]
pub(crate) struct InfoArgs {
    /// The part: STL, PLY, OBJ, glTF/GLB, PCD, points (XYZ, ASC, TXT, CSV) or a section grid (CSV).
    file: PathBuf,
    /// The unit of the file [default: what it declares, else by its extent].
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
}

/// Reads the part and prints what it is.
pub(crate) fn run(args: &InfoArgs, shell: &Shell) -> anyhow::Result<()> {
    let reading = io::read_surface(&args.file, args.units)?;
    let info = Info::of(&args.file, &reading);
    shell.report(&info, &info.table())
}

/// What the JSON holds; lengths in millimetres.
#[derive(serde::Serialize)]
struct Info<'a> {
    file: &'a Path,
    format: Format,
    unit: LengthUnit,
    unit_from: UnitSource,
    kind: &'static str,
    n_points: usize,
    /// Stations and points a station, of a section grid.
    sections: Option<[usize; 2]>,
    has_normals: bool,
    has_colors: bool,
    min: [f64; 3],
    max: [f64; 3],
    size: [f64; 3],
    /// Of a mesh, or of the triangles between sections.
    mesh: Option<MeshReport>,
    is_closed: bool,
    notes: &'a [String],
}

impl<'a> Info<'a> {
    fn of(file: &'a Path, reading: &'a Reading) -> Self {
        let surface = &reading.surface;
        let aabb = surface.aabb();
        let (mesh, sections) = match surface {
            Surface::Mesh(mesh) => (Some(topology(mesh)), None),
            Surface::Sections(grid) => {
                (Some(topology(&grid.to_mesh())), Some([grid.n_rows(), grid.n_columns]))
            }
            Surface::Points(_) => (None, None),
        };
        let (has_normals, has_colors) = match surface {
            Surface::Mesh(mesh) => (mesh.normals.is_some(), mesh.colors.is_some()),
            Surface::Points(cloud) => (cloud.normals.is_some(), cloud.colors.is_some()),
            Surface::Sections(_) => (false, false),
        };
        Self {
            file,
            format: reading.format,
            unit: reading.unit,
            unit_from: reading.unit_from,
            kind: surface.kind(),
            n_points: surface.points().len(),
            sections,
            has_normals,
            has_colors,
            min: aabb.min.into(),
            max: aabb.max.into(),
            size: aabb.size().into(),
            is_closed: mesh.as_ref().is_some_and(MeshReport::is_closed),
            mesh,
            notes: &reading.notes,
        }
    }

    fn table(&self) -> String {
        let vector = |[x, y, z]: [f64; 3]| format!("{x:.3} {y:.3} {z:.3} mm");
        let mut table = Table::default();
        table.row("file", self.file.display());
        table.row("format", self.format);
        table.row("units", format_args!("{}, {}", self.unit, self.unit_from));
        table.row("kind", self.kind);
        if let Some([n_rows, n_columns]) = self.sections {
            table.row("sections", format_args!("{n_rows} of {n_columns} points"));
        }
        table.row("points", self.n_points);
        let extras = [(self.has_normals, "normals"), (self.has_colors, "colours")];
        let extras: Vec<_> = extras.iter().filter(|(has, _)| *has).map(|(_, name)| *name).collect();
        if !extras.is_empty() {
            table.row("with", extras.join(", "));
        }
        table.row("size", vector(self.size));
        table.row("from", vector(self.min));
        table.row("to", vector(self.max));
        if let Some(mesh) = &self.mesh {
            table.mesh(mesh);
        }
        for note in self.notes {
            table.row("note", note);
        }
        table.0
    }
}

/// Names left, values right.
#[derive(Default)]
struct Table(String);

impl Table {
    fn row(&mut self, name: &str, value: impl std::fmt::Display) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "{name:<22}{value}");
    }

    fn mesh(&mut self, mesh: &MeshReport) {
        self.row("triangles", mesh.n_triangles);
        self.row("area", format_args!("{:.1} mm2", mesh.area));
        self.row("surface", if mesh.is_closed() { "closed" } else { "open" });
        match mesh.volume {
            Some(volume) if volume < 0.0 => {
                self.row("volume", format_args!("{:.1} mm3, wound inside out", -volume));
            }
            Some(volume) => self.row("volume", format_args!("{volume:.1} mm3")),
            None => {}
        }
        self.row("pieces", mesh.n_components);
        self.row(
            "open edges",
            format_args!("{} in {} loops", mesh.n_open_edges, mesh.n_open_loops),
        );
        self.row("non-manifold edges", mesh.n_non_manifold_edges);
        self.row("flipped edges", mesh.n_flipped_edges);
        self.row("degenerate triangles", mesh.n_degenerate_triangles);
        self.row("duplicate triangles", mesh.n_duplicate_triangles);
        self.row("unused vertices", mesh.n_unused_points);
        self.row("repeated vertices", mesh.n_points - mesh.n_positions);
    }
}
