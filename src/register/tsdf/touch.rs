//! Which blocks a frame has something to say about.

use super::block::{Key, SIDE};
use super::volume::CORNERS;
use super::{Readings, TsdfOptions};
use crate::geom::{Point3, Pose, Vector3};
use rayon::prelude::*;

/// Rows looked at side by side.
const ROWS: usize = 32;
/// Pixels between those that are followed, at most.
const WIDEST_STEP: usize = 4;

/// The blocks within the truncation of what `readings` see, in order.
///
/// Rays are followed from before the surface to behind it, through every block they cross; where the
/// surface is, all blocks that have a lattice point within a voxel are taken too, so that no cell the
/// surface cuts lacks a corner.
pub(super) fn touched(
    readings: &Readings,
    world_from_camera: &Pose,
    options: &TsdfOptions,
) -> Vec<Key> {
    let (width, height) = (readings.pixels.width(), readings.pixels.height());
    let deepest =
        readings.pixels.pixels().iter().filter(|r| r.weight > 0.0).fold(0.0, |d, r| r.depth.max(d));
    // Two rays through each block, at least.
    let half = 0.5 * SIDE as f64 * options.voxel;
    let step = (half * readings.camera.fx.min(readings.camera.fy) / f64::from(deepest)) as usize;
    let step = step.clamp(1, WIDEST_STEP);
    let rows: Vec<usize> = (0..height).step_by(step).collect();
    let mut keys: Vec<Key> = rows
        .par_chunks(ROWS)
        .flat_map_iter(|rows| {
            let mut found = Found::default();
            for &y in rows {
                let seen = readings.pixels.row(y).iter().enumerate().step_by(step);
                for (x, reading) in seen.filter(|(_, reading)| reading.weight > 0.0) {
                    let [ray_x, ray_y] = readings.camera.ray([x as f64, y as f64]);
                    let ray = world_from_camera.rotation * Vector3::new(ray_x, ray_y, 1.0);
                    let eye = Point3::from(world_from_camera.translation.vector);
                    follow(&eye, &ray, f64::from(reading.depth), options, &mut found);
                }
            }
            found.keys
        })
        .collect();
    keys.par_sort_unstable();
    keys.dedup();
    debug_assert!(width * height > 0 || keys.is_empty());
    keys
}

/// Takes the blocks along a ray around `depth`.
fn follow(eye: &Point3, ray: &Vector3, depth: f64, options: &TsdfOptions, found: &mut Found) {
    let reach = options.truncation();
    // In blocks; the points of a block reach half a voxel around them.
    let scale = 1.0 / (SIDE as f64 * options.voxel);
    let shift = Vector3::repeat(0.5 / SIDE as f64);
    let at = |depth: f64| (eye + ray * depth).coords * scale + shift;
    let surface = at(depth);
    let around = Vector3::repeat(1.0 / SIDE as f64);
    for corner in CORNERS {
        let side = Vector3::from(corner.map(|c| 2.0 * c as f64 - 1.0));
        found.take(key_of(&(surface + around.component_mul(&side))));
    }
    walk(&at((depth - reach).max(0.0)), &at(depth + reach), |key| found.take(key));
}

/// The blocks between two places, one after the other (Amanatides and Woo, 1987).
fn walk(from: &Vector3, to: &Vector3, mut take: impl FnMut(Key)) {
    let (mut key, last) = (key_of(from), key_of(to));
    let way = to - from;
    let sign = way.map(|c| if c < 0.0 { -1 } else { 1 });
    // Shares of the way to the next border, and from border to border.
    let between = way.map(|c| if c == 0.0 { f64::INFINITY } else { 1.0 / c.abs() });
    let mut next = Vector3::from_fn(|k, _| {
        let border = f64::from(key[k]) + if sign[k] > 0 { 1.0 } else { 0.0 };
        if way[k] == 0.0 { f64::INFINITY } else { (border - from[k]) / way[k] }
    });
    take(key);
    let n_steps: u32 = (0..3).map(|k| key[k].abs_diff(last[k])).sum();
    for _ in 0..n_steps {
        let k = next.imin();
        key[k] += sign[k];
        next[k] += between[k];
        take(key);
    }
}

fn key_of(place: &Vector3) -> Key {
    [0, 1, 2].map(|k| place[k].floor() as i32)
}

/// Blocks found, hardly one of them twice.
struct Found {
    keys: Vec<Key>,
    /// Those found lately, by their last bits.
    lately: [Option<Key>; 64],
}

impl Default for Found {
    fn default() -> Self {
        Self { keys: Vec::new(), lately: [None; 64] }
    }
}

impl Found {
    fn take(&mut self, key: Key) {
        let [x, y, z] = key.map(|c| (c & 3) as usize);
        let slot = &mut self.lately[x + 4 * y + 16 * z];
        if *slot != Some(key) {
            *slot = Some(key);
            self.keys.push(key);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_passes_every_block_a_fine_step_finds() {
        let walks = [
            ([0.2, 0.3, 0.4], [3.7, -2.2, 1.9]),
            ([-0.5, 0.5, 0.5], [-0.5, 0.5, 4.5]),
            ([1.0, 1.0, 1.0], [-2.5, 1.0, 1.0]),
            ([0.1, 0.1, 0.1], [0.2, 0.2, 0.2]),
        ];
        for (from, to) in walks.map(|(a, b)| (Vector3::from(a), Vector3::from(b))) {
            let mut passed = Vec::new();
            walk(&from, &to, |key| passed.push(key));
            for i in 0..=10_000 {
                let key = key_of(&from.lerp(&to, f64::from(i) / 10_000.0));
                assert!(passed.contains(&key), "{key:?} of {from} to {to}");
            }
            let steps = passed.windows(2).map(|w| (0..3).map(|k| w[0][k].abs_diff(w[1][k])).sum());
            assert!(steps.into_iter().all(|n: u32| n == 1), "one border at a time");
        }
    }
}
