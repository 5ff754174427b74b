//! Views: clouds as one look of a scanner gave them, rows and columns kept.

use crate::geom::{LengthUnit, Point3, PointCloud, Surface, Vector3};
use crate::io::fault::{Fault, ReadError};
use crate::io::raw::RawGrid;
use crate::io::read::{Reading, read_raw, settle};
use crate::rgbd::OrganisedCloud;
use std::path::Path;

/// Reads what [`read_surface`](crate::io::read_surface) does, and where the file has rows and columns (`WIDTH`
/// and `HEIGHT` of a PCD, the `range_grid` of a PLY) the same in these, in millimetres.
pub fn read_scan(
    path: &Path,
    unit: Option<LengthUnit>,
) -> Result<(Reading, Option<OrganisedCloud>), ReadError> {
    read(path, unit).map_err(|fault| ReadError { path: path.into(), fault })
}

fn read(path: &Path, unit: Option<LengthUnit>) -> Result<(Reading, Option<OrganisedCloud>), Fault> {
    let (raw, format) = read_raw(path)?;
    let mut organised = match (&raw.grid, &raw.surface) {
        (Some(grid), Surface::Points(cloud)) if grid.height > 1 => Some(in_grid(cloud, grid)?),
        _ => None,
    };
    let reading = settle(raw, format, unit)?;
    for point in organised.iter_mut().flat_map(|cloud| cloud.points.pixels_mut()) {
        *point *= reading.unit.in_mm();
    }
    Ok((reading, organised))
}

/// The points in the cells of a grid that name them.
fn in_grid(cloud: &PointCloud, grid: &RawGrid) -> Result<OrganisedCloud, Fault> {
    let Some(cells) = &grid.cells else {
        return Ok(OrganisedCloud::from_cloud(cloud.clone(), grid.width, grid.height)?);
    };
    let nowhere = Point3::from(Vector3::repeat(f64::NAN));
    let pick = |cell: &Option<u32>| cell.map(|i| i as usize);
    let points = cells.iter().map(|c| pick(c).map_or(nowhere, |i| cloud.points[i])).collect();
    let normals = cloud.normals.as_ref().map(|normals| {
        cells.iter().map(|c| pick(c).map_or(nowhere.coords, |i| normals[i])).collect()
    });
    let colors = cloud
        .colors
        .as_ref()
        .map(|colors| cells.iter().map(|c| pick(c).map_or([0; 3], |i| colors[i])).collect());
    let cloud = PointCloud { points, normals, colors };
    Ok(OrganisedCloud::from_cloud(cloud, grid.width, grid.height)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(name: &str, text: &str) -> Result<(Reading, Option<OrganisedCloud>), ReadError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        read_scan(&path, None)
    }

    const PCD: &str = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

    #[test]
    fn a_pcd_keeps_its_width_height_and_gaps() {
        let text = format!(
            "{PCD}WIDTH 3\nHEIGHT 2\nPOINTS 6\nDATA ascii\n0 0 1\nnan nan nan\n0.2 0 1\n0 0.1 1\n\
             0.1 0.1 1\n0.2 0.1 1\n"
        );
        let (reading, view) = scan("a.pcd", &text).unwrap();
        let view = view.unwrap();
        assert_eq!((view.points.width(), view.points.height()), (3, 2));
        assert_eq!(view.point(1, 0), None);
        let last = view.point(2, 1).unwrap();
        assert!(
            (last - Point3::new(200.0, 100.0, 1000.0)).norm() < 1e-4,
            "f32 metres to mm: {last}"
        );
        assert_eq!(
            (reading.unit, reading.surface.into_points().points.len()),
            (LengthUnit::Metre, 5)
        );
    }

    #[test]
    fn a_pcd_without_rows_is_no_view() {
        let text = format!("{PCD}WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n0 0 1\n0.2 0 1\n");
        let (reading, view) = scan("a.pcd", &text).unwrap();
        assert_eq!((view, reading.surface.into_points().points.len()), (None, 2));
    }

    const PLY: &str = "ply\nformat ascii 1.0\ncomment units: mm\nobj_info num_cols 2\n\
        obj_info num_rows 2\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element range_grid 4\nproperty list uchar int vertex_indices\nend_header\n0 0 9\n1 0 9\n0 1 9\n";

    #[test]
    fn a_ply_has_its_range_grid() {
        let (_, view) = scan("a.ply", &format!("{PLY}1 2\n0\n1 0\n1 1\n")).unwrap();
        let view = view.unwrap();
        assert_eq!(view.point(0, 0), Some(&Point3::new(0.0, 1.0, 9.0)));
        assert_eq!(view.point(1, 0), None);
        assert_eq!(view.point(1, 1), Some(&Point3::new(1.0, 0.0, 9.0)));
    }

    #[test]
    fn faults_of_views_name_the_value() {
        let told = |name, text: &str| scan(name, text).unwrap_err().to_string();
        let grid = told("a.ply", &format!("{PLY}1 3\n0\n1 0\n1 1\n"));
        assert!(grid.contains("line 16: a cell names point 3, but there are only 3"), "{grid}");
        let size = told(
            "a.ply",
            &format!("{}1 2\n0\n1 0\n1 1\n", PLY.replace("num_cols 2", "num_cols 3")),
        );
        assert!(size.contains("range_grid of 4 cells is not 3 x 2"), "{size}");
        let none = format!("{PCD}WIDTH 1\nHEIGHT 2\nPOINTS 2\nDATA ascii\nnan 0 0\nnan 0 0\n");
        assert!(told("a.pcd", &none).contains("no points in it"));
        let far = format!("{PCD}WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\ninf 0 0\n");
        assert!(told("a.pcd", &far).contains("coordinate x of point 1 is inf"));
    }
}
