//! What spans a gap: small gaps are filled, large ones are holes.

use super::skin::{Face, Skin};
use crate::geom::Point3;

/// The skin without what closes holes whose rims are longer than `longest`, and without pieces that are nothing
/// but gaps; and how many gaps were filled.
///
/// Faces hang together over the sides that span a gap. Such a patch fills it, and its rim is that of the gap.
pub(super) fn trimmed(skin: Skin, points: &[Point3], longest: f64) -> (Skin, usize) {
    let is_open = |face: &Face, i: usize| !face.whole[i];
    let mut kept = vec![true; skin.faces.len()];
    let mut n_filled = 0;
    for patch in skin.pieces(is_open) {
        if skin.faces[patch[0] as usize].is_whole() {
            continue;
        }
        let is_within = |face: &Face, i: usize| !face.whole[i] && face.beyond[i].is_some();
        let is_hole = longest < skin.rim(points, &patch, is_within);
        n_filled += usize::from(!is_hole);
        for &face in &patch {
            kept[face as usize] = !is_hole;
        }
    }
    let skin = skin.only(&kept);
    let mut kept = vec![true; skin.faces.len()];
    for piece in skin.pieces(|_, _| true) {
        let is_kept = piece.iter().any(|&face| skin.faces[face as usize].is_whole());
        for &face in &piece {
            kept[face as usize] = is_kept;
        }
    }
    (skin.only(&kept), n_filled)
}
