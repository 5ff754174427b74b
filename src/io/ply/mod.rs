//! PLY, the Stanford polygon format: ASCII, little and big endian; meshes and clouds.
//!
//! Read here and not by `ply-rs-bw`, which builds a map or calls a setter by name for every value,
//! and whose errors do not say where in a binary file they are; tests read what we write through it.

mod header;
mod read;
mod stream;
mod values;
mod write;

pub(super) use read::{read, read_all};
pub(super) use stream::VertexStream;
pub(super) use write::{write_cloud, write_mesh, write_network};
