//! The pieces a surface falls into.

use super::{Aabb, TriMesh};

/// `mesh` without the pieces whose box has a diagonal below `least`, and how many those were.
///
/// Points that no triangle is left for go too. Triangles hang together where they share a vertex.
pub fn without_small_pieces(mesh: &TriMesh, least: f64) -> (TriMesh, usize) {
    let mut parent: Vec<u32> = (0..mesh.points.len() as u32).collect();
    for &[a, b, c] in &mesh.triangles {
        join(&mut parent, a, b);
        join(&mut parent, a, c);
    }
    let roots: Vec<u32> = (0..parent.len() as u32).map(|i| root(&mut parent, i)).collect();
    // Of the root of each piece that has triangles.
    let mut boxes: Vec<Option<Aabb>> = vec![None; roots.len()];
    for &i in mesh.triangles.iter().flatten() {
        let place = mesh.points[i as usize];
        let around = boxes[roots[i as usize] as usize].get_or_insert(Aabb::around(&[place]));
        around.min = around.min.inf(&place);
        around.max = around.max.sup(&place);
    }
    let is_small = |around: &Aabb| around.size().norm() < least;
    let n_small = boxes.iter().flatten().filter(|around| is_small(around)).count();
    let stays =
        |i: u32| boxes[roots[i as usize] as usize].as_ref().is_some_and(|around| !is_small(around));
    let kept: Vec<u32> = (0..roots.len() as u32).filter(|i| stays(*i)).collect();
    let mut number = vec![u32::MAX; roots.len()];
    for (new, &old) in (0..).zip(&kept) {
        number[old as usize] = new;
    }
    let of = |i: u32| number[i as usize];
    let triangles = mesh.triangles.iter().filter(|corners| stays(corners[0]));
    let small = TriMesh {
        triangles: triangles.map(|corners| corners.map(of)).collect(),
        normals: mesh.normals.as_ref().map(|normals| chosen(normals, &kept)),
        colors: mesh.colors.as_ref().map(|colors| chosen(colors, &kept)),
        points: chosen(&mesh.points, &kept),
    };
    (small, n_small)
}

fn chosen<T: Copy>(all: &[T], which: &[u32]) -> Vec<T> {
    which.iter().map(|&i| all[i as usize]).collect()
}

/// Makes the pieces of two vertices one; true if they were two. The lower index becomes the root.
pub(super) fn join(parent: &mut [u32], a: u32, b: u32) -> bool {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
    a != b
}

/// The vertex that stands for a piece; path halving keeps the trees shallow.
fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        parent[vertex as usize] = parent[parent[vertex as usize] as usize];
        vertex = parent[vertex as usize];
    }
    vertex
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, shapes, topology};

    #[test]
    fn small_pieces_go_and_large_ones_stay_as_they_are() {
        let mut mesh = shapes::sphere(&Point3::origin(), 10.0, 20);
        let ball = mesh.clone();
        mesh.colors = Some(vec![[9, 8, 7]; mesh.points.len()]);
        for (place, radius) in [(50.0, 1.0), (60.0, 2.0)] {
            let other = shapes::sphere(&Point3::new(place, 0.0, 0.0), radius, 8);
            let first = mesh.points.len() as u32;
            mesh.points.splice(0..0, other.points.iter().copied());
            let n = other.points.len() as u32;
            mesh.triangles.iter_mut().flatten().for_each(|i| *i += n);
            mesh.triangles.extend(&other.triangles);
            mesh.colors.as_mut().unwrap().resize((first + n) as usize, [9, 8, 7]);
        }
        mesh.points.push(Point3::new(5.0, 0.0, 0.0));
        mesh.colors.as_mut().unwrap().push([0; 3]);
        let (kept, n_small) = without_small_pieces(&mesh, 10.0);
        assert_eq!(n_small, 2);
        assert_eq!((&kept.points, &kept.triangles), (&ball.points, &ball.triangles));
        assert!(kept.colors.unwrap().iter().all(|color| *color == [9, 8, 7]));
        let (all, n_small) = without_small_pieces(&mesh, 0.0);
        assert_eq!((topology(&all).n_components, n_small), (3, 0));
        let (nothing, _) = without_small_pieces(&TriMesh::default(), 1.0);
        assert!(nothing.points.is_empty());
    }
}
