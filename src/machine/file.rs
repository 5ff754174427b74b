//! A machine file as it is written: keys, units and nesting, nothing checked yet.
//!
//! Lengths are millimetres; what can be millimetres or degrees says which in its key. The values
//! keep their place in the text, so that [`description`](super::description) can point at them.

use super::{AxisKind, Carries, Mount, ToolChanges};
use toml::Spanned;

/// A whole machine.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) struct MachineFile {
    pub(super) name: Spanned<String>,
    pub(super) title: Spanned<String>,
    pub(super) attack: Spanned<char>,
    pub(super) spindle: Option<Spanned<char>>,
    pub(super) mount: Spanned<Mount>,
    pub(super) clamping: ClampingFile,
    pub(super) dialect: Spanned<String>,
    pub(super) default_tool: Spanned<String>,
    pub(super) clearance: Spanned<f64>,
    pub(super) blocks_per_second: Spanned<f64>,
    #[serde(default)]
    pub(super) tool_changes: ToolChanges,
    pub(super) look_ahead_blocks: Option<Spanned<i64>>,
    pub(super) obstacles: Option<ObstaclesFile>,
    pub(super) axis: Vec<AxisFile>,
}

/// `[obstacles]`: what stands around the part.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) struct ObstaclesFile {
    pub(super) dogs: Option<Spanned<DogsFile>>,
    pub(super) table_radius: Option<Spanned<f64>>,
}

/// `dogs = { radius = 20, length = 60 }`
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) struct DogsFile {
    pub(super) radius: Spanned<f64>,
    pub(super) length: Spanned<f64>,
}

/// One axis. Of each pair of keys the one in the unit of the axis' kind must be given.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) struct AxisFile {
    pub(super) letter: Spanned<char>,
    pub(super) kind: Spanned<AxisKind>,
    pub(super) carries: Spanned<Carries>,
    pub(super) direction: Spanned<[f64; 3]>,
    pub(super) point: Option<Spanned<[f64; 3]>>,
    pub(super) sign: Spanned<i64>,
    pub(super) zero_mm: Option<Spanned<f64>>,
    pub(super) zero_deg: Option<Spanned<f64>>,
    pub(super) limits_mm: Option<Spanned<[f64; 2]>>,
    pub(super) limits_deg: Option<Spanned<[f64; 2]>>,
    pub(super) velocity_mm_per_s: Option<Spanned<f64>>,
    pub(super) velocity_deg_per_s: Option<Spanned<f64>>,
    pub(super) acceleration_mm_per_s2: Option<Spanned<f64>>,
    pub(super) acceleration_deg_per_s2: Option<Spanned<f64>>,
    pub(super) follows: Option<FollowFile>,
}

/// `follows = { axis = "A", ratio = -1 }`
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) struct FollowFile {
    pub(super) axis: Spanned<char>,
    pub(super) ratio: Spanned<f64>,
}

/// `clamping = "table"`, or a table `[clamping.nibs]` or `[clamping.cone]`.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", rename_all_fields = "kebab-case", deny_unknown_fields)]
pub(super) enum ClampingFile {
    Table,
    Nibs { radius: Spanned<f64>, length: Spanned<f64> },
    Cone { radius: Spanned<f64>, length: Spanned<f64>, gap: Spanned<f64> },
}
