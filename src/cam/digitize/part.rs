//! A part prepared for digitizing: its primitives, and the search tree over them.

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

/// The primitives in the user's order.
#[derive(Debug, Clone)]
pub(super) enum Primitives {
    Triangles(Vec<Facet>),
    Points(Vec<Point3>),
}

/// The best touch so far and what it is on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub(super) touch: Touch,
    /// Its number.
    pub(super) primitive: u32,
}

impl Part {
    /// Triangles, to be digitized exactly. Any soup will do; all its pieces count.
    pub fn triangles(mesh: &TriMesh) -> Self {
        let corners: Vec<[Point3; 3]> =
            (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect();
        let tree = PatchTree::build(&corners);
        let facets = corners.into_iter().map(Facet::new).collect();
        Self { tree, primitives: Primitives::Triangles(facets) }
    }

    /// Points alone: the thesis' mode. Between them the tool may sink in.
    pub fn points(cloud: &PointCloud) -> Self {
        let points: Vec<[Point3; 1]> = cloud.points.iter().map(|&point| [point]).collect();
        let tree = PatchTree::build(&points);
        Self { tree, primitives: Primitives::Points(cloud.points.clone()) }
    }

    /// Number of triangles or points.
    pub fn n_primitives(&self) -> usize {
        match &self.primitives {
            Primitives::Triangles(facets) => facets.len(),
            Primitives::Points(points) => points.len(),
        }
    }

    /// The better of `best` and what the tool touches of `primitive`.
    #[inline(always)]
    pub(super) fn try_one(
        &self,
        tool: &impl HeightFunction,
        view: &View,
        primitive: u32,
        best: &mut Option<Found>,
    ) {
        let touch = match &self.primitives {
            Primitives::Triangles(facets) => {
                let least = best.map_or(f64::NEG_INFINITY, |best| best.touch.height);
                touch::on_triangle(tool, view, &facets[primitive as usize], least)
            }
            Primitives::Points(points) => {
                touch::on_point(tool, view.see(&points[primitive as usize]))
            }
        };
        if let Some(touch) = touch {
            let found = Found { touch, primitive };
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
                view.facing(&facets[self.primitive as usize].normal)
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
