//! A wheel at work on a turned part.
//!
//! At a station `dx` beside the wheel's centre its section is a disc of radius
//! `A = R + sqrt(r^2 - dx^2)`, whatever way it attacks.

use super::disc::Disc;
use super::layout::At;
use super::shave::Blade;
use crate::tool::Wheel;

impl Blade for Wheel {
    type Section = Disc;

    #[inline(always)]
    fn half_width(&self) -> f64 {
        self.minor
    }

    #[inline(always)]
    fn section(&self, at: &At, dx: f64) -> Disc {
        let nose = (self.minor * self.minor - dx * dx).max(0.0).sqrt();
        Disc::new([at.point.y, at.point.z], self.major + nose)
    }
}
