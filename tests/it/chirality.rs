//! The sign of every rotary axis, proved on every machine that comes with horma.
//!
//! A part that is no mirror image of itself is cut. The words are taken from the program's text;
//! the part is turned and the tool placed by matrices written here, from what the machine files say
//! in words; and the tool is held against the part point by point. A tool of the right program
//! touches and never cuts in; with a sign turned round it cuts in deep.

use crate::jobs::{WHEEL, cut};
use horma::cam::{Centre, Strategy};
use horma::geom::{Aabb, TriMesh, shapes};
use horma::machine::Machine;
use horma::workflow::cam::{CamOptions, OffPart};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// x, y, z [mm].
type Point = [f64; 3];
/// The words in force, by their letters [mm and deg].
type Words = BTreeMap<char, f64>;

/// How far the tool may seem to stay off: the nearest sample lies up to 0.45 mm beside the contact,
/// where a nose of 5 mm has risen by 0.45^2 / 10 [mm].
const GAP: f64 = 0.02;
/// How far it may seem to cut in: half the last decimal of Y and of A at a radius of 30 mm [mm].
const CUT: f64 = 0.001;
/// A wrong sign cuts in deeper than this [mm].
const CLEARLY: f64 = 0.5;
/// Of the mills' ball [mm].
const BALL: f64 = 5.0;

/// The part as it is drawn, and points all over it 0.7 mm apart at most.
static PART: LazyLock<TriMesh> = LazyLock::new(|| shapes::chiral(6_000));
static SAMPLES: LazyLock<Vec<Point>> = LazyLock::new(|| {
    let mut samples = Vec::new();
    for [a, b, c] in (0..PART.triangles.len()).map(|i| PART.corners(i)) {
        let (to_b, to_c) = (b - a, c - a);
        let n = (to_b.norm().max(to_c.norm()).max((c - b).norm()) / 0.7).ceil();
        for i in 0..=n as u32 {
            for j in 0..=n as u32 - i {
                let p = a + to_b * (f64::from(i) / n) + to_c * (f64::from(j) / n);
                samples.push([p.x, p.y, p.z]);
            }
        }
    }
    samples
});

#[test]
fn every_machine_that_comes_with_horma_is_proved_here() {
    let mut names: Vec<_> = Machine::builtin_names().collect();
    names.sort_unstable();
    let proved = ["last-lathe", "last-lathe-cone", "last-lathe-pair"];
    assert_eq!(names, [&proved[..], &["mill-3axis", "mill-5axis", "mill-rotary"]].concat());
}

#[test]
fn a_last_lathe_turns_the_part_the_right_way() {
    let positions = lathe_positions("last-lathe");
    let turned = |sign: f64, part: Point, words: &Words| {
        wheel_gap(turned_about_x(laid_at(part, 25.0), -sign * words[&'A']), words)
    };
    proves(&positions, 'A', |part, words| turned(1.0, part, words));
    refutes(&positions, |part, words| turned(-1.0, part, words));
    refutes(&positions, |part, words| turned(1.0, mirrored(part), words));
}

#[test]
fn a_last_lathe_that_holds_the_cone_turns_the_part_the_right_way() {
    let top = SAMPLES.iter().copied().reduce(|a, b| if a[2] < b[2] { b } else { a }).unwrap();
    // Near the post, on what lies highest, the wheel touches that.
    let positions: Vec<Words> = lathe_positions("last-lathe-cone")
        .into_iter()
        .filter(|words| (words[&'X'] - 20.0 - top[0]).abs() > 30.0)
        .collect();
    let turned = |sign: f64, part: Point, words: &Words| {
        wheel_gap(turned_about_x(laid_at(part, 20.0), -sign * words[&'A']), words)
    };
    proves(&positions, 'A', |part, words| turned(1.0, part, words));
    refutes(&positions, |part, words| turned(-1.0, part, words));
}

#[test]
fn the_second_spindle_of_a_pair_cuts_the_mirror_image() {
    let positions = lathe_positions("last-lathe-pair");
    let turned = |letter: char, part: Point, words: &Words| {
        wheel_gap(turned_about_x(laid_at(part, 25.0), -words[&letter]), words)
    };
    // Seen along the spindle from the tool, left and right are those of Z.
    let image = |[x, y, z]: Point| [x, y, -z];
    proves(&positions, 'A', |part, words| turned('A', part, words));
    proves(&positions, 'B', |part, words| turned('B', image(part), words));
    refutes(&positions, |part, words| turned('B', part, words));
    refutes(&positions, |part, words| turned('A', image(part), words));
    assert!(positions.iter().all(|words| words[&'A'] == -words[&'B']));
}

#[test]
fn a_mill_with_a_rotary_table_turns_the_part_the_right_way() {
    let options = CamOptions { tool: Some(format!("ball:{BALL}")), ..around() };
    let positions = amid(&positions("mill-rotary", &options), 30.0);
    let turned = |sign: f64, part: Point, words: &Words| {
        let [x, y, z] = turned_about_x(laid_at(part, 30.0), -sign * words[&'A']);
        // The table goes the other way than its words say; the head moves in Z alone.
        ball_gap([x - words[&'X'], y - words[&'Y'], z - words[&'Z']])
    };
    proves(&positions, 'A', |part, words| turned(1.0, part, words));
    refutes(&positions, |part, words| turned(-1.0, part, words));
    refutes(&positions, |part, words| turned(1.0, mirrored(part), words));
}

#[test]
fn a_portal_mill_cuts_the_part_and_not_its_mirror_image() {
    let positions = touching(&positions("mill-3axis", &over()));
    let placed = |part: Point, words: &Words| ball_gap(off(part, words));
    proves(&positions, 'Y', |part, words| placed(on_table(part), words));
    refutes(&positions, |part, words| placed(mirrored(on_table(part)), words));
}

#[test]
fn a_trunnion_tilts_and_turns_the_part_the_right_way() {
    let options = CamOptions { hold: vec!["A=30".into(), "C=-50".into()], ..over() };
    let positions = touching(&positions("mill-5axis", &options));
    assert!(positions.iter().all(|words| words[&'A'] == 30.0 && words[&'C'] == -50.0));
    let turned = |signs: [f64; 2], stands: Point, words: &Words| {
        let [x, y, z] = turned_about_z(stands, -signs[1] * words[&'C']);
        // The cradle's centre line lies 60 mm above the table.
        let [x, y, z] = turned_about_x([x, y, z - 60.0], -signs[0] * words[&'A']);
        ball_gap(off([x, y, z + 60.0], words))
    };
    proves(&positions, 'Y', |part, words| turned([1.0, 1.0], on_table(part), words));
    for signs in [[-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]] {
        refutes(&positions, |part, words| turned(signs, on_table(part), words));
    }
    refutes(&positions, |part, words| turned([1.0, 1.0], mirrored(on_table(part)), words));
}

/// The tool touches at every position, cuts in at none, and `letter` really moves.
#[track_caller]
fn proves(positions: &[Words], letter: char, gap: impl Fn(Point, &Words) -> f64) {
    let words: Vec<f64> = positions.iter().map(|words| words[&letter]).collect();
    assert!(words.len() >= 30, "only {} positions", words.len());
    let least = words.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(words.iter().any(|word| *word > least + 10.0), "{letter} hardly moves");
    for words in positions.iter().step_by(positions.len().div_ceil(60)) {
        let nearest = nearest(words, &gap);
        assert!(-CUT < nearest, "it cuts in by {} at {words:?}", -nearest);
        assert!(nearest < GAP, "it stays off by {nearest} at {words:?}");
    }
}

/// The tool cuts in deep somewhere.
#[track_caller]
fn refutes(positions: &[Words], gap: impl Fn(Point, &Words) -> f64) {
    let is_deep = |words: &Words| nearest(words, &gap) < -CLEARLY;
    assert!(positions.iter().any(is_deep), "a wrong sign goes unseen");
}

fn nearest(words: &Words, gap: impl Fn(Point, &Words) -> f64) -> f64 {
    SAMPLES.iter().map(|&part| gap(part, words)).fold(f64::INFINITY, f64::min)
}

/// A helix of few positions about the part's own X.
fn around() -> CamOptions {
    CamOptions {
        // The tool touches at every position: as digitized, without a lift.
        no_certify: true,
        strategy: Some(Strategy::Helix),
        axis: Some("x".into()),
        centre: Some(Centre::Origin),
        pitch: Some(11.0),
        points_per_turn: Some(17),
        ..Default::default()
    }
}

/// A raster of few positions over the part as it stands.
fn over() -> CamOptions {
    CamOptions {
        // The tool touches at every position: as digitized, without a lift.
        no_certify: true,
        tool: Some(format!("ball:{BALL}")),
        strategy: Some(Strategy::Raster),
        centre: Some(Centre::Box),
        pitch: Some(6.0),
        step: Some(7.0),
        off_part: Some(OffPart::Clear),
        ..Default::default()
    }
}

fn lathe_positions(machine: &str) -> Vec<Words> {
    let options = CamOptions { tool: Some(WHEEL.into()), ..around() };
    let heel = if machine == "last-lathe-cone" { 20.0 } else { 25.0 };
    amid(&positions(machine, &options), heel)
}

/// Where the program cuts the part's middle, 25 mm and more from the stubs, its heel at X `heel`.
fn amid(positions: &[Words], heel: f64) -> Vec<Words> {
    let amid = positions.iter().filter(|words| (words[&'X'] - heel - 60.0).abs() < 35.0);
    amid.cloned().collect()
}

/// Where the program is not clear of the part.
fn touching(positions: &[Words]) -> Vec<Words> {
    let clear = positions.iter().map(|words| words[&'Z']).fold(0.0, f64::max);
    positions.iter().filter(|words| words[&'Z'] < clear).cloned().collect()
}

/// Where the feed moves of the program of the part end, by the program's text alone.
fn positions(machine: &str, options: &CamOptions) -> Vec<Words> {
    let text = String::from_utf8(cut(&PART, machine, options).text).unwrap();
    let (mut words, mut positions) = (Words::new(), Vec::new());
    for line in text.lines().filter(|line| !line.starts_with('(')) {
        for word in line.split(' ') {
            let (letter, number) = word.split_at(1);
            words.insert(letter.chars().next().unwrap(), number.parse().unwrap());
        }
        if words.get(&'G') == Some(&1.0) && line.contains(['X', 'Y', 'Z', 'A']) {
            positions.push(words.clone());
        }
    }
    positions
}

/// On a spindle: as drawn, but for X.
fn laid_at([x, y, z]: Point, heel: f64) -> Point {
    [x + heel, y, z]
}

/// On a table: its box centred on it.
fn on_table([x, y, z]: Point) -> Point {
    static BOX: LazyLock<Aabb> = LazyLock::new(|| PART.aabb());
    let middle = BOX.center();
    [x - middle.x, y - middle.y, z - BOX.min.z]
}

/// Mirrored in the plane of X and Z.
fn mirrored([x, y, z]: Point) -> Point {
    [x, -y, z]
}

/// By the right hand, about X.
fn turned_about_x([x, y, z]: Point, angle_deg: f64) -> Point {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    [x, y * cos - z * sin, y * sin + z * cos]
}

/// By the right hand, about Z.
fn turned_about_z([x, y, z]: Point, angle_deg: f64) -> Point {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    [x * cos - y * sin, x * sin + y * cos, z]
}

/// Seen from a tool that goes where X, Y and Z say.
fn off([x, y, z]: Point, words: &Words) -> Point {
    [x - words[&'X'], y - words[&'Y'], z - words[&'Z']]
}

/// From a wheel of R60 r10 about X, its centre at X and Y, to a point; negative inside.
fn wheel_gap([x, y, z]: Point, words: &Words) -> f64 {
    let from_axis = (y - words[&'Y']).hypot(z);
    (from_axis - 60.0).max(0.0).hypot(x - words[&'X']) - 10.0
}

/// From a ball mill, its tip at the origin and its shank upwards, to a point; negative inside.
fn ball_gap([x, y, z]: Point) -> f64 {
    x.hypot(y).hypot((z - BALL).min(0.0)) - BALL
}
