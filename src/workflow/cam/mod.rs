//! From a part to a program: set up, run, digitize, certify, schedule, post, read back, report.

mod certified;
mod heights;
mod options;
mod plan;
mod program;
mod report;
mod rough;
mod spacing;

pub use options::{CamOptions, Mode, OffPart, OptionsError};
pub use plan::{CamError, Job, Plan, Scene, plan};
pub use report::{CamReport, PartReport, RoughReport, RunReport, SetupReport};
pub use rough::rough;
pub use spacing::SpacingError;
