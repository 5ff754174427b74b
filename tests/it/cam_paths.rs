//! The paths of whole jobs against closed forms and against each other.

use crate::jobs::{WHEEL, cut, feed_words, small_last, try_cut};
use horma::cam::{Centre, Method, Strategy};
use horma::geom::{Point3, PointCloud, Surface, TriMesh, shapes};
use horma::machine::Machine;
use horma::workflow::cam::{CamOptions, Mode, OffPart, Plan};

const LATHE: &str = "last-lathe";
/// Half the last decimal of a word, and the noise of its binary form [mm or deg].
const HALF_A_DECIMAL: f64 = 0.5e-4 + 1e-9;
/// The heel of a part on the last lathe [mm].
const HEEL: f64 = 25.0;
const R_CYL: f64 = 30.0;
/// R + r of the wheel [mm].
const WHEEL_TOP: f64 = 70.0;
/// r of the wheel [mm].
const NOSE: f64 = 10.0;

#[test]
fn the_last_lathe_is_the_one_these_numbers_are_for() {
    let machine = Machine::builtin(LATHE).unwrap();
    assert_eq!([0, 1, 2].map(|i| machine.axes[i].letter), ['X', 'Y', 'A']);
}

#[test]
fn a_helix_around_a_cylinder_keeps_its_distance() {
    let options = CamOptions { points_per_turn: Some(90), pitch: Some(5.0), ..lathe() };
    let plan = cut(&cylinder(90, 60.0), LATHE, &options);
    let words = feed_words(&plan, LATHE);
    let between = words.iter().filter(|words| HEEL < words[0] && words[0] < HEEL + 60.0);
    assert!(between.clone().count() > 11 * 90);
    for &[x, y, ..] in between {
        assert!((y - R_CYL - WHEEL_TOP).abs() < HALF_A_DECIMAL, "Y {y} at X {x}");
    }
    // Beyond the end it follows the edge, round its nose.
    let past = words.iter().filter(|words| words[0] < HEEL && HEEL - words[0] < 0.99 * NOSE);
    assert!(past.clone().count() > 90);
    for &[x, y, ..] in past {
        let expected = R_CYL + 60.0 + (NOSE * NOSE - (HEEL - x).powi(2)).sqrt();
        // Near the nose's side it is steep: half a decimal of X counts seven times.
        assert!((y - expected).abs() < 2e-3, "Y {y} at X {x}, not {expected}");
    }
}

#[test]
fn an_allowance_stays_on_to_the_last_decimal() {
    let options = CamOptions { points_per_turn: Some(90), pitch: Some(10.0), ..lathe() };
    for allowance in [0.0, 0.7, 4.0] {
        let options = CamOptions { allowance: Some(allowance), ..options.clone() };
        let words = feed_words(&cut(&cylinder(90, 60.0), LATHE, &options), LATHE);
        let mut between = words.iter().filter(|words| (words[0] - HEEL - 30.0).abs() < 29.0);
        let expected = R_CYL + WHEEL_TOP + allowance;
        assert!(between.clone().count() > 5 * 90);
        assert!(between.all(|words| (words[1] - expected).abs() < HALF_A_DECIMAL), "{allowance}");
    }
}

#[test]
fn the_other_foot_runs_along_the_mirrored_path() {
    let per_turn = 72;
    let options = CamOptions {
        strategy: Some(Strategy::Rings),
        points_per_turn: Some(per_turn as u32),
        pitch: Some(8.0),
        // Not where the nose only just meets the end's edge, or by rounding does not.
        overrun: Some(9.0),
        ..lathe()
    };
    let part = shapes::chiral(3_000);
    let plain = feed_words(&cut(&part, LATHE, &options), LATHE);
    let mirrored = CamOptions { mirror: true, ..options.clone() };
    let flagged = feed_words(&cut(&part, LATHE, &mirrored), LATHE);
    let by_hand = feed_words(&cut(&seen_in_a_mirror(&part), LATHE, &options), LATHE);
    assert_eq!(flagged, by_hand);
    // Mirrored in the plane of X and Z, the part shows at -A + 180 degrees what it showed at A.
    let rows = plain.chunks_exact(per_turn + 1).zip(flagged.chunks_exact(per_turn + 1));
    assert!(rows.len() > 12);
    let mut differs: f64 = 0.0;
    for (plain, mirrored) in rows {
        for (i, words) in mirrored.iter().enumerate() {
            let image = &plain[(per_turn + per_turn / 2 - i) % per_turn];
            assert!((words[1] - image[1]).abs() < 1.5e-4, "{words:?} is no image of {image:?}");
            differs = differs.max((words[1] - plain[i][1]).abs());
        }
    }
    assert!(differs > 2.0, "the part is its own mirror image");
}

#[test]
fn a_scallop_height_on_a_cylinder_gives_its_pitch() {
    let height = 0.02;
    let pitch = pitch_amid(&cylinder(90, 120.0), height);
    let ridge = NOSE - (NOSE * NOSE - pitch * pitch / 4.0).sqrt();
    assert!((ridge - height).abs() < 0.02 * height, "{ridge} mm");
}

#[test]
fn a_slope_of_sixty_degrees_halves_the_pitch() {
    let height = 0.02;
    // A cone of radius 15 to 15 + 30 tan 60.
    let mut cone = cylinder(90, 30.0);
    for point in &mut cone.points {
        let radius = 15.0 + point.x * 3_f64.sqrt();
        (point.y, point.z) = (point.y * radius / R_CYL, point.z * radius / R_CYL);
    }
    let level = (8.0 * height * NOSE).sqrt();
    let pitch = pitch_amid(&cone, height);
    assert!((pitch - level / 2.0).abs() < 0.01 * level, "{pitch} on a slope, {level} on the level");
}

#[test]
fn a_precision_sets_all_spacings() {
    let options = CamOptions { points_per_mm: Some(1.5), overrun: Some(0.0), ..lathe() };
    let run = cut(&cylinder(90, 60.0), LATHE, &options).report.run;
    let around = std::f64::consts::TAU * R_CYL * 1.5;
    assert!((f64::from(run.per_turn) - around).abs() < 0.01 * around + 1.0, "{}", run.per_turn);
    assert!((run.pitch[1] - 1.0 / 1.5).abs() < 0.02, "{:?}", run.pitch);
    let options = CamOptions {
        strategy: Some(Strategy::Lines),
        points_per_mm: None,
        points_per_turn: Some(4),
        step: Some(0.8),
        ..options
    };
    let words = feed_words(&cut(&cylinder(90, 60.0), LATHE, &options), LATHE);
    let steps: Vec<f64> = words.windows(2).map(|pair| (pair[1][0] - pair[0][0]).abs()).collect();
    // A turn between two lines moves nothing along them.
    let along: Vec<&f64> = steps.iter().filter(|step| 0.0 < **step).collect();
    assert_eq!(along.len(), 4 * 75);
    assert!(along.iter().all(|step| (**step - 0.8).abs() < 2e-4), "{along:?}");
}

#[test]
fn positions_beside_the_part_follow_the_rule_that_was_given() {
    let ball = shapes::sphere(&Point3::new(0.0, 0.0, 0.0), 20.0, 16);
    let raster = |rule| CamOptions {
        tool: Some("ball:5".into()),
        pitch: Some(5.0),
        step: Some(5.0),
        off_part: Some(rule),
        ..Default::default()
    };
    let [clear, held] = [OffPart::Clear, OffPart::Hold].map(|rule| {
        let plan = cut(&ball, "mill-3axis", &raster(rule));
        assert!(plan.report.run.n_missed > 20, "{}", plan.report.run.n_missed);
        plan
    });
    let n_missed = clear.report.run.n_missed;
    let words = feed_words(&clear, "mill-3axis");
    // The clearance of the mill above the part that stands on its table.
    let top = ball.aabb().size().z;
    let n_clear = words.iter().filter(|words| (words[2] - top - 10.0).abs() < 1e-4).count();
    // Moves from one such position to the next along a row have blocks of their own.
    assert!(n_clear + 2 >= n_missed, "{n_clear} of {n_missed}");

    let words = feed_words(&held, "mill-3axis");
    assert!(words.iter().all(|words| words[2] <= top + HALF_A_DECIMAL));
    let repeats = words.windows(2).filter(|pair| pair[0][2] == pair[1][2]).count();
    assert!(repeats + 8 >= n_missed, "{repeats} of {n_missed}");
}

#[test]
fn a_path_that_begins_beside_the_part_is_no_bug_of_ours() {
    // The plunge onto a first position that is clear of the part is no move at all.
    let ball = shapes::sphere(&Point3::origin(), 20.0, 8);
    let options = CamOptions {
        tool: Some("ball:5".into()),
        pitch: Some(9.0),
        off_part: Some(OffPart::Clear),
        ..Default::default()
    };
    let first = feed_words(&cut(&ball, "mill-3axis", &options), "mill-3axis")[0];
    assert!((first[2] - ball.aabb().size().z - 10.0).abs() < 1e-4, "{first:?}");
}

#[test]
fn an_allowance_makes_the_wheel_no_wider_beside_the_dogs() {
    // Room for the wheel's 10 mm twice and 4 mm more; not for 14 mm twice.
    let options = CamOptions { points_per_turn: Some(24), pitch: Some(20.0), ..lathe() };
    let options = CamOptions { allowance: Some(4.0), ..options };
    let run = cut(&cylinder(24, 60.0), LATHE, &options).report.run;
    // A hair less than the 14 mm at which rounding would decide what the nose's side touches.
    assert!((HEEL - run.along[0] - 0.99 * 14.0).abs() < 1e-9, "{:?}", run.along);
    // With 16 mm of nose only the 15 mm that the dogs leave are run over, and the report says so.
    let report = cut(&cylinder(24, 60.0), LATHE, &CamOptions { allowance: Some(6.0), ..options });
    assert_eq!(report.report.run.along[0], HEEL - 15.0);
    let told = report.report.warnings.join("\n");
    assert!(told.contains("only 15.0 mm beyond the part's ends, where 16.0 mm would"), "{told}");
}

#[test]
fn neither_threads_nor_the_method_change_a_byte() {
    let part = small_last(200.0);
    let options = CamOptions { points_per_turn: Some(45), pitch: Some(12.0), ..lathe() };
    let text = |n_threads: usize, method: Method| {
        let options = CamOptions { method: Some(method), ..options.clone() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let text = String::from_utf8(pool.install(|| cut(&part, LATHE, &options)).text).unwrap();
        // The header quotes the options; the method is one of them.
        text.lines().filter(|line| !line.starts_with("(options")).collect::<Vec<_>>().join("\n")
    };
    let expected = text(1, Method::Indexed);
    assert!(expected.lines().count() > 800);
    for n_threads in [2, 5] {
        assert!(text(n_threads, Method::Indexed) == expected, "{n_threads} threads");
    }
    assert!(text(2, Method::Exhaustive) == expected, "exhaustive");
}

#[test]
fn every_strategy_runs_the_way_it_is_called() {
    let cylinder = cylinder(90, 60.0);
    let run = |strategy| {
        let options = CamOptions {
            strategy: Some(strategy),
            points_per_turn: Some(12),
            pitch: Some(20.0),
            step: Some(5.0),
            overrun: Some(10.0),
            ..lathe()
        };
        feed_words(&cut(&cylinder, LATHE, &options), LATHE)
    };
    let rings = run(Strategy::Rings);
    for ring in rings.chunks(13) {
        assert!(ring.iter().all(|words| words[0] == ring[0][0]), "a ring stands");
        assert!((ring[12][2] - ring[0][2] + 360.0).abs() < 1e-9, "a ring closes");
    }
    assert_eq!(rings.len(), 5 * 13);
    let lines = run(Strategy::Lines);
    for (i, line) in lines.chunks(17).enumerate() {
        let turned = -30.0 * i as f64;
        assert!(line.iter().all(|words| (words[2] - turned).abs() < 1e-9), "a line stands");
        let way = line[16][0] - line[0][0];
        assert_eq!(way, if i % 2 == 0 { 80.0 } else { -80.0 }, "back and forth");
    }
    assert_eq!(lines.len(), 12 * 17);
    let helix = run(Strategy::Helix);
    assert!(helix.windows(2).all(|pair| pair[0][0] <= pair[1][0] && pair[1][2] < pair[0][2]));
    assert_eq!(helix.len(), 6 * 12 + 1);
}

#[test]
fn a_raster_runs_along_x_and_steps_across() {
    let options =
        CamOptions { pitch: Some(10.0), step: Some(4.0), no_certify: true, ..Default::default() };
    let plan = cut(&shapes::chiral(2_000), "mill-3axis", &options);
    let words = feed_words(&plan, "mill-3axis");
    for pair in words.windows(2) {
        let [dx, dy] = [0, 1].map(|axis| (pair[1][axis] - pair[0][axis]).abs());
        assert!(dx == 0.0 || dy == 0.0, "{pair:?}");
        assert!(dx < 4.0 + 2e-4 && dy < 10.0 + 2e-4, "{pair:?}");
    }
}

#[test]
fn the_mode_of_the_thesis_is_labelled_wherever_it_is_told() {
    let part = shapes::chiral(3_000);
    let options = CamOptions { points_per_turn: Some(36), pitch: Some(10.0), ..lathe() };
    let asked = CamOptions { mode: Some(Mode::Points), ..options.clone() };
    let cloud = PointCloud { points: part.points.clone(), ..PointCloud::default() };
    for (surface, options) in [
        (Surface::Mesh(part.clone()), &asked),
        (Surface::Points(cloud.clone()), &asked),
        (Surface::Points(cloud), &options),
    ] {
        let plan = try_cut(surface, LATHE, options).unwrap();
        assert_eq!(plan.report.part.mode, "points");
        assert_eq!(plan.report.part.n_primitives, part.points.len());
        assert!(plan.report.reach.is_none());
        assert!(is_labelled(&plan), "{:?}", plan.report.warnings);
    }
    let exact = cut(&part, LATHE, &options);
    assert_eq!(exact.report.part.mode, "triangles");
    assert!(!is_labelled(&exact));
}

/// Both the warnings and the program's header say that only points were digitized.
fn is_labelled(plan: &Plan) -> bool {
    let label = "on points alone, as in the thesis";
    let header = plan.text.split(|byte| *byte == b'\n').take_while(|line| line.starts_with(b"("));
    let says = |line: &[u8]| String::from_utf8_lossy(line).contains(label);
    let told = [
        plan.report.warnings.iter().any(|line| line.contains(label)),
        header.into_iter().any(says),
    ];
    assert_eq!(told[0], told[1], "warnings and header agree");
    told[0]
}

/// The pitch of rings at the middle of `part`, for ridges of `height`.
fn pitch_amid(part: &TriMesh, height: f64) -> f64 {
    let options = CamOptions {
        strategy: Some(Strategy::Rings),
        points_per_turn: Some(4),
        scallop: Some(height),
        overrun: Some(0.0),
        ..lathe()
    };
    let mut stations: Vec<f64> =
        feed_words(&cut(part, LATHE, &options), LATHE).iter().map(|words| words[0]).collect();
    stations.dedup();
    let middle = stations.len() / 2;
    (stations[middle + 4] - stations[middle - 4]) / 8.0
}

fn seen_in_a_mirror(part: &TriMesh) -> TriMesh {
    let points = part.points.iter().map(|p| Point3::new(p.x, -p.y, p.z)).collect();
    TriMesh::new(points, part.triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect())
}

/// About X, its edges at the angles of as many positions a turn.
fn cylinder(n_sides: usize, length: f64) -> TriMesh {
    shapes::prism(n_sides, R_CYL, length)
}

/// The usual wheel, the part as it lies.
fn lathe() -> CamOptions {
    CamOptions {
        // Positions are held one by one against closed forms.
        no_certify: true,
        tool: Some(WHEEL.into()),
        axis: Some("x".into()),
        centre: Some(Centre::Origin),
        ..Default::default()
    }
}
