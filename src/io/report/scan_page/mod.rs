//! What a scan shows: what was seen, the way of the camera, and what became of its frames. One page, whether
//! frames were followed one by one or fused into a model.

mod followed;
mod fused;
mod pictures;
mod shown;

pub use followed::scan_page;
pub use fused::fusion_page;
