//! The parametric last: a shoe last of our own drawing, closed, of any length.
//!
//! Two closed lines carry it: the *feather edge* round the bottom and a *ridge* above it. Each
//! station on them is a leaning cross-section: the bottom from feather to feather, and on each
//! side one cubic curve that leaves the feather edge and arrives level on the ridge. The sections
//! fan out round heel and toe like the pages of a book, and what stands above the cone plane is
//! sawn off. Every line is a function of the station, so the form is as fine as it is asked to be.
//!
//! X runs heel to toe, Z up from the ground `z = 0`, and the medial side of a left last lies at
//! negative Y.

mod form;
mod lines;
mod parameters;

pub use parameters::{LastError, LastParameters, Side};

use super::girth::girth;
use crate::geom::{Point3, SectionGrid, TriMesh, Vector3};
use form::Form;
use std::collections::HashMap;

/// The last that `parameters` describe.
pub fn last(parameters: &LastParameters) -> Result<TriMesh, LastError> {
    let form = fitted(parameters)?;
    let mesh = welded(&form.sections().to_mesh());
    Ok(match parameters.side {
        Side::Left => mesh,
        Side::Right => mesh.mirrored(),
    })
}

/// The form whose ball girth is the one asked for: a secant search on its fullness, which the
/// girth follows almost linearly.
fn fitted(parameters: &LastParameters) -> Result<Form, LastError> {
    let size = parameters.sizes()?;
    let miss = |form: &Form| ball_girth(form) - size.ball_girth;
    let (mut before, mut form) = (Form::new(&size, 0.95), Form::new(&size, 1.0));
    let mut miss_before = miss(&before);
    for _ in 0..12 {
        let miss_here = miss(&form);
        if miss_here.abs() < 1e-6 {
            return Ok(form);
        }
        let step = miss_here * (form.fullness - before.fullness) / (miss_here - miss_before);
        let next = form.fullness - step;
        if !(0.3..3.0).contains(&next) {
            break;
        }
        miss_before = miss_here;
        before = std::mem::replace(&mut form, Form::new(&size, next));
    }
    Err(LastError::Unfitted { girth: size.ball_girth, length: size.length })
}

/// The tape in the vertical plane through the outermost feather points of the ball.
fn ball_girth(form: &Form) -> f64 {
    let grid = form.sections();
    let [lateral, medial] = ball_points(form, &grid);
    let normal = Vector3::z().cross(&(lateral - medial)).normalize();
    girth(&grid.to_mesh(), &medial, &normal)
}

/// The outermost points of the feather edge, lateral and medial, between waist and toe.
fn ball_points(form: &Form, grid: &SectionGrid) -> [Point3; 2] {
    let edges = form.feather_columns();
    let mut ball = edges.map(|column| grid.points[column]);
    for row in grid.points.chunks(grid.n_columns) {
        for (outermost, column) in ball.iter_mut().zip(edges) {
            let here = row[column];
            if (0.5..0.85).contains(&(here.x / form.length())) && here.y.abs() > outermost.y.abs() {
                *outermost = here;
            }
        }
    }
    ball
}

/// The mesh with equal points made one, and without the triangles that this leaves no area.
fn welded(mesh: &TriMesh) -> TriMesh {
    let mut places = HashMap::with_capacity(mesh.points.len());
    let mut points = Vec::with_capacity(mesh.points.len());
    let mut place = |p: &Point3| {
        // Adding zero makes -0 and 0 one key.
        let key = [p.x, p.y, p.z].map(|c| (c + 0.0).to_bits());
        *places.entry(key).or_insert_with(|| {
            points.push(*p);
            points.len() as u32 - 1
        })
    };
    let index: Vec<u32> = mesh.points.iter().map(&mut place).collect();
    let renamed = mesh.triangles.iter().map(|t| t.map(|i| index[i as usize]));
    let triangles = renamed.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    TriMesh::new(points, triangles)
}

#[cfg(test)]
mod tests {
    use super::super::solids::tests::{assert_watertight, volume};
    use super::*;

    fn drawn(parameters: &LastParameters) -> TriMesh {
        last(parameters).unwrap()
    }

    #[test]
    fn last_is_closed_and_has_no_triangle_without_area() {
        for toe_roundness in [1.6, 2.0, 4.0] {
            let mesh = drawn(&LastParameters { toe_roundness, ..Default::default() });
            assert_watertight(&mesh);
            let least = (0..mesh.triangles.len()).map(|i| mesh.area_vector(i).norm());
            assert!(least.fold(f64::INFINITY, f64::min) > 1e-9, "toe roundness {toe_roundness}");
            assert!((20_000..40_000).contains(&mesh.triangles.len()));
            assert!(volume(&mesh) > 0.0);
            // A real men's 40 has 63,800 mm2.
            let area: f64 = (0..mesh.triangles.len()).map(|i| mesh.area_vector(i).norm()).sum();
            assert!((58_000.0..68_000.0).contains(&area), "{area} mm2");
        }
    }

    #[test]
    fn extreme_lasts_are_closed_and_end_at_the_top_of_the_cone() {
        let pick = |bits: usize, bit: usize, [low, high]: [f64; 2]| {
            Some(265.0 * if bits & bit == 0 { low } else { high })
        };
        for bits in 0..32 {
            let heel_height = pick(bits, 1, [0.0, 0.3]);
            let seat = heel_height.unwrap() / 265.0;
            let parameters = LastParameters {
                heel_height,
                toe_spring: pick(bits, 2, [0.0, 0.12]),
                ball_girth: pick(bits, 4, [0.75, 1.2]),
                cone_height: pick(bits, 8, [(seat + 0.24).max(0.3), seat + 0.4]),
                cone_length: pick(bits, 16, [0.34, 0.46]),
                resolution: Some(6.0),
                ..Default::default()
            };
            let mesh = drawn(&parameters);
            assert_watertight(&mesh);
            assert!(volume(&mesh) > 0.0);
            let miss = mesh.aabb().max.z - parameters.cone_height.unwrap();
            assert!(miss.abs() < 4.0, "{miss} mm off the cone height: {parameters:?}");
        }
    }

    #[test]
    fn last_is_as_long_as_asked_and_stands_on_the_ground() {
        for length in [20.0, 236.0, 265.0, 310.0, 2000.0] {
            let aabb = drawn(&LastParameters { length, ..Default::default() }).aabb();
            assert_eq!((aabb.min.x, aabb.max.x, aabb.min.z), (0.0, length, 0.0));
        }
    }

    #[test]
    fn right_last_is_the_mirror_image_of_the_left_and_not_the_same() {
        let left = drawn(&LastParameters::default());
        let right = drawn(&LastParameters { side: Side::Right, ..Default::default() });
        assert_watertight(&right);
        assert!(volume(&right) > 0.0);
        assert_eq!(right, left.clone().mirrored());
        // The toe of a left last leans to the medial side.
        let toe = |mesh: &TriMesh| mesh.points.iter().max_by(|a, b| a.x.total_cmp(&b.x)).unwrap().y;
        assert!(toe(&left) < -5.0 && toe(&right) > 5.0);
    }

    #[test]
    fn ball_girth_is_the_one_asked_for() {
        for (length, girth) in [(265.0, 250.0), (265.0, 225.0), (287.0, 280.0)] {
            let parameters =
                LastParameters { length, ball_girth: Some(girth), ..Default::default() };
            let measured = ball_girth(&fitted(&parameters).unwrap());
            assert!((measured - girth).abs() < 1e-5, "{measured} instead of {girth}");
        }
    }

    #[test]
    fn heel_height_and_toe_spring_are_those_asked_for() {
        for (heel, spring) in [(22.0, 10.0), (45.0, 4.0), (0.0, 15.0)] {
            let parameters = LastParameters {
                heel_height: Some(heel),
                toe_spring: Some(spring),
                ..Default::default()
            };
            let grid = fitted(&parameters).unwrap().sections();
            // The first column is the lateral feather edge.
            let (rear, front) = (grid.points[0], grid.points[(grid.n_rows() - 1) * grid.n_columns]);
            assert!((rear.z - heel).abs() < 0.6, "{} instead of {heel}", rear.z);
            assert!((front.z - spring).abs() < 0.6, "{} instead of {spring}", front.z);
        }
    }

    #[test]
    fn ball_swells_in_front_on_the_medial_and_behind_on_the_lateral_side() {
        let form = fitted(&LastParameters::default()).unwrap();
        let [lateral, medial] = ball_points(&form, &form.sections());
        assert!((lateral.x / 265.0 - 0.61).abs() < 0.03, "lateral ball at {}", lateral.x / 265.0);
        assert!((medial.x / 265.0 - 0.70).abs() < 0.03, "medial ball at {}", medial.x / 265.0);
    }

    #[test]
    fn instep_is_as_full_as_on_real_lasts() {
        let mesh = drawn(&LastParameters::default());
        // From the shank midway heel-ball forwards over the ridge, as the tape lies.
        let shank = Point3::new(0.35 * 265.0, 0.0, 11.0);
        let ridge = Point3::new(0.46 * 265.0, 0.0, 88.0);
        let normal = (ridge - shank).cross(&Vector3::y()).normalize();
        let length = girth(&mesh, &shank, &normal);
        assert!((250.0..268.0).contains(&length), "instep girth {length}");
    }

    #[test]
    fn sizes_that_make_no_last_are_refused_by_name() {
        let refused = |parameters: LastParameters| last(&parameters).unwrap_err().to_string();
        let text = refused(LastParameters { length: f64::NAN, ..Default::default() });
        assert!(text.starts_with("length is NaN"), "{text}");
        let text = refused(LastParameters { resolution: Some(1e-6), ..Default::default() });
        assert!(text.starts_with("resolution is 0.000001"), "{text}");
        let text = refused(LastParameters { heel_height: Some(200.0), ..Default::default() });
        assert!(text.starts_with("heel-height is 200, but this last takes 0.0 to 79.5"), "{text}");
    }
}
