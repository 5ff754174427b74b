//! A part prepared for digitizing: its primitives, and the search tree over them.

use super::Contact;
use super::touch::{self, ContactKind, Facet, Touch};
use super::view::View;
use crate::geom::{PatchTree, Point3, PointCloud, TriMesh};
use crate::tool::HeightFunction;
use fearless_simd::Simd;

/// What is to be digitized, with its tree.
#[derive(Debug, Clone)]
pub struct Part {
    pub(super) primitives: Primitives,
}

/// The primitives in the user's order.
#[derive(Debug, Clone)]
pub(super) enum Primitives {
    Triangles(Vec<Facet>, PatchTree<3>),
    Points(Vec<Point3>, PatchTree<1>),
}

/// The tree over them.
pub(in crate::cam) enum Tree<'a> {
    Triangles(&'a PatchTree<3>),
    Points(&'a PatchTree<1>),
}

/// The best touch so far and what it is on.
#[derive(Debug, Clone, Copy)]
pub(in crate::cam) struct Found {
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
        Self { primitives: Primitives::Triangles(facets, tree) }
    }

    /// Points alone: the thesis' mode. Between them the tool may sink in.
    pub fn points(cloud: &PointCloud) -> Self {
        let points: Vec<[Point3; 1]> = cloud.points.iter().map(|&point| [point]).collect();
        let tree = PatchTree::build(&points);
        Self { primitives: Primitives::Points(cloud.points.clone(), tree) }
    }

    /// Number of triangles or points.
    pub fn n_primitives(&self) -> usize {
        match &self.primitives {
            Primitives::Triangles(facets, _) => facets.len(),
            Primitives::Points(points, _) => points.len(),
        }
    }

    /// The tree over its primitives.
    pub(in crate::cam) fn tree(&self) -> Tree<'_> {
        match &self.primitives {
            Primitives::Triangles(_, tree) => Tree::Triangles(tree),
            Primitives::Points(_, tree) => Tree::Points(tree),
        }
    }

    /// The better of `best` and what the tool touches of `primitive`.
    ///
    /// A function of its own for each level of vector instructions: inlined wherever it is called,
    /// it would take minutes to compile.
    #[inline(never)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the inner loop's own four, and what it improves"
    )]
    pub(super) fn try_one<S: Simd>(
        &self,
        simd: S,
        tool: &impl HeightFunction,
        view: &View,
        primitive: u32,
        best: &mut Option<Found>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                if let Some(touch) = self.touch(tool, view, primitive, best.as_ref()) {
                    let found = Found { touch, primitive };
                    if best.is_none_or(|best| best.is_beaten_by(&found)) {
                        *best = Some(found);
                    }
                }
            },
        );
    }

    #[inline(always)]
    fn touch(
        &self,
        tool: &impl HeightFunction,
        view: &View,
        primitive: u32,
        best: Option<&Found>,
    ) -> Option<Touch> {
        match &self.primitives {
            Primitives::Triangles(facets, _) => {
                let best = best.map(|best| &best.touch);
                touch::on_triangle(tool, view, &facets[primitive as usize], best)
            }
            Primitives::Points(points, _) => {
                touch::on_point(tool, view.see(&points[primitive as usize]))
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
    pub(in crate::cam) fn contact(
        &self,
        part: &Part,
        tool: &impl HeightFunction,
        view: &View,
    ) -> Contact {
        let Touch { height, at, kind, .. } = self.touch;
        let normal = match (&part.primitives, kind) {
            (Primitives::Triangles(facets, _), ContactKind::Facet) => {
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
