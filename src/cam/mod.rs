//! From a part on a machine to a toolpath.

mod block;
mod certify;
mod clamps;
mod contour;
mod digitize;
mod fit;
mod reach;
mod rough;
mod schedule;
mod setup;
mod tilt;
mod toolpath;
mod trajectory;

pub use block::{Block, BlockError};
pub use certify::{
    Certificate, Certified, CertifyOptions, Draft, Grid, Lift, ShortestStep, certify,
};
pub use clamps::ClampError;
pub use contour::{Across, ContourOptions, contours};
pub use digitize::{
    Contact, ContactKind, Device, DigitizeError, Digitized, Digitizer, Method, Part,
};
pub use fit::{FitError, clear_word, room_beside, run_along, within};
pub use reach::{Place, ReachReport, Stand, reach};
pub use rough::{Cut, RoughError, RoughOptions, Roughing};
pub use schedule::{
    Cause, Drive, FeedReport, Limit, Motion, Pass, PassOptions, Slow, Slowdowns, Slowed, Spot,
    Timing, drives, pass, time_motion,
};
pub use setup::{Centre, Setup, SetupError, SetupOptions, SpindleAxis, TABLE_GAP, set_up};
pub use tilt::{TiltError, TurnLine};
pub use toolpath::{Move, Pace, Position, Toolpath};
pub use trajectory::{Spacing, Strategy, Trajectory, TrajectoryError};
