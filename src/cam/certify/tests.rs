//! Closed forms, and dense sampling of random parts and moves.

use super::*;
use crate::cam::{Method, Part};
use crate::geom::{Aabb, PointCloud, TriMesh, shapes};
use crate::progress::Silent;
use crate::tool::Profile;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const WHEEL: Profile = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 };
const BALL: Profile = Profile::Ball { radius: 6.0 };

fn options(gouge: f64) -> CertifyOptions {
    let least_step = [0.005, 0.005_f64.to_radians()];
    CertifyOptions { gouge, grid: Grid([0.0; MAX_AXES]), least_step, thin: false }
}

/// A machine, a part and a tool, and what is asked of them.
struct Bench {
    machine: Machine,
    part: Part,
    cutter: Cutter,
}

impl Bench {
    fn new(machine: &str, mesh: &TriMesh, profile: Profile) -> Self {
        let machine = Machine::builtin(machine).unwrap();
        Self { machine, part: Part::triangles(mesh), cutter: profile.cutter(0.0) }
    }

    fn exact(&self, words: &[AxisValues]) -> Vec<Option<Contact>> {
        let digitizer =
            Digitizer { part: &self.part, cutter: self.cutter, method: Method::Indexed };
        let pose = |i: usize| self.machine.attack_from_part(&words[i]);
        digitizer.run(words.len(), pose, &Silent).unwrap()
    }

    /// The path through exact positions at `words`, certified.
    fn certified(&self, words: &[AxisValues], options: &CertifyOptions) -> Certified {
        let contacts = self.exact(words);
        let digitizer =
            Digitizer { part: &self.part, cutter: self.cutter, method: Method::Indexed };
        let attack = &self.machine.axes[self.machine.attack];
        let position = |i: usize| {
            let mut words = words[i];
            words[self.machine.attack] = attack.word(contacts[i].map_or(0.0, |c| c.height));
            (words, contacts[i])
        };
        let draft = Draft { machine: &self.machine, n_positions: words.len(), position };
        certify(&digitizer, &draft, options, &Silent).unwrap()
    }

    /// The deepest of `n` samples on each move of a path.
    fn deepest(&self, path: &[AxisValues], n: usize) -> f64 {
        let at = |i: usize| -> AxisValues {
            let (from, to, t) = (&path[i / n], &path[i / n + 1], (i % n) as f64 / n as f64);
            std::array::from_fn(|k| from[k] + (to[k] - from[k]) * t)
        };
        let words: Vec<_> = (0..(path.len() - 1) * n).map(at).collect();
        let attack = &self.machine.axes[self.machine.attack];
        let gouges = words.iter().zip(self.exact(&words)).filter_map(|(words, contact)| {
            Some(contact?.height - attack.motion(words[self.machine.attack]))
        });
        gouges.fold(0.0, f64::max)
    }

    /// Is the move from one exact position to the next proved to gouge no more?
    fn is_proved(&self, words: &[AxisValues; 2], gouge: f64) -> bool {
        let made = self.certified(words, &options(gouge));
        made.positions.len() == 2
    }
}

fn words_of(positions: &[Position]) -> Vec<AxisValues> {
    positions.iter().map(|position| position.words).collect()
}

/// On the last lathe: X and A.
fn lathe_words(x: f64, a_deg: f64) -> AxisValues {
    [x, 0.0, a_deg.to_radians(), 0.0, 0.0, 0.0]
}

/// A square bar along the spindle.
fn bar(half: f64) -> TriMesh {
    let corner = |x: f64, side: f64| Point3::new(x, side, side);
    shapes::cuboid(&Aabb { min: corner(0.0, -half), max: corner(60.0, half) })
}

/// Height of the wheel over the edge of a bar turned by `angle` from lying on top.
fn over_edge(edge: f64, angle: f64) -> f64 {
    edge * angle.cos() + (70.0_f64.powi(2) - (edge * angle.sin()).powi(2)).sqrt()
}

#[test]
fn over_the_edge_of_a_bar_the_bound_is_the_chord_error_of_a_circle() {
    let bench = Bench::new("last-lathe", &bar(20.0), WHEEL);
    let edge = 20.0 * 2.0_f64.sqrt();
    for step_deg in [1.0, 2.0, 5.0_f64] {
        // The edge on top in the middle of the move: A = 45 degrees either way.
        let at = |side: f64| lathe_words(30.0, 45.0 + side * step_deg / 2.0);
        let gouge = edge + 70.0 - over_edge(edge, (step_deg / 2.0).to_radians());
        let sampled = bench.deepest(
            &words_of(&bench.certified(&[at(-1.0), at(1.0)], &options(1.0)).positions),
            100,
        );
        assert!((sampled - gouge).abs() < 1e-6, "{sampled} is not {gouge}");
        assert!(bench.is_proved(&[at(-1.0), at(1.0)], 1.02 * gouge + 1e-6), "{step_deg}");
        assert!(!bench.is_proved(&[at(-1.0), at(1.0)], 0.98 * gouge), "{step_deg}");
    }
}

#[test]
fn a_ball_over_a_ridge_sinks_in_by_the_sagitta_of_its_own_radius() {
    // A roof along X, its ridge at z = 0 of the table; the ball steps across it.
    let points = [[-20.0, -10.0], [-20.0, 10.0], [20.0, -10.0], [20.0, 10.0]];
    let foot = |[x, y]: [f64; 2]| Point3::new(x, y, -20.0);
    let ridge = |x: f64| Point3::new(x, 0.0, 0.0);
    let mut corners: Vec<Point3> = points.into_iter().map(foot).collect();
    corners.extend([ridge(-20.0), ridge(20.0)]);
    let triangles = vec![[0, 2, 4], [2, 5, 4], [1, 4, 3], [3, 4, 5]];
    let bench = Bench::new("mill-3axis", &TriMesh::new(corners, triangles), BALL);
    for step in [0.2, 0.5, 1.0_f64] {
        let at = |y: f64| [0.0, y, 0.0, 0.0, 0.0, 0.0];
        let gouge = 6.0 - (36.0 - step * step / 4.0).sqrt();
        let words = [at(-step / 2.0), at(step / 2.0)];
        assert!(bench.is_proved(&words, 1.02 * gouge + 1e-6), "{step}");
        assert!(!bench.is_proved(&words, 0.98 * gouge), "{step}");
    }
}

#[test]
fn a_flat_end_that_climbs_a_ball_sinks_in_by_the_chord_of_what_its_rim_touches() {
    let ball = shapes::sphere(&Point3::new(0.0, 0.0, -20.0), 20.0, 120);
    let bench = Bench::new("mill-3axis", &ball, Profile::Flat { radius: 6.0 });
    let height = |out: f64| (400.0 - (out - 6.0).powi(2)).sqrt();
    for [from, to] in [[10.0, 12.0], [8.0, 11.0], [7.0, 10.0_f64]] {
        let words = [from, to].map(|y| [0.0, y, 0.0, 0.0, 0.0, 0.0]);
        // The heights' rate grows along the way: the chord is deepest near its middle.
        let gouge = height(f64::midpoint(from, to)) - f64::midpoint(height(from), height(to));
        // The ball's facets lie up to 0.002 mm inside it.
        assert!(bench.is_proved(&words, 1.02 * gouge + 0.004), "{gouge} from {from} to {to}");
        assert!(!bench.is_proved(&words, 0.98 * gouge - 0.004), "{gouge} from {from} to {to}");
    }
}

#[test]
fn a_round_bar_needs_no_step_however_coarse_the_move() {
    let bench = Bench::new("last-lathe", &shapes::prism(3_600, 30.0, 60.0), WHEEL);
    // Its 3,600 sides leave a gouge of a thousandth at most.
    for step_deg in [1.0, 5.0, 20.0] {
        let words: Vec<_> =
            (0..10).map(|i| lathe_words(30.0, 0.7 + step_deg * f64::from(i))).collect();
        let made = bench.certified(&words, &options(0.01));
        assert_eq!(made.certificate.n_inserted, 0, "{step_deg} degrees a step");
    }
}

fn soup(random: &mut Pcg64Mcg) -> TriMesh {
    let points = (0..300).map(|_| Point3::from([0; 3].map(|_| random.random_range(-30.0..30.0))));
    TriMesh::new(points.collect(), (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Random moves on every machine that has the room for them, over `mesh`.
fn random_moves(machine: &Machine, random: &mut Pcg64Mcg, size: f64, n: usize) -> Vec<AxisValues> {
    let mut words = vec![machine.at_rest()];
    for _ in 0..n {
        let mut next = words[words.len() - 1];
        for (i, axis) in machine.axes.iter().enumerate() {
            let turn = if axis.kind == AxisKind::Rotary { 0.05 } else { 1.0 };
            next[i] += size * turn * random.random_range(-1.0..1.0);
        }
        words.push(next);
    }
    words
}

#[test]
fn no_sample_of_any_move_lies_deeper_than_the_bound_on_any_machine_by_any_tool() {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let tools = [
        BALL,
        Profile::Flat { radius: 6.0 },
        Profile::Bull { radius: 6.0, corner_radius: 1.5 },
        Profile::Cone { radius: 6.0, half_angle: 0.5 },
        Profile::BallCone { radius: 6.0, tip_radius: 2.0, half_angle: 0.3 },
    ];
    let parts = [soup(&mut random), shapes::bumpy_cylinder(3_000)];
    let mut n_inserted = 0;
    for (name, tools) in
        [("last-lathe", &[WHEEL][..]), ("mill-rotary", &tools), ("mill-5axis", &tools)]
    {
        for (i, tool) in tools.iter().enumerate() {
            let bench = Bench::new(name, &parts[i % 2], *tool);
            for gouge in [0.02, 0.1] {
                let words = random_moves(&bench.machine, &mut random, 1.0, 10);
                let made = bench.certified(&words, &options(gouge));
                n_inserted += made.certificate.n_inserted;
                let deepest = bench.deepest(&words_of(&made.positions), 40);
                assert!(deepest <= gouge, "{deepest} with {tool:?} on {name}, not {gouge}");
                assert!(made.certificate.n_moves + 1 == made.positions.len());
            }
        }
    }
    assert!(n_inserted > 50, "only {n_inserted} steps: nothing was tried");
}

#[test]
fn no_sample_of_a_ball_on_long_moves_around_a_part_of_many_nodes_lies_deeper() {
    let bench = Bench::new("mill-rotary", &shapes::bumpy_cylinder(20_000), BALL);
    let [x, a] = ['X', 'A'].map(|letter| bench.machine.axis_index(letter).unwrap());
    for step_deg in [2.0, 5.0, 10.0_f64] {
        let at = |i: usize| {
            let mut words = bench.machine.at_rest();
            (words[x], words[a]) = (20.0 + 0.1 * i as f64, (step_deg * i as f64).to_radians());
            words
        };
        let words: Vec<_> = (0..60).map(at).collect();
        let made = bench.certified(&words, &options(0.01));
        let deepest = bench.deepest(&words_of(&made.positions), 40);
        assert!(deepest <= 0.01, "{deepest} at {step_deg} degrees a step");
        assert!(made.certificate.n_inserted > 0, "{step_deg} degrees a step");
    }
}

#[test]
fn of_small_steps_the_bound_is_at_most_twice_the_gouge() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let bench = Bench::new("last-lathe", &shapes::bumpy_cylinder(3_000), WHEEL);
    let mut n_gouging = 0;
    for _ in 0..60 {
        let (x, a) = (random.random_range(15.0..45.0), random.random_range(0.0..360.0));
        let words = [lathe_words(x, a), lathe_words(x + 0.01, a + 1.0)];
        let made = bench.certified(&words, &options(10.0));
        let deepest = bench.deepest(&words_of(&made.positions), 200);
        n_gouging += usize::from(1e-3 < deepest);
        assert!(bench.is_proved(&words, 2.0 * deepest + 1e-4), "{deepest} at {x}, {a}");
    }
    assert!(n_gouging > 5, "{n_gouging} moves gouge");
}

/// A table with a step of height 8 at X = 0, running along Y.
fn shoulder() -> TriMesh {
    let at = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
    let points = vec![
        at(-20.0, -20.0, 0.0),
        at(-20.0, 20.0, 0.0),
        at(0.0, -20.0, 0.0),
        at(0.0, 20.0, 0.0),
        at(0.0, -20.0, 8.0),
        at(0.0, 20.0, 8.0),
        at(20.0, -20.0, 8.0),
        at(20.0, 20.0, 8.0),
    ];
    let triangles = vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5], [4, 6, 5], [5, 6, 7]];
    TriMesh::new(points, triangles)
}

#[test]
fn over_a_shoulder_the_attack_axis_is_lifted_on_its_own() {
    let bench = Bench::new("mill-3axis", &shoulder(), Profile::Ball { radius: 3.0 });
    let words: Vec<_> = (0..12).map(|i| [-6.3 + f64::from(i), 0.4, 0.0, 0.0, 0.0, 0.0]).collect();
    let made = bench.certified(&words, &options(0.01));
    let path = words_of(&made.positions);
    let n_lifts = made.certificate.n_lifts;
    assert!((1..=3).contains(&n_lifts), "{:?}", made.certificate);
    let rise = made.certificate.greatest_lift.unwrap().rise;
    // The ball's centre climbs from level 0 to its side's height: 8 - 3; the bound may lie a little
    // above where the side has no slope.
    assert!((5.0 - 0.3..5.0 + 0.3).contains(&rise), "{rise}");
    let deepest = bench.deepest(&path, 200);
    assert!(deepest <= 0.01, "{deepest}");
    // Those lifts are moves of the attack axis alone.
    let climbs = path.windows(2).filter(|pair| pair[0][..2] == pair[1][..2]).count();
    assert!((n_lifts..=2 * n_lifts).contains(&climbs), "{climbs}");
    assert!(0.005 <= made.certificate.shortest_step.unwrap().mm);
}

#[test]
fn thinning_leaves_out_what_is_not_needed_and_nothing_else() {
    let bench = Bench::new("last-lathe", &bar(20.0), WHEEL);
    let words: Vec<_> =
        (0..361).map(|i| lathe_words(20.0 + 0.01 * f64::from(i), f64::from(i))).collect();
    let all = bench.certified(&words, &options(0.01));
    let thin = bench.certified(&words, &CertifyOptions { thin: true, ..options(0.01) });
    let certificate = &thin.certificate;
    assert!(3 * thin.positions.len() < 2 * all.positions.len(), "{}", thin.positions.len());
    assert_eq!(
        certificate.n_moves,
        360 + certificate.n_inserted - certificate.n_dropped + 2 * certificate.n_lifts
    );
    assert!(certificate.left_by_dropping <= 0.01, "{}", certificate.left_by_dropping);
    assert!(bench.deepest(&words_of(&thin.positions), 100) <= 0.01);
    let ends = [0, 360].map(|i| words[i][0]);
    assert_eq!([thin.positions[0].words[0], thin.positions.last().unwrap().words[0]], ends);
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let bench = Bench::new("last-lathe", &shapes::bumpy_cylinder(3_000), WHEEL);
    let words: Vec<_> =
        (0..500).map(|i| lathe_words(10.0 + 0.02 * f64::from(i), 3.0 * f64::from(i))).collect();
    let run = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| bench.certified(&words, &options(0.005)))
    };
    let one = run(1);
    assert!(one.certificate.n_inserted > 0);
    assert_eq!(one, run(3));
}

#[test]
fn points_are_certified_as_points() {
    let points = shapes::bumpy_cylinder(3_000).points;
    let cloud = PointCloud { points, ..PointCloud::default() };
    let machine = Machine::builtin("last-lathe").unwrap();
    let bench = Bench { machine, part: Part::points(&cloud), cutter: WHEEL.cutter(0.0) };
    let words: Vec<_> =
        (0..60).map(|i| lathe_words(20.0 + 0.02 * f64::from(i), 2.0 * f64::from(i))).collect();
    let made = bench.certified(&words, &options(0.01));
    assert!(bench.deepest(&words_of(&made.positions), 100) <= 0.01);
}
