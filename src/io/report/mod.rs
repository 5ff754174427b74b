//! What people read after a job: pictures, charts, and one HTML page with everything inside.
//!
//! Nothing here touches a file. [`render`] turns a [`Scene`] into pixels, [`line_chart`],
//! [`bar_chart`] and [`heat_map`] turn numbers into SVG, and [`html`] turns a [`Page`] into the
//! text of a file that needs no other: no script, no font, no address.

mod band;
mod bars;
mod cam_page;
mod chart;
mod colour;
mod html;
mod odometry_plot;
mod page;
mod png;
mod raster;
mod scan_page;
mod scene;
mod shade;
mod svg;
mod ticks;
mod verify_page;

pub use bars::{Bar, bar_chart};
pub use cam_page::{cam_page, cam_summary};
pub use chart::{Labels, sheet};
pub use colour::heat;
pub use html::html;
pub use odometry_plot::odometry_plot;
pub use page::{Block, Figure, Image, Page, Picture, Section, Table};
pub use png::encode_png;
pub use raster::{Raster, render};
pub use scan_page::{fusion_page, scan_page};
pub use scene::{Camera, Path, Scene, Solid};
pub use svg::{Grid, Series, heat_map, line_chart, log_log_chart, plan_chart, signed_map};
pub use verify_page::{deviation_map, verify_page, verify_summary, with_cut};
