//! What is told about a fusion.

use super::{FusedFrame, KeptOutReport};
use crate::geom::{TriMesh, topology};
use crate::register::pose_delay::PoseDelay;
use crate::workflow::cam::ComputeReport;
use crate::workflow::evaluate::EvaluationReport;
use crate::workflow::turns::TurnReport;
use crate::workflow::turntable::TurntableReport;
use serde::Serialize;

/// What is told about a fusion; lengths in mm.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FuseReport {
    /// Frames of the sequence.
    pub n_frames: usize,
    /// Frames that made the surface.
    pub n_fused: usize,
    /// True if they were placed by tracking.
    pub tracked: bool,
    /// The turntable that the part stood on, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turntable: Option<TurntableReport>,
    /// How late stamps are, if it was looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose_delay: Option<PoseDelay>,
    /// The turns of the part, if it was turned several times.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub turns: Vec<TurnReport>,
    /// Those that could not be placed.
    pub skipped: Vec<Skipped>,
    /// Those that made the surface.
    pub frames: Vec<FusedFrame>,
    /// Side of a voxel [mm].
    pub voxel: f64,
    /// Truncation [mm].
    pub truncation: f64,
    /// Blocks of 8 x 8 x 8 voxels.
    pub n_blocks: usize,
    /// What the model took [MB].
    pub memory_mb: f64,
    /// The surface.
    pub mesh: MeshSummary,
    /// Pieces that were dropped, too small to be anything.
    pub n_small_pieces: usize,
    /// Where it was computed.
    pub compute: ComputeReport,
    /// How far points of frames kept out lie from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept_out: Option<KeptOutReport>,
    /// How far tracking is off the truth, if it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_truth: Option<EvaluationReport>,
    /// What the user must know.
    pub notes: Vec<String>,
}

/// A frame that is not in the surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Skipped {
    /// Counted from 1, through all turns in the surface if there are several.
    pub number: usize,
    /// When it was taken [s].
    pub stamp: f64,
    /// Why.
    pub reason: String,
}

/// A surface in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MeshSummary {
    /// Vertices.
    pub n_points: usize,
    /// Triangles.
    pub n_triangles: usize,
    /// True if it has no border.
    pub is_closed: bool,
    /// Edges with one triangle.
    pub n_open_edges: usize,
    /// Pieces that hang together.
    pub n_pieces: usize,
    /// Its extent [mm].
    pub size: [f64; 3],
    /// Its area [mm2].
    pub area: f64,
    /// What it encloses, if it is closed [mm3].
    pub volume: Option<f64>,
}

impl MeshSummary {
    pub(super) fn of(mesh: &TriMesh) -> Self {
        let topology = topology(mesh);
        Self {
            n_points: mesh.points.len(),
            n_triangles: mesh.triangles.len(),
            is_closed: topology.is_closed(),
            n_open_edges: topology.n_open_edges,
            n_pieces: topology.n_components,
            size: mesh.aabb().size().into(),
            area: topology.area,
            volume: topology.volume,
        }
    }
}
