//! A block, as commands are told about it.

use anyhow::Context;
use horma::cam::Block;
use horma::geom::LengthUnit;
use horma::io;
use std::path::Path;

/// A shape such as `cylinder:60`, or the file of a moulded block.
pub(super) fn read_block(text: &str, units: Option<LengthUnit>) -> anyhow::Result<Block> {
    let path = Path::new(text);
    match text.parse::<Block>() {
        Err(no_shape) if !path.exists() => Err(no_shape.into()),
        Err(_) => {
            let mesh = io::read_surface(path, units)?.surface.into_mesh();
            let no_body = || format!("the block {text} has no triangles; give a body, not points");
            Ok(Block::Mesh(mesh.with_context(no_body)?))
        }
        Ok(block) => Ok(block),
    }
}
