//! Faces as a file lists them, checked against its vertices once all are known.

use super::fault::{Fault, Place};
use crate::geom::{Point3, Polygons, TriMesh};

/// Polygons under construction.
#[derive(Default)]
pub(super) struct Faces {
    polygons: Polygons,
    corners: Vec<u32>,
    /// The highest vertex named (from 0), and where: the only one that must be compared.
    highest: Option<(i64, Place)>,
}

impl Faces {
    /// Adds a face over vertices counted from 0, found at `place`; negative ones are kept for the
    /// message.
    pub(super) fn push(&mut self, corners: &[i64], place: Place) {
        for &corner in corners {
            let worse = match self.highest {
                None => true,
                Some((highest, _)) => highest >= 0 && (corner < 0 || corner > highest),
            };
            if worse {
                self.highest = Some((corner, place));
            }
        }
        self.corners.clear();
        // What does not fit u32 is out of range too, and `into_mesh` says so.
        self.corners.extend(corners.iter().map(|&corner| corner as u32));
        self.polygons.push(&self.corners);
    }

    /// True if there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.polygons.is_empty()
    }

    /// The faces as triangles over `points`; `counted_from` is how the file counts its vertices.
    pub(super) fn into_mesh(
        self,
        points: Vec<Point3>,
        counted_from: i64,
    ) -> Result<TriMesh, Fault> {
        match self.highest {
            Some((index, place))
                if index < 0 || index.cast_unsigned() >= (points.len() as u64).min(1 << 32) =>
            {
                Err(Fault::NoSuchPoint {
                    place,
                    index: index.saturating_add(counted_from),
                    n_points: points.len(),
                    counted_from,
                })
            }
            _ => Ok(self.polygons.into_mesh(points)),
        }
    }
}
