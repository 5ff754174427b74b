//! Every bound of every tool against samples of its height function.

use super::*;
use crate::tool::{Cutter, Profile};
use fearless_simd::{Level, dispatch, prelude::*};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Rounding of `f32` in a product of several factors.
const SLACK: f64 = 1.0 + 1e-4;

/// Every kind of tool, with and without an allowance.
fn tools() -> impl Iterator<Item = Cutter> {
    let (radius, half_angle) = (6.0, 0.3);
    let profiles = [
        Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 },
        Profile::Ball { radius },
        Profile::Flat { radius },
        Profile::Bull { radius, corner_radius: 1.5 },
        Profile::Cone { radius, half_angle },
        Profile::BallCone { radius, tip_radius: 2.0, half_angle },
    ];
    let of = |profile: Profile| [0.0, 0.7].map(|allowance| profile.cutter(allowance));
    profiles.into_iter().flat_map(of)
}

#[test]
fn no_place_of_a_rectangle_is_steeper_or_more_bent_than_its_sharpness() {
    for tool in tools() {
        match tool {
            Cutter::Wheel(tool) => check_sharpness(&tool),
            Cutter::Mill(tool) => check_sharpness(&tool),
        }
    }
}

#[test]
fn the_lowest_plane_of_a_slope_touches_the_tool_and_lies_above_all_of_it() {
    for tool in tools() {
        match tool {
            Cutter::Wheel(tool) => check_lowest_plane(&tool),
            Cutter::Mill(tool) => check_lowest_plane(&tool),
        }
    }
}

#[test]
fn no_tangent_plane_lies_below_the_tool_wherever_it_is_asked_for() {
    for tool in tools() {
        match tool {
            Cutter::Wheel(tool) => check_tangents(&tool),
            Cutter::Mill(tool) => check_tangents(&tool),
        }
    }
}

#[test]
fn planes_asked_for_beyond_a_sharp_rim_fall_off_outwards() {
    for profile in [Profile::Flat { radius: 6.0 }, Profile::Cone { radius: 6.0, half_angle: 1.5 }] {
        let Cutter::Mill(mill) = profile.cutter(0.0) else { panic!("{profile:?} is a mill") };
        assert_eq!(mill.rim().map(|rim| rim.radius), Some(6.0));
        let [_, x0, _, slope, _] = tangent(&mill, [7.0, 0.0], 0.999);
        assert_eq!(x0, 6.0);
        assert!(slope < -20.0, "{slope} of {profile:?}");
    }
}

fn check_tangents(tool: &impl HeightFunction) {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let reach = tool.reach();
    for _ in 0..500 {
        let mut place =
            |most: f64| [reach.x, reach.z].map(|reach| reach * random.random_range(-most..most));
        let at = place(1.5);
        let places = [0; 20].map(|_| place(1.0));
        for share in [0.9, 0.999] {
            let [value, x0, z0, slope_x, slope_z] = tangent(tool, at, share);
            for [x, z] in places {
                let Some(height) = tool.height(x, z) else { continue };
                let plane = value + slope_x * (x - x0) + slope_z * (z - z0);
                assert!(height <= plane + 1e-3, "{height} above {plane} at {x}, {z}");
            }
        }
    }
}

/// Value, place and slopes of the plane asked for at one place.
fn tangent(tool: &impl HeightFunction, at: [f64; 2], share: f32) -> [f64; 5] {
    dispatch!(Level::new(), simd => {
        let [x, z] = at.map(|at| f32x16::splat(simd, at as f32));
        let Tangent { x0, z0, value, slope_x, slope_z } =
            tool.tangent_within(simd, x, z, share);
        [value, x0, z0, slope_x, slope_z].map(|lanes| f64::from(lanes.as_slice()[0]))
    })
}

/// Against the best of many places of the shadow, its rim among them.
fn check_lowest_plane(tool: &impl HeightFunction) {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let reach = tool.reach();
    for _ in 0..200 {
        let slope = [0; 2].map(|_| random.random_range(-3.0..3.0_f64));
        let value = dispatch!(Level::new(), simd => {
            let [x, z] = slope.map(|slope| f32x16::splat(simd, slope as f32));
            f64::from(tool.lowest_plane(simd, x, z).as_slice()[0])
        });
        let mut highest = f64::NEG_INFINITY;
        for i in 0..=100 {
            for k in 0..=100 {
                let at = |reach: f64, i: i32| reach * (f64::from(i) / 50.0 - 1.0);
                // Towards the rim ever closer, where heights change most.
                let (x, z) = (at(1.0, i), at(1.0, k));
                let closer = |share: f64| (1.0 - (1.0 - share.abs()).powi(2)).copysign(share);
                let (x, z) = (reach.x * closer(x), reach.z * closer(z));
                if let Some(height) = tool.height(x, z) {
                    highest = highest.max(height - slope[0] * x - slope[1] * z);
                }
            }
        }
        assert!(highest <= value + 1e-4, "{highest} above {value} at {slope:?}");
        assert!(value <= highest + 0.02 * (reach.x + reach.z), "{value}, {highest}, {slope:?}");
    }
}

fn check_sharpness(tool: &impl HeightFunction) {
    let mut random = Pcg64Mcg::seed_from_u64(99);
    let reach = tool.reach();
    let mut n_within = 0;
    for _ in 0..2_000 {
        let share = [0.9, 0.995][random.random_range(0..2)];
        let [x, z] = [reach.x, reach.z].map(|reach| reach * random.random_range(-1.2..1.2));
        let [half_x, half_z] = [0; 2].map(|_| reach.x * random.random_range(0.0..0.3));
        let step = [0; 2].map(|_| random.random_range(-1.0..1.0_f64));
        let (whole, _) = sharpness(tool, [x, z, half_x, half_z], step, share);
        for _ in 0..10 {
            let [x, z] = [
                x + half_x * random.random_range(-1.0..1.0),
                z + half_z * random.random_range(-1.0..1.0),
            ];
            let Some(height) = tool.height(x, z) else { continue };
            let (_, is_here_within) = sharpness(tool, [x, z, 0.0, 0.0], step, share);
            assert!(!whole.is_outside, "{x}, {z} is in the shadow");
            if !is_here_within {
                assert!(height <= whole.beyond + 1e-5, "{height} beyond at {x}, {z}");
                continue;
            }
            n_within += 1;
            let bend = -tool.along(x, z, step[0], step[1]).bend;
            assert!(bend <= whole.bend * SLACK + 1e-9, "{bend} above {whole:?} at {x}, {z}");
            let slopes = [[1.0, 0.0], [0.0, 1.0]].map(|[dx, dz]| tool.along(x, z, dx, dz).slope);
            assert!(slopes[0].abs() <= whole.slope[0] * SLACK + 1e-6, "{slopes:?}, {whole:?}");
            assert!(slopes[1].abs() <= whole.slope[1] * SLACK + 1e-6, "{slopes:?}, {whole:?}");
        }
    }
    assert!(n_within > 3_000, "{n_within}");
}

#[derive(Debug)]
struct Plain {
    slope: [f64; 2],
    bend: f64,
    is_outside: bool,
    beyond: f64,
}

/// That of one rectangle, and whether it lies within the share.
fn sharpness(
    tool: &impl HeightFunction,
    rectangle: [f64; 4],
    step: [f64; 2],
    share: f32,
) -> (Plain, bool) {
    dispatch!(Level::new(), simd => {
        let splat = |value: f64| f32x16::splat(simd, value as f32);
        let [x, z, half_x, half_z] = rectangle.map(splat);
        // What the middle loses in rounding the half-sides must hold.
        let rounding = splat(1e-5);
        let (half_x, half_z) = (half_x + rounding, half_z + rounding);
        let [step_x, step_z] = step.map(|step| splat(step.abs()));
        let swept = Swept { x, z, half_x, half_z, step_x, step_z };
        let sharpness = tool.sharpness(simd, &swept, share);
        let first = |lanes: f32x16<_>| f64::from(lanes.as_slice()[0]);
        let plain = Plain {
            slope: [first(sharpness.slope_x), first(sharpness.slope_z)],
            bend: first(sharpness.bend),
            is_outside: sharpness.is_outside.to_bitmask() & 1 == 1,
            beyond: sharpness.beyond.into(),
        };
        (plain, sharpness.is_within.to_bitmask() & 1 == 1)
    })
}
