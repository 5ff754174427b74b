//! Machines built by hand, a tool, and toolpaths drawn at random.

use horma::cam::{Move, Pace, Toolpath};
use horma::geom::{Point3, Vector3};
use horma::machine::{
    Axis, AxisKind, AxisValues, Carries, Clamping, Follow, MAX_AXES, Machine, Mount, Obstacles,
    ToolChanges,
};
use horma::tool::{Profile, Tool, Turns};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

/// A last lathe: carriage X, infeed Y, spindle A with sign -1.
pub(crate) fn lathe() -> Machine {
    let axes = vec![
        linear('X', Carries::Tool, Vector3::x(), [-50.0, 400.0]),
        linear('Y', Carries::Tool, Vector3::y(), [0.0, 250.0]),
        Axis { sign: -1.0, ..rotary('A', None) },
    ];
    machine("lathe", axes, 1)
}

/// A lathe with a second spindle C that turns against the first.
pub(crate) fn pair() -> Machine {
    let mut machine = lathe();
    let follows = Some(Follow { leader: 2, ratio: -1.0 });
    machine.axes.push(Axis { follows, ..rotary('C', None) });
    Machine { name: "pair".into(), ..machine }
}

/// A mill with a table under X and Y; Z attacks.
pub(crate) fn mill() -> Machine {
    let axes = vec![
        linear('X', Carries::Part, -Vector3::x(), [0.0, 300.0]),
        linear('Y', Carries::Part, -Vector3::y(), [0.0, 200.0]),
        linear('Z', Carries::Tool, Vector3::z(), [-100.0, 100.0]),
    ];
    machine("mill", axes, 2)
}

/// A wheel with a plunge feed of 20 mm/s.
pub(crate) fn wheel() -> Tool {
    Tool {
        number: 7,
        name: "wheel".into(),
        profile: Profile::Wheel { major_radius: 50.0, minor_radius: 10.0 },
        length: 80.0,
        speed_rpm: 6000.0,
        turns: Turns::CounterClockwise,
        feed: 50.0,
        plunge_feed: 20.0,
        body: None,
    }
}

/// Axis values from the first few of them.
pub(crate) fn values<const N: usize>(some: [f64; N]) -> AxisValues {
    let mut all = [0.0; MAX_AXES];
    all[..N].copy_from_slice(&some);
    all
}

/// A path of `n_moves` moves of every pace and size, down to ones too small for a word.
pub(crate) fn random_path(machine: &Machine, n_moves: usize, seed: u64) -> Toolpath {
    let mut random = Pcg32::seed_from_u64(seed);
    let clear = machine.axes[machine.attack].limits.map_or(0.0, |[_, greatest]| greatest - 1.0);
    let mut at = [0.0; MAX_AXES];
    for (value, axis) in at.iter_mut().zip(&machine.axes) {
        *value = axis.limits.map_or(0.0, |[least, greatest]| f64::midpoint(least, greatest));
    }
    let mut moves = vec![Move { to: at, pace: Pace::Rapid }];
    while moves.len() < n_moves {
        let size = 10_f64.powf(random.random_range(-6.0..1.0));
        let mut to = at;
        for (value, axis) in to.iter_mut().zip(&machine.axes) {
            if axis.follows.is_none() && random.random_bool(0.7) {
                let step = if axis.kind == AxisKind::Rotary { size / 20.0 } else { size };
                let [least, greatest] = axis.limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                *value = (*value + step * random.random_range(-1.0..1.0)).clamp(least, greatest);
            }
        }
        let pace = random_pace(machine, &at, &to, &mut random);
        moves.push(Move { to, pace });
        at = to;
    }
    Toolpath { moves, clear }
}

fn random_pace(machine: &Machine, from: &AxisValues, to: &AxisValues, random: &mut Pcg32) -> Pace {
    let (from, to) = (machine.with_followers(from), machine.with_followers(to));
    let ways = || machine.axes.iter().enumerate().map(|(i, axis)| (axis, (to[i] - from[i]).abs()));
    let shortest = ways().map(|(axis, way)| way / axis.velocity).fold(1e-4, f64::max);
    let turns = ways().any(|(axis, way)| axis.kind == AxisKind::Rotary && way > 0.0);
    match random.random_range(0..10) {
        0 => Pace::Rapid,
        1 if !turns => Pace::Feed(random.random_range(1.0..100.0)),
        _ => Pace::Duration(shortest * random.random_range(1.0..3.0)),
    }
}

fn machine(name: &str, axes: Vec<Axis>, attack: usize) -> Machine {
    Machine {
        name: name.into(),
        title: format!("a {name} built by hand"),
        spindle: axes.iter().position(|axis| axis.kind == AxisKind::Rotary),
        axes,
        attack,
        mount: Mount::Across,
        clamping: Clamping::Table,
        dialect: "linuxcnc".into(),
        default_tool: "wheel".into(),
        clearance: 5.0,
        blocks_per_second: 1000.0,
        tool_changes: ToolChanges::WithinPrograms,
        look_ahead_blocks: None,
        obstacles: Obstacles::default(),
    }
}

fn linear(letter: char, carries: Carries, direction: Vector3, limits: [f64; 2]) -> Axis {
    Axis {
        letter,
        kind: AxisKind::Linear,
        carries,
        direction,
        point: Point3::origin(),
        sign: 1.0,
        zero: 0.0,
        limits: Some(limits),
        velocity: 500.0,
        acceleration: 5000.0,
        follows: None,
    }
}

fn rotary(letter: char, limits: Option<[f64; 2]>) -> Axis {
    Axis {
        kind: AxisKind::Rotary,
        limits,
        velocity: 900_f64.to_radians(),
        acceleration: 200.0,
        ..linear(letter, Carries::Part, Vector3::x(), [0.0, 0.0])
    }
}
