//! What a mesh is made of: how its triangles hang together and what is wrong with them.

use super::pieces::join;
use super::{Aabb, TriMesh, weld};
use rayon::prelude::*;

/// What [`topology`] found.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MeshReport {
    /// Vertices as stored.
    pub n_points: usize,
    /// Different positions among them.
    pub n_positions: usize,
    /// Vertices no triangle uses.
    pub n_unused_points: usize,
    /// Triangles as stored.
    pub n_triangles: usize,
    /// Triangles with two corners in one place or with no area.
    pub n_degenerate_triangles: usize,
    /// Triangles over the same three corners as an earlier one, whichever way round.
    pub n_duplicate_triangles: usize,
    /// Edges with one triangle.
    pub n_open_edges: usize,
    /// Connected pieces of the open edges: holes, roughly.
    pub n_open_loops: usize,
    /// Edges with more than two triangles.
    pub n_non_manifold_edges: usize,
    /// Edges whose two triangles are wound against each other.
    pub n_flipped_edges: usize,
    /// Pieces of the surface that share no vertex.
    pub n_components: usize,
    /// Of all triangles [mm2].
    pub area: f64,
    /// Enclosed [mm3], negative if the triangles are wound inside out; only where every edge is run
    /// through equally often in both directions, so that there is an inside.
    pub volume: Option<f64>,
}

impl MeshReport {
    /// True if the surface has no border.
    pub fn is_closed(&self) -> bool {
        self.n_triangles > 0 && self.n_open_edges == 0
    }
}

/// Counts what `mesh` is made of.
///
/// Vertices at exactly the same position count as one, so a soup of triangles is judged by its
/// shape and not by how it was stored. Triangles with two corners in one place have no edges.
pub fn topology(mesh: &TriMesh) -> MeshReport {
    let welded = weld(&mesh.points);
    let faces: Vec<[u32; 3]> = mesh
        .triangles
        .par_iter()
        .map(|triangle| triangle.map(|i| welded[i as usize]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    let n_collapsed = mesh.triangles.len() - faces.len();
    let edges = Edges::of(&faces);
    MeshReport {
        n_points: mesh.points.len(),
        n_positions: welded.iter().zip(0..).filter(|(first, i)| **first == *i).count(),
        n_unused_points: n_unused(mesh),
        n_triangles: mesh.triangles.len(),
        n_degenerate_triangles: n_collapsed + n_flat(mesh, &welded),
        n_duplicate_triangles: n_duplicates(&faces),
        n_open_edges: edges.open.len(),
        n_open_loops: n_pieces(mesh.points.len(), &edges.open),
        n_non_manifold_edges: edges.n_non_manifold,
        n_flipped_edges: edges.n_flipped,
        n_components: n_pieces(mesh.points.len(), &faces),
        area: (0..mesh.triangles.len()).map(|i| mesh.area_vector(i).norm()).sum(),
        volume: (edges.balanced && !faces.is_empty()).then(|| signed_volume(mesh)),
    }
}

/// The edges, by how many triangles meet in them.
struct Edges {
    open: Vec<[u32; 2]>,
    n_non_manifold: usize,
    n_flipped: usize,
    balanced: bool,
}

impl Edges {
    fn of(faces: &[[u32; 3]]) -> Self {
        let mut uses: Vec<([u32; 2], bool)> = faces
            .par_iter()
            .flat_map_iter(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .map(|(from, to)| ([from.min(to), from.max(to)], from < to))
            .collect();
        uses.par_sort_unstable();
        let mut edges = Self { open: Vec::new(), n_non_manifold: 0, n_flipped: 0, balanced: true };
        for same in uses.chunk_by(|(edge, _), (next, _)| edge == next) {
            let n_forward = same.iter().filter(|(_, forward)| *forward).count();
            edges.balanced &= 2 * n_forward == same.len();
            match same.len() {
                1 => edges.open.push(same[0].0),
                2 => edges.n_flipped += usize::from(n_forward != 1),
                _ => edges.n_non_manifold += 1,
            }
        }
        edges
    }
}

/// Triangles whose corners are apart but lie on one line: height below 1e-12 of the longest side.
fn n_flat(mesh: &TriMesh, welded: &[u32]) -> usize {
    let is_flat = |i_triangle: usize| {
        let [i, j, k] = mesh.triangles[i_triangle].map(|i| welded[i as usize]);
        let [a, b, c] = mesh.corners(i_triangle);
        let longest =
            (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        i != j && j != k && k != i && 2.0 * mesh.area_vector(i_triangle).norm() <= 1e-12 * longest
    };
    (0..mesh.triangles.len()).into_par_iter().filter(|&i| is_flat(i)).count()
}

fn n_duplicates(faces: &[[u32; 3]]) -> usize {
    let mut keys = faces.to_vec();
    keys.par_iter_mut().for_each(|corners| corners.sort_unstable());
    keys.par_sort_unstable();
    keys.windows(2).filter(|pair| pair[0] == pair[1]).count()
}

fn n_unused(mesh: &TriMesh) -> usize {
    let mut used = vec![false; mesh.points.len()];
    for &i_point in mesh.triangles.iter().flatten() {
        used[i_point as usize] = true;
    }
    used.iter().filter(|used| !**used).count()
}

/// Number of pieces that `cells` (triangles, edges) over `n_points` vertices fall into.
fn n_pieces<const N: usize>(n_points: usize, cells: &[[u32; N]]) -> usize {
    let mut parent: Vec<u32> = (0..n_points as u32).collect();
    let mut is_used = vec![false; n_points];
    let mut n_pieces = 0;
    for cell in cells {
        for &vertex in cell {
            n_pieces += usize::from(!std::mem::replace(&mut is_used[vertex as usize], true));
            n_pieces -= usize::from(join(&mut parent, cell[0], vertex));
        }
    }
    n_pieces
}

/// Sum of the tetrahedra over all triangles; taken from the middle of the part, where they are small.
fn signed_volume(mesh: &TriMesh) -> f64 {
    let middle = Aabb::around(&mesh.points).center();
    (0..mesh.triangles.len())
        .map(|i| mesh.corners(i).map(|corner| corner - middle))
        .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point3;

    /// A box of 1 x 2 x 3, wound outwards.
    fn cuboid() -> TriMesh {
        let points = (0..8)
            .map(|i| Point3::new(f64::from(i & 1), f64::from(i & 2), f64::from(i >> 2) * 3.0))
            .collect();
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriMesh::new(points, triangles)
    }

    fn as_soup(mesh: &TriMesh) -> TriMesh {
        let points: Vec<_> = (0..mesh.triangles.len()).flat_map(|i| mesh.corners(i)).collect();
        let triangles = (0..mesh.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        TriMesh::new(points, triangles.collect())
    }

    #[test]
    fn a_box_is_closed_and_holds_its_volume() {
        let report = topology(&cuboid());
        assert!(report.is_closed());
        assert_eq!((report.n_components, report.n_flipped_edges), (1, 0));
        assert!((report.area - 22.0).abs() < 1e-12, "{}", report.area);
        assert!((report.volume.unwrap() - 6.0).abs() < 1e-12, "{:?}", report.volume);
    }

    #[test]
    fn a_soup_is_judged_like_the_mesh_it_was_cut_from() {
        let (mesh, soup) = (topology(&cuboid()), topology(&as_soup(&cuboid())));
        assert_eq!((soup.n_points, soup.n_positions), (36, 8));
        assert_eq!(MeshReport { n_points: 8, ..soup }, mesh);
    }

    #[test]
    fn an_open_box_has_one_loop_and_no_volume() {
        let mut mesh = cuboid();
        mesh.triangles.truncate(10);
        let report = topology(&mesh);
        assert_eq!((report.n_open_edges, report.n_open_loops), (4, 1));
        assert_eq!((report.is_closed(), report.volume), (false, None));
    }

    #[test]
    fn an_inside_out_box_has_a_negative_volume() {
        let report = topology(&cuboid().mirrored());
        assert!(report.volume.unwrap() > 0.0, "mirroring keeps the outside outside");
        let mut mesh = cuboid();
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert!((topology(&mesh).volume.unwrap() + 6.0).abs() < 1e-12);
    }

    #[test]
    fn one_flipped_triangle_shows_on_its_three_edges() {
        let mut mesh = cuboid();
        mesh.triangles[4].swap(0, 1);
        let report = topology(&mesh);
        assert_eq!((report.n_flipped_edges, report.volume, report.is_closed()), (3, None, true));
    }

    #[test]
    fn broken_triangles_are_counted_by_kind() {
        let mut mesh = cuboid();
        mesh.points.push(Point3::new(0.5, 0.0, 0.0));
        mesh.points.push(Point3::new(9.0, 9.0, 9.0));
        mesh.triangles.push([0, 0, 1]); // two corners in one place
        mesh.triangles.push([0, 8, 1]); // on one line
        mesh.triangles.push([2, 0, 3]); // the first one again, from elsewhere and turned over
        let report = topology(&mesh);
        assert_eq!((report.n_degenerate_triangles, report.n_duplicate_triangles), (2, 1));
        assert_eq!((report.n_unused_points, report.n_components), (1, 1));
        assert_eq!(report.n_non_manifold_edges, 4, "three of the duplicate, one of the sliver");
    }

    #[test]
    fn two_boxes_apart_are_two_components() {
        let mut mesh = cuboid();
        let far = crate::geom::Pose::translation(10.0, 0.0, 0.0);
        mesh.append(cuboid().moved(&far));
        let report = topology(&mesh);
        assert_eq!(report.n_components, 2);
        assert!((report.volume.unwrap() - 12.0).abs() < 1e-9);
    }

    #[test]
    fn nothing_at_all_is_not_closed() {
        let report = topology(&TriMesh::default());
        assert_eq!((report.is_closed(), report.volume, report.n_components), (false, None, 0));
    }
}
