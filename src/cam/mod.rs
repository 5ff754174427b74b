//! From a part on a machine to a toolpath.

mod clamps;
mod digitize;
mod fit;
mod reach;
mod schedule;
mod setup;
mod toolpath;
mod trajectory;

pub use clamps::ClampError;
pub use digitize::{Contact, ContactKind, Digitizer, Method, Part};
pub use fit::{FitError, clear_word, room_beside, run_along, within};
pub use reach::{Place, ReachReport, Stand, reach};
pub use schedule::{
    Cause, Drive, FeedReport, Limit, Motion, Pass, PassOptions, Slowdowns, Slowed, Spot, Timing,
    drives, pass, time_motion,
};
pub use setup::{Centre, Setup, SetupError, SetupOptions, SpindleAxis, set_up};
pub use toolpath::{Move, Pace, Toolpath};
pub use trajectory::{Spacing, Strategy, Trajectory, TrajectoryError};
