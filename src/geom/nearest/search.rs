//! Going down a kd-tree: the near half first, the far half if the ball still reaches into it.

use super::Neighbour;
use super::kd_tree::{KdTree, Leaf, WIDTH, relative};
use crate::geom::Point3;

/// Deeper than any tree of 2^32 points.
const DEPTH: usize = 32;

/// What looks into the leaves that a shrinking ball reaches.
pub(super) trait Descent {
    /// The squared radius of the ball.
    fn reach(&self) -> f32;

    /// A leaf, and how far off its points are, squared.
    fn look(&mut self, leaf: &Leaf, squares: &[f32; WIDTH]);

    /// Shows `self` every leaf within reach of `place`.
    #[inline(always)]
    fn descend(&mut self, tree: &KdTree, place: &Point3) {
        let at = relative(place, &tree.origin);
        let n_splits = tree.splits.len();
        // A node, the squared distance of its region, and that along each axis.
        let mut waiting = [(0_u32, 0.0_f32, [0.0_f32; 3]); DEPTH];
        let mut n_waiting = 1;
        while 0 < n_waiting {
            n_waiting -= 1;
            let (node, bound, mut out) = waiting[n_waiting];
            if bound >= self.reach() {
                continue;
            }
            let mut node = node as usize;
            while node < n_splits {
                let split = tree.splits[node];
                let axis = split.axis as usize % 3;
                let beyond = at[axis] - split.value;
                let is_right = beyond >= 0.0;
                let near = 2 * node + 1 + usize::from(is_right);
                let far = 2 * node + 2 - usize::from(is_right);
                let kept = std::mem::replace(&mut out[axis], beyond);
                let bound = out[0] * out[0] + out[1] * out[1] + out[2] * out[2];
                if bound < self.reach() {
                    waiting[n_waiting] = (far as u32, bound, out);
                    n_waiting += 1;
                }
                out[axis] = kept;
                node = near;
            }
            let leaf = &tree.leaves[node - n_splits];
            self.look(leaf, &squares(leaf, at));
        }
    }
}

#[inline(always)]
fn squares(leaf: &Leaf, at: [f32; 3]) -> [f32; WIDTH] {
    let mut squares = [0.0; WIDTH];
    for (lane, square) in squares.iter_mut().enumerate() {
        let out = [0, 1, 2].map(|k| leaf.at[k][lane] - at[k]);
        *square = out[0] * out[0] + out[1] * out[1] + out[2] * out[2];
    }
    squares
}

/// The nearest and the next.
pub(super) struct TwoNearest {
    squares: [f32; 2],
    points: [u32; 2],
}

impl TwoNearest {
    pub(super) fn new(within: f64) -> Self {
        Self { squares: [square(within); 2], points: [u32::MAX; 2] }
    }

    pub(super) fn search(mut self, tree: &KdTree, place: &Point3) -> [Option<Neighbour>; 2] {
        self.descend(tree, place);
        [0, 1].map(|i| neighbour(self.points[i], self.squares[i]))
    }
}

impl Descent for TwoNearest {
    fn reach(&self) -> f32 {
        self.squares[1]
    }

    #[inline(always)]
    fn look(&mut self, leaf: &Leaf, squares: &[f32; WIDTH]) {
        for (&square, &point) in squares.iter().zip(&leaf.points) {
            if square < self.squares[1] {
                if square < self.squares[0] {
                    self.squares = [square, self.squares[0]];
                    self.points = [point, self.points[0]];
                } else {
                    self.squares[1] = square;
                    self.points[1] = point;
                }
            }
        }
    }
}

/// The `k` nearest, kept sorted.
pub(super) struct KNearest {
    k: usize,
    reach: f32,
    found: Vec<(f32, u32)>,
}

impl KNearest {
    pub(super) fn new(k: usize, within: f64) -> Self {
        Self { k, reach: square(within), found: Vec::with_capacity(k + 1) }
    }

    /// Looks no farther than `within` from now on.
    pub(super) fn limit(&mut self, within: f64) {
        self.reach = square(within);
    }

    pub(super) fn search(&mut self, tree: &KdTree, place: &Point3, found: &mut Vec<Neighbour>) {
        self.found.clear();
        if 0 < self.k {
            self.descend(tree, place);
        }
        found.clear();
        found.extend(self.found.iter().filter_map(|&(square, point)| neighbour(point, square)));
    }
}

impl Descent for KNearest {
    fn reach(&self) -> f32 {
        self.reach
    }

    #[inline(always)]
    fn look(&mut self, leaf: &Leaf, squares: &[f32; WIDTH]) {
        for (&square, &point) in squares.iter().zip(&leaf.points) {
            if square < self.reach {
                let place = self.found.iter().rposition(|entry| entry.0 <= square);
                self.found.insert(place.map_or(0, |i| i + 1), (square, point));
                if self.found.len() > self.k {
                    self.found.pop();
                }
                if self.found.len() == self.k {
                    self.reach = self.found[self.k - 1].0;
                }
            }
        }
    }
}

/// Rounded up, so that what lies at `within` less a rounding error is found.
fn square(within: f64) -> f32 {
    let within = within.max(0.0) as f32;
    (within * within).next_up()
}

fn neighbour(point: u32, square: f32) -> Option<Neighbour> {
    (point != u32::MAX).then(|| Neighbour { index: point, distance: f64::from(square.sqrt()) })
}
