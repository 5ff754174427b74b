//! What certifying a path costs beside digitizing it: by the tree, and by trying every primitive.
//! `cargo bench --bench certify`; with `HORMA_DATA` set around the real foot, else a bumpy cylinder. A
//! word of their names picks cases: `cargo bench --bench certify -- flat`.

use horma::cam::{CertifyOptions, Contact, Digitizer, Draft, Grid, Method, Part, certify};
use horma::geom::{Pose, TriMesh, shapes};
use horma::machine::{AxisValues, Machine};
use horma::progress::Silent;
use horma::tool::{Cutter, Profile};
use std::path::PathBuf;
use std::time::Instant;

/// Runs of each contender; the best counts.
const RUNS: usize = 3;
/// Positions that every primitive is tried at, spread evenly over the path.
const SOME: usize = 500;
const PITCH: f64 = 2.0;
const TOLERANCE: f64 = 0.01;

fn main() {
    let mesh = foot();
    let part = Part::triangles(&mesh);
    let length = mesh.aabb().size().x;
    println!("{} triangles, one thread, tolerance {TOLERANCE} mm", mesh.triangles.len());
    // Cargo's own flags begin with a dash.
    let picked: Vec<_> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let radius = 6.0;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    for (name, machine, profile) in [
        ("wheel R60 r10", "last-lathe", Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }),
        ("ball 6", "mill-rotary", Profile::Ball { radius }),
        ("flat 6", "mill-rotary", Profile::Flat { radius }),
        ("bull 6 r2", "mill-rotary", Profile::Bull { radius, corner_radius: 2.0 }),
        (
            "ball-cone 6 r2",
            "mill-rotary",
            Profile::BallCone { radius, tip_radius: 2.0, half_angle: 0.3 },
        ),
    ] {
        let machine = Machine::builtin(machine).expect("a built-in machine");
        for degrees in [1, 2, 5] {
            let name = format!("{name}, {degrees} degrees");
            if !picked.is_empty() && !picked.iter().any(|word| name.contains(word)) {
                continue;
            }
            let words = helix(&machine, length, degrees);
            let bench =
                Bench { machine: &machine, part: &part, cutter: profile.cutter(0.0), words };
            pool.install(|| bench.compare(&name));
        }
    }
}

/// The part, lying along X from 0, its middle on the axis.
fn foot() -> TriMesh {
    let mesh = if let Some(data) = std::env::var_os("HORMA_DATA") {
        let path = PathBuf::from(data).join("lasts/find_foot/foot_mean_left.obj");
        let reading = horma::io::read_surface(&path, None).expect("the foot can be read");
        reading.surface.into_mesh().expect("the foot is a mesh")
    } else {
        eprintln!("HORMA_DATA is not set: a bumpy cylinder stands in for the foot");
        shapes::bumpy_cylinder(128_000)
    };
    let (aabb, middle) = (mesh.aabb(), mesh.aabb().center());
    mesh.moved(&Pose::translation(-aabb.min.x, -middle.y, -middle.z))
}

/// Words of X and A; the attack words are not known yet.
fn helix(machine: &Machine, length: f64, degrees: usize) -> Vec<AxisValues> {
    let [x, a] = ['X', 'A'].map(|letter| machine.axis_index(letter).expect("a lathe has X and A"));
    let per_turn = 360 / degrees;
    let at = |i: usize| {
        let turns = i as f64 / per_turn as f64;
        let mut words = machine.at_rest();
        (words[x], words[a]) = (turns * PITCH, -turns * std::f64::consts::TAU);
        words
    };
    (0..(length / PITCH) as usize * per_turn).map(at).collect()
}

struct Bench<'a> {
    machine: &'a Machine,
    part: &'a Part,
    cutter: Cutter,
    words: Vec<AxisValues>,
}

impl Bench<'_> {
    fn digitizer(&self, method: Method) -> Digitizer<'_> {
        Digitizer { part: self.part, cutter: self.cutter, method }
    }

    fn digitized(&self, method: Method, stride: usize) -> Vec<Option<Contact>> {
        let pose = |i: usize| self.machine.attack_from_part(&self.words[i * stride]);
        let n = self.words.len() / stride;
        self.digitizer(method).run(n, pose, &Silent).expect("never cancelled")
    }

    fn compare(&self, name: &str) {
        let stride = (self.words.len() / SOME) | 1;
        let n_some = self.words.len() / stride;
        let n = self.words.len() as f64;
        let contacts = self.digitized(Method::Indexed, 1);
        let attack = self.machine.attack;
        let position = |i: usize| {
            let mut words = self.words[i];
            let height = contacts[i].map_or(200.0, |contact| contact.height);
            words[attack] = self.machine.axes[attack].word(height);
            (words, contacts[i])
        };
        let draft = Draft { machine: self.machine, n_positions: self.words.len(), position };
        let options = CertifyOptions {
            gouge: TOLERANCE,
            grid: Grid::new(self.machine, 0.0, 0.0),
            least_step: [0.005, 0.005_f64.to_radians()],
            thin: false,
        };
        let digitizer = self.digitizer(Method::Indexed);
        let [mut all, mut tree, mut proof] = [f64::INFINITY; 3];
        let mut certificate = None;
        // They take turns, so that a machine whose pace drifts is fair to all.
        for _ in 0..RUNS {
            all = all
                .min(micros(|| drop(self.digitized(Method::Exhaustive, stride))) / n_some as f64);
            tree = tree.min(micros(|| drop(self.digitized(Method::Indexed, 1))) / n);
            proof = proof.min(
                micros(|| {
                    let made = certify(&digitizer, &draft, &options, &Silent);
                    certificate = Some(made.expect("never cancelled").certificate);
                }) / n,
            );
        }
        let certificate = certificate.unwrap_or_default();
        println!(
            "{name:<26} exhaustive {all:7.1} us, indexed {tree:5.2} us, certified {proof:6.2} us a \
             position given: 1/{:.0} of exhaustive for the path made; {} steps put into {}, {} lifts",
            all * (certificate.n_moves + 1) as f64 / (proof * n),
            certificate.n_inserted,
            self.words.len(),
            certificate.n_lifts
        );
    }
}

fn micros(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1e6
}
