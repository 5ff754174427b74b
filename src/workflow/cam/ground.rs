//! Where a job stands: the part on its machine, and the way of its tool over it.

use super::computing::{ComputeReport, Computing};
use super::heights::Heights;
use super::job::{CamError, Job};
use super::options::{CamOptions, Mode, OptionsError};
use super::spacing::{self, Run};
use crate::cam::{
    Contact, ContourOptions, Digitizer, FitError, Part, PassOptions, ReachReport, Setup, Spacing,
    Stand, Strategy, Trajectory, TrajectoryError, TurnLine, clear_word, contours, reach,
    room_beside, run_along, set_up, within,
};
use crate::geom::{Point3, Pose, Surface};
use crate::machine::{AxisKind, AxisValues, MAX_AXES, Machine};
use crate::progress::{Cancelled, Progress};
use crate::tool::{Cutter, Profile, Reach, Tool};
use std::f64::consts::TAU;

/// The tool runs this share of its reach beyond the part's ends: at its very side rounding would
/// decide, from one position to the next, whether it touches the end or the clamp.
const NEARLY: f64 = 0.99;

/// A job with its part set up under the tool.
pub(super) struct Ground<'a> {
    /// What the part is called.
    pub(super) name: String,
    /// What reading it had to say.
    pub(super) notes: Vec<String>,
    /// The tool.
    pub(super) tool: Tool,
    /// How it is cut.
    pub(super) options: &'a CamOptions,
    /// Keep what the pictures show.
    pub(super) keep_scene: bool,
    /// The part with all that the tool spares.
    pub(super) setup: Setup,
    /// Where the tool goes.
    pub(super) run: Run<'a>,
    /// The tool, larger by what it leaves.
    pub(super) cutter: Cutter,
    /// The attack word at which it is clear of the part and its clamps.
    pub(super) clear: f64,
    part: Part,
    computing: Computing,
}

impl<'a> Ground<'a> {
    /// The part of `job` on its machine, as the options ask for it.
    pub(super) fn new(job: Job<'a>) -> Result<Self, CamError> {
        let Job { name, surface, notes, machine, tool, options, keep_scene, .. } = job;
        options.check()?;
        tool.profile.check()?;
        machine.check_tool(&tool)?;
        let computing = Computing::asked(options)?;
        let mut setup = set_up(in_mode(surface, options.mode)?, machine, &options.setup()?)?;
        let stand = Stand { machine, rest: held(machine, &options.hold)? };
        let run = run_of(&mut setup, stand, options, &tool.profile)?;
        let cutter = tool.profile.cutter(options.allowance.unwrap_or(0.0));
        let clear = clear_word(&setup, machine, &stand.rest, run.line.as_ref(), cutter.reach())?;
        let part = prepared(&setup.surface);
        Ok(Self {
            name,
            notes,
            tool,
            options,
            keep_scene,
            setup,
            run,
            cutter,
            clear,
            part,
            computing,
        })
    }

    /// The machine it stands on.
    pub(super) fn machine(&self) -> &'a Machine {
        self.run.stand.machine
    }

    /// What finds the tool's contacts with the part.
    pub(super) fn digitizer(&self) -> Digitizer<'_> {
        let method = self.options.method.unwrap_or_default();
        Digitizer { part: &self.part, cutter: self.cutter, method }
    }

    /// The way of the tool, within the travel of all axes but the attack axis.
    pub(super) fn way(&self, progress: &dyn Progress) -> Result<Trajectory<'a>, CamError> {
        let digitizer = self.digitizer();
        let spacing =
            spacing::spacing(&self.run, &digitizer, &self.tool.profile, self.options, progress)?;
        let way = way_of(&self.setup, &self.run, spacing)?;
        within_travel(self.machine(), &way)?;
        Ok(way)
    }

    /// What the tool touches at each of `n_positions`, the part under it as `pose` says; and what
    /// found it.
    pub(super) fn contacts(
        &self,
        n_positions: usize,
        pose: impl Fn(usize) -> Pose + Sync,
        progress: &dyn Progress,
    ) -> Result<(Vec<Option<Contact>>, ComputeReport), CamError> {
        let (mut contacts, computed) =
            self.computing.contacts(&self.digitizer(), n_positions, pose, progress)?;
        if self.run.line.is_some() {
            stay_over_part(&mut contacts, self.setup.n_own);
        }
        Ok((contacts, computed))
    }

    /// The attack words of all positions, missed ones by their rule.
    pub(super) fn heights<'c>(
        &self,
        contacts: &'c [Option<Contact>],
        clear: f64,
    ) -> Result<Heights<'c>, CamError>
    where
        'a: 'c,
    {
        let rule = self.options.off_part.unwrap_or_default();
        Heights::new(contacts, rule, self.machine(), clear).ok_or(CamError::Missed)
    }

    /// How fast the tool goes, out of the way at the attack word `clear`.
    pub(super) fn pace(&self, clear: f64) -> PassOptions {
        let cut = self.options.feed.map_or(self.tool.feed, |feed| feed / 60.0);
        let rotation = self.options.rpm.map(|rpm| rpm * TAU / 60.0);
        PassOptions { clear, cut, plunge: self.tool.plunge_feed.min(cut), rotation }
    }

    /// The depth of uncut material its tool may meet.
    pub(super) fn depth_of_cut(&self) -> f64 {
        depth_of_cut(&self.tool.profile)
    }

    /// What of the part the tool can reach: of triangles, in the poses of a spindle or at rest.
    pub(super) fn reach(&self, progress: &dyn Progress) -> Result<Option<ReachReport>, Cancelled> {
        match &self.setup.surface {
            Surface::Mesh(mesh) if self.run.line.is_none() => {
                reach(&self.digitizer(), &self.run.stand, mesh, self.setup.n_own, progress)
                    .map(Some)
            }
            _ => Ok(None),
        }
    }
}

fn in_mode(surface: Surface, mode: Option<Mode>) -> Result<Surface, CamError> {
    match mode {
        Some(Mode::Points) => Ok(Surface::Points(surface.into_points())),
        Some(Mode::Triangles) => {
            surface.into_mesh().map(Surface::Mesh).ok_or(CamError::NoTriangles)
        }
        None => Ok(match surface {
            Surface::Sections(grid) => Surface::Mesh(grid.to_mesh()),
            other => other,
        }),
    }
}

fn prepared(surface: &Surface) -> Part {
    match surface {
        Surface::Mesh(mesh) => Part::triangles(mesh),
        Surface::Points(cloud) => Part::points(cloud),
        Surface::Sections(grid) => Part::triangles(&grid.to_mesh()),
    }
}

/// The words of all axes at rest, some of them held elsewhere by the user.
fn held(machine: &Machine, hold: &[String]) -> Result<AxisValues, CamError> {
    let mut rest = machine.at_rest();
    for text in hold {
        let bad = || OptionsError::Hold { text: text.clone(), machine: machine.name.clone() };
        let (letter, word) = text.split_once('=').ok_or_else(bad)?;
        let letter = letter.trim().to_ascii_uppercase();
        let word: f64 = word.trim().parse().map_err(|_| bad())?;
        let mut axes = machine.axes.iter().enumerate();
        let (index, axis) =
            axes.find(|(_, axis)| letter == axis.letter.to_string()).ok_or_else(bad)?;
        if !word.is_finite() || index == machine.attack {
            return Err(bad().into());
        }
        rest[index] = if axis.kind == AxisKind::Rotary { word.to_radians() } else { word };
    }
    Ok(rest)
}

/// Where the run goes: by default around a part on a spindle, over one on a table; and so far
/// beyond its ends that it cuts them whole, or as far as the clamps leave room.
fn run_of<'a>(
    setup: &mut Setup,
    stand: Stand<'a>,
    options: &CamOptions,
    profile: &Profile,
) -> Result<Run<'a>, CamError> {
    let reach = profile.cutter(options.allowance.unwrap_or(0.0)).reach();
    let has_spindle = stand.machine.spindle.is_some();
    let usual = if has_spindle { Strategy::Helix } else { Strategy::Raster };
    let strategy = options.strategy.unwrap_or(usual);
    if options.rpm.is_some() && !matches!(strategy, Strategy::Helix | Strategy::Rings) {
        return Err(OptionsError::NotTurning { strategy }.into());
    }
    let is_around = !matches!(strategy, Strategy::Raster | Strategy::Contour);
    if is_around && !has_spindle {
        return on_tilted_table(setup, stand, strategy, options.overrun, reach);
    }
    let [along, stations] = if is_around {
        // The tool is no wider for the allowance it leaves.
        let bare = profile.cutter(0.0).reach();
        let whole = (NEARLY * reach.x).min(room_beside(setup, bare));
        let overrun = options.overrun.unwrap_or(whole);
        [run_along(setup, stand.machine, bare, overrun)?; 2]
    } else {
        let beyond = [reach.x, reach.z].map(|reach| options.overrun.unwrap_or(NEARLY * reach));
        over_part(setup, &stand, beyond)
    };
    Ok(Run { stand, strategy, along, stations, line: None })
}

/// Around a part that a tilted table turns. The table becomes a part of what the tool spares.
fn on_tilted_table<'a>(
    setup: &mut Setup,
    stand: Stand<'a>,
    strategy: Strategy,
    overrun: Option<f64>,
    reach: Reach,
) -> Result<Run<'a>, CamError> {
    let Stand { machine, rest } = stand;
    let tilt = |source| TrajectoryError::Tilt { strategy, source };
    let line = TurnLine::of(machine, &rest).map_err(tilt)?;
    let beyond = overrun.unwrap_or(NEARLY * reach.x);
    let along = line.stretch(machine, setup.own_points(), beyond);
    setup.swing = line.swing(machine, setup.own_points());
    setup.add_table(&machine.axes[line.axis].point, setup.swing + 2.0 * reach.x);
    Ok(Run { stand, strategy, along, stations: along, line: Some(line) })
}

/// The trajectory of a run.
fn way_of<'a>(setup: &Setup, run: &Run<'a>, spacing: Spacing) -> Result<Trajectory<'a>, CamError> {
    let Stand { machine, rest } = run.stand;
    match run.strategy {
        Strategy::Contour => contour_way(setup, run, spacing),
        strategy => Ok(Trajectory::new(machine, strategy, run.along, spacing, &rest)?),
    }
}

/// The run along the contours of the part as it stands.
fn contour_way<'a>(
    setup: &Setup,
    run: &Run<'a>,
    spacing: Spacing,
) -> Result<Trajectory<'a>, CamError> {
    let Stand { machine, rest } = run.stand;
    let Surface::Mesh(mesh) = &setup.surface else { return Err(CamError::NoOutline) };
    let pose = machine.attack_from_part(&rest);
    let seen = |point: &Point3| {
        let seen = pose * point;
        [seen.x, seen.z]
    };
    let own = setup.own_points().map(seen).fold(f64::INFINITY, |least, [x, _]| least.min(x));
    let [pitch, _] = spacing.pitch_range();
    let options = ContourOptions { pitch, step: spacing.step, overrun: own - run.along[0] };
    let points = contours(mesh, setup.n_own, seen, &options);
    Ok(Trajectory::through(machine, points, spacing, &rest)?)
}

/// Where the tool would go down past the part onto the table, it keeps the height it had over the
/// part.
fn stay_over_part(contacts: &mut [Option<Contact>], n_own: usize) {
    let mut over_part = f64::NEG_INFINITY;
    for contact in contacts.iter_mut().flatten() {
        if (contact.primitive as usize) < n_own {
            over_part = contact.height;
        } else {
            contact.height = contact.height.max(over_part);
        }
    }
}

/// Refuses a trajectory that leaves an axis' travel, before it is digitized.
fn within_travel(machine: &Machine, way: &Trajectory) -> Result<(), FitError> {
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; MAX_AXES];
    for words in (0..way.n_positions()).map(|i| machine.with_followers(&way.values(i))) {
        for (range, word) in range.iter_mut().zip(words) {
            *range = [range[0].min(word), range[1].max(word)];
        }
    }
    let remedy = "take another spindle axis, a smaller --overrun or a larger machine";
    let driven = machine.axes.iter().enumerate().filter(|(index, _)| *index != machine.attack);
    for (index, axis) in driven {
        for word in range[index] {
            within(machine, axis, word, remedy)?;
        }
    }
    Ok(())
}

/// The part's extent across the attack axis, as it stands, and `beyond` it.
fn over_part(setup: &Setup, stand: &Stand, beyond: [f64; 2]) -> [[f64; 2]; 2] {
    let attack_from_part = stand.machine.attack_from_part(&stand.rest);
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for seen in setup.own_points().map(|point| attack_from_part * point) {
        for (range, at) in range.iter_mut().zip([seen.x, seen.z]) {
            *range = [range[0].min(at), range[1].max(at)];
        }
    }
    [0, 1].map(|k| [range[k][0] - beyond[k], range[k][1] + beyond[k]])
}

/// How deep a nose may go into uncut material where nobody says otherwise [mm]: a wheel or ball by
/// its radius, other mills by half of theirs.
fn depth_of_cut(profile: &Profile) -> f64 {
    match *profile {
        Profile::Wheel { minor_radius, .. } => minor_radius,
        Profile::Ball { radius } => radius,
        Profile::BallCone { tip_radius, .. } => tip_radius,
        Profile::Flat { radius } | Profile::Bull { radius, .. } | Profile::Cone { radius, .. } => {
            radius / 2.0
        }
    }
}
