//! What crosses modules, in one binary.

mod bad_files;
mod cam_command;
mod cam_paths;
mod cam_refusals;
mod chirality;
mod command;
mod docs;
mod foot_program;
mod formats;
mod jobs;
mod layers;
mod licences;
mod linuxcnc;
mod machine_files;
mod machines;
mod oracles;
mod output;
mod parts;
mod programs;
mod rs274;
mod shapes;
mod small_machines;
mod source;
