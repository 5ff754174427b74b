//! STL: triangles without shared vertices, binary or as text.
//!
//! Corners at exactly the same position become one vertex on reading, or every later step would
//! carry six copies of each. Facet normals are ignored: they are redundant and often wrong.

mod read;
mod write;

pub(super) use read::{read_ascii, read_binary};
pub(super) use write::{write_ascii, write_binary};

/// Bytes before the number of triangles.
const HEADER_SIZE: usize = 80;
/// Bytes per triangle: normal, three corners, two spare.
const FACET_SIZE: u64 = 50;
