//! Pieces of one plane become one.

use super::flat::Fit;
use super::grow::Ground;
use std::cmp::Reverse;

/// The planes, those of them as one that touch and lie on one plane; the greatest draw others first.
pub(super) fn merged(
    ground: &mut Ground<'_>,
    mut found: Vec<(Fit, Vec<u32>)>,
) -> Vec<(Fit, Vec<u32>)> {
    let mut now_in: Vec<usize> = (0..found.len()).collect();
    let mut pairs = ground.touching();
    let size = |found: &[(Fit, Vec<u32>)], i: u32| found[i as usize].1.len();
    pairs.sort_by_key(|&[a, b]| Reverse(size(&found, a) + size(&found, b)));
    for pair in pairs {
        let [a, b] = pair.map(|i| now_in[i as usize]);
        if a == b {
            continue;
        }
        let both: Vec<u32> = found[a].1.iter().chain(&found[b].1).copied().collect();
        let Some(fit) = ground.as_one(&both) else { continue };
        found[a] = (fit, both);
        found[b].1.clear();
        now_in.iter_mut().filter(|i| **i == b).for_each(|i| *i = a);
    }
    found.retain(|(_, members)| !members.is_empty());
    found
}
