//! The vertices of a PLY file, some at a time.

use super::header::{Element, Encoding, Header, Property, Scalar};
use super::read::Columns;
use super::values::{Values, decode};
use crate::geom::{LengthUnit, PointCloud};
use crate::io::fault::Fault;
use crate::io::source::Source;
use rayon::prelude::*;

/// Vertices handed over at a time.
const CHUNK: usize = 1 << 20;
/// Vertices decoded by one thread at a time.
const PIECE: usize = 1 << 14;

/// The vertices of a PLY file whose first element they are.
pub(in crate::io) struct VertexStream {
    encoding: Encoding,
    element: Element,
    columns: Columns,
    n_points: usize,
    /// The unit, where the file says it.
    pub(in crate::io) declared: Option<LengthUnit>,
}

impl VertexStream {
    /// Reads the header; nothing if the file holds more than vertices, or others come first.
    pub(in crate::io) fn open(source: &mut Source<'_>) -> Result<Option<Self>, Fault> {
        let header = Header::read(source)?;
        let mut elements = header.elements.into_iter().filter(|element| 0 < element.claimed);
        let (Some(element), None) = (elements.next(), elements.next()) else { return Ok(None) };
        if element.name != "vertex" {
            return Ok(None);
        }
        let columns = Columns::of(&element, source.byte_place())?;
        let n_points = Values::new(source, header.encoding).count(&element)?;
        let (encoding, declared) = (header.encoding, header.declared);
        Ok(Some(Self { encoding, element, columns, n_points, declared }))
    }

    /// How many vertices there are.
    pub(in crate::io) fn n_points(&self) -> usize {
        self.n_points
    }

    /// Hands all vertices to `take`, in their order; `source` is behind the header.
    pub(in crate::io) fn each<E: From<Fault>>(
        &self,
        source: &mut Source<'_>,
        mut take: impl FnMut(PointCloud) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut left = self.n_points;
        let is_row = |property: &Property| property.length.is_none();
        let is_binary = self.encoding != Encoding::Ascii;
        if is_binary && self.element.properties.iter().all(is_row) {
            let rows = Rows::of(&self.element, self.encoding);
            let mut bytes = Vec::new();
            while 0 < left {
                let n = left.min(CHUNK);
                bytes.resize(n * rows.size, 0);
                source.fill(&mut bytes, "the vertices")?;
                take(self.decoded(&rows, &bytes))?;
                left -= n;
            }
        } else {
            let mut values = Values::new(source, self.encoding);
            let mut row = vec![0.0; self.element.properties.len()];
            while 0 < left {
                let n = left.min(CHUNK);
                let mut cloud = self.columns.cloud(n);
                for _ in 0..n {
                    values.read_element(&self.element, &mut row, None, &mut Vec::new())?;
                    self.columns.push(&row, &mut cloud);
                }
                take(cloud)?;
                left -= n;
            }
        }
        Ok(())
    }

    fn decoded(&self, rows: &Rows, bytes: &[u8]) -> PointCloud {
        let decode_piece = |bytes: &[u8]| {
            let mut cloud = self.columns.cloud(bytes.len() / rows.size);
            let mut row = vec![0.0; rows.columns.len()];
            for bytes in bytes.chunks_exact(rows.size) {
                rows.decode(bytes, &mut row);
                self.columns.push(&row, &mut cloud);
            }
            cloud
        };
        let pieces: Vec<PointCloud> =
            bytes.par_chunks(PIECE * rows.size).map(decode_piece).collect();
        let mut all = self.columns.cloud(bytes.len() / rows.size);
        for piece in pieces {
            all.points.extend(piece.points);
            all.normals.iter_mut().zip(piece.normals).for_each(|(all, more)| all.extend(more));
            all.colors.iter_mut().zip(piece.colors).for_each(|(all, more)| all.extend(more));
        }
        all
    }
}

/// Rows of values, each as many bytes as the others.
struct Rows {
    /// Where in a row each value begins, and what it is.
    columns: Vec<(usize, Scalar)>,
    size: usize,
    is_big_endian: bool,
}

impl Rows {
    fn of(element: &Element, encoding: Encoding) -> Self {
        let mut size = 0;
        let mut column = |property: &Property| {
            size += property.item.size();
            (size - property.item.size(), property.item)
        };
        let columns = element.properties.iter().map(&mut column).collect();
        Self { columns, size, is_big_endian: encoding == Encoding::BigEndian }
    }

    #[inline]
    fn decode(&self, bytes: &[u8], row: &mut [f64]) {
        for ((begin, kind), value) in self.columns.iter().zip(row) {
            let bytes = &bytes[*begin..begin + kind.size()];
            *value = if self.is_big_endian {
                let mut turned = [0; 8];
                let turned = &mut turned[..bytes.len()];
                turned.copy_from_slice(bytes);
                turned.reverse();
                decode(*kind, turned)
            } else {
                decode(*kind, bytes)
            };
        }
    }
}
