//! Reading STL.

use super::{FACET_SIZE, HEADER_SIZE};
use crate::geom::{LengthUnit, Point3, Surface, TriMesh};
use crate::io::fault::{Fault, Place};
use crate::io::raw::{Raw, checked, counted};
use crate::io::source::{Source, number, shown, words};
use std::collections::HashMap;

/// Reads a binary STL.
pub(in crate::io) fn read_binary(source: &mut Source<'_>) -> Result<Raw, Fault> {
    let header: [u8; HEADER_SIZE] = source.bytes("the header of a binary STL")?;
    let claimed = u32::from_le_bytes(source.bytes("the number of triangles")?);
    // Without the odd byte that `Source::count` grants to text.
    if u64::from(claimed) * FACET_SIZE > source.remaining() {
        return Err(Fault::Lies {
            what: "triangles".into(),
            claimed: claimed.into(),
            room: source.remaining(),
            possible: source.remaining() / FACET_SIZE,
        });
    }
    let mut welder = Welder::default();
    let mut triangles = Vec::with_capacity(claimed as usize);
    let mut facet = [0; FACET_SIZE as usize];
    for number in 1..=u64::from(claimed) {
        source.fill(&mut facet, "a triangle")?;
        let coordinate = |k: usize| {
            let at = 12 + 4 * k;
            f64::from(f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]]))
        };
        let mut triangle = [0; 3];
        for (i, index) in triangle.iter_mut().enumerate() {
            let corner =
                Point3::new(coordinate(3 * i), coordinate(3 * i + 1), coordinate(3 * i + 2));
            *index = welder.index_of(checked(corner, Place::Thing("triangle", number))?)?;
        }
        triangles.push(triangle);
    }
    let mut raw = Raw::new(Surface::Mesh(TriMesh::new(welder.points, triangles)));
    raw.declared = LengthUnit::declared_in(&String::from_utf8_lossy(&header));
    if source.remaining() > 0 {
        let n_bytes = counted(source.remaining() as usize, "byte");
        raw.notes.push(format!("{n_bytes} after the last triangle left out"));
    }
    Ok(raw)
}

/// Reads an ASCII STL; several solids become one mesh.
pub(in crate::io) fn read_ascii(source: &mut Source<'_>) -> Result<Raw, Fault> {
    let mut welder = Welder::default();
    let mut triangles = Vec::new();
    let mut corners: Vec<u32> = Vec::with_capacity(3);
    let mut declared = None;
    let mut line = Vec::new();
    let mut is_open = false;
    while source.read_line(&mut line)? {
        let mut words = words(&line);
        let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
        match keyword.as_slice() {
            b"solid" => {
                declared =
                    declared.or_else(|| LengthUnit::declared_in(&String::from_utf8_lossy(&line)));
            }
            b"vertex" => {
                let corner = vertex(words, source.line_place())?;
                let place = Place::Thing("triangle", triangles.len() as u64 + 1);
                corners.push(welder.index_of(checked(corner, place)?)?);
            }
            b"facet" => is_open = true,
            b"endfacet" => {
                let Ok(triangle) = <[u32; 3]>::try_from(corners.as_slice()) else {
                    let problem = format!("a facet with {} corners", corners.len());
                    return Err(Fault::malformed(source.line_place(), problem));
                };
                triangles.push(triangle);
                corners.clear();
                is_open = false;
            }
            b"\xef\xbb\xbfsolid" | b"outer" | b"endloop" | b"endsolid" | b"" => {}
            other => {
                let problem = format!("{} is no word of an STL file", shown(other));
                return Err(Fault::malformed(source.line_place(), problem));
            }
        }
    }
    if is_open || !corners.is_empty() {
        return Err(Fault::Truncated { place: source.line_place(), what: "a facet".into() });
    }
    let mut raw = Raw::new(Surface::Mesh(TriMesh::new(welder.points, triangles)));
    raw.declared = declared;
    Ok(raw)
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a [u8]>, place: Place) -> Result<Point3, Fault> {
    let mut coordinate = || {
        let word = words.next().unwrap_or_default();
        number(word).ok_or_else(|| {
            Fault::malformed(place, format!("{} where a coordinate must be", shown(word)))
        })
    };
    Ok(Point3::new(coordinate()?, coordinate()?, coordinate()?))
}

/// Gives equal corners the same index, in order of appearance.
#[derive(Default)]
struct Welder {
    points: Vec<Point3>,
    index: HashMap<[u64; 3], u32>,
}

impl Welder {
    fn index_of(&mut self, point: Point3) -> Result<u32, Fault> {
        let next = u32::try_from(self.points.len()).map_err(|_| {
            Fault::malformed(Place::Thing("vertex", 1 << 32), "more vertices than can be counted")
        })?;
        // Adding 0 turns -0 into 0.
        let key = [point.x, point.y, point.z].map(|x| (x + 0.0).to_bits());
        let index = *self.index.entry(key).or_insert(next);
        if index == next {
            self.points.push(point);
        }
        Ok(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  \
                         vertex 0 1 0\n endloop\nendfacet\n";

    fn ascii(text: &str) -> Result<Raw, Fault> {
        let mut bytes = text.as_bytes();
        read_ascii(&mut Source::new(&mut bytes, text.len() as u64))
    }

    #[test]
    fn two_solids_in_capitals_become_one_welded_mesh() {
        let text = format!("solid a units=mm\n{FACET}endsolid a\nSOLID b\n{FACET}ENDSOLID b\n");
        let raw = ascii(&text.replace("vertex", "VERTEX")).unwrap();
        let Surface::Mesh(mesh) = raw.surface else { panic!("a mesh") };
        assert_eq!((mesh.points.len(), mesh.triangles.len()), (3, 2));
        assert_eq!(raw.declared, Some(LengthUnit::Millimetre));
    }

    #[test]
    fn faults_name_their_line() {
        for (text, message) in [
            (FACET.replace("  vertex 0 1 0\n", ""), "line 6: a facet with 2 corners"),
            (FACET.replace("1 0 0", "1 O 0"), "line 4: \"O\" where a coordinate must be"),
            (FACET.replace("1 0 0", "1"), "line 4: \"\" where a coordinate must be"),
            (FACET.replace("endloop", "endlop"), "line 6: \"endlop\" is no word of an STL"),
            (FACET.replace("endfacet\n", ""), "ends at line 6, in the middle of a facet"),
        ] {
            let error = ascii(&text).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
