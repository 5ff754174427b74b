//! Depth made smoother, and rid of readings that belong to no surface.

mod bilateral;
mod outliers;

pub use bilateral::{BilateralOptions, bilateral};
pub use outliers::{OutlierOptions, Outliers, drop_outliers};
