//! Stock against closed forms: what moves of a tool leave of blocks of known shape.

use crate::random_cases::Draw;
use horma::geom::{Aabb, Point3, TriMesh, shapes};
use horma::machine::{AxisValues, Machine};
use horma::progress::Silent;
use horma::stock::{Cut, Layout, Resolution, Stance, Stock, Sweep};
use horma::tool::{Cutter, HeightFunction, Profile};
use rand::{RngExt, SeedableRng};
use std::f64::consts::{PI, TAU};

const WHEEL: Profile = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 };

fn around(x: [f64; 2], radius: f64) -> Aabb {
    Aabb { min: Point3::new(x[0], -radius, -radius), max: Point3::new(x[1], radius, radius) }
}

fn layout(machine: &Machine, block: &Aabb, resolution: Resolution) -> Layout {
    Layout::new(machine, &machine.at_rest(), block, resolution).unwrap()
}

fn lathe() -> Machine {
    Machine::builtin("last-lathe").unwrap()
}

/// A round block on the lathe.
fn bar(x: [f64; 2], radius: f64, resolution: Resolution) -> Stock {
    // The corners of the box lie farther out than the bar.
    Stock::cylinder(layout(&lathe(), &around(x, radius), resolution), radius)
}

fn at(x: f64, y: f64, a: f64) -> AxisValues {
    [x, y, a, 0.0, 0.0, 0.0]
}

/// Moves through `places`, one engagement.
fn through(places: &[AxisValues]) -> Vec<Sweep> {
    let pairs = places.windows(2).enumerate();
    pairs.map(|(i, pair)| Sweep { from: pair[0], to: pair[1], engages: i == 0 }).collect()
}

fn cut(stock: &mut Stock, machine: &Machine, profile: Profile, places: &[AxisValues]) -> Vec<Cut> {
    stock.remove(machine, &profile.cutter(0.0), &through(places), &Silent).unwrap()
}

#[test]
fn a_cylinder_holds_its_own_volume() {
    let stock = bar([0.0, 80.0], 30.0, Resolution::even(0.5));
    let expected = PI * 900.0 * 80.0;
    assert!((stock.volume() / expected - 1.0).abs() < 1e-9, "{}", stock.volume());
}

#[test]
fn a_helix_of_the_wheel_leaves_the_cusps_of_its_formula() {
    // h = r - sqrt(r^2 - pitch^2 / 4) = 0.2020 mm for r 10, pitch 4; stations pitch / 400 apart.
    let resolution = Resolution { along: 0.01, across: 20.0 };
    let mut stock = bar([20.0, 28.0], 40.0, resolution);
    // From far left to far right of the bar, six degrees a step.
    let helix: Vec<_> = (0..=60 * 12)
        .map(|i| f64::from(i) / 60.0)
        .map(|turns| at(4.0 * turns, 100.0, -TAU * turns))
        .collect();
    cut(&mut stock, &lathe(), WHEEL, &helix);
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for row in 100..stock.layout().n_rows() - 100 {
        let end = stock.end(row, 0).unwrap();
        (low, high) = (low.min(end), high.max(end));
    }
    let h = 10.0 - (100.0_f64 - 4.0).sqrt();
    assert!((h - 0.2020).abs() < 1e-4);
    assert!(((high - low) / h - 1.0).abs() < 0.01, "{} for {h}", high - low);
    assert!((low - 30.0).abs() < stock.sweep_error() + 1e-4, "{low}");
}

#[test]
fn a_ring_takes_the_groove_of_the_wheel_and_says_how_much() {
    let resolution = Resolution { along: 0.05, across: 0.5 };
    let mut stock = bar([0.0, 60.0], 30.0, resolution);
    let before = stock.volume();
    // Plunge to 2 mm deep, then a full turn in 10 degree moves.
    let mut places = vec![at(30.0, 120.0, 0.0), at(30.0, 98.0, 0.0)];
    places.extend((1..=36).map(|i| at(30.0, 98.0, -TAU * f64::from(i) / 36.0)));
    let cuts = cut(&mut stock, &lathe(), WHEEL, &places);
    for x in [30.0, 27.0, 33.0, 36.0] {
        let dx: f64 = x - 30.0;
        let nose = (100.0_f64 - dx * dx).sqrt();
        let expected = (98.0 - 60.0 - nose).min(30.0);
        for i in 0..50 {
            let radius = stock.height_at(x, TAU * f64::from(i) / 50.0).unwrap();
            assert!((radius - expected).abs() < 0.005, "{radius} for {expected} at {x}");
        }
    }
    let removed: f64 = cuts.iter().map(|cut| cut.removed).sum();
    assert!((before - stock.volume() - removed).abs() < 1e-6 * removed);
    let deepest = cuts.iter().map(|cut| cut.depth).fold(0.0, f64::max);
    assert!((deepest - 2.0).abs() < 1e-9, "{deepest}");
    // The groove by revolving its section: integral of pi (30^2 - rho(x)^2).
    let n = 20_000;
    let half = (100.0_f64 - 64.0).sqrt();
    let groove: f64 = (0..n)
        .map(|i| -half + 2.0 * half * (f64::from(i) + 0.5) / f64::from(n))
        .map(|dx| PI * (900.0 - (38.0 - (100.0 - dx * dx).sqrt()).powi(2)))
        .sum::<f64>()
        * 2.0
        * half
        / f64::from(n);
    assert!((removed / groove - 1.0).abs() < 1e-3, "{removed} for {groove}");
}

#[test]
fn a_whole_turn_in_one_block_is_cut_like_many_small_ones() {
    let resolution = Resolution::even(0.5);
    let ends = |n_moves: i32| {
        let mut stock = bar([0.0, 40.0], 30.0, resolution);
        let places: Vec<_> = (0..=n_moves)
            .map(|i| f64::from(i) / f64::from(n_moves))
            .map(|t| at(10.0 + 8.0 * t, 98.0 - 3.0 * t, -2.0 * TAU * t))
            .collect();
        cut(&mut stock, &lathe(), WHEEL, &places);
        stock
    };
    let (one, many) = (ends(1), ends(2000));
    assert!(one.sweep_error() <= 0.01 && one.sweep_error() > 0.0, "{}", one.sweep_error());
    let off = one.deepest_below(&many).max(many.deepest_below(&one));
    assert!(off <= 1.5 * one.sweep_error() + many.sweep_error(), "{off} {}", one.sweep_error());
}

#[test]
fn a_wandering_wheel_cuts_every_ray_as_the_textbook_does_one_by_one() {
    let large = [60.0, 10.0];
    let small = [8.0, 3.0];
    for (seed, wheel, spacing) in
        [(1, large, 0.5), (2, small, 0.5), (3, small, 14.0), (4, large, 5.0)]
    {
        let mut draw = Draw::seed_from_u64(seed);
        let mut stock = bar([0.0, 40.0], 30.0, Resolution::even(spacing));
        let mut rays = Rays::of(&stock);
        let [major, minor] = wheel;
        let mut place: [f64; 3] = [20.0, 28.0 + major + minor, 0.0];
        let mut was_overhanging = false;
        for _ in 0..400 {
            // Small steps, as on a path, and now and then one right into the block.
            let jumps = draw.random_bool(0.05);
            let step = if jumps { 1.0 } else { 0.05 };
            let lowest = if draw.random_bool(0.01) { -4.0 } else { 6.0 };
            let sink = if jumps { 25.0 } else { 9.0 };
            place[0] = (place[0] + step * draw.random_range(-12.0..12.0)).clamp(-8.0, 48.0);
            place[1] = (place[1] + step * draw.random_range(-sink..sink))
                .clamp(lowest + major + minor, 32.0 + major + minor);
            place[2] += step * draw.random_range(-3.0..4.0);
            let [x, y, a] = place;
            let place = at(x, y, a);
            let cuts = cut(&mut stock, &lathe(), wheel_of(wheel), &[place, place]);
            let expected = rays.cut(wheel, [x, y, a]);
            was_overhanging |= cuts[0].n_overhangs > 0;
            assert_eq!(cuts[0].n_overhangs > 0, expected.n_overhangs > 0);
            assert_eq!(cuts[0].is_through, expected.is_through);
            assert!((cuts[0].depth - expected.depth).abs() < 1e-9, "{cuts:?} {expected:?}");
            assert!((cuts[0].removed - expected.removed).abs() < 1e-6, "{cuts:?} {expected:?}");
        }
        assert!(rays.farthest_from(&stock) < 1e-9, "seed {seed}");
        assert!(was_overhanging || seed != 2, "the case tries nothing");
    }
}

#[test]
fn a_wandering_mill_cuts_every_ray_where_its_height_function_says() {
    let profiles = [
        Profile::Ball { radius: 6.0 },
        Profile::Flat { radius: 6.0 },
        Profile::Bull { radius: 6.0, corner_radius: 2.0 },
        Profile::BallCone { tip_radius: 1.0, half_angle: 0.2, radius: 5.0 },
    ];
    let mill = Machine::builtin("mill-rotary").unwrap();
    let [x, y, z, a] = ['X', 'Y', 'Z', 'A'].map(|letter| mill.axis_index(letter).unwrap());
    // Seeds for which no ray only grazes a tool, where rounding decides.
    for (seed, profile) in (10..).zip(profiles) {
        for allowance in [0.0, 0.5] {
            let mut draw = Draw::seed_from_u64(seed);
            let block = around([0.0, 30.0], 30.0);
            let layout = layout(&mill, &block, Resolution::even(2.0));
            let mut stock = Stock::cylinder(layout, 30.0);
            let mut rays = Rays::of(&stock);
            let mut place: [f64; 4] = [15.0, 0.0, 31.0, 0.0];
            for _ in 0..30 {
                let jumps = draw.random_bool(0.3);
                let step = if jumps { 1.0 } else { 0.1 };
                place[0] = (place[0] + step * draw.random_range(-9.0..9.0)).clamp(-4.0, 34.0);
                // Beside the axis as well, even past the part's middle.
                place[1] = (place[1] + step * draw.random_range(-9.0..9.0)).clamp(-25.0, 25.0);
                place[2] = (place[2] + step * draw.random_range(-12.0..12.0)).clamp(3.0, 32.0);
                place[3] += step * draw.random_range(-3.0..4.0);
                let mut values = mill.at_rest();
                (values[x], values[y], values[z], values[a]) =
                    (place[0], place[1], place[2], place[3]);
                let moves = [Sweep { from: values, to: values, engages: true }];
                let cutter = profile.cutter(allowance);
                let cuts = stock.remove(&mill, &cutter, &moves, &Silent).unwrap();
                let stance = Stance::at(&mill, &values);
                let expected = rays.mill(&cutter, &stance);
                assert_eq!(cuts[0].is_through, expected.is_through);
                assert!((cuts[0].depth - expected.depth).abs() < 1e-6, "{cuts:?} {expected:?}");
                assert!((cuts[0].removed - expected.removed).abs() < 1e-3, "{cuts:?} {expected:?}");
            }
            assert!(rays.farthest_from(&stock) < 1e-6, "{profile} {}", rays.farthest_from(&stock));
        }
    }
}

#[test]
fn moves_taken_together_cut_what_they_cut_one_by_one() {
    let places: Vec<_> = (0..600)
        .map(f64::from)
        .map(|i| at(0.08 * i, 94.0 + 3.0 * (i / 11.0).sin(), -i / 17.0))
        .collect();
    let mut together = bar([0.0, 60.0], 30.0, Resolution::even(0.4));
    let cuts = cut(&mut together, &lathe(), WHEEL, &places);
    let mut alone = bar([0.0, 60.0], 30.0, Resolution::even(0.4));
    for (sweep, cut) in through(&places).iter().zip(&cuts) {
        let sweep = std::slice::from_ref(sweep);
        let taken = alone.remove(&lathe(), &WHEEL.cutter(0.0), sweep, &Silent).unwrap();
        assert_eq!(taken[0].depth.to_bits(), cut.depth.to_bits());
        assert!((taken[0].removed - cut.removed).abs() < 1e-9, "{taken:?} {cut:?}");
    }
    assert_eq!(together.deepest_below(&alone), 0.0);
    assert_eq!(alone.deepest_below(&together), 0.0);
}

#[test]
fn the_bits_are_the_same_for_any_number_of_threads() {
    let run = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| {
            let mut stock = bar([0.0, 60.0], 30.0, Resolution::even(0.4));
            let places: Vec<_> = (0..400)
                .map(f64::from)
                .map(|i| at(0.1 * i, 97.0 + (i / 7.0).sin(), -i / 9.0))
                .collect();
            let cuts = cut(&mut stock, &lathe(), WHEEL, &places);
            (cuts, stock.to_mesh(), stock.volume())
        })
    };
    assert!(run(1) == run(3));
}

#[test]
fn the_surface_of_a_cylinder_is_closed_and_holds_its_volume() {
    let stock = bar([0.0, 20.0], 30.0, Resolution::even(0.5));
    let report = horma::geom::topology(&stock.to_mesh());
    assert_eq!((report.n_open_edges, report.n_flipped_edges), (0, 0));
    let volume = report.volume.unwrap();
    assert!((volume / stock.volume() - 1.0).abs() < 1e-3, "{volume}");
    let layout = stock.layout();
    let area: f64 = (0..layout.n_rows())
        .flat_map(|i| (0..layout.n_columns()).map(move |j| (i, j)))
        .map(|(i, j)| stock.area_at(i, j))
        .sum();
    assert!((area / (TAU * 30.0 * 20.0) - 1.0).abs() < 1e-3, "{area}");
}

#[test]
fn a_mesh_fills_a_ray_up_to_its_outermost_surface() {
    // A ring with air between it and a core: what one radius a ray cannot tell.
    let mut mesh = shapes::prism(64, 10.0, 40.0);
    mesh.append(shapes::prism(64, 25.0, 40.0));
    let block = around([0.0, 40.0], 30.0);
    let stock = Stock::of_mesh(layout(&lathe(), &block, Resolution::even(0.5)), &mesh);
    let radius = stock.height_at(20.0, 0.0).unwrap();
    assert!((radius - 25.0).abs() < 1e-9, "{radius}");
}

#[test]
fn a_prism_as_stock_has_the_volume_of_its_formula() {
    let prism = shapes::prism(6, 40.0, 50.0);
    let block = around([0.0, 50.0], 40.0);
    let stock = Stock::of_mesh(layout(&lathe(), &block, Resolution::even(0.25)), &prism);
    let expected = 50.0 * 3.0 * 1600.0 * (TAU / 6.0).sin();
    assert!((stock.volume() / expected - 1.0).abs() < 1e-4, "{} {expected}", stock.volume());
}

#[test]
fn a_grown_body_has_its_margin_everywhere_and_nowhere_much_more() {
    let ball = shapes::sphere(&Point3::new(40.0, 0.0, 0.0), 20.0, 60);
    let block = around([15.0, 65.0], 25.0);
    let stock = Stock::of_mesh(layout(&lathe(), &block, Resolution::even(0.5)), &ball).grown(4.0);
    for row in 0..stock.layout().n_rows() {
        let x = stock.layout().row_x(row) - 40.0;
        for column in (0..stock.layout().n_columns()).step_by(7) {
            if let Some(end) = stock.end(row, column) {
                // Rays stand on the ball's tips sparsely, and so do the balls it is grown by.
                let least = if x.abs() < 20.0 { 23.9 } else { 23.75 };
                let radius = end.hypot(x);
                assert!((least..24.05).contains(&radius), "{radius} at {x}");
            } else {
                // At its very tips a ray from the axis has nothing to grow from.
                assert!(x.abs() > 23.4, "nothing at {x}");
            }
        }
    }
}

#[test]
fn what_stands_over_a_tool_that_passes_beneath_it_is_kept_and_counted() {
    // A mill along Z beside the axis: rays slanting through its slot come out at the side of it,
    // below the skin of the block.
    let mill = Machine::builtin("mill-rotary").unwrap();
    let block = around([0.0, 40.0], 30.0);
    let mut stock = Stock::cylinder(layout(&mill, &block, Resolution::even(0.5)), 30.0);
    let [x, y, z] = ['X', 'Y', 'Z'].map(|letter| mill.axis_index(letter).unwrap());
    let place = |height: f64| {
        let mut values = mill.at_rest();
        (values[x], values[y], values[z]) = (20.0, 0.0, height);
        values
    };
    let plunge = [place(40.0), place(10.0)];
    let cuts = cut(&mut stock, &mill, Profile::Flat { radius: 5.0 }, &plunge);
    assert!(cuts[0].n_overhangs > 0);
    // The floor of the slot is exact; beside the slot the skin is whole.
    let floor = (0..stock.layout().n_columns())
        .filter_map(|j| stock.height_at(20.0, TAU * j as f64 / stock.layout().n_columns() as f64))
        .fold(f64::INFINITY, f64::min);
    assert!((floor - 10.0).abs() < 1e-6, "{floor}");
    assert!((stock.height_at(20.0, PI / 4.0).unwrap() - 30.0).abs() < 1e-9);
}

#[test]
fn a_wheel_across_the_axis_cuts_the_part_in_two_once_it_has_been_all_around() {
    let mut stock = bar([0.0, 40.0], 30.0, Resolution::even(0.5));
    let places = [at(20.0, 110.0, 0.0), at(20.0, 69.0, 0.0), at(20.0, 69.0, TAU)];
    let cuts = cut(&mut stock, &lathe(), WHEEL, &places);
    // At first it leaves what lies beyond it.
    assert!(!cuts[0].is_through && cuts[0].depth > 29.9);
    assert!(cuts[1].is_through);
    assert!((0..stock.layout().n_columns()).all(|column| stock.end(40, column).is_none()));
    assert!(stock.height_at(0.0, 1.0).unwrap() > 29.9);
}

#[test]
fn a_ball_around_a_rotary_table_turns_the_cylinder_of_its_tip() {
    let mill = Machine::builtin("mill-rotary").unwrap();
    let block = around([0.0, 12.0], 30.0);
    let mut stock = Stock::cylinder(layout(&mill, &block, Resolution::even(0.3)), 30.0);
    let [x, z, a] = ['X', 'Z', 'A'].map(|letter| mill.axis_index(letter).unwrap());
    let places: Vec<_> = (0..=36 * 40)
        .map(|i| f64::from(i) / 36.0)
        .map(|turns| {
            let mut values = mill.at_rest();
            (values[x], values[z], values[a]) = (0.5 * turns - 4.0, 28.0, TAU * turns);
            values
        })
        .collect();
    cut(&mut stock, &mill, Profile::Ball { radius: 5.0 }, &places);
    let cusp = 5.0 - (25.0_f64 - 0.0625).sqrt();
    for row in 0..stock.layout().n_rows() {
        for column in (0..stock.layout().n_columns()).step_by(11) {
            let radius = stock.end(row, column).unwrap();
            assert!((28.0 - 1e-6..28.0 + cusp + 0.01).contains(&radius), "{radius}");
        }
    }
}

#[test]
fn a_slope_on_a_table_is_exact_between_the_ends_of_one_long_move() {
    // A ball that climbs from one end of the block to the other: its envelope is a cylinder.
    let mill = Machine::builtin("mill-3axis").unwrap();
    let block = Aabb { min: Point3::new(-30.0, -10.0, 0.0), max: Point3::new(30.0, 10.0, 30.0) };
    let mut stock = Stock::cylinder(layout(&mill, &block, Resolution::even(0.5)), 0.0);
    let [from, to] = [[-50.0, 0.0, 2.0], [50.0, 0.0, 27.0]];
    let place = |[x, y, z]: [f64; 3]| [x, y, z, 0.0, 0.0, 0.0];
    cut(&mut stock, &mill, Profile::Ball { radius: 6.0 }, &[place(from), place(to)]);
    let slope: f64 = 0.25;
    let (mut worst, mut n) = (0.0_f64, 0);
    for x in [-20.0, -3.0, 11.0, 25.0] {
        for y in [0.0, 2.0, -4.0, 5.5] {
            // Under a cylinder of radius 6 about the line of the ball's centre.
            let centre = 2.0 + slope * (x + 50.0) + 6.0;
            let expected = centre - (36.0_f64 - y * y).sqrt() * (1.0 + slope * slope).sqrt();
            let found = stock.height_at(x, -y).unwrap();
            worst = worst.max((found - expected.clamp(0.0, 30.0)).abs());
            n += 1;
        }
    }
    assert!(n == 16 && worst < 1e-6, "{worst}");
    assert_eq!(stock.sweep_error(), 0.0);
}

#[test]
fn a_box_milled_flat_returns_its_own_volume() {
    let mill = Machine::builtin("mill-3axis").unwrap();
    let block = Aabb { min: Point3::new(-25.0, -15.0, 0.0), max: Point3::new(25.0, 15.0, 20.0) };
    let mut stock = Stock::cylinder(layout(&mill, &block, Resolution::even(0.5)), 0.0);
    assert!((stock.volume() / 30_000.0 - 1.0).abs() < 1e-9);
    let rows = (0..=10).flat_map(|i| {
        let y = -15.0 + 3.0 * f64::from(i);
        [[-40.0, y, 12.5, 0.0, 0.0, 0.0], [40.0, y, 12.5, 0.0, 0.0, 0.0]]
    });
    cut(&mut stock, &mill, Profile::Flat { radius: 6.0 }, &rows.collect::<Vec<_>>());
    assert!((stock.volume() / (50.0 * 30.0 * 12.5) - 1.0).abs() < 1e-9, "{}", stock.volume());
}

#[test]
fn a_mill_below_the_block_is_told() {
    let mill = Machine::builtin("mill-3axis").unwrap();
    let block = Aabb { min: Point3::new(-9.0, -9.0, 0.0), max: Point3::new(9.0, 9.0, 9.0) };
    let mut stock = Stock::cylinder(layout(&mill, &block, Resolution::even(0.5)), 0.0);
    let plunge = [[0.0, 0.0, 20.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0, 0.0, 0.0]];
    assert!(cut(&mut stock, &mill, Profile::Flat { radius: 3.0 }, &plunge)[0].is_through);
}

#[test]
fn a_link_is_tried_without_cutting_anything() {
    let stock = bar([0.0, 60.0], 30.0, Resolution::even(0.3));
    let over = |y: f64, allowance: f64| {
        let sweep = Sweep { from: at(10.0, y, 0.0), to: at(50.0, y, 1.0), engages: false };
        let cutter: Cutter = WHEEL.cutter(allowance);
        stock.depth_of(&lathe(), &cutter, &sweep).unwrap()
    };
    assert_eq!(over(100.5, 0.0), 0.0);
    assert!((over(99.0, 0.0) - 1.0).abs() < 0.01);
    assert!((over(100.5, 2.0) - 1.5).abs() < 0.01, "half a millimetre is no clearance of two");
    assert!(over(60.0, 0.0) > 29.9, "across the axis");
    assert!(
        (stock.volume() / bar([0.0, 60.0], 30.0, Resolution::even(0.3)).volume() - 1.0).abs()
            < 1e-12
    );
}

#[test]
fn an_empty_mesh_is_no_stock() {
    let block = around([0.0, 10.0], 5.0);
    let stock =
        Stock::of_mesh(layout(&lathe(), &block, Resolution::even(0.5)), &TriMesh::default());
    assert_eq!(stock.volume(), 0.0);
    assert!(stock.to_mesh().triangles.is_empty());
}

fn wheel_of([major_radius, minor_radius]: [f64; 2]) -> Profile {
    Profile::Wheel { major_radius, minor_radius }
}

/// Rays from the spindle axis, cut by nothing but the equation of a circle.
struct Rays {
    /// X of each row, and what it counts for.
    rows: Vec<[f64; 2]>,
    ends: Vec<Vec<f64>>,
}

impl Rays {
    fn of(stock: &Stock) -> Self {
        let layout = stock.layout();
        let (n_rows, n_columns) = (layout.n_rows(), layout.n_columns());
        let row = |i: usize| {
            let is_end = i == 0 || i + 1 == n_rows;
            [layout.row_x(i), layout.resolution().along * if is_end { 0.5 } else { 1.0 }]
        };
        let end = |i: usize, j: usize| stock.end(i, j).unwrap();
        Self {
            rows: (0..n_rows).map(row).collect(),
            ends: (0..n_rows).map(|i| (0..n_columns).map(|j| end(i, j)).collect()).collect(),
        }
    }

    /// A wheel of radii `major` and `minor` with its centre at `x`, `far` from the axis, seen by the
    /// part at angle `a`.
    fn cut(&mut self, [major, minor]: [f64; 2], [x, far, a]: [f64; 3]) -> Cut {
        let mut cut = Cut::default();
        for ([row_x, weight], ends) in self.rows.iter().zip(&mut self.ends) {
            let nose2 = minor * minor - (row_x - x).powi(2);
            if nose2 < 0.0 {
                continue;
            }
            let radius = major + nose2.sqrt();
            let step = TAU / ends.len() as f64;
            let stood = ends.iter().any(|&end| end > 0.0);
            for (j, end) in ends.iter_mut().enumerate() {
                let turn = step * j as f64 - a;
                let aside = far * turn.sin();
                let half = (radius * radius - aside * aside).max(0.0).sqrt();
                let [entry, exit] = [far * turn.cos() - half, far * turn.cos() + half];
                let lower = entry.max(0.0);
                if radius <= aside.abs() || exit <= 0.0 || lower >= *end {
                    continue;
                }
                if *end > exit {
                    cut.n_overhangs += 1;
                    continue;
                }
                cut.removed += (*end * *end - lower * lower) / 2.0 * step * weight;
                cut.depth =
                    if *end - lower > 1e-4 { cut.depth.max(*end - lower) } else { cut.depth };
                *end = lower;
            }
            cut.is_through |= stood && ends.iter().all(|&end| end <= 0.0);
        }
        cut
    }

    /// A mill at `stance`: along each ray its inside is where a concave function is not negative.
    fn mill(&mut self, cutter: &Cutter, stance: &Stance) -> Cut {
        let Cutter::Mill(mill) = cutter else { unreachable!("a mill") };
        let (point, attack) = (stance.point, stance.attack);
        let mut cut = Cut::default();
        for ([row_x, weight], ends) in self.rows.iter().zip(&mut self.ends) {
            let step = TAU / ends.len() as f64;
            let stood = ends.iter().any(|&end| end > 0.0);
            for (j, end) in ends.iter_mut().enumerate() {
                let (sin, cos) = (step * j as f64).sin_cos();
                let inside = |s: f64| {
                    let seen = Point3::new(*row_x, s * cos, s * sin) - point;
                    let along = seen.y * attack.y + seen.z * attack.z;
                    let across = seen.z * attack.y - seen.y * attack.z;
                    mill.height(seen.x, across).map_or(-1e9 - across.abs(), |u| along + u)
                };
                // Up to the greatest value, then back to where it becomes negative.
                let [mut low, mut high, mut top] = [0.0, 200.0, 0.0];
                for _ in 0..100 {
                    let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
                    let to_the_right = inside(a) < inside(b);
                    let best = if to_the_right { b } else { a };
                    top = if inside(best) > inside(top) { best } else { top };
                    [low, high] = if to_the_right { [a, high] } else { [low, b] };
                }
                if inside(top) < 0.0 {
                    continue;
                }
                let edge = |mut outside: f64| {
                    let mut within = top;
                    for _ in 0..60 {
                        let middle = f64::midpoint(outside, within);
                        *if inside(middle) < 0.0 { &mut outside } else { &mut within } = middle;
                    }
                    within
                };
                let entry = if inside(0.0) >= 0.0 { 0.0 } else { edge(0.0) };
                let exit = if inside(200.0) >= 0.0 { f64::INFINITY } else { edge(200.0) };
                if entry >= *end || *end > exit {
                    continue;
                }
                cut.removed += (*end * *end - entry * entry) / 2.0 * step * weight;
                cut.depth =
                    if *end - entry > 1e-4 { cut.depth.max(*end - entry) } else { cut.depth };
                *end = entry;
            }
            cut.is_through |= stood && ends.iter().all(|&end| end <= 0.0);
        }
        cut
    }

    fn farthest_from(&self, stock: &Stock) -> f64 {
        let rows = self.ends.iter().enumerate();
        let all = rows.flat_map(|(i, row)| row.iter().enumerate().map(move |(j, end)| (i, j, end)));
        let off = |(i, j, end): (usize, usize, &f64)| (stock.end(i, j).unwrap_or(0.0) - end).abs();
        all.map(off).fold(0.0, f64::max)
    }
}
