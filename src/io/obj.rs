//! Wavefront OBJ: vertices with colours, normals, polygons; without faces it is a cloud.
//!
//! Read here and not by `tobj`, whose errors name no line, which reads `f32`, takes several hundred
//! bytes a triangle and drops the vertices that no face uses; tests read what we write through it.

use super::faces::Faces;
use super::fault::{Fault, Place};
use super::raw::{Raw, counted};
use super::source::{Source, number, shown, words};
use crate::geom::{LengthUnit, Point3, PointCloud, Surface, TriMesh, Vector3};
use std::io::Write;

/// Reads an OBJ file; objects and groups become one surface.
pub(super) fn read(source: &mut Source<'_>) -> Result<Raw, Fault> {
    let mut obj = Obj::default();
    let mut line = Vec::new();
    let mut more = Vec::new();
    while source.read_line(&mut line)? {
        // A backslash at its end joins a line to the next.
        while line.last() == Some(&b'\\') {
            line.pop();
            source.read_line(&mut more)?;
            line.extend_from_slice(&more);
        }
        obj.take(&line, source.line_place())?;
    }
    obj.finish()
}

/// What has been read so far.
#[derive(Default)]
struct Obj {
    points: Vec<Point3>,
    /// As long as `points`, or some vertex has none.
    colors: Vec<[f32; 3]>,
    normals: Vec<Vector3>,
    /// For each vertex its normal (from 0), as far as the faces told.
    normal_of: Vec<Option<u32>>,
    has_many_normals: bool,
    faces: Faces,
    corners: Vec<i64>,
    n_left_out: usize,
    declared: Option<LengthUnit>,
}

impl Obj {
    fn take(&mut self, line: &[u8], place: Place) -> Result<(), Fault> {
        let code = line.split(|byte| *byte == b'#').next().unwrap_or_default();
        let mut words = words(code);
        match words.next() {
            Some(b"v") => self.take_vertex(words, place),
            Some(b"vn") => {
                let [x, y, z] = numbers(words, place)?;
                self.normals.push(Vector3::new(x, y, z));
                Ok(())
            }
            Some(b"f" | b"fo") => self.take_face(words, place),
            Some(b"l" | b"p" | b"curv" | b"curv2" | b"surf") => {
                self.n_left_out += 1;
                Ok(())
            }
            Some(word) if !word.iter().all(u8::is_ascii_graphic) => {
                Err(Fault::malformed(place, format!("{} is no word of an OBJ file", shown(word))))
            }
            Some(_) => Ok(()),
            None => {
                if self.declared.is_none() {
                    self.declared = LengthUnit::declared_in(&String::from_utf8_lossy(line));
                }
                Ok(())
            }
        }
    }

    /// `v x y z [w]` or `v x y z r g b`.
    fn take_vertex<'w>(
        &mut self,
        mut words: impl Iterator<Item = &'w [u8]>,
        place: Place,
    ) -> Result<(), Fault> {
        let [x, y, z] = numbers(&mut words, place)?;
        let mut rest = words.peekable();
        self.points.push(Point3::new(x, y, z));
        let first = rest.next();
        if rest.peek().is_some() {
            let color = numbers(first.into_iter().chain(rest), place)?;
            self.colors.push(color.map(|share| share as f32));
        }
        Ok(())
    }

    /// `f v v v ...`, each `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative ones count from the end.
    fn take_face<'w>(
        &mut self,
        words: impl Iterator<Item = &'w [u8]>,
        place: Place,
    ) -> Result<(), Fault> {
        self.corners.clear();
        for word in words {
            let mut parts = word.split(|byte| *byte == b'/');
            let corner = index(parts.next().unwrap_or_default(), self.points.len());
            let corner = corner.ok_or_else(|| {
                Fault::malformed(place, format!("{} where a face names a vertex", shown(word)))
            })?;
            if corner < 0 {
                let n_points = self.points.len();
                let problem =
                    format!("{} names none of the {n_points} vertices so far", shown(word));
                return Err(Fault::malformed(place, problem));
            }
            self.corners.push(corner);
            if let Some(normal) = parts.nth(1).and_then(|word| index(word, self.normals.len())) {
                self.note_normal(corner, normal);
            }
        }
        self.faces.push(&self.corners, place);
        Ok(())
    }

    fn note_normal(&mut self, corner: i64, normal: i64) {
        // Out of range is told when the faces are checked; the table grows with the vertices only.
        let corner = corner as usize;
        if corner >= self.points.len() {
            self.has_many_normals = true;
            return;
        }
        if self.normal_of.len() < self.points.len() {
            self.normal_of.resize(self.points.len(), None);
        }
        let known = &mut self.normal_of[corner];
        let normal = u32::try_from(normal).ok();
        self.has_many_normals |= known.is_some() && *known != normal;
        *known = normal;
    }

    fn finish(mut self) -> Result<Raw, Fault> {
        let mut notes = Vec::new();
        if self.n_left_out > 0 {
            let n = counted(self.n_left_out, "line, point or free-form element");
            notes.push(format!("{n} left out"));
        }
        let colors = (self.colors.len() == self.points.len()).then(|| to_bytes(&self.colors));
        if !self.colors.is_empty() && colors.is_none() {
            notes.push("colours left out: not every vertex has one".to_owned());
        }
        let normals = self.vertex_normals();
        if !self.normals.is_empty() && normals.is_none() {
            notes.push("normals left out: not every vertex has just one".to_owned());
        }
        let points = std::mem::take(&mut self.points);
        let surface = if self.faces.is_empty() {
            Surface::Points(PointCloud { points, normals, colors })
        } else {
            let mesh = self.faces.into_mesh(points, 1)?;
            Surface::Mesh(TriMesh { normals, colors, ..mesh })
        };
        Ok(Raw { declared: self.declared, notes, ..Raw::new(surface) })
    }

    /// One normal a vertex: as the faces say, or, without faces, in order.
    fn vertex_normals(&self) -> Option<Vec<Vector3>> {
        if self.faces.is_empty() {
            let is_paired = !self.normals.is_empty() && self.normals.len() == self.points.len();
            return is_paired.then(|| self.normals.clone());
        }
        if self.has_many_normals || self.normal_of.len() != self.points.len() {
            return None;
        }
        self.normal_of.iter().map(|i| self.normals.get((*i)? as usize).copied()).collect()
    }
}

/// A vertex or normal, from 0; what counts from the end may come out negative.
fn index(word: &[u8], n_so_far: usize) -> Option<i64> {
    let index: i64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    if index < 0 { index.checked_add_unsigned(n_so_far as u64) } else { Some(index - 1) }
}

fn numbers<'w, const N: usize>(
    mut words: impl Iterator<Item = &'w [u8]>,
    place: Place,
) -> Result<[f64; N], Fault> {
    let mut values = [0.0; N];
    for value in &mut values {
        let word = words.next().unwrap_or_default();
        *value = number(word).ok_or_else(|| {
            Fault::malformed(place, format!("{} where a number must be", shown(word)))
        })?;
    }
    Ok(values)
}

/// Colours run to 1 by custom; some programs write them to 255.
fn to_bytes(colors: &[[f32; 3]]) -> Vec<[u8; 3]> {
    let full = if colors.iter().flatten().all(|share| *share <= 1.0) { 255.0 } else { 1.0 };
    colors.iter().map(|color| color.map(|share| (share * full).round() as u8)).collect()
}

/// Writes a mesh, coordinates with all their digits.
pub(super) fn write_mesh(out: &mut dyn Write, mesh: &TriMesh) -> std::io::Result<()> {
    writeln!(out, "# by horma, units mm")?;
    write_vertices(out, &mesh.points, mesh.normals.as_deref(), mesh.colors.as_deref())?;
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| u64::from(i) + 1)) {
        if mesh.normals.is_some() {
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        } else {
            writeln!(out, "f {a} {b} {c}")?;
        }
    }
    Ok(())
}

/// Writes a cloud as vertices without faces.
pub(super) fn write_cloud(out: &mut dyn Write, cloud: &PointCloud) -> std::io::Result<()> {
    writeln!(out, "# by horma, units mm")?;
    write_vertices(out, &cloud.points, cloud.normals.as_deref(), cloud.colors.as_deref())
}

fn write_vertices(
    out: &mut dyn Write,
    points: &[Point3],
    normals: Option<&[Vector3]>,
    colors: Option<&[[u8; 3]]>,
) -> std::io::Result<()> {
    for (i_point, point) in points.iter().enumerate() {
        write!(out, "v {} {} {}", point.x, point.y, point.z)?;
        for value in colors.iter().flat_map(|colors| colors[i_point]) {
            write!(out, " {}", f32::from(value) / 255.0)?;
        }
        writeln!(out)?;
    }
    for normal in normals.unwrap_or_default() {
        writeln!(out, "vn {} {} {}", normal.x, normal.y, normal.z)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn obj(text: &str) -> Result<Raw, Fault> {
        read(&mut Source::new(&mut text.as_bytes(), text.len() as u64))
    }

    fn mesh(text: &str) -> TriMesh {
        obj(text).unwrap().surface.into_mesh().unwrap()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn faces_count_from_either_end_and_may_be_polygons() {
        let all = [[3, 0, 1], [1, 2, 3]];
        assert_eq!(mesh(&format!("{SQUARE}f 1 2 3 4\n")).triangles, all);
        assert_eq!(mesh(&format!("{SQUARE}f -4/9 -3/9 \\\n-2/9 -1/9\n")).triangles, all);
        assert_eq!(mesh(&format!("f 1 2 3 4 # first\n{SQUARE}")).triangles, all);
    }

    #[test]
    fn normals_stay_where_every_vertex_has_just_one() {
        let up = "vn 0 0 1\nvn 0 1 0\n";
        let smooth = mesh(&format!("{SQUARE}{up}f 1//1 2//1 3//1 4//2\n"));
        assert_eq!(smooth.normals.unwrap()[3], Vector3::y());
        let sharp = obj(&format!("{SQUARE}{up}f 1//1 2//1 3//1\nf 1//2 3//2 4//2\n")).unwrap();
        assert_eq!(sharp.notes, ["normals left out: not every vertex has just one"]);
    }

    #[test]
    fn colours_run_to_1_or_to_255() {
        for text in ["v 0 0 0 1 0 0.2\n", "v 0 0 0 255 0 51\n"] {
            let Surface::Points(cloud) = obj(text).unwrap().surface else { panic!("a cloud") };
            assert_eq!(cloud.colors, Some(vec![[255, 0, 51]]));
        }
    }

    #[test]
    fn faults_name_line_and_value() {
        for (line, message) in [
            ("v 1 two 3", "line 5: \"two\" where a number must be"),
            ("f 1 2 5", "line 5: a face names vertex 5, but there are only 4 (counted from 1)"),
            ("f 1 2 0", "line 5: \"0\" names none of the 4 vertices so far"),
            ("f 1 2 -5", "line 5: \"-5\" names none of the 4 vertices so far"),
            ("f 1 2 99999999999", "line 5: a face names vertex 99999999999, but"),
            ("f 1 2 x", "line 5: \"x\" where a face names a vertex"),
        ] {
            let error = obj(&format!("{SQUARE}{line}\n")).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
