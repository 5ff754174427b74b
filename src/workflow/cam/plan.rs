//! scratch
use super::{CamOptions, CamReport};
use crate::geom::{Point3, Surface};

/// What a job makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The program, as the bytes of its file; they were read back and give the path.
    pub text: Vec<u8>,
    /// What there is to say about it.
    pub report: CamReport,
    /// What there is to see, unless it was not asked for.
    pub scene: Option<Scene>,
}

/// What the pictures of a report show, in the part's frame on the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The part, then its clamps.
    pub surface: Surface,
    /// How many triangles (or points) are the part's own.
    pub n_own: usize,
    /// Where the tool touches, position by position (missed positions are left out).
    pub path: Vec<Point3>,
    /// Attack height over the position's number, thinned.
    pub heights: Vec<[f64; 2]>,
}
