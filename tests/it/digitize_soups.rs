//! Virtual digitizing of many primitives: the tree against the reference, the reference against its
//! primitives one by one, and nothing that hangs on threads, order or luck.

use crate::dropping::{agreed, bits, contacts, soup};
use crate::random_cases::{Draw, draw_pose, draw_tool, draw_triangle, in_cube};
use crate::textbook::{ROUNDING, Reach, Tool, tools};
use horma::cam::{Contact, ContactKind, Method, Part};
use horma::geom::{Aabb, Point3, PointCloud, Pose, TriMesh, Vector3, shapes};
use nalgebra::{Translation3, UnitQuaternion};
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};

const N_SOUPS: u64 = 300;

/// Triangles that trouble an exact contact, some of them twice, some hanging on edges of others.
fn draw_soup(n: usize, tool: &Tool, attack_from_part: &Pose, draw: &mut Draw) -> Vec<[Point3; 3]> {
    let part_from_attack = attack_from_part.inverse();
    let mut triangles: Vec<[Point3; 3]> = Vec::with_capacity(n);
    for _ in 0..n {
        let mut fresh =
            draw_triangle(tool, draw).map(|corner| part_from_attack * Point3::from(corner));
        if let Some(known) = triangles.choose(draw) {
            match draw.random_range(0..4) {
                0 => fresh = *known,
                1 => fresh[..2].copy_from_slice(&known[1..]),
                _ => {}
            }
        }
        fresh.shuffle(draw);
        triangles.push(fresh);
    }
    triangles
}

/// Twenty poses about one, some of them the same.
fn near(pose: &Pose, tool: &Tool, draw: &mut Draw) -> Vec<Pose> {
    let size = tool.profile.reach();
    let mut nearby = || {
        let shift = Translation3::from(in_cube(draw) * size * draw.random::<f64>());
        shift * pose * UnitQuaternion::from_scaled_axis(in_cube(draw) * 0.1)
    };
    (0..20).map(|i| if i % 5 == 0 { *pose } else { nearby() }).collect()
}

/// What the triangles one by one come to: the highest, and of those the first.
fn highest_alone(triangles: &[[Point3; 3]], tool: &Tool, poses: &[Pose]) -> Vec<Option<Contact>> {
    let mut best: Vec<Option<Contact>> = vec![None; poses.len()];
    for (primitive, triangle) in (0..).zip(triangles) {
        let alone = Part::triangles(&soup(&[*triangle]));
        for (best, contact) in
            best.iter_mut().zip(contacts(&alone, tool, Method::Exhaustive, poses))
        {
            let Some(contact) = contact else { continue };
            if best.is_none_or(|best| best.height < contact.height) {
                *best = Some(Contact { primitive, ..contact });
            }
        }
    }
    best
}

#[test]
fn soup_is_touched_where_its_highest_triangle_is_by_both_methods() {
    (0..N_SOUPS).into_par_iter().for_each(|i| {
        let mut draw = Draw::seed_from_u64(i);
        let tool = draw_tool(&mut draw);
        let pose = draw_pose(&mut draw);
        let n = [2, 9, 70, 300][i as usize % 4];
        let triangles = draw_soup(n, &tool, &pose, &mut draw);
        let poses = near(&pose, &tool, &mut draw);
        let found = agreed(&Part::triangles(&soup(&triangles)), &tool, &poses);
        let alone = highest_alone(&triangles, &tool, &poses);
        assert_eq!(bits(&found), bits(&alone), "in soup {i} by {tool:?}");
    });
}

#[test]
fn cloud_is_touched_at_its_highest_point_by_both_methods() {
    (0..N_SOUPS).into_par_iter().for_each(|i| {
        let mut draw = Draw::seed_from_u64(i);
        let tool = draw_tool(&mut draw);
        let pose = draw_pose(&mut draw);
        let points = draw_soup(1 + i as usize % 100, &tool, &pose, &mut draw).into_flattened();
        let poses = near(&pose, &tool, &mut draw);
        let part = Part::points(&PointCloud { points: points.clone(), ..PointCloud::default() });
        for (found, pose) in agreed(&part, &tool, &poses).into_iter().zip(&poses) {
            let highest = |outwards| {
                let seen = points.iter().map(|point| pose * point);
                let heights = seen.filter_map(|p| Some(p.y + tool.height(p.x, p.z, outwards)?));
                heights.reduce(f64::max)
            };
            let slack = tool.slack(&points, pose);
            let Some(found) = found else {
                assert_eq!(highest(slack), None, "missed in cloud {i}, {tool:?}");
                continue;
            };
            let least = highest(slack).unwrap_or(f64::NEG_INFINITY) - ROUNDING;
            let most = highest(-slack).unwrap_or(f64::NEG_INFINITY) + ROUNDING;
            let height = found.height;
            assert!(least <= height && height <= most, "{found:?} in cloud {i}, {tool:?}");
            assert_eq!(found.kind, ContactKind::Point);
            let off = found.point - points[found.primitive as usize];
            assert!(off.amax() <= ROUNDING, "{found:?} is {off:?} off in cloud {i}");
        }
    });
}

/// A part of many ties: level and upright facets, shared edges and corners, every one twice.
fn blocks() -> TriMesh {
    let mut mesh = TriMesh::default();
    for i in 0..64 {
        let min =
            Point3::new(f64::from(i % 4) * 10.0, f64::from(i / 16), f64::from(i / 4 % 4) * 10.0);
        mesh.append(shapes::cuboid(&Aabb { min, max: min + Vector3::new(10.0, 20.0, 10.0) }));
    }
    mesh.append(shapes::prism(8, 20.0, 40.0));
    mesh.append(mesh.clone());
    mesh
}

#[test]
fn ties_are_settled_the_same_way_by_both_methods() {
    let part = Part::triangles(&blocks());
    let poses: Vec<Pose> = (0..4 * 21 * 21)
        .map(|i| {
            let (turn, i, j) = (i / 441, i / 21 % 21, i % 21);
            let shift = Vector3::new(-2.5 * f64::from(i), 0.0, -2.5 * f64::from(j));
            let turned =
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), f64::from(turn) * FRAC_PI_2);
            Pose::from_parts(shift.into(), turned)
        })
        .collect();
    let n_primitives = part.n_primitives() as u32;
    for profile in tools() {
        let found = agreed(&part, &Tool { profile, allowance: 0.0 }, &poses);
        let touched: Vec<Contact> = found.into_iter().flatten().collect();
        assert!(touched.len() > poses.len() / 4, "{} of {}", touched.len(), poses.len());
        assert!(
            touched.iter().all(|contact| contact.primitive < n_primitives / 2),
            "the first wins"
        );
    }
}

#[test]
fn contacts_hang_neither_on_threads_nor_on_the_order_of_positions() {
    let part = Part::triangles(&shapes::bumpy_cylinder(4000));
    let mut draw = Draw::seed_from_u64(5);
    let mut poses: Vec<Pose> = (0..4000)
        .map(|i| {
            let turned =
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), TAU * f64::from(i) / 90.0);
            Pose::from_parts(Translation3::new(20.0 - 0.07 * f64::from(i), 0.0, 0.0), turned)
        })
        .collect();
    for profile in tools() {
        let tool = Tool { profile, allowance: 0.3 };
        let known = contacts(&part, &tool, Method::Indexed, &poses);
        for n_threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            let again = pool.install(|| contacts(&part, &tool, Method::Indexed, &poses));
            assert!(bits(&known) == bits(&again), "{n_threads} threads");
        }
        let mut order: Vec<usize> = (0..poses.len()).collect();
        order.shuffle(&mut draw);
        let shuffled: Vec<Pose> = order.iter().map(|&i| poses[i]).collect();
        let again = contacts(&part, &tool, Method::Indexed, &shuffled);
        let reordered: Vec<Option<Contact>> = order.iter().map(|&i| known[i]).collect();
        assert!(bits(&reordered) == bits(&again), "shuffled, by {tool:?}");
        poses.reverse();
    }
}

#[test]
fn tool_beside_the_part_meets_nothing() {
    let body =
        shapes::cuboid(&Aabb { min: Point3::new(0.0, 0.0, 0.0), max: Point3::new(9.0, 5.0, 7.0) });
    let cloud = PointCloud { points: body.points.clone(), ..PointCloud::default() };
    for part in [Part::triangles(&body), Part::points(&cloud)] {
        for profile in tools() {
            let tool = Tool { profile, allowance: 0.5 };
            let reach = profile.half_width() + tool.allowance;
            let at = |x| Pose::translation(x, 0.0, 0.0);
            let poses = [
                at(reach + 1e-6),
                at(reach - 1e-6),
                at(-reach - 9.0 - 1e-6),
                at(-reach - 9.0 + 1e-6),
            ];
            let touched: Vec<bool> =
                agreed(&part, &tool, &poses).iter().map(Option::is_some).collect();
            assert_eq!(touched, [false, true, false, true], "{tool:?}");
        }
    }
}

#[test]
fn empty_part_is_met_nowhere() {
    for part in [Part::triangles(&TriMesh::default()), Part::points(&PointCloud::default())] {
        for profile in tools() {
            let found = agreed(&part, &Tool { profile, allowance: 0.0 }, &[Pose::identity(); 3]);
            assert_eq!(found, [None; 3]);
        }
    }
}

#[test]
fn no_positions_have_no_contacts() {
    let part = Part::triangles(&blocks());
    let [profile, ..] = tools();
    assert_eq!(agreed(&part, &Tool { profile, allowance: 0.0 }, &[]), []);
}
