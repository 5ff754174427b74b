//! What is told of a turn.

use super::Turn;
use crate::geom::Pose;
use crate::workflow::turntable::TurntableReport;
use serde::Serialize;

/// What is told of a turn. Lengths in millimetres.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct TurnReport {
    /// What it is called.
    pub name: String,
    /// Its frames.
    pub n_frames: usize,
    /// How it turned, if that is known.
    pub turntable: Option<TurntableReport>,
    /// The motion that lays it on the first turn that is in the surface, row by row; nothing if it is left
    /// out.
    pub first_from_turn: Option<[[f64; 4]; 3]>,
    /// The share of it and of the turn it lies on best that lies on each other; nothing if it lies on
    /// none.
    pub lies_on_others: Option<f64>,
    /// Why it is left out.
    pub reasons: Vec<String>,
}

impl TurnReport {
    pub(super) fn new(turn: &Turn) -> Self {
        Self {
            name: turn.name.clone(),
            n_frames: turn.stamps.len(),
            turntable: None,
            first_from_turn: None,
            lies_on_others: None,
            reasons: Vec::new(),
        }
    }

    /// True if it is in the surface.
    pub fn is_in(&self) -> bool {
        self.first_from_turn.is_some()
    }

    pub(super) fn place(&mut self, first_from_turn: &Pose) {
        let matrix = first_from_turn.to_homogeneous();
        let rows = [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| matrix[(i, j)]));
        self.first_from_turn = Some(rows);
    }
}
