//! Reads a part, whatever its format, and says how its triangles hang together. Without a file it
//! draws a last, writes it, and reads that.
//!
//! ```sh
//! cargo run --example 03_read_a_part -- my-last.stl
//! ```

use horma::geom::{Surface, shapes, topology};
use horma::io::{Overwrite, read_surface, write_surface};
use std::path::{Path, PathBuf};

fn main() -> anyhow::Result<()> {
    let Some(file) = std::env::args_os().nth(1) else {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("last.stl");
        let last = shapes::last(&shapes::LastParameters::default())?;
        write_surface(&file, &Surface::Mesh(last), Overwrite::Refuse)?;
        return describe(&file);
    };
    describe(&PathBuf::from(file))
}

fn describe(file: &Path) -> anyhow::Result<()> {
    // No unit is stated: the file declares it, or the part's extent tells.
    let reading = read_surface(file, None)?;
    println!("{}", file.display());
    println!("  {}, in {} ({})", reading.format, reading.unit, reading.unit_from);
    let size = reading.surface.aabb().size();
    println!("  {:.1} x {:.1} x {:.1} mm", size.x, size.y, size.z);
    for note in &reading.notes {
        println!("  note: {note}");
    }
    let Some(mesh) = reading.surface.into_mesh() else {
        println!("  points alone: nothing hangs together");
        return Ok(());
    };
    let found = topology(&mesh);
    println!("  {} triangles over {} places", found.n_triangles, found.n_positions);
    println!("  {} pieces, {} open edges", found.n_components, found.n_open_edges);
    println!("  {} edges with more than two triangles", found.n_non_manifold_edges);
    println!("  {} triangles without area", found.n_degenerate_triangles);
    println!("  {:.0} mm2", found.area);
    match found.volume {
        Some(volume) => println!("  {:.1} cm3 inside", volume / 1000.0),
        None => println!("  no inside"),
    }
    Ok(())
}
