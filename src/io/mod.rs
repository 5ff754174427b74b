//! Files in and out.
//!
//! [`read_surface`] tells a format by what a file holds, settles its unit and refuses what is no
//! surface; one file per format holds its reader and writer. [`write_surface`] goes by the name.

mod cloud_file;
mod faces;
mod fault;
mod folder;
mod format;
mod gltf;
mod job;
mod machine;
mod network;
mod obj;
mod output;
mod output_folder;
mod output_set;
mod pcd;
mod ply;
mod points;
mod pose;
mod program;
mod raw;
mod read;
pub mod report;
pub mod rgbd;
mod sections;
mod source;
mod stl;
mod target;
mod unfinished;
mod write;

pub use cloud_file::{CloudFile, open_cloud};
pub use fault::{Fault, Place, ReadError};
pub use folder::create_folder;
pub use format::Format;
pub use job::{JobError, JobFile, read_job};
pub use machine::{
    DescriptionError, read_dialect, read_dialect_text, read_machine, read_machine_text, read_tools,
};
pub use network::read_network;
pub use output::{Overwrite, WriteError, write_file};
pub use output_set::OutputSet;
pub use pose::{PoseError, pose_text, read_pose};
pub use program::{ReadProgramError, read_program, write_program};
pub use read::{Reading, read_surface};
pub use target::is_standard_output;
pub use unfinished::abandon_unfinished;
pub use write::{write_surface, write_surface_as};
