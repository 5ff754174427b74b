//! Files of depth cameras: sequences and views in, simulated scans and trajectories in and out.
//!
//! A sequence is opened by [`open_sequence`], which looks at the lists alone; its frames are read one by
//! one. TUM's files are in metres and are turned into millimetres here.

mod camera;
mod contact;
mod list;
mod picture;
mod scan_folder;
mod sequence;
mod trajectory;
mod turntable;
mod view;

pub use camera::{DepthCamera, read_camera};
pub use contact::contact_sheet;
pub use picture::{read_color, read_depth, read_numbers};
pub use scan_folder::ScanFolder;
pub use sequence::{FrameFiles, Sequence, open_sequence};
pub use trajectory::{read_trajectory, trajectory_text, write_trajectory};
pub use turntable::{read_turntable, turntable_text};
pub use view::read_scan;
