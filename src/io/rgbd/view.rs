//! Views: clouds as one look of a scanner gave them, rows and columns kept.

use crate::geom::{LengthUnit, Point3, PointCloud, Surface, UnitSource, Vector3};
use crate::io::fault::{Fault, Place, ReadError};
use crate::io::format::Format;
use crate::io::raw::{RawGrid, checked};
use crate::io::read::{Reading, read_raw, settle, unit_of};
use crate::rgbd::OrganisedCloud;
use std::path::Path;

/// A cloud as a scanner saw it, in millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The points in their rows and columns, in the frame of the file. A file without such structure is
    /// one row.
    pub cloud: OrganisedCloud,
    /// The format the file was in.
    pub format: Format,
    /// The unit it was in.
    pub unit: LengthUnit,
    /// How that is known.
    pub unit_from: UnitSource,
    /// What else the user must know.
    pub notes: Vec<String>,
}

impl View {
    /// True if rows and columns mean something.
    pub fn is_organised(&self) -> bool {
        self.cloud.points.height() > 1
    }
}

/// Reads the view in the file `path`: PCD and PLY with their rows and columns (`WIDTH` and `HEIGHT`; a
/// `range_grid`), anything else that holds points as one row. Lengths are in `unit` if it is given.
pub fn read_view(path: &Path, unit: Option<LengthUnit>) -> Result<View, ReadError> {
    read(path, unit).map_err(|fault| ReadError { path: path.into(), fault })
}

/// Reads what [`read_surface`](crate::io::read_surface) does, and the same in its rows and columns where
/// the file has any.
pub fn read_scan(
    path: &Path,
    unit: Option<LengthUnit>,
) -> Result<(Reading, Option<OrganisedCloud>), ReadError> {
    both(path, unit).map_err(|fault| ReadError { path: path.into(), fault })
}

fn both(path: &Path, unit: Option<LengthUnit>) -> Result<(Reading, Option<OrganisedCloud>), Fault> {
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

fn read(path: &Path, stated: Option<LengthUnit>) -> Result<View, Fault> {
    let (raw, format) = read_raw(path)?;
    let cloud = raw.surface.into_points();
    for (point, number) in cloud.points.iter().zip(1..) {
        if !point.iter().any(|c| c.is_nan()) {
            checked(*point, Place::Thing("point", number))?;
        }
    }
    let is_there = |point: &&Point3| !point.iter().any(|c| c.is_nan());
    if !cloud.points.iter().any(|point| is_there(&point)) {
        return Err(Fault::Nothing("points"));
    }
    let extent = crate::geom::Aabb::around(cloud.points.iter().filter(is_there)).size().max();
    let mut notes = raw.notes;
    let (unit, unit_from, doubt) = unit_of(extent, stated, raw.declared, raw.metres_are_customary);
    notes.extend(doubt);
    let mut cloud = match raw.grid {
        None => organised(cloud)?,
        Some(grid) => in_grid(&cloud, &grid)?,
    };
    for point in cloud.points.pixels_mut() {
        *point *= unit.in_mm();
    }
    Ok(View { cloud, format, unit, unit_from, notes })
}

fn organised(cloud: PointCloud) -> Result<OrganisedCloud, Fault> {
    let n = cloud.points.len();
    Ok(OrganisedCloud::from_cloud(cloud, n, 1)?)
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

    fn view(name: &str, text: &str) -> Result<View, ReadError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        read_view(&path, None)
    }

    const PCD: &str = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

    #[test]
    fn a_pcd_keeps_its_width_height_and_gaps() {
        let text = format!(
            "{PCD}WIDTH 3\nHEIGHT 2\nPOINTS 6\nDATA ascii\n0 0 1\nnan nan nan\n0.2 0 1\n0 0.1 1\n\
             0.1 0.1 1\n0.2 0.1 1\n"
        );
        let view = view("a.pcd", &text).unwrap();
        assert!(view.is_organised());
        assert_eq!((view.cloud.points.width(), view.cloud.points.height()), (3, 2));
        assert_eq!(view.cloud.point(1, 0), None);
        let last = view.cloud.point(2, 1).unwrap();
        assert!(
            (last - Point3::new(200.0, 100.0, 1000.0)).norm() < 1e-4,
            "f32 metres to mm: {last}"
        );
        assert_eq!((view.unit, view.unit_from), (LengthUnit::Metre, UnitSource::Detected));
    }

    #[test]
    fn a_pcd_without_rows_is_one_row() {
        let text = format!("{PCD}WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n0 0 1\n0.2 0 1\n");
        let view = view("a.pcd", &text).unwrap();
        assert!(!view.is_organised() && view.cloud.points.width() == 2);
    }

    const PLY: &str = "ply\nformat ascii 1.0\ncomment units: mm\nobj_info num_cols 2\n\
        obj_info num_rows 2\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element range_grid 4\nproperty list uchar int vertex_indices\nend_header\n0 0 9\n1 0 9\n0 1 9\n";

    #[test]
    fn a_ply_has_its_range_grid() {
        let view = view("a.ply", &format!("{PLY}1 2\n0\n1 0\n1 1\n")).unwrap();
        assert_eq!(view.cloud.point(0, 0), Some(&Point3::new(0.0, 1.0, 9.0)));
        assert_eq!(view.cloud.point(1, 0), None);
        assert_eq!(view.cloud.point(1, 1), Some(&Point3::new(1.0, 0.0, 9.0)));
    }

    #[test]
    fn faults_of_views_name_the_value() {
        let told = |name, text: &str| view(name, text).unwrap_err().to_string();
        let grid = told("a.ply", &format!("{PLY}1 3\n0\n1 0\n1 1\n"));
        assert!(grid.contains("line 16: a cell names point 3, but there are only 3"), "{grid}");
        let size = told(
            "a.ply",
            &format!("{}1 2\n0\n1 0\n1 1\n", PLY.replace("num_cols 2", "num_cols 3")),
        );
        assert!(size.contains("range_grid of 4 cells is not 3 x 2"), "{size}");
        let none = format!("{PCD}WIDTH 1\nHEIGHT 2\nPOINTS 2\nDATA ascii\nnan 0 0\nnan 0 0\n");
        assert!(told("a.pcd", &none).contains("there are no points in it"));
        let far = format!("{PCD}WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\ninf 0 0\n");
        assert!(told("a.pcd", &far).contains("coordinate x of point 1 is inf"));
    }
}
