//! How a surface catches the light: normals that are smooth but keep creases, and two lamps.

use crate::geom::{TriMesh, Vector3};
use rayon::prelude::*;

/// Facets that turn less than this at a shared vertex are one smooth surface (cosine of 35 deg).
const CREASE: f64 = 0.82;
/// Where the lamps stand, seen from the camera: right, up, towards the eye; unit.
const KEY: [f32; 3] = [-0.46, 0.62, 0.635];
const FILL: [f32; 3] = [0.8, -0.1, 0.59];

/// The unit normal at each corner of each triangle: of all facets round the vertex that belong to
/// the same smooth surface, weighted by area. Zero where a triangle has no area.
pub(super) fn corner_normals(mesh: &TriMesh) -> Vec<[Vector3; 3]> {
    let n = mesh.triangles.len();
    let facets: Vec<Vector3> = (0..n).into_par_iter().map(|i| mesh.area_vector(i)).collect();
    let around = Around::new(mesh);
    let corner = |i_triangle: usize, i_point: u32| {
        let Some(own) = facets[i_triangle].try_normalize(0.0) else { return Vector3::zeros() };
        let neighbours = around.of(i_point).iter().map(|&i| facets[i as usize]);
        let smooth = neighbours.filter(|f| f.dot(&own) >= CREASE * f.norm());
        smooth.sum::<Vector3>().try_normalize(0.0).unwrap_or(own)
    };
    (0..n).into_par_iter().map(|i| mesh.triangles[i].map(|p| corner(i, p))).collect()
}

/// The triangles round each vertex, one list after the other.
struct Around {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn new(mesh: &TriMesh) -> Self {
        let mut starts = vec![0; mesh.points.len() + 1];
        for &i_point in mesh.triangles.as_flattened() {
            starts[i_point as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut triangles = vec![0; 3 * mesh.triangles.len()];
        for (i_corner, &i_point) in mesh.triangles.as_flattened().iter().enumerate() {
            let place = &mut next[i_point as usize];
            triangles[*place as usize] = (i_corner / 3) as u32;
            *place += 1;
        }
        Self { starts, triangles }
    }

    fn of(&self, i_point: u32) -> &[u32] {
        let i = i_point as usize;
        &self.triangles[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}

/// What the eye sees of a surface of `color` whose `normal` (right, up, towards the eye) may point
/// either way.
pub(super) fn lit(color: [f32; 3], normal: [f32; 3]) -> [u8; 3] {
    let length = dot(normal, normal).sqrt().max(1e-12);
    let length = if normal[2] < 0.0 { -length } else { length };
    let normal = normal.map(|c| c / length);
    let sky = 0.30 + 0.10 * normal[1];
    let light = sky + 0.62 * dot(normal, KEY).max(0.0) + 0.16 * dot(normal, FILL).max(0.0);
    // Blinn's highlight of the key lamp.
    let half = [KEY[0], KEY[1], KEY[2] + 1.0];
    let shine = 0.10 * (dot(normal, half) / dot(half, half).sqrt()).max(0.0).powi(48);
    color.map(|c| {
        let linear = c.powf(2.2) * light + shine;
        (linear.min(1.0).powf(1.0 / 2.2) * 255.0).round() as u8
    })
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{
        Point3,
        shapes::{prism, sphere},
    };

    #[test]
    fn normals_of_a_sphere_point_from_its_center() {
        let mesh = sphere(&Point3::origin(), 10.0, 60);
        for (triangle, normals) in mesh.triangles.iter().zip(corner_normals(&mesh)) {
            for (i_point, normal) in triangle.iter().zip(normals) {
                let radial = mesh.points[*i_point as usize].coords / 10.0;
                assert!(normal.dot(&radial) > 0.999);
            }
        }
    }

    #[test]
    fn edges_of_a_prism_stay_sharp() {
        let mesh = prism(6, 10.0, 20.0);
        for (i, normals) in corner_normals(&mesh).into_iter().enumerate() {
            let own = mesh.area_vector(i).normalize();
            assert!(normals.iter().all(|n| (n - own).norm() < 1e-9));
        }
    }

    #[test]
    fn surface_that_faces_the_lamp_is_brighter_and_both_sides_are_lit_alike() {
        let towards = lit([0.5; 3], KEY);
        let away = lit([0.5; 3], [0.9, -0.4, 0.1]);
        assert!(towards[0] > away[0] + 30);
        assert_eq!(towards, lit([0.5; 3], KEY.map(|c| -c)));
    }
}
