//! What crosses modules, in one binary.

mod command;
mod docs;
mod layers;
mod licences;
mod machine_files;
mod machines;
mod output;
mod shapes;
mod source;
