//! Tools: convex profiles of revolution and what is known of the cutter around them.

mod body;
mod check;
mod cutter;
mod degrees;
mod error;
mod height;
mod library;
mod mill;
mod place;
mod profile;
mod shape;
mod shorthand;
mod wheel;

pub use body::{Axle, Body, BodyError, BodyPart, Cylinder, Side};
pub use cutter::Cutter;
pub use error::ToolError;
pub(crate) use error::{hint, nearest};
pub use height::{HeightFunction, Jet, Reach, Rim, Sharpness, Swept, Tangent};
pub use library::ToolLibrary;
pub use mill::Mill;
pub use place::Place;
pub(crate) use place::printable;
pub use profile::Profile;
pub use shape::Shape;
pub use wheel::Wheel;
pub(crate) use wheel::disc_chord;

/// A cutter as the tool library lists it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    /// Its place in the tool changer: the T word.
    pub number: u32,
    /// The name it is called by.
    pub name: String,
    /// The shape that cuts.
    pub profile: Profile,
    /// Length from the spindle nose to the programmed point [mm].
    pub length: f64,
    /// Spindle speed [rpm].
    pub speed_rpm: f64,
    /// Which way it turns.
    pub turns: Turns,
    /// Cutting feed at the contact [mm/s].
    pub feed: f64,
    /// Feed of a plunge into the material [mm/s].
    pub plunge_feed: f64,
    /// What of it does not cut, if its library says so.
    pub body: Option<Body>,
}

/// Which way a cutter's spindle turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Turns {
    /// M3.
    Clockwise,
    /// M4.
    CounterClockwise,
}
