//! Shapes of known form: what tests compare with closed forms, and the last the demo cuts.
//!
//! All solids are closed and wound counter-clockwise seen from outside. Round ones run along X;
//! an angle `a` about X points to `y = cos a`, `z = sin a`, as a last lathe turns its part.

mod girth;
mod last;
mod solids;
mod spline;
mod star;
mod subdivide;

pub use last::{LastError, LastParameters, Side, last};
pub use solids::{cuboid, cylinder_points, prism, sphere, stub};
pub use star::{bumpy_cylinder, chiral};
pub use subdivide::subdivide;
