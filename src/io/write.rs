//! Writing a part in the format its name asks for; lengths are millimetres, in GLB metres.

use super::format::{Format, extension};
use super::output::{Overwrite, WriteError};
use super::output_set::OutputSet;
use super::{gltf, obj, ply, points, sections, stl};
use crate::geom::Surface;
use std::path::Path;

/// Writes `surface` to `path`, in the format of its extension ([`Format::to_write`]).
pub fn write_surface(
    path: &Path,
    surface: &Surface,
    overwrite: Overwrite,
) -> Result<(), WriteError> {
    let mut files = OutputSet::new(overwrite);
    files.add_surface(path, surface)?;
    files.commit()
}

/// Writes `surface` to `path` in the format given, whatever the name.
pub fn write_surface_as(
    path: &Path,
    surface: &Surface,
    format: Format,
    overwrite: Overwrite,
) -> Result<(), WriteError> {
    let mut files = OutputSet::new(overwrite);
    files.add_surface_as(path, surface, format)?;
    files.commit()
}

impl OutputSet {
    /// Writes `surface` as [`OutputSet::add`] does, in the format of the extension of `path`.
    pub fn add_surface(&mut self, path: &Path, surface: &Surface) -> Result<(), WriteError> {
        let format = Format::to_write(path, surface)
            .ok_or_else(|| WriteError::UnknownExtension { path: path.into() })?;
        self.add_surface_as(path, surface, format)
    }

    fn add_surface_as(
        &mut self,
        path: &Path,
        surface: &Surface,
        format: Format,
    ) -> Result<(), WriteError> {
        let separator = if extension(path) == "csv" { ',' } else { ' ' };
        let mut write = |fill: &dyn Fn(&mut dyn std::io::Write) -> std::io::Result<()>| {
            self.add(path, |out| fill(out))
        };
        match (format, surface) {
            (Format::StlBinary, Surface::Mesh(mesh)) => write(&|out| stl::write_binary(out, mesh)),
            (Format::StlAscii, Surface::Mesh(mesh)) => write(&|out| stl::write_ascii(out, mesh)),
            (Format::Ply, Surface::Mesh(mesh)) => write(&|out| ply::write_mesh(out, mesh)),
            (Format::Ply, Surface::Points(cloud)) => write(&|out| ply::write_cloud(out, cloud)),
            (Format::Obj, Surface::Mesh(mesh)) => write(&|out| obj::write_mesh(out, mesh)),
            (Format::Obj, Surface::Points(cloud)) => write(&|out| obj::write_cloud(out, cloud)),
            (Format::Glb, Surface::Mesh(mesh)) => write(&|out| gltf::write_mesh(out, mesh)),
            (Format::Glb, Surface::Points(cloud)) => write(&|out| gltf::write_cloud(out, cloud)),
            (Format::Points, Surface::Points(cloud)) => {
                write(&|out| points::write(out, cloud, separator))
            }
            (Format::Sections, Surface::Sections(grid)) => write(&|out| sections::write(out, grid)),
            _ => Err(WriteError::CannotHold {
                path: path.into(),
                format,
                kind: surface.kind(),
                remedy: match surface {
                    Surface::Mesh(_) => ".stl, .ply, .obj or .glb",
                    Surface::Points(_) => ".ply, .obj, .glb, .xyz or .csv",
                    Surface::Sections(_) => ".csv",
                },
            }),
        }
    }
}
