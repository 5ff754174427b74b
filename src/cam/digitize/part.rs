//! A part prepared for digitizing: its primitives in the order of a search tree.

use super::Contact;
use super::touch::{self, ContactKind, Facet, Touch};
use super::view::View;
use crate::geom::{PatchTree, Point3, PointCloud, TriMesh};
use crate::tool::HeightFunction;

/// What is to be digitized, with its tree.
#[derive(Debug, Clone)]
pub struct Part {
    pub(super) tree: PatchTree,
    pub(super) primitives: Primitives,
}

/// The primitives in leaf order.
#[derive(Debug, Clone)]
pub(super) enum Primitives {
    Triangles(Vec<Facet>),
    Points(Vec<Point3>),
}

/// The best touch so far and what it is on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub(super) touch: Touch,
    /// Place in leaf order.
    pub(super) place: u32,
    /// The user's number of the primitive.
    pub(super) primitive: u32,
}

impl Part {
    /// Triangles, to be digitized exactly. Any soup will do; all its pieces count.
    pub fn triangles(mesh: &TriMesh) -> Self {
        let corners: Vec<[Point3; 3]> =
            (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect();
        let tree = PatchTree::build(&corners);
        let facets = tree.order.iter().map(|&i| Facet::new(corners[i as usize])).collect();
        Self { tree, primitives: Primitives::Triangles(facets) }
    }

    /// Points alone: the thesis' mode. Between them the tool may sink in.
    pub fn points(cloud: &PointCloud) -> Self {
        let points: Vec<[Point3; 1]> = cloud.points.iter().map(|&point| [point]).collect();
        let tree = PatchTree::build(&points);
        let ordered = tree.order.iter().map(|&i| cloud.points[i as usize]).collect();
        Self { tree, primitives: Primitives::Points(ordered) }
    }

    /// Number of triangles or points.
    pub fn n_primitives(&self) -> usize {
        self.tree.order.len()
    }

    /// The better of `best` and what the tool touches at `place` in leaf order.
    #[inline]
    pub(super) fn try_place(
        &self,
        tool: &impl HeightFunction,
        view: &View,
        place: u32,
        best: &mut Option<Found>,
    ) {
        let touch = match &self.primitives {
            Primitives::Triangles(facets) => {
                let least = best.map_or(f64::NEG_INFINITY, |best| best.touch.height);
                touch::on_triangle(tool, view, &facets[place as usize], least)
            }
            Primitives::Points(points) => touch::on_point(tool, view.see(&points[place as usize])),
        };
        if let Some(touch) = touch {
            let found = Found { touch, place, primitive: self.tree.order[place as usize] };
            if best.is_none_or(|best| best.is_beaten_by(&found)) {
                *best = Some(found);
            }
        }
    }
}

impl Found {
    /// The greatest height wins, then the lowest number.
    fn is_beaten_by(&self, other: &Self) -> bool {
        (self.touch.height, other.primitive) < (other.touch.height, self.primitive)
    }

    /// The contact in the part frame.
    pub(super) fn contact(&self, part: &Part, tool: &impl HeightFunction, view: &View) -> Contact {
        let Touch { height, at, kind } = self.touch;
        let normal = match (&part.primitives, kind) {
            (Primitives::Triangles(facets), ContactKind::Facet) => {
                view.facing(&facets[self.place as usize].normal)
            }
            _ => tool.normal_at(at.x, at.z),
        };
        Contact {
            height,
            point: view.part_point(&at),
            normal: view.part_direction(&normal),
            primitive: self.primitive,
            kind,
        }
    }
}
