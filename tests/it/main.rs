//! What crosses modules, in one binary.

mod bad_files;
mod command;
mod docs;
mod formats;
mod last;
mod layers;
mod licences;
mod linuxcnc;
mod machine_files;
mod machines;
mod oracles;
mod output;
mod page;
mod parts;
mod programs;
mod rs274;
mod shapes;
mod small_machines;
mod source;
