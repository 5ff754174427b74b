//! What is where in an octree.

use super::code::Code;
use super::{Node, Octree, OctreeCell};
use crate::geom::{Aabb, Point3};

impl Octree {
    /// The leaf that a place is in, if it has points.
    pub fn leaf_at(&self, place: &Point3) -> Option<OctreeCell> {
        let half = 1_i64 << (self.depth() - 1);
        let cell = (place - self.cells.origin) / self.cells.side;
        let along = [cell.x, cell.y, cell.z].map(|x| x.floor() as i64 + half);
        self.leaf(along)
    }

    /// The leaves that touch the leaf `index`, of 26 at most.
    pub fn neighbours(&self, index: usize) -> Vec<OctreeCell> {
        let Some(node) = self.leaves().get(index) else { return Vec::new() };
        let at = node.code.along().map(i64::from);
        let step = |i: i64| [at[0] + i / 9 - 1, at[1] + i / 3 % 3 - 1, at[2] + i % 3 - 1];
        (0..27).filter(|i| *i != 13).filter_map(|i| self.leaf(step(i))).collect()
    }

    /// The leaves that share a place with the box.
    pub fn leaves_in(&self, aabb: &Aabb) -> Vec<OctreeCell> {
        let mut found = Vec::new();
        let mut waiting = vec![(0, 0)];
        while let Some((level, index)) = waiting.pop() {
            let cell = self.cell(level, index);
            let is_apart = |k: usize| {
                aabb.max[k] < cell.middle[k] - cell.side / 2.0
                    || cell.middle[k] + cell.side / 2.0 < aabb.min[k]
            };
            if (0..3).any(is_apart) {
                continue;
            }
            if level == self.depth() {
                found.push(cell);
                continue;
            }
            let Node { first, occupied, .. } = &self.levels[level][index];
            let n_below = occupied.count_ones() as usize;
            // Those with lower codes are looked at first.
            waiting.extend((*first..first + n_below).rev().map(|i| (level + 1, i)));
        }
        found
    }

    fn leaves(&self) -> &[Node] {
        self.levels.last().map_or(&[], Vec::as_slice)
    }

    /// The leaf so many cells from the lowest corner of the root.
    fn leaf(&self, along: [i64; 3]) -> Option<OctreeCell> {
        let n = 1_i64 << self.depth();
        let is_inside = along.iter().all(|x| (0..n).contains(x));
        let code = is_inside.then(|| Code::at(along.map(|x| x as u32)))?;
        let index = self.leaves().binary_search_by_key(&code, |node| node.code).ok()?;
        Some(self.cell(self.depth(), index))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{octree, sheet};
    use super::*;
    use crate::geom::Vector3;

    #[test]
    fn the_leaf_at_a_point_holds_it() {
        let cloud = sheet(2000);
        let octree = octree(&cloud, 4.0);
        for point in &cloud.points {
            let leaf = octree.leaf_at(point).unwrap();
            assert!((leaf.middle - point).amax() <= 2.0 + 1e-9);
        }
        assert_eq!(octree.leaf_at(&Point3::new(-1e9, 0.0, f64::NAN)), None);
    }

    #[test]
    fn leaves_in_a_box_and_neighbours_are_those_found_by_trying_all() {
        let octree = octree(&sheet(4000), 3.0);
        let all: Vec<OctreeCell> = octree.level(octree.depth()).collect();
        let corner = Point3::new(1020.0, 11.0, -3.0);
        let aabb = Aabb::around([&corner, &(corner + Vector3::new(25.0, 17.0, 6.0))]);
        let meets = |cell: &&OctreeCell| {
            (0..3)
                .all(|k| aabb.min[k] <= cell.middle[k] + 1.5 && cell.middle[k] - 1.5 <= aabb.max[k])
        };
        let expected: Vec<OctreeCell> = all.iter().filter(meets).copied().collect();
        assert!(10 < expected.len());
        assert_eq!(octree.leaves_in(&aabb), expected);
        for cell in all.iter().step_by(37) {
            let touches = |other: &&OctreeCell| {
                other.index != cell.index && (other.middle - cell.middle).amax() < 4.0
            };
            let expected: Vec<usize> = all.iter().filter(touches).map(|c| c.index).collect();
            let mut found: Vec<usize> =
                octree.neighbours(cell.index).iter().map(|c| c.index).collect();
            found.sort_unstable();
            assert_eq!(found, expected);
        }
        assert!(octree.neighbours(all.len()).is_empty());
    }
}
