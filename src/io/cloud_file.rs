//! A cloud in a file, in memory if it fits, else read again for every pass.

use super::fault::{Fault, Place, ReadError};
use super::format::Format;
use super::ply::VertexStream;
use super::raw::checked;
use super::read::{opened, read_surface, unit_of};
use crate::geom::{
    Aabb, CloudPart, CloudParts, LengthUnit, PartError, Point3, PointCloud, UnitSource, Vector3,
};
use std::path::{Path, PathBuf};

/// Clouds of more points than this are not held in memory, if their file can be read in parts.
const HELD: usize = 1 << 25;

/// A cloud that can be gone through part by part, in millimetres.
pub struct CloudFile {
    /// The format of the file.
    pub format: Format,
    /// The unit it is in.
    pub unit: LengthUnit,
    /// How that is known.
    pub unit_from: UnitSource,
    /// What else the user must know.
    pub notes: Vec<String>,
    path: PathBuf,
    content: Content,
}

enum Content {
    Held(PointCloud),
    /// Places without a reading are left out: so many points are left.
    Streamed {
        n_points: u64,
    },
}

/// Opens the cloud in the file `path`, whatever its format; lengths are in `unit` if it is given. Of a mesh
/// its vertices are taken.
pub fn open_cloud(path: &Path, unit: Option<LengthUnit>) -> Result<CloudFile, ReadError> {
    open(path, unit, HELD)
}

fn open(path: &Path, unit: Option<LengthUnit>, held: usize) -> Result<CloudFile, ReadError> {
    let fault = |fault| ReadError { path: path.into(), fault };
    if let Some(file) = opened_stream(path, unit, held).map_err(fault)? {
        return Ok(file);
    }
    let reading = read_surface(path, unit)?;
    Ok(CloudFile {
        format: reading.format,
        unit: reading.unit,
        unit_from: reading.unit_from,
        notes: reading.notes,
        path: path.into(),
        content: Content::Held(reading.surface.into_points()),
    })
}

/// The file as a stream, if it is one and holds more than `held` points.
fn opened_stream(
    path: &Path,
    unit: Option<LengthUnit>,
    held: usize,
) -> Result<Option<CloudFile>, Fault> {
    opened(path, |format, source, _| {
        if format != Format::Ply {
            return Ok(None);
        }
        let Some(stream) = VertexStream::open(source)?.filter(|s| held < s.n_points()) else {
            return Ok(None);
        };
        let (mut aabb, mut n_points, mut n_before) = (Aabb::around([]), 0, 0);
        stream.each(source, |cloud| {
            let readings = cloud.points.iter().enumerate().filter(|(_, p)| is_reading(p));
            for (i, point) in readings {
                checked(*point, Place::Thing("point", (n_before + i + 1) as u64))?;
                aabb = aabb.with(point);
                n_points += 1;
            }
            n_before += cloud.points.len();
            Ok::<_, Fault>(())
        })?;
        if n_points == 0 {
            return Err(Fault::Nothing("triangles and no points"));
        }
        let (unit, unit_from, doubt) = unit_of(aabb.size().max(), unit, stream.declared, false);
        let mut notes: Vec<String> = doubt.into_iter().collect();
        notes.push(format!("{n_points} points: read again for every pass, not held in memory"));
        let n_left_out = stream.n_points() as u64 - n_points;
        if 0 < n_left_out {
            notes.push(format!("{n_left_out} points with NaN left out"));
        }
        let content = Content::Streamed { n_points };
        Ok(Some(CloudFile { format, unit, unit_from, notes, path: path.into(), content }))
    })
}

fn is_reading(point: &Point3) -> bool {
    !point.iter().any(|x| x.is_nan())
}

impl CloudParts for CloudFile {
    fn n_points(&self) -> u64 {
        match &self.content {
            Content::Held(cloud) => cloud.points.len() as u64,
            Content::Streamed { n_points } => *n_points,
        }
    }

    fn each_part(
        &mut self,
        take: &mut dyn FnMut(CloudPart<'_>) -> Result<(), PartError>,
    ) -> Result<(), PartError> {
        match &self.content {
            Content::Held(cloud) => take(cloud.as_part()),
            Content::Streamed { .. } => self.each_read(take).map_err(|halt| match halt {
                Halt::Fault(fault) => {
                    let path = self.path.clone();
                    PartError::Source(Box::new(ReadError { path, fault }))
                }
                Halt::Taker(error) => error,
            }),
        }
    }
}

/// Why a pass ended early.
enum Halt {
    Fault(Fault),
    Taker(PartError),
}

impl From<Fault> for Halt {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl CloudFile {
    fn each_read(
        &self,
        take: &mut dyn FnMut(CloudPart<'_>) -> Result<(), PartError>,
    ) -> Result<(), Halt> {
        let scale = self.unit.in_mm();
        opened(&self.path, |_, source, _| {
            let Some(stream) = VertexStream::open(source)? else {
                let problem = "the file is no longer the cloud it was";
                return Err(Fault::malformed(Place::Byte(0), problem).into());
            };
            stream.each(source, |mut cloud| {
                retain_readings(&mut cloud);
                for point in &mut cloud.points {
                    *point *= scale;
                }
                for normal in cloud.normals.iter_mut().flatten() {
                    *normal = normal.try_normalize(1e-9).unwrap_or_else(Vector3::zeros);
                }
                take(cloud.as_part()).map_err(Halt::Taker)
            })
        })
    }
}

fn retain_readings(cloud: &mut PointCloud) {
    if cloud.points.iter().all(is_reading) {
        return;
    }
    let keep: Vec<bool> = cloud.points.iter().map(is_reading).collect();
    super::read::retain(&mut cloud.points, &keep);
    cloud.normals.iter_mut().for_each(|normals| super::read::retain(normals, &keep));
    cloud.colors.iter_mut().for_each(|colors| super::read::retain(colors, &keep));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Surface, box_of_parts};
    use crate::io::{OutputSet, Overwrite};

    fn cloud(n: u32) -> PointCloud {
        let at = |i: u32| Point3::new(f64::from(i), f64::from(i % 7), -1.5);
        PointCloud {
            points: (0..n).map(at).collect(),
            normals: Some(vec![Vector3::y(); n as usize]),
            colors: Some((0..n).map(|i| [i as u8, 1, 2]).collect()),
        }
    }

    fn written(folder: &Path, cloud: PointCloud) -> PathBuf {
        let path = folder.join("cloud.ply");
        let mut files = OutputSet::new(Overwrite::Replace);
        files.add_surface(&path, &Surface::Points(cloud)).unwrap();
        files.commit().unwrap();
        path
    }

    fn all(file: &mut CloudFile) -> PointCloud {
        let mut all =
            PointCloud { normals: Some(vec![]), colors: Some(vec![]), ..PointCloud::default() };
        file.each_part(&mut |part| {
            all.points.extend(part.points);
            all.normals.as_mut().unwrap().extend(part.normals.unwrap());
            all.colors.as_mut().unwrap().extend(part.colors.unwrap());
            Ok(())
        })
        .unwrap();
        all
    }

    #[test]
    fn a_cloud_read_in_parts_is_the_cloud_again_and_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), cloud(1000));
        let mut streamed = open(&path, None, 10).unwrap();
        let mut held = open(&path, None, 1000).unwrap();
        assert_eq!((streamed.n_points(), streamed.unit), (1000, held.unit));
        assert_eq!(all(&mut streamed), cloud(1000));
        assert_eq!(all(&mut streamed), all(&mut held));
        let metres = open(&path, Some(LengthUnit::Metre), 10);
        assert_eq!(box_of_parts(&mut metres.unwrap()).unwrap().max.x, 999_000.0);
    }

    #[test]
    fn places_without_a_reading_are_left_out_of_every_part() {
        let folder = tempfile::tempdir().unwrap();
        let mut broken = cloud(100);
        broken.points[40].x = f64::NAN;
        let path = written(folder.path(), broken);
        let mut streamed = open(&path, None, 10).unwrap();
        assert_eq!((streamed.n_points(), all(&mut streamed).points.len()), (99, 99));
        assert!(streamed.notes.iter().any(|note| note == "1 points with NaN left out"));
        assert_eq!(all(&mut streamed), all(&mut open(&path, None, 1000).unwrap()));
    }

    #[test]
    fn a_file_cut_off_or_a_point_too_far_away_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), cloud(100));
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 5]).unwrap();
        let error = open(&path, None, 10).err().unwrap().to_string();
        assert!(error.contains("header promises 100"), "{error}");
        let mut far = cloud(100);
        far.points[2].y = 1e300;
        let error = open(&written(folder.path(), far), None, 10).err().unwrap().to_string();
        assert!(
            error.contains("coordinate y of point 3 is 1e300") || error.contains("point 3"),
            "{error}"
        );
    }
}
