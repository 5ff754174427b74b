//! Contour-parallel runs: around the part's outline on the table, ring within ring.
//!
//! The rings are lines of equal distance from the outline of the part's shadow along the attack
//! axis, one pitch apart, from outside the part inwards until nothing is left. They only say where
//! the tool goes sideways: its height is digitized, links between the rings included, so that the
//! rings need no more than a drawing's precision. They run clockwise seen from the tool, which has
//! the uncut part on its right: climb milling with a spindle that turns clockwise.

mod field;
mod level;

use crate::geom::{Point3, TriMesh};
use field::Field;

/// Cells of the drawing to a pitch.
const CELLS: f64 = 4.0;
/// Its cells are no larger than this, however large the pitch [mm].
const COARSEST: f64 = 1.0;
/// More cells than this are not drawn: the cells become larger.
const MOST_CELLS: f64 = 4e6;

/// How far apart the rings are, and how far outside they begin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContourOptions {
    /// From ring to ring [mm].
    pub pitch: f64,
    /// Positions on a ring are this far apart or a little less [mm].
    pub step: f64,
    /// The first ring lies this far outside the outline [mm].
    pub overrun: f64,
}

/// A point across the attack axis: x and z of the attack frame [mm].
pub type Across = [f64; 2];

/// The run around the first `n_own` triangles of `mesh`, seen through `seen` in the attack frame:
/// ring after ring with the links between them, positions about `step` apart.
///
/// Empty if there is no triangle.
pub fn contours(
    mesh: &TriMesh,
    n_own: usize,
    seen: impl Fn(&Point3) -> Across,
    options: &ContourOptions,
) -> Vec<Across> {
    let triangles: Vec<[Across; 3]> =
        (0..n_own).map(|i| mesh.corners(i).map(|corner| seen(&corner))).collect();
    let cell = (options.pitch / CELLS).min(COARSEST);
    let Some(field) = Field::around(&triangles, options.overrun, cell, MOST_CELLS) else {
        return Vec::new();
    };
    let mut levels = Vec::new();
    let mut height = options.overrun;
    while field.deepest() < height {
        levels.push(level::rings(&field, height));
        height -= options.pitch;
    }
    let mut run = Vec::new();
    for ring in in_order(levels) {
        for point in ring {
            walk_to(&mut run, point, options.step);
        }
    }
    run
}

/// All rings, each closed and turned so that it begins near where the last one ended: onwards to
/// the next level while there is one, then to what an outer level still holds.
fn in_order(mut levels: Vec<Vec<Vec<Across>>>) -> Vec<Vec<Across>> {
    let mut ordered: Vec<Vec<Across>> = Vec::new();
    let (mut at, mut i_level) = ([f64::NEG_INFINITY, 0.0], 0);
    loop {
        let inner = i_level + 1;
        let outermost = || levels.iter().position(|rings| !rings.is_empty());
        let next = if levels.get(inner).is_some_and(|rings| !rings.is_empty()) {
            Some(inner)
        } else {
            outermost()
        };
        let Some(next) = next else { return ordered };
        i_level = next;
        let Some((i_ring, i_start)) = nearest(&levels[i_level], at) else { return ordered };
        let mut ring = levels[i_level].swap_remove(i_ring);
        ring.rotate_left(i_start);
        ring.push(ring[0]);
        at = ring[0];
        ordered.push(ring);
    }
}

/// The ring and its point closest to `at`.
fn nearest(rings: &[Vec<Across>], at: Across) -> Option<(usize, usize)> {
    let far = |point: &Across| (point[0] - at[0]).powi(2) + (point[1] - at[1]).powi(2);
    let points = rings.iter().enumerate().flat_map(|(i_ring, ring)| {
        ring.iter().enumerate().map(move |(i_point, point)| (far(point), i_ring, i_point))
    });
    let best = points.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((best.1, best.2))
}

/// Goes straight to `point` in steps of at most `step`; nearer than half a step it is passed over
/// unless it is the first.
fn walk_to(run: &mut Vec<Across>, point: Across, step: f64) {
    let Some(&from) = run.last() else {
        run.push(point);
        return;
    };
    let way = [point[0] - from[0], point[1] - from[1]];
    let length = way[0].hypot(way[1]);
    if length < step / 2.0 {
        return;
    }
    let n = (length / step).ceil().max(1.0);
    for i in 1..=n as usize {
        let share = i as f64 / n;
        run.push([from[0] + way[0] * share, from[1] + way[1] * share]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Aabb, Pose, shapes};

    const OPTIONS: ContourOptions = ContourOptions { pitch: 2.0, step: 1.0, overrun: 3.0 };

    fn from_above(point: &Point3) -> Across {
        [point.x, -point.y]
    }

    /// How far outside the square |x|, |z| <= half a point lies; negative inside.
    fn outside_square([x, z]: Across, half: f64) -> f64 {
        let (x, z) = (x.abs() - half, z.abs() - half);
        if x.max(z) < 0.0 { x.max(z) } else { x.max(0.0).hypot(z.max(0.0)) }
    }

    fn boxes(n: usize) -> TriMesh {
        let corners = [Point3::new(-20.0, -20.0, 0.0), Point3::new(20.0, 20.0, 10.0)];
        let mut mesh = TriMesh::default();
        for i in 0..n {
            let one = shapes::cuboid(&Aabb::around(&corners));
            mesh.append(one.moved(&Pose::translation(100.0 * i as f64, 0.0, 0.0)));
        }
        mesh
    }

    #[test]
    fn rings_lie_one_pitch_apart_from_the_overrun_inwards() {
        let mesh = boxes(1);
        let run = contours(&mesh, mesh.triangles.len(), from_above, &OPTIONS);
        // Off the links every position lies on one of the levels 3, 1, -1, -3, ... -19.
        let off = |point: &Across| {
            let level = (3.0 - outside_square(*point, 20.0)) / 2.0;
            (level - level.round()).abs() * 2.0
        };
        let near = run.iter().filter(|point| off(point) < 0.3).count();
        assert!(near * 100 > run.len() * 95, "{near} of {}", run.len());
        let farthest = run.iter().map(|p| outside_square(*p, 20.0)).fold(f64::MIN, f64::max);
        assert!((farthest - 3.0).abs() < 0.3, "{farthest}");
        let middle = run.iter().map(|p| p[0].hypot(p[1])).fold(f64::MAX, f64::min);
        assert!(middle < 2.0, "the middle is reached: {middle}");
    }

    #[test]
    fn no_step_is_longer_than_asked_for_not_even_from_part_to_part() {
        let mesh = boxes(2);
        let run = contours(&mesh, mesh.triangles.len(), from_above, &OPTIONS);
        let longest = run.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
        assert!(longest.fold(0.0, f64::max) <= 1.0 + 1e-9);
        assert!(run.iter().any(|p| p[0] < -10.0) && run.iter().any(|p| p[0] > 110.0));
    }

    #[test]
    fn rings_run_clockwise_seen_from_the_tool() {
        let mesh = boxes(1);
        let options = ContourOptions { pitch: 100.0, ..OPTIONS };
        let run = contours(&mesh, mesh.triangles.len(), from_above, &options);
        // Seen from the tool x points right and z down: a positive area in x and z is clockwise.
        let area: f64 = run.windows(2).map(|w| (w[0][0] * w[1][1] - w[1][0] * w[0][1]) / 2.0).sum();
        // Square with corners rounded by the overrun, to a cell of a millimetre.
        assert!((area / 2108.3 - 1.0).abs() < 0.05, "{area}");
    }

    #[test]
    fn of_nothing_there_is_no_run() {
        assert!(contours(&TriMesh::default(), 0, from_above, &OPTIONS).is_empty());
    }
}
