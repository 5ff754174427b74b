//! Pairing by the picture: what a camera would see where the point is.
//!
//! The point is put before the target's camera, and only what was seen around that pixel is looked at.
//! That needs no tree and never pairs a point with a surface far off its line of sight. Blais and
//! Levine (1995); here the nearest point of the cells around is taken, not the one at the pixel.

use super::view::View;
use crate::geom::{Nearest, Neighbour, Point3};
use crate::rgbd::Camera;

/// Cells along a side of the picture, at most.
const MOST: f64 = 512.0;

/// The points of a view by where its camera sees them.
#[derive(Debug)]
pub(super) struct Projective<'a> {
    view: &'a View,
    camera: Camera,
    /// Side of a cell [px].
    cell: f64,
    size: [usize; 2],
    /// Where each cell's points begin among `points`, and where the last one's end.
    firsts: Vec<u32>,
    points: Vec<u32>,
}

impl<'a> Projective<'a> {
    /// Cells about as large as a voxel at the usual depth.
    pub(super) fn new(view: &'a View, camera: Camera) -> Self {
        let depth = |point: &Point3| (point.z + view.center.z).max(0.0);
        let mean = view.points.iter().map(depth).sum::<f64>() / view.len().max(1) as f64;
        let least = camera.width.max(camera.height) as f64 / MOST;
        let cell = (camera.fx * view.voxel / mean.max(view.voxel)).max(least);
        let size = [camera.width, camera.height].map(|n| (n as f64 / cell).ceil() as usize);
        let mut projective =
            Self { view, camera, cell, size, firsts: Vec::new(), points: Vec::new() };
        let mut keyed: Vec<(u32, u32)> = (0_u32..)
            .zip(&view.points)
            .filter_map(|(i, point)| {
                let [x, y] = projective.cell_of(point)?;
                Some(((y * size[0] + x) as u32, i))
            })
            .collect();
        keyed.sort_unstable();
        projective.firsts = (0..=(size[0] * size[1]) as u32)
            .map(|cell| keyed.partition_point(|(key, _)| *key < cell) as u32)
            .collect();
        projective.points = keyed.into_iter().map(|(_, i)| i).collect();
        projective
    }

    /// Where the camera sees a point that is given about the view's centre.
    fn cell_of(&self, point: &Point3) -> Option<[usize; 2]> {
        let pixel = self.camera.project(&(point + self.view.center.coords))?;
        let cells = pixel.map(|x| ((x + 0.5) / self.cell).floor());
        let is_inside = |k: usize| 0.0 <= cells[k] && cells[k] < self.size[k] as f64;
        (is_inside(0) && is_inside(1)).then(|| cells.map(|x| x as usize))
    }
}

impl Nearest for Projective<'_> {
    fn two_nearest(&self, place: &Point3, within: f64) -> [Option<Neighbour>; 2] {
        let mut found = [None::<Neighbour>; 2];
        let Some([x, y]) = self.cell_of(place) else { return found };
        for row in y.saturating_sub(1)..(y + 2).min(self.size[1]) {
            let first = row * self.size[0] + x.saturating_sub(1);
            let end = row * self.size[0] + (x + 2).min(self.size[0]);
            let range = self.firsts[first] as usize..self.firsts[end] as usize;
            for &index in &self.points[range] {
                let distance = (self.view.points[index as usize] - place).norm();
                let neighbour = Neighbour { index, distance };
                if distance >= within || found[1].is_some_and(|other| distance >= other.distance) {
                    continue;
                }
                if found[0].is_none_or(|other| distance < other.distance) {
                    found = [Some(neighbour), found[0]];
                } else {
                    found[1] = Some(neighbour);
                }
            }
        }
        found
    }

    /// Another place asks other cells: no answer lasts.
    fn reach(&self) -> f64 {
        0.0
    }
}
