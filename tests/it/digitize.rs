//! Virtual digitizing against closed forms, to 1e-9 mm.

use crate::dropping::{
    agreed, assert_near, assert_near_all, edge, needle, normals, passing_edge, plane, soup, touched,
};
use crate::textbook::{Reach, Tool, peak, tools};
use horma::cam::{ContactKind, Part};
use horma::geom::{Point3, Pose, Vector3, shapes};
use horma::tool::Profile;
use nalgebra::{Translation3, UnitQuaternion};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI, TAU};

const WHEEL: Profile = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 };

/// The part turned by `angle` under the tool, which stands over `x`.
fn on_lathe(angle: f64, x: f64) -> Pose {
    let turned = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    Pose::from_parts(Translation3::new(-x, 0.0, 0.0), turned)
}

#[test]
fn wheel_on_a_coaxial_prism_stands_as_high_as_its_disc_on_the_polygon() {
    // Along x nothing changes, so that the wheel of R and r acts as its greatest disc, of
    // rho = R + r, on a polygon of circumradius C and apothem A = C cos(pi / n). With the nearest
    // facet normal turned by d out of the attack axis, the disc's centre stands (A + rho) / cos d
    // high and touches the facet (A + rho) tan d from its middle, if it is that wide: if that is
    // at most C sin(pi / n). Else it touches the nearest edge, which is turned by e = pi / n - d,
    // and stands C cos e + sqrt(rho^2 - (C sin e)^2) high. For d = 0 this is A + rho, for e = 0
    // C + rho.
    let (radius, disc) = (30.0, 70.0);
    let part_of = |n| Part::triangles(&shapes::prism(n, radius, 100.0));
    for n in [3, 4, 5, 8, 24, 360] {
        let half_turn = PI / n as f64;
        let height = |angle: f64| {
            let apothem = radius * half_turn.cos();
            let turned = (angle + half_turn).rem_euclid(2.0 * half_turn);
            let d = turned.min(2.0 * half_turn - turned);
            if (apothem + disc) * d.tan() <= radius * half_turn.sin() {
                (apothem + disc) / d.cos()
            } else {
                let (sin, cos) = (half_turn - d).sin_cos();
                radius * cos + (disc * disc - (radius * sin).powi(2)).sqrt()
            }
        };
        assert_near(height(2.0 * half_turn), radius + disc);
        assert_near(height(half_turn), radius * half_turn.cos() + disc);
        let angles: Vec<f64> = (0..=16 * n).map(|i| i as f64 * half_turn / 8.0).collect();
        let poses: Vec<Pose> = angles.iter().map(|&angle| on_lathe(angle, 43.21)).collect();
        let tool = Tool { profile: WHEEL, allowance: 0.0 };
        for (contact, angle) in agreed(&part_of(n), &tool, &poses).into_iter().zip(angles) {
            assert_near(contact.unwrap().height, height(angle));
        }
        let tool = Tool { allowance: 0.25, ..tool };
        let contact = agreed(&part_of(n), &tool, &[on_lathe(0.0, 43.21)])[0];
        assert_near(contact.unwrap().height, radius + disc + 0.25);
    }
}

#[test]
fn wheel_on_points_of_a_cylinder_stands_both_radii_above_the_axis() {
    let (n_stations, n_angles) = (13, 36);
    let part = Part::points(&shapes::cylinder_points(30.0, 120.0, n_stations, n_angles));
    let poses: Vec<Pose> = (0..n_stations * n_angles)
        .map(|i| {
            let angle = -TAU * (i % n_angles) as f64 / n_angles as f64;
            on_lathe(angle, 10.0 * (i / n_angles) as f64)
        })
        .collect();
    let tool = Tool { profile: WHEEL, allowance: 0.0 };
    for (contact, i) in agreed(&part, &tool, &poses).into_iter().map(Option::unwrap).zip(0..) {
        assert_near(contact.height, 100.0);
        assert_eq!((contact.kind, contact.primitive), (ContactKind::Point, i));
    }
}

#[test]
fn plane_is_touched_where_its_normal_meets_the_tools() {
    let center = Vector3::new(20.0, -7.0, 30.0);
    for (profile, n) in tools().into_iter().flat_map(|tool| normals().map(move |n| (tool, n))) {
        let level = n.x.hypot(n.z);
        // How far the tool reaches from its programmed point against the normal.
        let reach = match profile {
            Profile::Wheel { major_radius, minor_radius } => {
                minor_radius + major_radius * n.y.hypot(n.z)
            }
            Profile::Ball { radius } => radius - radius * n.y,
            Profile::Flat { radius } => radius * level,
            Profile::Bull { radius, corner_radius: c } => c + (radius - c) * level - c * n.y,
            Profile::Cone { radius, half_angle } => {
                (radius * level - radius / half_angle.tan() * n.y).max(0.0)
            }
            Profile::BallCone { radius, tip_radius: t, half_angle } => {
                let shoulder = radius / half_angle.tan() - t / half_angle.sin() + t;
                (radius * level - shoulder * n.y).max(t - t * n.y)
            }
        };
        for allowance in [0.0, 0.4] {
            let tool = Tool { profile, allowance };
            let contact = touched(&plane(&center, &n), profile, allowance);
            assert_near(contact.height, (n.dot(&center) + reach + allowance) / n.y);
            assert_eq!(contact.kind, ContactKind::Facet);
            assert_near_all(&contact.normal, &n);
            // A flat touches a level plane everywhere; of that its axis is picked.
            if 0.0 < level {
                let above = Vector3::y() * contact.height;
                assert_near_all(&contact.point.coords, &(above + tool.support(&n)));
            } else {
                let axis = Vector3::new(0.0, center.y, 0.0);
                assert_near_all(&contact.point.coords, &axis);
            }
        }
    }
}

#[test]
fn allowance_is_what_the_bare_tool_stays_away_from_a_plane() {
    let center = Vector3::new(-3.0, 11.0, 8.0);
    for (profile, n) in tools().into_iter().flat_map(|tool| normals().map(move |n| (tool, n))) {
        for allowance in [0.001, 0.5, 6.0] {
            let contact = touched(&plane(&center, &n), profile, allowance);
            let bare = Tool { profile, allowance: 0.0 };
            let nearest = Vector3::y() * contact.height + bare.support(&n);
            assert_near((nearest - center).dot(&n), allowance);
        }
    }
}

#[test]
fn allowance_sweeps_the_tool_by_a_ball() {
    // Over every point stands the highest of the bare tools moved by less than the allowance, each
    // as much higher as is left of it.
    let allowance = 1.5;
    for profile in tools() {
        let bare = Tool { profile, allowance: 0.0 };
        let size = Vector3::new(profile.half_width(), 0.0, profile.reach()).add_scalar(allowance);
        for (x, z) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
            let share = |k| f64::from(k) / 12.0 * FRAC_1_SQRT_2;
            let (x, z) = (share(x) * size.x, share(z) * size.z);
            let (_, swept) = peak(|s| {
                let dx = allowance * (2.0 * s - 1.0);
                let left = (allowance * allowance - dx * dx).max(0.0).sqrt();
                peak(|t| {
                    let dz = left * (2.0 * t - 1.0);
                    let (inside, height) = bare.level(x - dx, z - dz, 0.0);
                    let up = (left * left - dz * dz).max(0.0).sqrt();
                    (inside, if inside { height + up } else { height })
                })
            });
            let contact = touched(&needle(Vector3::new(x, 0.0, z)), profile, allowance);
            assert_near(contact.height, swept);
        }
    }
}

#[test]
fn sphere_is_touched_as_its_centre_is_by_a_tool_larger_by_its_radius() {
    let radius = 25.0;
    for (profile, n) in tools().into_iter().flat_map(|tool| normals().map(move |n| (tool, n))) {
        let tool = Tool { profile, allowance: 0.1 };
        let larger = Tool { profile, allowance: 0.1 + radius };
        let center = larger.support(&n) + Vector3::y() * 17.0;
        let expected = center.y + larger.height(center.x, center.z, 0.0).unwrap();
        assert_near(expected, 17.0);
        let pole = center + n * radius;
        // By a facet tangent to it.
        let contact = touched(&plane(&pole, &n), profile, tool.allowance);
        assert_near(contact.height, expected);
        // By a mesh of it, which reaches out to it with this vertex.
        let turned = UnitQuaternion::rotation_between(&Vector3::x(), &n).unwrap();
        let mesh = shapes::sphere(&Point3::origin(), radius, 20);
        let mesh = mesh.moved(&Pose::from_parts(Translation3::from(center), turned));
        let contact = touched(&mesh, profile, tool.allowance);
        assert_near(contact.height, expected);
    }
}

#[test]
fn wheel_rests_on_an_edge_as_its_section_does() {
    let height = |p: [f64; 3], q: [f64; 3]| {
        let contact = touched(&edge(p.into(), q.into()), WHEEL, 0.0);
        assert_eq!(contact.kind, ContactKind::Edge);
        let (p, q) = (Vector3::from(p), Vector3::from(q));
        let along = (q - p).normalize();
        assert_near((contact.point.coords - p).cross(&along).norm(), 0.0);
        contact.height
    };
    for (m, z) in [(0f64, 0.0), (0.3, 12.0), (-2.0, -40.0), (25.0, 69.0)] {
        // Level along x: its greatest disc.
        let disc = f64::sqrt(70.0 * 70.0 - z * z);
        assert_near(height([-90.0, 5.0, z], [300.0, 5.0, z]), 5.0 + disc);
        // Across x, of slope m: the disc there.
        let x = z / 7.0;
        let disc = 60.0 + (100.0 - x * x).sqrt();
        let end = |z: f64| [x, 5.0 + m * z, z];
        assert_near(height(end(-80.0), end(110.0)), 5.0 + disc * 1f64.hypot(m));
        // In the plane of the spindle, of slope m: the nose circle.
        let end = |x: f64| [x, 5.0 + m * x, 0.0];
        assert_near(height(end(-50.0), end(31.0)), 5.0 + 60.0 + 10.0 * 1f64.hypot(m));
    }
}

#[test]
fn end_mill_rests_on_an_edge_as_its_section_does() {
    let k = |half_angle: f64| 1.0 / half_angle.tan();
    let (cone, taper) = (0.5, 0.35);
    for turn in [0.0, 0.9, 2.2, 4.0] {
        for (m, d) in [(0f64, 0f64), (0.0, 1.2), (1e-9, 1.1), (0.7, 1.0), (-1.6, 1.5), (-9.0, 0.3)]
        {
            let rests = |profile, expected: f64| {
                let contact = touched(&passing_edge(m, d, turn), profile, 0.0);
                assert_near(contact.height, 3.0 + expected);
                assert_eq!(contact.kind, ContactKind::Edge, "{profile:?} on slope {m} at {d}");
            };
            let arc = |radius: f64| (radius * radius - d * d).sqrt() * 1f64.hypot(m) - radius;
            rests(Profile::Ball { radius: 6.0 }, arc(6.0));
            rests(Profile::Flat { radius: 5.0 }, m.abs() * (25.0 - d * d).sqrt());
            // A hyperbola of the cone, or the end of its flank.
            let flank = |radius: f64, k: f64| {
                if m.abs() < k && d * k / (k * k - m * m).sqrt() <= radius {
                    -d * (k * k - m * m).sqrt()
                } else {
                    m.abs() * (radius * radius - d * d).sqrt() - k * radius
                }
            };
            rests(Profile::Cone { radius: 7.0, half_angle: cone }, flank(7.0, k(cone)));
            // The flank's tip lies below the ball's, and the ball covers it.
            let profile = Profile::BallCone { radius: 9.0, tip_radius: 2.0, half_angle: taper };
            let on_ball = (4.0 - d * d).sqrt() * m / 1f64.hypot(m);
            let expected = if on_ball.hypot(d) <= 2.0 * taper.cos() {
                arc(2.0)
            } else {
                flank(9.0, k(taper)) + 2.0 / taper.sin() - 2.0
            };
            rests(profile, expected);
            // Through the axis a bull's section is a flat between two arcs.
            let profile = Profile::Bull { radius: 8.0, corner_radius: 2.5 };
            if d == 0.0 || m == 0.0 {
                rests(profile, m.abs() * 5.5 + 2.5 * 1f64.hypot(m) - 2.5);
            }
        }
    }
}

#[test]
fn point_is_touched_by_what_of_the_tool_is_over_it() {
    let half_angle = (4.0f64 / 3.0).atan();
    let ball_cone = Profile::BallCone { radius: 20.0, tip_radius: 5.0, half_angle };
    let cases = [
        (WHEEL, [0.0, 0.0], 70.0),
        (WHEEL, [6.0, 0.0], 68.0),
        (WHEEL, [-6.0, 32.0], 60.0),
        (WHEEL, [8.0, -66.0 * 0.6], 66.0 * 0.8),
        (Profile::Ball { radius: 5.0 }, [0.0, -3.0], -1.0),
        (Profile::Flat { radius: 5.0 }, [2.9, -4.0], 0.0),
        (Profile::Bull { radius: 8.0, corner_radius: 5.0 }, [1.0, 2.0], 0.0),
        (Profile::Bull { radius: 8.0, corner_radius: 5.0 }, [-6.0, 0.0], -1.0),
        (Profile::Cone { radius: 8.0, half_angle: FRAC_PI_4 }, [-3.0, 4.0], -5.0),
        (Profile::Cone { radius: 8.0, half_angle: FRAC_PI_4 }, [0.0, 0.0], 0.0),
        // The ball ends 3 from the axis; the flank falls by 3 in 4.
        (ball_cone, [0.0, 3.0], -1.0),
        (ball_cone, [0.0, 7.0], -4.0),
        (ball_cone, [0.0, -19.0], -13.0),
    ];
    for (profile, [x, z], above) in cases {
        let point = Vector3::new(x, 4.0, z);
        let contact = touched(&needle(point), profile, 0.0);
        assert_near(contact.height, 4.0 + above);
        assert_eq!(contact.kind, ContactKind::Vertex, "{profile:?} at {x}, {z}");
        assert_near_all(&contact.point.coords, &point);
    }
}

#[test]
fn normal_at_an_edge_is_the_tools() {
    // The nose touches 6 from the middle: its normal leans 6 in 10.
    let contact = touched(&needle(Vector3::new(6.0, 0.0, 0.0)), WHEEL, 0.0);
    assert_near_all(&contact.normal, &Vector3::new(-0.6, 0.8, 0.0));
    let contact = touched(&passing_edge(0.0, 3.0, 0.0), Profile::Ball { radius: 5.0 }, 0.0);
    assert_near_all(&contact.normal, &Vector3::new(0.0, 0.8, -0.6));
}

#[test]
fn edge_almost_as_steep_as_a_flank_is_followed_to_its_end() {
    // The search once took the end of a sharp bend for the top: past it a slope that is small but
    // does not end led on, up to the rim or down to the tip.
    let cone = |half_angle: f64| Profile::Cone { radius: 7.0, half_angle };
    let bull = Profile::Bull { radius: 8.0, corner_radius: 0.02 };
    for i in 0..400 {
        let half_angle = 0.2 + 1e-3 * f64::from(i);
        let k = 1.0 / half_angle.tan();
        let little = 10f64.powf(-2.0 - f64::from(i % 40) / 5.0);
        let turn = f64::from(i);
        let steeper = touched(&passing_edge(k + little, 0.0, turn), cone(half_angle), 0.0);
        assert_near(steeper.height, 3.0 + 7.0 * little);
        let flatter = touched(&passing_edge(k - little, 0.0, turn), cone(half_angle), 0.0);
        assert_near(flatter.height, 3.0);
        let level = touched(&passing_edge(little, 0.0, turn), bull, 0.0);
        assert_near(level.height, 3.0 + 7.98 * little + 0.02 * (1f64.hypot(little) - 1.0));
    }
}

#[test]
fn sliver_holds_a_tool_as_high_as_the_plane_it_lies_in() {
    // Plain products left a sliver a normal of mere rounding, and a plane that missed its corners.
    let ball = Profile::Ball { radius: 6.0 };
    for (n, i) in normals().zip(0..) {
        let contact = Vector3::y() * 9.0 + Tool { profile: ball, allowance: 0.0 }.support(&n);
        let along = n.cross(&Vector3::new(0.3, 0.2, 0.9)).normalize();
        let across = n.cross(&along) * 10f64.powi(-i % 14);
        let corners = [along * -300.0 - across, along * 500.0, along * -400.0 + across];
        let sliver = soup(&[corners.map(|out| Point3::from(contact + out))]);
        assert_near(touched(&sliver, ball, 0.0).height, 9.0);
    }
}
