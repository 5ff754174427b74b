//! What simulated surfaces look like.

use crate::geom::Point3;

/// What a surface is painted with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// The pattern.
    pub kind: TextureKind,
    /// The size of its patches [mm].
    pub size: f64,
    /// Tells one pattern from another.
    pub seed: u64,
}

/// A pattern.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum TextureKind {
    /// One light grey: visual methods have nothing to see but edges and shade.
    Plain,
    /// The colours of the mesh's vertices; plain where it has none.
    Vertices,
    /// Coloured patches, fixed to the surface, with corners and fine grain.
    Patches,
}

impl Default for Texture {
    fn default() -> Self {
        Self { kind: TextureKind::Plain, size: 40.0, seed: 0 }
    }
}

/// The grey of what has no colour.
pub(super) const GREY: [f64; 3] = [0.72, 0.71, 0.69];

impl Texture {
    /// The colour of the pattern at a place in the world, 0 to 1; `None` if it has none of its own.
    pub(super) fn color(&self, place: &Point3) -> Option<[f64; 3]> {
        if self.kind != TextureKind::Patches {
            return None;
        }
        let at = |size: f64, salt: u64| value_noise(&(place / size), mixed(self.seed ^ salt));
        let [shade, ..] = at(self.size * 5.0, 1);
        let patch = at(self.size, 2);
        let [grain, ..] = at(self.size / 5.0, 3);
        // Steep where the noise passes its middle: patches with corners for features to hold on to. What
        // all colours share is what grey pictures see.
        let common = 0.1 + 0.3 * shade + 0.25 * steep(patch[3]) + 0.2 * grain;
        Some([0, 1, 2].map(|k| (common + 0.3 * (steep(patch[k]) - 0.3)).clamp(0.0, 1.0)))
    }
}

fn steep(value: f64) -> f64 {
    smooth(((value - 0.4) / 0.2).clamp(0.0, 1.0))
}

fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// Four random values at whole coordinates, smooth in between (K. Perlin's first noise), 0 to 1.
fn value_noise(place: &Point3, seed: u64) -> [f64; 4] {
    let cell = [place.x.floor(), place.y.floor(), place.z.floor()];
    let ends = [0, 1, 2].map(|k| [cell[k] as i64, (cell[k] as i64).wrapping_add(1)]);
    let weights = [0, 1, 2].map(|k| {
        let share = smooth(place[k] - cell[k]);
        [1.0 - share, share]
    });
    let mut sums = [0.0; 4];
    for x in 0..2 {
        let along = mixed(seed ^ ends[0][x].cast_unsigned());
        for y in 0..2 {
            let across = mixed(along ^ ends[1][y].cast_unsigned());
            for z in 0..2 {
                let drawn = mixed(across ^ ends[2][z].cast_unsigned());
                let weight = weights[0][x] * weights[1][y] * weights[2][z] / 65535.0;
                for (k, sum) in sums.iter_mut().enumerate() {
                    *sum += weight * (drawn >> (16 * k) & 0xffff) as f64;
                }
            }
        }
    }
    sums
}

/// `SplitMix64`'s step (S. Vigna; public domain): every bit of the input reaches every bit of the output.
pub(super) fn mixed(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_stay_on_their_place_are_smooth_and_differ_by_seed() {
        let texture = Texture { kind: TextureKind::Patches, ..Texture::default() };
        let at = |x: f64| texture.color(&Point3::new(x, 20.0, -300.0)).unwrap();
        let colors: Vec<_> = (0..4000).map(|i| at(f64::from(i) * 0.25)).collect();
        let steps = colors.windows(2).map(|w| (w[0][0] - w[1][0]).abs());
        assert!(steps.fold(0.0, f64::max) < 0.1, "smooth at a quarter of a millimetre");
        let mean = colors.iter().map(|c| c[0]).sum::<f64>() / 4000.0;
        let spread = (colors.iter().map(|c| (c[0] - mean).powi(2)).sum::<f64>() / 4000.0).sqrt();
        assert!(spread > 0.12, "{spread}");
        let other = Texture { seed: 1, ..texture };
        assert_ne!(other.color(&Point3::origin()), texture.color(&Point3::origin()));
    }

    #[test]
    fn plain_has_no_colour_of_its_own() {
        assert_eq!(Texture::default().color(&Point3::origin()), None);
    }
}
