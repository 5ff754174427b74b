//! Reading a part from a file in any format: what is in it, in which unit, and what was left out.

use super::fault::{Fault, Place, ReadError};
use super::format::Format;
use super::raw::{Raw, checked, counted};
use super::source::Source;
use super::{gltf, obj, pcd, ply, points, sections, stl};
use crate::geom::{LengthUnit, Point3, PointCloud, Surface, UnitSource, Vector3};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// A part as read from a file, in millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The part.
    pub surface: Surface,
    /// The format it was in.
    pub format: Format,
    /// The unit it was in.
    pub unit: LengthUnit,
    /// How that is known.
    pub unit_from: UnitSource,
    /// What else the user must know: what was left out, what is doubtful.
    pub notes: Vec<String>,
}

/// Reads the part in the file `path`, whatever its format; lengths are in `unit` if it is given.
pub fn read_surface(path: &Path, unit: Option<LengthUnit>) -> Result<Reading, ReadError> {
    read(path, unit).map_err(|fault| ReadError { path: path.into(), fault })
}

/// Big enough to see past a page of comments when telling a format.
const HEAD_SIZE: usize = 1 << 16;

fn read(path: &Path, unit: Option<LengthUnit>) -> Result<Reading, Fault> {
    let (raw, format) = read_raw(path)?;
    settle(raw, format, unit)
}

/// What the file `path` holds, before units are settled.
pub(super) fn read_raw(path: &Path) -> Result<(Raw, Format), Fault> {
    opened(path, |format, source, folder| Ok((parse(format, source, folder)?, format)))
}

/// Opens the file `path`, tells its format, and hands it to `read` with the folder it is in.
pub(super) fn opened<T, E: From<Fault>>(
    path: &Path,
    read: impl FnOnce(Format, &mut Source<'_>, &Path) -> Result<T, E>,
) -> Result<T, E> {
    let system = |error| E::from(Fault::System(error));
    let file = File::open(path).map_err(system)?;
    let size = file.metadata().map_err(system)?.len();
    let mut reader = BufReader::with_capacity(HEAD_SIZE, file);
    let head = reader.fill_buf().map_err(system)?;
    if head.is_empty() {
        return Err(Fault::Empty.into());
    }
    let format = Format::detect(head, size, path).ok_or(Fault::Unrecognised)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    read(format, &mut Source::new(&mut reader, size), folder)
}

fn parse(format: Format, source: &mut Source<'_>, folder: &Path) -> Result<Raw, Fault> {
    match format {
        Format::StlBinary => stl::read_binary(source),
        Format::StlAscii => stl::read_ascii(source),
        Format::Ply => ply::read(source),
        Format::Obj => obj::read(source),
        Format::Glb => gltf::read_glb(source, folder),
        Format::Gltf => gltf::read_json(source, folder),
        Format::Pcd => pcd::read(source),
        Format::Points => points::read(source),
        Format::Sections => sections::read(source),
    }
}

/// Checks every coordinate, normalises normals and scales to millimetres.
pub(super) fn settle(
    raw: Raw,
    format: Format,
    stated: Option<LengthUnit>,
) -> Result<Reading, Fault> {
    let Raw { mut surface, declared, metres_are_customary, mut notes, grid: _ } = raw;
    match &mut surface {
        Surface::Mesh(mesh) => {
            if mesh.triangles.is_empty() {
                return Err(Fault::Nothing("triangles"));
            }
            check(&mesh.points, "vertex")?;
            notes.extend(normalise(&mut mesh.normals));
        }
        Surface::Points(cloud) => {
            notes.extend(drop_nan(cloud)?);
            if cloud.points.is_empty() {
                return Err(Fault::Nothing("triangles and no points"));
            }
            notes.extend(normalise(&mut cloud.normals));
        }
        Surface::Sections(grid) => check(&grid.points, "section point")?,
    }
    let extent = surface.aabb().size().max();
    let (unit, unit_from, doubt) = unit_of(extent, stated, declared, metres_are_customary);
    notes.extend(doubt);
    Ok(Reading { surface: surface.scaled(unit.in_mm()), format, unit, unit_from, notes })
}

/// The unit of a file whose content has that extent, how it is known, and what is doubtful about it.
pub(super) fn unit_of(
    extent: f64,
    stated: Option<LengthUnit>,
    declared: Option<LengthUnit>,
    metres_are_customary: bool,
) -> (LengthUnit, UnitSource, Option<String>) {
    match (stated, declared) {
        (Some(unit), _) => (unit, UnitSource::Stated, None),
        (None, Some(unit)) => (unit, UnitSource::Declared, None),
        (None, None) => {
            let unit = LengthUnit::detect(extent, metres_are_customary);
            (unit, UnitSource::Detected, doubt(extent, unit, metres_are_customary))
        }
    }
}

fn check(points: &[Point3], kind: &'static str) -> Result<(), Fault> {
    for (point, number) in points.iter().zip(1..) {
        checked(*point, Place::Thing(kind, number))?;
    }
    Ok(())
}

/// Scanners mark a place without a reading by NaN; everything else that is no length is an error.
fn drop_nan(cloud: &mut PointCloud) -> Result<Option<String>, Fault> {
    let is_reading = |point: &Point3| !point.iter().any(|x| x.is_nan());
    let keep: Vec<bool> = cloud.points.iter().map(is_reading).collect();
    for ((point, keep), number) in cloud.points.iter().zip(&keep).zip(1..) {
        if *keep {
            checked(*point, Place::Thing("point", number))?;
        }
    }
    let n_dropped = keep.iter().filter(|keep| !**keep).count();
    if n_dropped == 0 {
        return Ok(None);
    }
    retain(&mut cloud.points, &keep);
    cloud.normals.iter_mut().for_each(|normals| retain(normals, &keep));
    cloud.colors.iter_mut().for_each(|colors| retain(colors, &keep));
    Ok(Some(format!("{} with NaN left out", counted(n_dropped, "point"))))
}

pub(super) fn retain<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| keep.next() == Some(&true));
}

/// Makes the normals unit vectors; if one of them has no direction, none is worth keeping.
fn normalise(normals: &mut Option<Vec<Vector3>>) -> Option<String> {
    let all = normals.as_mut()?;
    let is_direction = |normal: &Vector3| (1e-6..1e6).contains(&normal.norm());
    let n_bad = all.iter().filter(|normal| !is_direction(normal)).count();
    if n_bad > 0 {
        *normals = None;
        return Some(format!("normals left out: {n_bad} of them have no direction"));
    }
    for normal in all {
        normal.normalize_mut();
    }
    None
}

/// What is odd about a part of that extent.
fn doubt(extent: f64, unit: LengthUnit, metres_are_customary: bool) -> Option<String> {
    let length = extent * unit.in_mm();
    let is_plausible = (50.0..2000.0).contains(&length);
    if metres_are_customary && unit != LengthUnit::Metre {
        Some(format!(
            "such files are in metres, but its longest side is {extent:.4}: taken as millimetres; \
             state the unit (--units) if that is wrong"
        ))
    } else if !is_plausible {
        Some(format!(
            "its longest side is {length:.4} mm; state the unit (--units) if that is wrong"
        ))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(points: &[[f64; 3]]) -> Raw {
        let points: Vec<_> = points.iter().map(|p| Point3::from(*p)).collect();
        let colors = Some((0..points.len()).map(|i| [i as u8; 3]).collect());
        Raw::new(Surface::Points(PointCloud { points, normals: None, colors }))
    }

    #[test]
    fn nan_points_are_dropped_with_what_belongs_to_them_and_counted() {
        let raw = cloud(&[[f64::NAN; 3], [100.0, 0.0, 0.0], [1.0, f64::NAN, 0.0], [0.0; 3]]);
        let reading = settle(raw, Format::Pcd, None).unwrap();
        assert_eq!(reading.notes, ["2 points with NaN left out"]);
        assert_eq!(reading.surface.into_points().colors, Some(vec![[1; 3], [3; 3]]));
    }

    #[test]
    fn infinite_points_are_an_error_that_names_them() {
        let raw = cloud(&[[f64::NAN; 3], [0.0, 0.0, f64::NEG_INFINITY]]);
        let error = settle(raw, Format::Pcd, None).unwrap_err().to_string();
        assert!(error.starts_with("coordinate z of point 2 is -inf"), "{error}");
    }

    #[test]
    fn the_caller_is_believed_before_the_file_and_the_file_before_its_extent() {
        let metres = || cloud(&[[0.0; 3], [0.25, 0.0, 0.0]]);
        let inches = || Raw { declared: Some(LengthUnit::Inch), ..metres() };
        for (raw, stated, x, from) in [
            (metres(), None, 250.0, UnitSource::Detected),
            (inches(), None, 6.35, UnitSource::Declared),
            (inches(), Some(LengthUnit::Centimetre), 2.5, UnitSource::Stated),
        ] {
            let reading = settle(raw, Format::Points, stated).unwrap();
            assert_eq!((reading.surface.points()[1].x, reading.unit_from), (x, from));
        }
    }

    #[test]
    fn a_doubtful_size_is_told() {
        let reading = settle(cloud(&[[0.0; 3], [10.5, 0.0, 0.0]]), Format::Points, None).unwrap();
        assert!(reading.notes[0].contains("longest side is 10.5000 mm"), "{:?}", reading.notes);
    }

    #[test]
    fn normals_become_unit_vectors_or_go() {
        let mut normals = Some(vec![Vector3::new(0.0, 0.0, 2.0)]);
        assert_eq!((normalise(&mut normals), normals), (None, Some(vec![Vector3::z()])));
        let mut normals = Some(vec![Vector3::z(), Vector3::zeros()]);
        assert!(normalise(&mut normals).unwrap().contains("1 of them") && normals.is_none());
    }
}
