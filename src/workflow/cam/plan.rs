//! The job itself, step by step.

use super::certified::{self, Proof};
use super::heights::Heights;
use super::options::{CamOptions, Mode, OptionsError};
use super::program::{header, write_and_read_back};
use super::report::{CamReport, PartReport, RunReport, SetupReport};
use super::spacing::{self, Run, SpacingError};
use crate::cam::{
    BlockError, Contact, ContourOptions, Digitizer, FitError, Part, Pass, PassOptions, RoughError,
    Setup, SetupError, Spacing, Stand, Strategy, Trajectory, TrajectoryError, TurnLine, clear_word,
    contours, pass, reach, room_beside, run_along, set_up, within,
};
use crate::gcode::{self, Dialect, PostError, SplitError};
use crate::geom::{Point3, Surface};
use crate::machine::{AxisKind, AxisValues, MAX_AXES, Machine, MachineError};
use crate::progress::{Cancelled, Progress};
use crate::tool::{Profile, Reach, Tool, ToolError};
use std::f64::consts::TAU;

/// The tool runs this share of its reach beyond the part's ends: at its very side rounding would
/// decide, from one position to the next, whether it touches the end or the clamp.
const NEARLY: f64 = 0.99;

/// What a job is made from.
#[derive(Debug, Clone)]
pub struct Job<'a> {
    /// What the part is called: most often its file.
    pub name: String,
    /// The part, in millimetres.
    pub surface: Surface,
    /// What reading it had to say.
    pub notes: Vec<String>,
    /// The machine it is cut on.
    pub machine: &'a Machine,
    /// The tool that cuts it.
    pub tool: Tool,
    /// The language of the control.
    pub dialect: &'a Dialect,
    /// How it is cut.
    pub options: &'a CamOptions,
    /// Keep what the pictures show.
    pub keep_scene: bool,
}

/// What a job makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The program, as the bytes of its file; they were read back and give the path.
    pub text: Vec<u8>,
    /// The same in parts that run one after the other, if it is too large for its control.
    pub parts: Vec<Vec<u8>>,
    /// What there is to say about it.
    pub report: CamReport,
    /// What there is to see, unless it was not asked for.
    pub scene: Option<Scene>,
}

/// What the pictures of a report show, in the part's frame on the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The part, then its clamps.
    pub surface: Surface,
    /// How many triangles (or points) are the part's own.
    pub n_own: usize,
    /// Where the tool touches, position by position (missed positions are left out).
    pub path: Vec<Point3>,
    /// Attack height over the position's number, thinned.
    pub heights: Vec<[f64; 2]>,
}

/// Why a job cannot be done.
#[derive(Debug, thiserror::Error)]
pub enum CamError {
    /// An option cannot be.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// The tool cannot be.
    #[error(transparent)]
    Tool(#[from] ToolError),
    /// The tool does not sit on the machine.
    #[error(transparent)]
    Machine(#[from] MachineError),
    /// The part cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The part does not fit.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The strategy cannot run here.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// No spacing comes of the options.
    #[error(transparent)]
    Spacing(#[from] SpacingError),
    /// The control cannot say it, or an axis would leave its limits.
    #[error(transparent)]
    Post(#[from] PostError),
    /// It does not fit into parts as small as asked for.
    #[error(transparent)]
    Split(#[from] SplitError),
    /// The tool meets the part nowhere.
    #[error("the tool meets the part nowhere on its way; check the spindle axis and the units")]
    Missed,
    /// Exact digitizing was asked for a part without triangles.
    #[error("mode triangles needs triangles, and the part has points alone; use --mode points")]
    NoTriangles,
    /// Contours were asked for around a part without triangles.
    #[error("strategy contour needs triangles to find the outline, and the part has points alone")]
    NoOutline,
    /// It cannot be roughed.
    #[error(transparent)]
    Rough(#[from] RoughError),
    /// The block is none.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// The program read back is not the path it was made from: our fault.
    #[error("the program read back leaves the path at move {i_move}: this is a bug in horma")]
    ReadBack {
        /// The first move that differs.
        i_move: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Makes the program of `job`, and all there is to tell about it.
pub fn plan(job: Job, progress: &dyn Progress) -> Result<Plan, CamError> {
    let Job { name, surface, notes, machine, tool, dialect, options, keep_scene } = job;
    options.check()?;
    tool.profile.check()?;
    machine.check_tool(&tool)?;
    let cutter = tool.profile.cutter(options.allowance.unwrap_or(0.0));
    let mut setup = set_up(in_mode(surface, options.mode)?, machine, &options.setup()?)?;
    let stand = Stand { machine, rest: held(machine, &options.hold)? };
    let run = run_of(&mut setup, stand, options, &tool.profile)?;
    let clear = clear_word(&setup, machine, &stand.rest, run.line.as_ref(), cutter.reach())?;
    let part = prepared(&setup.surface);
    let digitizer = Digitizer { part: &part, cutter, method: options.method.unwrap_or_default() };
    let spacing = spacing::spacing(&run, &digitizer, &tool.profile, options, progress)?;
    let way = way_of(&setup, &run, spacing)?;
    within_travel(machine, &way)?;
    let proof = Proof::asked(options, machine, dialect, &cutter)?;
    let words = |i: usize| certified::words(proof.as_ref(), machine, &way, i);
    let pose = |i: usize| machine.attack_from_part(&words(i));
    let mut contacts = digitizer.run(way.n_positions(), pose, progress)?;
    if run.line.is_some() {
        stay_over_part(&mut contacts, setup.n_own);
    }
    let rule = options.off_part.unwrap_or_default();
    let heights = Heights::new(&contacts, rule, machine, clear).ok_or(CamError::Missed)?;
    let (positions, certificate) =
        certified::positions(proof.as_ref(), &digitizer, &heights, words, progress)?;
    let mut run_report = RunReport::new(&way, &setup, &tool, options, &heights);
    let is_turned_on_table = run.line.is_some();
    let path = keep_scene.then(|| (heights.touched(), heights.thinned()));
    // A million positions are 70 MB: gone before the program is made.
    drop(contacts);
    let pace = pace(&tool, options, clear);
    let Pass { path: toolpath, feed } = pass(machine, positions, pace, progress)?;
    run_report.held = feed;

    let reach = match &setup.surface {
        // Its poses are those of a spindle, or of a part at rest.
        Surface::Mesh(mesh) if run.line.is_none() => {
            Some(reach(&digitizer, &stand, mesh, setup.n_own, progress)?)
        }
        _ => None,
    };
    let stock = options.stock.unwrap_or_else(|| depth_of_cut(&tool.profile));
    let tool = Tool { speed_rpm: options.speed.unwrap_or(tool.speed_rpm), ..tool };
    let mut header = header(&name, &tool, machine, options, stock);
    if matches!(setup.surface, Surface::Points(_)) {
        header.lines.push("digitized on points alone, as in the thesis".into());
    }
    let posted = gcode::post(&toolpath, machine, &tool, dialect, &header)?;
    let written = write_and_read_back(posted, dialect, machine, toolpath, options.split_bytes)?;
    let mut report = CamReport {
        part: PartReport::new(name, &setup, notes),
        machine: [machine.name.clone(), machine.title.clone()],
        tool: [tool.name.clone(), tool.profile.to_string()],
        setup: SetupReport::new(&setup, options),
        run: run_report,
        rough: None,
        certificate,
        reach,
        stock,
        program: written.check,
        warnings: written.warnings,
    };
    if is_turned_on_table {
        report.warn_of_table();
    }
    report.warn();
    let scene = path.map(|(path, heights)| Scene {
        surface: setup.surface,
        n_own: setup.n_own,
        path,
        heights,
    });
    Ok(Plan { text: written.text, parts: written.parts, report, scene })
}

pub(super) fn pace(tool: &Tool, options: &CamOptions, clear: f64) -> PassOptions {
    let cut = options.feed.map_or(tool.feed, |feed| feed / 60.0);
    let rotation = options.rpm.map(|rpm| rpm * TAU / 60.0);
    PassOptions { clear, cut, plunge: tool.plunge_feed.min(cut), rotation }
}

pub(super) fn in_mode(surface: Surface, mode: Option<Mode>) -> Result<Surface, CamError> {
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

pub(super) fn prepared(surface: &Surface) -> Part {
    match surface {
        Surface::Mesh(mesh) => Part::triangles(mesh),
        Surface::Points(cloud) => Part::points(cloud),
        Surface::Sections(grid) => Part::triangles(&grid.to_mesh()),
    }
}

/// The words of all axes at rest, some of them held elsewhere by the user.
pub(super) fn held(machine: &Machine, hold: &[String]) -> Result<AxisValues, CamError> {
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
pub(super) fn run_of<'a>(
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
pub(super) fn way_of<'a>(
    setup: &Setup,
    run: &Run<'a>,
    spacing: Spacing,
) -> Result<Trajectory<'a>, CamError> {
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
pub(super) fn within_travel(machine: &Machine, way: &Trajectory) -> Result<(), FitError> {
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
pub(super) fn depth_of_cut(profile: &Profile) -> f64 {
    match *profile {
        Profile::Wheel { minor_radius, .. } => minor_radius,
        Profile::Ball { radius } => radius,
        Profile::BallCone { tip_radius, .. } => tip_radius,
        Profile::Flat { radius } | Profile::Bull { radius, .. } | Profile::Cone { radius, .. } => {
            radius / 2.0
        }
    }
}
