//! From PLY elements to a mesh or a cloud.

use super::header::{Element, Header};
use super::values::Values;
use crate::geom::{Point3, PointCloud, Surface, TriMesh, Vector3};
use crate::io::faces::Faces;
use crate::io::fault::{Fault, Place};
use crate::io::raw::{Raw, RawGrid};
use crate::io::source::Source;
use crate::represent::gng::GraphEdge;

/// Reads a PLY file; without faces it is a cloud.
pub(in crate::io) fn read(source: &mut Source<'_>) -> Result<Raw, Fault> {
    Ok(read_all(source)?.0)
}

/// What only a network of neurons has.
#[derive(Debug, Default)]
pub(in crate::io) struct Net {
    /// Two vertices each, and how long ago the edge was confirmed.
    pub(in crate::io) edges: Vec<GraphEdge>,
    /// One per vertex, if the file has them.
    pub(in crate::io) errors: Vec<f64>,
}

/// Reads a PLY file with all that horma writes into one.
pub(in crate::io) fn read_all(source: &mut Source<'_>) -> Result<(Raw, Net), Fault> {
    let header = Header::read(source)?;
    let mut values = Values::new(source, header.encoding);
    let mut cloud = PointCloud::default();
    let mut faces = Faces::default();
    let mut net = Net::default();
    let mut notes = Vec::new();
    let mut grid = None;
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => cloud = read_vertices(&mut values, element, &mut net.errors)?,
            "face" => read_faces(&mut values, element, &mut faces)?,
            "edge" => {
                net.edges = read_edges(&mut values, element, cloud.points.len())?;
                notes.push(format!("{} edges of a network left out", net.edges.len()));
            }
            other => {
                match header.grid {
                    [Some(width), Some(height)] if other == "range_grid" => {
                        let n_points = cloud.points.len();
                        let cells = read_grid(&mut values, element, [width, height], n_points)?;
                        grid = Some(RawGrid { width, height, cells: Some(cells) });
                    }
                    _ => skip(&mut values, element)?,
                }
                notes.push(format!("{} of the element {other:?} left out", element.claimed));
            }
        }
    }
    let surface = if faces.is_empty() {
        Surface::Points(cloud)
    } else {
        let mesh = faces.into_mesh(cloud.points, 0)?;
        Surface::Mesh(TriMesh { normals: cloud.normals, colors: cloud.colors, ..mesh })
    };
    Ok((Raw { declared: header.declared, notes, grid, ..Raw::new(surface) }, net))
}

/// Where in a row of values what a vertex has stands.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    color: Option<[usize; 3]>,
    /// What a color is multiplied by.
    full: f64,
    error: Option<usize>,
}

impl Columns {
    /// Those of `element`, which begins at `place`.
    pub(super) fn of(element: &Element, place: Place) -> Result<Self, Fault> {
        let three = |names: [&[&str]; 3]| {
            let [a, b, c] = names.map(|names| element.position(names));
            Some([a?, b?, c?])
        };
        let Some(position) = three([&["x"], &["y"], &["z"]]) else {
            return Err(Fault::malformed(place, "the element \"vertex\" has no x, y and z"));
        };
        let color = three([
            &["red", "r", "diffuse_red"],
            &["green", "g", "diffuse_green"],
            &["blue", "b", "diffuse_blue"],
        ]);
        let is_whole = |color: [usize; 3]| element.properties[color[0]].item.is_integer();
        Ok(Self {
            position,
            normal: three([&["nx", "normal_x"], &["ny", "normal_y"], &["nz", "normal_z"]]),
            color,
            full: if color.is_none_or(is_whole) { 1.0 } else { 255.0 },
            error: element.position(&["error"]),
        })
    }

    /// A cloud with room for `n_points`.
    pub(super) fn cloud(&self, n_points: usize) -> PointCloud {
        PointCloud {
            points: Vec::with_capacity(n_points),
            normals: self.normal.map(|_| Vec::with_capacity(n_points)),
            colors: self.color.map(|_| Vec::with_capacity(n_points)),
        }
    }

    /// Adds the vertex in `row` to the cloud.
    #[inline]
    pub(super) fn push(&self, row: &[f64], cloud: &mut PointCloud) {
        cloud.points.push(Point3::from(self.position.map(|i| row[i])));
        if let (Some(normal), Some(normals)) = (self.normal, &mut cloud.normals) {
            normals.push(Vector3::from(normal.map(|i| row[i])));
        }
        if let (Some(color), Some(colors)) = (self.color, &mut cloud.colors) {
            colors.push(color.map(|i| (row[i] * self.full).round() as u8));
        }
    }
}

fn read_vertices(
    values: &mut Values<'_, '_>,
    element: &Element,
    errors: &mut Vec<f64>,
) -> Result<PointCloud, Fault> {
    let columns = Columns::of(element, values.place())?;
    let n_points = values.count(element)?;
    let mut cloud = columns.cloud(n_points);
    let mut row = vec![0.0; element.properties.len()];
    for _ in 0..n_points {
        values.read_element(element, &mut row, None, &mut Vec::new())?;
        columns.push(&row, &mut cloud);
        errors.extend(columns.error.map(|i| row[i]));
    }
    Ok(cloud)
}

/// The edges between `n_points` vertices.
fn read_edges(
    values: &mut Values<'_, '_>,
    element: &Element,
    n_points: usize,
) -> Result<Vec<GraphEdge>, Fault> {
    let ends = ["vertex1", "vertex2"].map(|name| element.position(&[name]));
    let [Some(first), Some(second)] = ends else {
        let problem = "the element \"edge\" has no vertex1 and vertex2";
        return Err(Fault::malformed(values.place(), problem));
    };
    let age = element.position(&["age"]);
    let n_edges = values.count(element)?;
    let mut edges = Vec::with_capacity(n_edges);
    let mut row = vec![0.0; element.properties.len()];
    for _ in 0..n_edges {
        values.read_element(element, &mut row, None, &mut Vec::new())?;
        let ends = [row[first], row[second]];
        let is_there = |end: &f64| end.fract() == 0.0 && (0.0..n_points as f64).contains(end);
        if let Some(bad) = ends.iter().find(|end| !is_there(end)) {
            let problem = format!("an edge names vertex {bad}, but there are only {n_points}");
            return Err(Fault::malformed(values.place(), problem));
        }
        let [a, b] = ends.map(|end| end as u32);
        let age = age.map_or(0, |i| row[i].clamp(0.0, f64::from(u32::MAX)) as u32);
        edges.push(GraphEdge { ends: [a.min(b), a.max(b)], age });
    }
    Ok(edges)
}

fn read_faces(
    values: &mut Values<'_, '_>,
    element: &Element,
    faces: &mut Faces,
) -> Result<(), Fault> {
    let i_list = element.properties.iter().position(|property| {
        property.length.is_some()
            && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
    });
    if i_list.is_none() {
        return Err(Fault::malformed(
            values.place(),
            "the element \"face\" has no list vertex_indices",
        ));
    }
    let mut row = vec![0.0; element.properties.len()];
    let mut corners = Vec::new();
    for _ in 0..values.count(element)? {
        values.read_element(element, &mut row, i_list, &mut corners)?;
        faces.push(&corners, values.place());
    }
    Ok(())
}

/// The point in each cell of a scanner's picture, if there is one.
fn read_grid(
    values: &mut Values<'_, '_>,
    element: &Element,
    [width, height]: [usize; 2],
    n_points: usize,
) -> Result<Vec<Option<u32>>, Fault> {
    let n_cells = values.count(element)?;
    if width.checked_mul(height) != Some(n_cells) {
        let problem = format!("the range_grid of {n_cells} cells is not {width} x {height}");
        return Err(Fault::malformed(values.place(), problem));
    }
    let i_list = element.properties.iter().position(|property| property.length.is_some());
    let mut row = vec![0.0; element.properties.len()];
    let (mut list, mut cells) = (Vec::new(), Vec::with_capacity(n_cells));
    for _ in 0..n_cells {
        values.read_element(element, &mut row, i_list, &mut list)?;
        let cell =
            list.first().map(|&i| u32::try_from(i).ok().filter(|i| (*i as usize) < n_points));
        if let (Some(None), Some(i)) = (cell, list.first()) {
            let problem = format!("a cell names point {i}, but there are only {n_points}");
            return Err(Fault::malformed(values.place(), problem));
        }
        cells.push(cell.flatten());
    }
    Ok(cells)
}

fn skip(values: &mut Values<'_, '_>, element: &Element) -> Result<(), Fault> {
    let mut row = vec![0.0; element.properties.len()];
    for _ in 0..values.count(element)? {
        values.read_element(element, &mut row, None, &mut Vec::new())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ply(body: &str) -> Result<Raw, Fault> {
        let text = format!("ply\n{body}");
        read(&mut Source::new(&mut text.as_bytes(), text.len() as u64))
    }

    const VERTEX: &str = "property float x\nproperty float y\nproperty float z\n";

    #[test]
    fn unknown_elements_are_passed_over_and_told() {
        let raw = ply(&format!(
            "format ascii 1.0\nobj_info is_mesh 0\ncomment units: m\nelement vertex 1\n{VERTEX}\
             element range_grid 2\nproperty list uchar int vertex_indices\nend_header\n\
             1 2 3 \n0\n1 0\n"
        ))
        .unwrap();
        assert_eq!(raw.surface.points(), [Point3::new(1.0, 2.0, 3.0)]);
        assert_eq!(raw.notes, ["2 of the element \"range_grid\" left out"]);
        assert_eq!(raw.declared, Some(crate::geom::LengthUnit::Metre));
    }

    #[test]
    fn colours_run_to_255_or_to_1_by_their_type() {
        for (kind, text) in [("uchar", "255 0 51"), ("float", "1 0 0.2")] {
            let raw = ply(&format!(
                "format ascii 1.0\nelement vertex 1\n{VERTEX}property {kind} red\nproperty {kind} \
                 green\nproperty {kind} blue\nend_header\n1 2 3 {text}\n"
            ));
            let Surface::Points(cloud) = raw.unwrap().surface else { panic!("a cloud") };
            assert_eq!(cloud.colors, Some(vec![[255, 0, 51]]));
        }
    }

    #[test]
    fn faults_name_line_and_value() {
        let head = format!("format ascii 1.0\nelement vertex 2\n{VERTEX}");
        for (body, message) in [
            ("element vertex many\n".to_owned(), "line 2: \"element vertex many\" is no PLY"),
            ("end_header\n".to_owned(), "line 2: the header has no format line"),
            (head.clone(), "ends at line 6, in the middle of the header"),
            (format!("{head}end_header\n1 2 3\n10 20\n"), "line 9: \"\" where a number must be"),
            (format!("{head}end_header\n1 2 3\n1 2 3 4\n"), "line 9: \"4\" is more than"),
            (
                format!(
                    "{head}element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                         1 2 3\n4 5 6\n3 0 1 2\n"
                ),
                "line 12: a face names vertex 2, but there are only 2 (counted from 0)",
            ),
            (
                format!(
                    "{head}element face 1\nproperty list char int vertex_indices\nend_header\n\
                         1 2 3\n4 5 6\n-3 0 1 2\n"
                ),
                "line 12: a list \"vertex_indices\" of length -3",
            ),
        ] {
            let error = ply(&body).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn an_element_without_properties_cannot_keep_the_reader_busy() {
        let body = format!(
            "format binary_little_endian 1.0\nelement nothing 18446744073709551615\n\
             element vertex 0\n{VERTEX}end_header\n"
        );
        assert!(ply(&body).unwrap().surface.points().is_empty());
    }
}
