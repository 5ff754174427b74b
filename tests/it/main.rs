//! What crosses modules, in one binary.

mod bad_files;
mod formats;
mod oracles;
mod parts;
