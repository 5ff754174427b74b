//! Distances of positions and turns: as given, or from a surface precision or a scallop height.
//!
//! Both need to know the part: a coarse pass of rings (or rows) is digitized first. Between turns
//! `s` apart on the surface, a nose of radius r leaves a ridge of `h = s^2 / 8 (1 / r + k)`, k the
//! part's curvature along the step; and where the part is steep the step on the surface is longer
//! than the pitch, `s = pitch / hypot(N_y, N_z)`: toe and heel need a finer one.

use super::CamOptions;
use crate::cam::{
    Contact, Digitizer, Spacing, Stand, Strategy, Trajectory, TrajectoryError, TurnLine,
};
use crate::progress::{Cancelled, Progress};
use crate::tool::Profile;

/// Pitch where nothing is said [mm].
const PITCH: f64 = 2.0;
/// Positions per turn where nothing is said.
const PER_TURN: u32 = 360;
/// Angles of a ring of the coarse pass.
const COARSE_TURN: u32 = 72;
/// Rings of the coarse pass, at most.
const COARSE_RINGS: f64 = 200.0;
/// A graded pitch never falls below this share of the level one.
const FINEST: f64 = 0.1;

/// Why no spacing can be made.
#[derive(Debug, thiserror::Error)]
pub enum SpacingError {
    /// A ridge height is asked for from a tool that leaves none that is known.
    #[error("--scallop is known for wheels and balls; with {tool} give --pitch instead")]
    NoScallop {
        /// The tool's shape.
        tool: String,
    },
    /// A ridge height is asked for between rings that keep one distance all around.
    #[error("--scallop cannot grade a contour's rings; give --pitch instead")]
    Ungraded,
    /// The coarse pass cannot run.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Where a run goes: its strategy, the stretch along X, and the stretch its stations cover.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run<'a> {
    pub(super) stand: Stand<'a>,
    pub(super) strategy: Strategy,
    pub(super) along: [f64; 2],
    pub(super) stations: [f64; 2],
    /// What turns the part where no spindle does.
    pub(super) line: Option<TurnLine>,
}

/// The spacing `options` ask for.
pub(super) fn spacing(
    run: &Run,
    digitizer: &Digitizer,
    profile: &Profile,
    options: &CamOptions,
    progress: &dyn Progress,
) -> Result<Spacing, SpacingError> {
    if run.strategy == Strategy::Contour && options.scallop.is_some() {
        return Err(SpacingError::Ungraded);
    }
    let coarse = match (options.scallop, options.points_per_mm) {
        (None, None) => Vec::new(),
        _ => coarse_pass(run, digitizer, progress)?,
    };
    let per_mm = options.points_per_mm.map(f64::recip);
    let pitch = options.pitch.or(per_mm).unwrap_or(PITCH);
    let [from, to] = run.stations;
    let stations = match options.scallop {
        _ if run.strategy == Strategy::Contour => vec![0.0, pitch],
        Some(height) => {
            let nose = nose_radius(profile)?;
            let steps: Vec<(f64, f64)> =
                coarse.iter().map(|row| (row.station, row.pitch(nose, height))).collect();
            Spacing::graded(from, to, |x| pitch_at(&steps, x))?
        }
        None => Spacing::even(from, to, pitch)?,
    };
    let per_turn = match (options.points_per_turn, per_mm) {
        (Some(n), _) => n,
        (None, Some(apart)) => (mean_length(&coarse) / apart).ceil().max(3.0) as u32,
        (None, None) => PER_TURN,
    };
    let per_turn = match (run.strategy, options.scallop) {
        (Strategy::Lines, Some(height)) => lines_around(&coarse, profile, height)?,
        _ => per_turn,
    };
    let step = options.step.or(per_mm).unwrap_or(pitch / 2.0);
    Ok(Spacing { per_turn, step, stations })
}

/// The ridge left between neighbouring turns that 95 of 100 contacts stay below, if the tool's nose
/// is round. The part is taken as level along the step: on a convex part ridges are a little higher.
pub(super) fn scallop(
    profile: &Profile,
    way: &Trajectory,
    contacts: &[Option<Contact>],
) -> Option<f64> {
    let nose = nose_radius(profile).ok()?;
    if way.strategy() == Strategy::Lines {
        return None;
    }
    let mut ridges: Vec<f64> = contacts
        .iter()
        .enumerate()
        .filter_map(|(i, contact)| {
            let half = way.pitch_at(i) / level(way.strategy(), contact.as_ref()?) / 2.0;
            Some(if half < nose { nose - (nose * nose - half * half).sqrt() } else { nose })
        })
        .collect();
    let place = ridges.len() * 95 / 100;
    (place < ridges.len()).then(|| *ridges.select_nth_unstable_by(place, f64::total_cmp).1)
}

/// How level the part is along the step: the cosine of its slope.
fn level(strategy: Strategy, contact: &Contact) -> f64 {
    let normal = contact.normal;
    match strategy {
        // Rows of a raster step across y.
        Strategy::Raster => normal.x.hypot(normal.z),
        // Rings step any way: the steepest one is assumed.
        Strategy::Contour => normal.z.abs(),
        _ => normal.y.hypot(normal.z),
    }
    .max(1e-3)
}

fn nose_radius(profile: &Profile) -> Result<f64, SpacingError> {
    match *profile {
        Profile::Wheel { minor_radius, .. } => Ok(minor_radius),
        Profile::Ball { radius } => Ok(radius),
        _ => Err(SpacingError::NoScallop { tool: profile.to_string() }),
    }
}

/// One ring or row of the coarse pass with, for each contact, that of the next row.
struct Row {
    station: f64,
    strategy: Strategy,
    contacts: Vec<(Option<Contact>, Option<Contact>)>,
}

fn coarse_pass(
    run: &Run,
    digitizer: &Digitizer,
    progress: &dyn Progress,
) -> Result<Vec<Row>, SpacingError> {
    let [from, to] = run.stations;
    let apart = ((to - from) / COARSE_RINGS).max(0.5);
    let stations = Spacing::even(from, to, apart)?;
    let spacing = Spacing { per_turn: COARSE_TURN, step: 2.0 * apart, stations: stations.clone() };
    let strategy = match run.strategy {
        Strategy::Raster | Strategy::Contour => Strategy::Raster,
        _ => Strategy::Rings,
    };
    let pass = Trajectory::new(run.stand.machine, strategy, run.along, spacing, &run.stand.rest)?;
    let pose = |i: usize| run.stand.machine.attack_from_part(&pass.values(i));
    let contacts = digitizer.run(pass.n_positions(), pose, progress)?;
    let per_row = pass.per_row() as usize;
    let in_order = |row: usize| {
        let contacts = contacts[row * per_row..(row + 1) * per_row].iter().copied();
        // Raster rows go back and forth: what lies side by side counts from the same end.
        let mut row_contacts: Vec<Option<Contact>> = contacts.collect();
        if strategy == Strategy::Raster && row % 2 == 1 {
            row_contacts.reverse();
        }
        row_contacts
    };
    let rows = stations.iter().enumerate().map(|(row, &station)| {
        let next = in_order((row + 1).min(stations.len() - 1));
        Row { station, strategy, contacts: in_order(row).into_iter().zip(next).collect() }
    });
    Ok(rows.collect())
}

impl Row {
    /// The pitch at which no ridge here is higher than `height`.
    fn pitch(&self, nose: f64, height: f64) -> f64 {
        let level_pitch = (8.0 * height * nose).sqrt();
        let pitches = self.contacts.iter().filter_map(|(contact, next)| {
            let contact = contact.as_ref()?;
            let bend = next.as_ref().map_or(0.0, |next| bend(contact, next));
            // A ridge in a hollow as tight as the nose is none; half of that is left to be safe.
            let step = (8.0 * height / (1.0 / nose + bend).max(0.5 / nose)).sqrt();
            Some(step * level(self.strategy, contact))
        });
        pitches.fold(level_pitch, f64::min).max(FINEST * level_pitch)
    }

    /// The way the contact runs along this row [mm].
    fn length(&self) -> f64 {
        let pairs = self.contacts.windows(2);
        let ways = pairs.filter_map(|pair| Some((pair[1].0?.point - pair[0].0?.point).norm()));
        ways.sum()
    }
}

/// Curvature from one contact to the next, positive on a convex part [1/mm]; 0 over an edge, which
/// the tool turns about without leaving a ridge.
fn bend(from: &Contact, to: &Contact) -> f64 {
    let way = to.point - from.point;
    let length = way.norm();
    if length < 0.05 { 0.0 } else { (to.normal - from.normal).dot(&way) / (length * length) }
}

fn pitch_at(steps: &[(f64, f64)], x: f64) -> f64 {
    let after = steps.partition_point(|(station, _)| *station <= x);
    let near = &steps[after.saturating_sub(1)..(after + 1).min(steps.len())];
    near.iter().map(|(_, pitch)| *pitch).fold(f64::INFINITY, f64::min)
}

fn mean_length(rows: &[Row]) -> f64 {
    let lengths: Vec<f64> = rows.iter().map(Row::length).filter(|length| *length > 0.0).collect();
    lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
}

/// How many lines along the spindle leave no ridge higher than `height` between them:
/// `h = s^2 / 8 (1 / (r + R / q) + k)` with s the arc, k taken as that of the contact's circle.
fn lines_around(rows: &[Row], profile: &Profile, height: f64) -> Result<u32, SpacingError> {
    let nose = nose_radius(profile)?;
    let major = match *profile {
        Profile::Wheel { major_radius, .. } => major_radius,
        _ => 0.0,
    };
    let needed = rows.iter().flat_map(|row| &row.contacts).filter_map(|(contact, _)| {
        let contact = contact.as_ref()?;
        let from_axis = contact.point.y.hypot(contact.point.z).max(1e-3);
        let across = nose + major / level(Strategy::Lines, contact);
        let arc = (8.0 * height / (1.0 / across + 1.0 / from_axis)).sqrt();
        Some(std::f64::consts::TAU * from_axis / arc)
    });
    Ok(needed.fold(3.0, f64::max).ceil() as u32)
}
