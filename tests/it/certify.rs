//! What is proved of a path between its positions, on a real foot and on a last.

use crate::jobs::{WHEEL, cut, feed_words, small_last, try_cut};
use crate::parts::{mesh, real};
use horma::cam::{
    Certified, CertifyOptions, Digitizer, Draft, Grid, Method, Part, Position, SetupOptions,
    Spacing, Strategy, Trajectory, certify, set_up,
};
use horma::geom::{LengthUnit, Surface, TriMesh, shapes};
use horma::io::read_surface;
use horma::machine::{AxisValues, Machine};
use horma::progress::Silent;
use horma::tool::ToolLibrary;
use horma::workflow::cam::CamOptions;
use std::ops::Range;

const LATHE: &str = "last-lathe";
/// What the certificates here allow [mm].
const TOLERANCE: f64 = 0.01;
/// A least step finer than any needed: what is compared is not where steps end.
const LEAST_STEP: f64 = 0.005;

/// A helix over a part on the last lathe.
struct Helix {
    machine: Machine,
    part: Part,
    words: Vec<AxisValues>,
}

impl Helix {
    /// `degrees` a step over a `share` of the way from heel to toe.
    fn around(mesh: TriMesh, degrees: u32, share: Range<f64>) -> Self {
        let machine = Machine::builtin(LATHE).unwrap();
        let setup = set_up(Surface::Mesh(mesh), &machine, &SetupOptions::default()).unwrap();
        let Surface::Mesh(mesh) = &setup.surface else { panic!("the part has no triangles") };
        let part = Part::triangles(mesh);
        let along = [setup.part.min.x - 9.9, setup.part.max.x + 9.9];
        let stations = Spacing::even(along[0], along[1], 2.0).unwrap();
        let spacing = Spacing { per_turn: 360 / degrees, step: 1.0, stations };
        let way =
            Trajectory::new(&machine, Strategy::Helix, along, spacing, &machine.at_rest()).unwrap();
        let n = way.n_positions() as f64;
        let [from, to] = [share.start, share.end].map(|share| (share * n) as usize);
        Self { part, words: (from..to).map(|i| way.values(i)).collect(), machine }
    }

    fn digitizer(&self) -> Digitizer<'_> {
        let tool = ToolLibrary::builtin().find(WHEEL).unwrap();
        let cutter = tool.profile.cutter(0.0);
        Digitizer { part: &self.part, cutter, method: Method::Indexed }
    }

    /// The height of the part under each of `words`, which it meets everywhere.
    fn heights(&self, words: &[AxisValues]) -> Vec<f64> {
        let pose = |i: usize| self.machine.attack_from_part(&words[i]);
        let contacts = self.digitizer().run(words.len(), pose, &Silent).unwrap();
        contacts.into_iter().map(|contact| contact.unwrap().height).collect()
    }

    /// `words` with their attack words.
    fn on_part(&self, words: &[AxisValues]) -> Vec<AxisValues> {
        let attack = self.machine.attack;
        let heights = self.heights(words);
        let mut words = words.to_vec();
        for (words, height) in words.iter_mut().zip(heights) {
            words[attack] = self.machine.axes[attack].word(height);
        }
        words
    }

    fn certified(&self) -> Certified {
        let pose = |i: usize| self.machine.attack_from_part(&self.words[i]);
        let contacts = self.digitizer().run(self.words.len(), pose, &Silent).unwrap();
        let words = self.on_part(&self.words);
        let draft = Draft {
            machine: &self.machine,
            n_positions: words.len(),
            position: |i: usize| (words[i], contacts[i]),
        };
        let options = CertifyOptions {
            gouge: TOLERANCE,
            grid: Grid::new(&self.machine, 0.0, 0.0),
            least_step: [LEAST_STEP, LEAST_STEP.to_radians()],
            thin: false,
        };
        certify(&self.digitizer(), &draft, &options, &Silent).unwrap()
    }

    /// The deepest of `n` samples inside each move of `path`.
    fn gouges(&self, path: &[[AxisValues; 2]], n: usize) -> Vec<f64> {
        let attack = self.machine.attack;
        let samples: Vec<AxisValues> = path
            .iter()
            .flat_map(|[from, to]| {
                (1..=n).map(move |k| {
                    let t = k as f64 / (n + 1) as f64;
                    std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * t)
                })
            })
            .collect();
        let heights = self.heights(&samples);
        let gouges: Vec<f64> = samples
            .iter()
            .zip(heights)
            .map(|(words, height)| height - self.machine.axes[attack].motion(words[attack]))
            .collect();
        gouges.chunks(n).map(|gouges| gouges.iter().copied().fold(0.0, f64::max)).collect()
    }

    /// Positions when moves are halved as long as one of 20 samples gouges more than allowed.
    fn n_by_halving(&self) -> usize {
        let words = self.on_part(&self.words);
        let mut moves: Vec<_> = words.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        let mut n = moves.len() + 1;
        while !moves.is_empty() {
            let gouges = self.gouges(&moves, 20);
            let deep = moves.iter().zip(&gouges).filter(|(_, gouge)| TOLERANCE < **gouge);
            let deep: Vec<_> = deep.map(|(ends, _)| *ends).collect();
            let middles: Vec<AxisValues> = deep
                .iter()
                .map(|[from, to]| std::array::from_fn(|axis| f64::midpoint(from[axis], to[axis])))
                .collect();
            let middles = self.on_part(&middles);
            n += middles.len();
            let halves = deep.iter().zip(&middles);
            moves = halves.flat_map(|([from, to], m)| [[*from, *m], [*m, *to]]).collect();
            let least = LEAST_STEP.to_radians();
            moves.retain(|[from, to]| 2.0 * least < (to[2] - from[2]).abs());
        }
        n
    }
}

/// Certifies a `share` of the path at 1, 2 and 5 degrees a step; samples every `stride`-th move.
fn is_as_deep_as_proved(mesh: &TriMesh, share: &Range<f64>, stride: usize) {
    for degrees in [1, 2, 5] {
        let helix = Helix::around(mesh.clone(), degrees, share.clone());
        let made = helix.certified();
        let ends = |pair: &[Position]| [pair[0].words, pair[1].words];
        let moves: Vec<_> = made.positions.windows(2).map(ends).step_by(stride).collect();
        let deepest = helix.gouges(&moves, 100).into_iter().fold(0.0, f64::max);
        assert!(deepest <= TOLERANCE, "{deepest} mm at {degrees} degrees a step");
        let (given, plain, n) = (helix.words.len(), helix.n_by_halving(), made.positions.len());
        eprintln!(
            "{degrees} degrees: of {given} positions {n}, plain halving {plain}; {} lifts; \
             {deepest:.6} mm at most",
            made.certificate.n_lifts
        );
        assert!(10 * n <= 13 * plain, "{n} positions, {plain} by plain halving, {degrees} degrees");
    }
}

/// The heel, where the wheel stands on its side, and the instep.
const SOME: [Range<f64>; 2] = [0.0..0.06, 0.5..0.54];
const ALL: Range<f64> = 0.0..1.0;

fn foot() -> Option<TriMesh> {
    let path = real("lasts/find_foot/foot_mean_left.obj")?;
    Some(mesh(read_surface(&path, Some(LengthUnit::Millimetre)).unwrap()))
}

#[test]
fn no_move_around_a_foot_is_deeper_than_proved_and_few_have_needless_steps() {
    let Some(foot) = foot() else { return };
    for share in &SOME {
        is_as_deep_as_proved(&foot, share, 11);
    }
}

#[test]
fn no_move_around_a_last_is_deeper_than_proved_and_few_have_needless_steps() {
    let last = small_last(240.0);
    for share in &SOME {
        is_as_deep_as_proved(&last, share, 11);
    }
}

#[test]
#[ignore = "minutes: every move of the whole path, a hundred samples each"]
fn no_move_of_the_whole_path_is_deeper_than_proved() {
    is_as_deep_as_proved(&small_last(240.0), &ALL, 1);
    let Some(foot) = foot() else { return };
    is_as_deep_as_proved(&foot, &ALL, 1);
}

#[test]
fn the_certificate_holds_for_the_words_of_the_program() {
    let last = small_last(200.0);
    let options = CamOptions {
        tool: Some(WHEEL.into()),
        points_per_turn: Some(72),
        pitch: Some(10.0),
        thin: true,
        ..Default::default()
    };
    let plan = cut(&last, LATHE, &options);
    let certificate = plan.report.certificate.as_ref().unwrap();
    assert!(certificate.n_inserted > 0, "{certificate:?}");
    let words: Vec<AxisValues> = feed_words(&plan, LATHE)
        .into_iter()
        .map(|mut words| {
            words[2] = words[2].to_radians();
            words
        })
        .collect();
    assert_eq!(words.len(), certificate.n_moves + 1);
    let helix = Helix::around(last, 5, 0.0..0.0);
    let moves: Vec<_> = words.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let deepest = helix.gouges(&moves, 20).into_iter().fold(0.0, f64::max);
    assert!(deepest <= certificate.gouge, "{deepest} above {}", certificate.gouge);
    // Not by wide margins: it was asked for no more.
    assert!(0.3 * certificate.gouge < deepest, "{deepest} of {}", certificate.gouge);
}

#[test]
fn a_bound_finer_than_the_words_is_refused() {
    let part = Surface::Mesh(small_last(200.0));
    let options = CamOptions { tolerance: Some(0.000_04), ..Default::default() };
    let error = try_cut(part, LATHE, &options).unwrap_err().to_string();
    assert!(error.contains("--tolerance is 0.00004 mm"), "{error}");
}

#[test]
fn a_wheel_whose_side_runs_along_the_end_of_a_part_is_proved_all_the_same() {
    let cylinder = shapes::prism(90, 30.0, 60.0);
    let options = CamOptions {
        tool: Some(WHEEL.into()),
        strategy: Some(Strategy::Rings),
        points_per_turn: Some(12),
        pitch: Some(40.0),
        // The wheel's r: its side touches the very end.
        overrun: Some(10.0),
        ..Default::default()
    };
    let certificate = cut(&cylinder, LATHE, &options).report.certificate.unwrap();
    assert_eq!(certificate.gouge, TOLERANCE);
    assert!(certificate.n_lifts > 0, "{certificate:?}");
    // Rounding decides whether it touches the end, R above 30, or the stub, R + r above 12.5; that
    // is what staying up between lifts leaves.
    let jump = 30.0 + 60.0 - 12.5 - 70.0;
    assert!(certificate.left_by_lifts < jump + 0.5, "{certificate:?}");
}
