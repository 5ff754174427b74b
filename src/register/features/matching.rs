//! Descriptors of one picture matched with those of another.

use super::Descriptor;
use rayon::prelude::*;

/// A feature found again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Match {
    /// Its place among the first picture's features.
    pub first: usize,
    /// Its place among the second picture's.
    pub second: usize,
    /// Bits that differ.
    pub distance: u32,
}

/// What is taken for the same feature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchOptions {
    /// Bits that may differ, of 256.
    pub most_different: u32,
    /// The nearest must have fewer different bits than this share of the second nearest's.
    pub ratio: f64,
}

impl Default for MatchOptions {
    fn default() -> Self {
        Self { most_different: 72, ratio: 0.85 }
    }
}

/// Pairs of which each is the other's nearest, and much nearer than the next.
pub fn matches(first: &[Descriptor], second: &[Descriptor], options: &MatchOptions) -> Vec<Match> {
    let (there, back) = rayon::join(|| nearest(first, second), || nearest(second, first));
    let mutual = |(i, found): (usize, &Option<Nearest>)| {
        let Nearest { index, distance, next } = (*found)?;
        let is_mutual = back[index].is_some_and(|other| other.index == i);
        let is_near = distance <= options.most_different;
        let is_alone = f64::from(distance) < options.ratio * f64::from(next);
        let found = Match { first: i, second: index, distance };
        (is_mutual && is_near && is_alone).then_some(found)
    };
    there.iter().enumerate().filter_map(mutual).collect()
}

/// The nearest descriptor, and how far off the next one is.
#[derive(Debug, Clone, Copy)]
struct Nearest {
    index: usize,
    distance: u32,
    next: u32,
}

fn nearest(of: &[Descriptor], among: &[Descriptor]) -> Vec<Option<Nearest>> {
    of.par_iter()
        .map(|own| {
            let mut best: Option<Nearest> = None;
            for (index, other) in among.iter().enumerate() {
                let distance = different(own, other);
                match &mut best {
                    Some(found) if distance >= found.distance => {
                        found.next = found.next.min(distance);
                    }
                    found => {
                        let next = found.map_or(u32::MAX, |before| before.distance);
                        *found = Some(Nearest { index, distance, next });
                    }
                }
            }
            best
        })
        .collect()
}

/// How many bits differ.
#[inline]
fn different(one: &Descriptor, other: &Descriptor) -> u32 {
    one.iter().zip(other).map(|(a, b)| (a ^ b).count_ones()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: MatchOptions = MatchOptions { most_different: 256, ratio: 1.0 };

    #[test]
    fn only_mutual_neighbours_match() {
        // Both of the first are nearest to 0b1 of the second, which is nearest to the first of them.
        let first = [[0b1, 0, 0, 0], [0b111, 0, 0, 0]];
        let second = [[0b1, 0, 0, 0], [u64::MAX, 0, 0, 0]];
        let found = matches(&first, &second, &ALL);
        assert_eq!(found, [Match { first: 0, second: 0, distance: 0 }]);
    }

    #[test]
    fn a_match_with_a_rival_is_none() {
        let second = [[0b1, 0, 0, 0], [0b10, 0, 0, 0]];
        assert_eq!(matches(&[[0b11, 0, 0, 0]], &second, &ALL), [], "both differ in one bit");
        let options = MatchOptions { ratio: 0.6, ..ALL };
        let alone = [[0b1, 0, 0, 0], [0b0110_0001, 0, 0, 0]];
        assert_eq!(matches(&[[0b11, 0, 0, 0]], &alone, &options).len(), 1);
        let few = MatchOptions { most_different: 0, ..ALL };
        assert_eq!(matches(&[[0b11, 0, 0, 0]], &alone, &few), []);
        assert_eq!(matches(&[], &alone, &ALL), []);
        assert_eq!(matches(&alone, &[], &ALL), []);
    }
}
