//! One pure function per job: values in, values out.

pub mod cam;
pub mod register;
pub mod verify;
