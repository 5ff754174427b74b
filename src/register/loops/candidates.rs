//! Which key frames may show what an earlier one showed: those that look alike, and those that are near
//! by what the walk says.

use super::KeyFrame;
use crate::register::features::{Descriptor, MatchOptions, matches};
use rayon::prelude::*;

/// Features of a frame that are asked whether it looks alike.
const ASKED: usize = 300;
/// Fewer that match say nothing.
const LEAST_MATCHES: usize = 15;
/// A camera that is turned by more than this sees something else [rad],
const MOST_TURNED: f64 = 0.6;
/// and so does one that is farther away than this [share of the depth].
const MOST_MOVED: f64 = 0.5;

/// Two key frames, by their places in the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Candidate {
    pub(super) earlier: usize,
    pub(super) later: usize,
    /// Features that look alike, of [`ASKED`].
    pub(super) n_alike: usize,
}

/// Of each key frame the earlier one that looks most like it, and the nearest one, if there are any at
/// least `gap` key frames before it. In the order of the later ones.
pub(super) fn candidates(keys: &[KeyFrame], gap: usize) -> Vec<Candidate> {
    let of = |later: usize| {
        let before = 0..(later + 1).saturating_sub(gap.max(1) + 1);
        let with = |earlier: usize| {
            let n_alike = n_alike(&keys[earlier], &keys[later]);
            Candidate { earlier, later, n_alike }
        };
        let best = before
            .clone()
            .map(with)
            .filter(|candidate| candidate.n_alike >= LEAST_MATCHES)
            // Of as many matches the earlier one: it closes the longer loop.
            .rev()
            .max_by_key(|candidate| candidate.n_alike);
        let near =
            before.filter_map(|earlier| Some((earlier, apart(&keys[earlier], &keys[later])?)));
        let nearest = near.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(earlier, _)| earlier);
        let nearest = nearest.filter(|near| best.is_none_or(|best| best.earlier != *near));
        best.into_iter().chain(nearest.map(with)).collect::<Vec<_>>()
    };
    (0..keys.len()).into_par_iter().flat_map_iter(of).collect()
}

/// How many of the best features of one are found again in the other.
fn n_alike(one: &KeyFrame, other: &KeyFrame) -> usize {
    let asked = |key: &KeyFrame| -> Vec<Descriptor> {
        let features = key.look.features();
        features.map_or_else(Vec::new, |features| {
            features.descriptors.iter().take(ASKED).copied().collect()
        })
    };
    matches(&asked(one), &asked(other), &MatchOptions::default()).len()
}

/// How far apart two cameras are that may see the same: turns and shifts by how they move the picture.
fn apart(one: &KeyFrame, other: &KeyFrame) -> Option<f64> {
    let off = one.world_from_camera.inverse() * other.world_from_camera;
    let depth = one.look.median_depth.min(other.look.median_depth);
    let (turned, moved) = (off.rotation.angle(), off.translation.vector.norm() / depth);
    (turned < MOST_TURNED && moved < MOST_MOVED).then_some(turned + moved)
}
