//! One pure function per job: values in, values out.

pub mod cam;
pub mod evaluate;
pub mod fuse;
pub mod mesh;
pub mod reduce;
pub mod register;
pub mod scan;
pub mod simulate_scan;
pub mod turns;
pub mod turntable;
pub mod verify;
pub mod views;
