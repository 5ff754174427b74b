//! What crosses modules, in one binary.

mod linuxcnc;
mod programs;
mod rs274;
mod small_machines;
