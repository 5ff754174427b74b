use super::super::TsdfOptions;
use super::super::block::N;
use super::*;
use crate::geom::topology;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A model of `n`^3 blocks about the origin whose distance at a point of the lattice is `distance`.
fn field(n: i32, mut distance: impl FnMut([i32; 3]) -> Option<f32>) -> Volume {
    let options = TsdfOptions { voxel: 2.0, ..TsdfOptions::default() };
    let mut volume = Volume::new(&options).unwrap();
    let span = -n / 2..n - n / 2;
    let keys: Vec<Key> = span
        .clone()
        .flat_map(|x| span.clone().flat_map(move |y| (-n / 2..n - n / 2).map(move |z| [x, y, z])))
        .collect();
    volume.make(&keys).unwrap();
    for (key, block) in keys.iter().zip(&mut volume.blocks) {
        for i in 0..N {
            if let Some(told) = distance(lattice_point(*key, coords_of(i))) {
                block.distance[i] = told;
                block.weight[i] = 1.0;
            }
        }
    }
    volume
}

#[test]
fn random_signs_leave_no_crack_and_no_edge_of_three() {
    let mut draw = Pcg64Mcg::seed_from_u64(5);
    for share in [0.5, 0.2, 0.8] {
        // Outside at the border, so that every piece is closed.
        let volume = field(2, |point| {
            let is_border = point.iter().any(|c| *c == -8 || *c == 7);
            let is_inside = !is_border && draw.random::<f64>() < share;
            let size = draw.random_range(0.05..1.0_f32);
            Some(if is_inside { -size } else { size })
        });
        let mesh = volume.mesh().unwrap();
        let report = topology(&mesh);
        assert!(report.n_triangles > 3000, "{share}: {report:?}");
        assert_eq!(report.n_open_edges, 0, "{share}");
        assert_eq!((report.n_non_manifold_edges, report.n_flipped_edges), (0, 0), "{share}");
        assert_eq!(report.n_degenerate_triangles + report.n_duplicate_triangles, 0, "{share}");
        assert_eq!(report.n_points, report.n_positions, "vertices are shared");
        assert_eq!(report.n_unused_points, 0);
        assert!(report.volume.unwrap() > 0.0, "wound with the outside outside");
    }
}

#[test]
fn a_slanting_plane_is_found_back_exactly() {
    let normal = nalgebra::Vector3::new(0.36_f64, -0.48, 0.8);
    let volume = field(4, |point| {
        let at = nalgebra::Vector3::from(point.map(f64::from));
        Some((0.1 * (normal.dot(&at) - 0.3)) as f32)
    });
    let mesh = volume.mesh().unwrap();
    assert!(mesh.points.len() > 1000);
    for point in &mesh.points {
        // A thousandth of an edge is kept free at its ends.
        let off = normal.dot(&point.coords) / 2.0 - 0.3;
        assert!(off.abs() < 1.1e-3, "{off}");
    }
    let looks: f64 = (0..mesh.triangles.len()).map(|i| mesh.area_vector(i).dot(&normal)).sum();
    let area: f64 = (0..mesh.triangles.len()).map(|i| mesh.area_vector(i).norm()).sum();
    assert!((looks / area - 1.0).abs() < 1e-2, "all triangles look along the normal");
}

#[test]
fn the_surface_ends_where_nothing_is_known() {
    let volume = field(2, |point| (point[0] < 3).then(|| point[2] as f32 * 0.1 + 0.05));
    let mesh = volume.mesh().unwrap();
    let largest = mesh.points.iter().map(|point| point.x).fold(f64::MIN, f64::max);
    assert_eq!(largest, 2.0 * 2.0);
    let report = topology(&mesh);
    assert_eq!((report.n_open_loops, report.n_components), (1, 1));
    assert!(field(2, |_| None).mesh().unwrap().triangles.is_empty());
    assert!(field(2, |_| Some(0.0)).mesh().unwrap().triangles.is_empty());
}

#[test]
fn colours_are_mixed_between_the_ends() {
    let mut volume = field(2, |point| Some(point[2] as f32 * 0.1 + 0.025));
    for (key, block) in volume.lattice.keys.iter().zip(&mut volume.blocks) {
        for i in 0..N {
            let z = lattice_point(*key, coords_of(i))[2];
            block.color[i] = if z < 0 { [100 << 8, 0, 0, 1] } else { [200 << 8, 255 << 8, 0, 9] };
        }
    }
    let mesh = volume.mesh().unwrap();
    // From -0.075 to 0.025: three quarters of the way up.
    assert!(mesh.colors.unwrap().iter().all(|color| *color == [175, 191, 0]));
}
