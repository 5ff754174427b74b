//! What crosses modules, in one binary.

mod machine_files;
mod machines;
