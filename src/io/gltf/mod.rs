//! glTF 2.0, as one binary file (GLB) or as JSON with its buffers inside or beside it.
//!
//! Lengths are metres by the standard. All triangles of the scene become one mesh, moved by their
//! nodes; y stays up. The container and the accessors are read here, every offset checked first;
//! the `gltf` crate checks and walks the JSON.

mod accessor;
mod buffers;
mod read;
mod write;

pub(super) use read::{read_glb, read_json};
pub(super) use write::{write_cloud, write_mesh, write_network};

/// First four bytes of a GLB.
const MAGIC: &[u8; 4] = b"glTF";
/// Type of the chunk that holds the JSON.
const JSON_CHUNK: &[u8; 4] = b"JSON";
/// Type of the chunk that holds the first buffer.
const BIN_CHUNK: &[u8; 4] = b"BIN\0";
