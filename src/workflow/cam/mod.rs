//! From a part to a program: set up, run, digitize, certify, schedule, post, read back, report.

mod both;
mod certified;
mod computing;
mod cutting;
mod ground;
mod heights;
mod job;
mod links;
mod operation;
mod options;
mod plan;
mod program;
mod report;
mod rough;
mod spacing;
mod warn;

pub use both::{is_one_program, rough_and_finish};
pub use computing::ComputeReport;
pub use job::{CamError, Job, Plan, Scene};
pub use options::{CamOptions, Mode, OffPart, OptionsError};
pub use plan::plan;
pub use report::{CamReport, LinkReport, PartReport, RoughReport, RunReport, SetupReport, Work};
pub use rough::rough;
pub use spacing::SpacingError;
