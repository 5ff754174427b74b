//! The job itself, step by step.

use super::options::{CamOptions, Mode, OffPart, OptionsError};
use super::report::{CamReport, PartReport, RunReport, SetupReport};
use super::spacing::{self, Run, SpacingError};
use crate::cam::{
    Contact, Digitizer, Feeds, FitError, Move, Part, Setup, SetupError, Stand, Strategy, Toolpath,
    Trajectory, TrajectoryError, clear_word, pass, reach, run_along, set_up, within,
};
use crate::gcode::{self, CheckReport, Dialect, Header, PostError, Posted, Program, StepKind};
use crate::geom::{Point3, Surface};
use crate::machine::{AxisKind, AxisValues, MAX_AXES, Machine, MachineError};
use crate::progress::{Cancelled, Progress};
use crate::tool::{Cutter, HeightFunction, Profile, Reach, Tool, ToolError};

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
    /// The tool meets the part nowhere.
    #[error("the tool meets the part nowhere on its way; check the spindle axis and the units")]
    Missed,
    /// Exact digitizing was asked for a part without triangles.
    #[error("mode triangles needs triangles, and the part has points alone; use --mode points")]
    NoTriangles,
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
    let allowance = options.allowance.unwrap_or(0.0);
    let cutter = tool.profile.cutter(allowance);
    let setup = set_up(in_mode(surface, options.mode)?, machine, &options.setup()?)?;
    let part = prepared(&setup.surface);
    let digitizer = Digitizer { part: &part, cutter, method: options.method.unwrap_or_default() };

    let tool_reach = reach_of(&cutter);
    let rest = held(machine, &options.hold)?;
    let clear = clear_word(&setup, machine, &rest, tool_reach)?;
    let run = run_of(&setup, machine, options, &tool.profile, rest)?;
    let spacing = spacing::spacing(&run, &digitizer, &tool.profile, options, progress)?;
    let (per_turn, step, stations) = (spacing.per_turn, spacing.step, spacing.stations.clone());
    let way = Trajectory::new(machine, run.strategy, run.along, spacing, &rest)?;
    let n_positions = way.n_positions();
    within_travel(machine, &way)?;
    let pose = |i: usize| machine.attack_from_part(&way.values(i));
    let contacts = digitizer.run(n_positions, pose, progress)?;
    let rule = options.off_part.unwrap_or_default();
    let heights = Heights::new(&contacts, rule, machine, clear).ok_or(CamError::Missed)?;

    let feeds = Feeds {
        cut: options.feed.map_or(tool.feed, |feed| feed / 60.0),
        plunge: tool.plunge_feed.min(options.feed.map_or(f64::INFINITY, |feed| feed / 60.0)),
    };
    let position = |i: usize| {
        let mut words = way.values(i);
        words[machine.attack] = heights.word(i);
        (words, contacts[i].map(|contact| contact.point))
    };
    let toolpath = pass(machine, n_positions, position, clear, feeds, progress)?;
    let per_row = way.per_row() as usize;
    let run_report = RunReport {
        strategy: run.strategy,
        n_positions,
        per_turn,
        pitch: pitch_range(&stations),
        step,
        along: run.along,
        allowance,
        n_missed: contacts.iter().filter(|contact| contact.is_none()).count(),
        off_part: rule.in_words(),
        scallop: spacing::scallop(
            &tool.profile,
            run.strategy,
            |i| pitch_near(&stations, i / per_row),
            &contacts,
        ),
        feed: feeds.cut * 60.0,
        greatest_rise: heights.greatest_rise(n_positions),
    };
    let scene_path = keep_scene.then(|| {
        let path = contacts.iter().flatten().map(|contact| contact.point).collect();
        (path, heights.thinned(n_positions))
    });
    drop(contacts);

    let reach = match &setup.surface {
        Surface::Mesh(mesh) => {
            Some(reach(&digitizer, &Stand { machine, rest }, mesh, setup.n_own, progress)?)
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
    let (text, program, warnings) = write_and_read_back(posted, dialect, machine, &toolpath)?;
    let mut report = CamReport {
        part: part_report(name, &setup, notes),
        machine: [machine.name.clone(), machine.title.clone()],
        tool: [tool.name.clone(), tool.profile.to_string()],
        setup: setup_report(&setup, options),
        run: run_report,
        reach,
        stock,
        program,
        warnings,
    };
    report.warn();
    let scene = scene_path.map(|(path, heights)| Scene {
        surface: setup.surface,
        n_own: setup.n_own,
        path,
        heights,
    });
    Ok(Plan { text, report, scene })
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

fn reach_of(cutter: &Cutter) -> Reach {
    match cutter {
        Cutter::Wheel(wheel) => wheel.reach(),
        Cutter::Mill(mill) => mill.reach(),
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

fn run_of<'a>(
    setup: &Setup,
    machine: &'a Machine,
    options: &CamOptions,
    profile: &Profile,
    rest: AxisValues,
) -> Result<Run<'a>, CamError> {
    // The tool runs on until nothing is left of the allowance, but it is no wider for it.
    let allowance = options.allowance.unwrap_or(0.0);
    let [bare, reach] = [0.0, allowance].map(|grown| reach_of(&profile.cutter(grown)));
    let usual = if machine.spindle.is_some() { Strategy::Helix } else { Strategy::Raster };
    let strategy = options.strategy.unwrap_or(usual);
    let (along, stations) = if machine.spindle.is_some() && strategy != Strategy::Raster {
        let overrun = options.overrun.unwrap_or(reach.x);
        let along = run_along(setup, machine, bare, overrun)?;
        (along, along)
    } else {
        let beyond = [options.overrun.unwrap_or(reach.x), options.overrun.unwrap_or(reach.z)];
        over_part(setup, machine, &rest, beyond)
    };
    Ok(Run { machine, strategy, along, stations, rest })
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
fn over_part(
    setup: &Setup,
    machine: &Machine,
    rest: &AxisValues,
    beyond: [f64; 2],
) -> ([f64; 2], [f64; 2]) {
    let attack_from_part = machine.attack_from_part(rest);
    let own = setup.own_points();
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for seen in own.map(|point| attack_from_part * point) {
        for (range, at) in range.iter_mut().zip([seen.x, seen.z]) {
            *range = [range[0].min(at), range[1].max(at)];
        }
    }
    let [x, z] = [0, 1].map(|k| [range[k][0] - beyond[k], range[k][1] + beyond[k]]);
    (x, z)
}

/// The attack words of all positions, missed ones by their rule.
struct Heights<'a> {
    contacts: &'a [Option<Contact>],
    machine: &'a Machine,
    /// For missed positions: clear, or held from the position this many before.
    missed: Option<Vec<(usize, f64)>>,
    clear: f64,
}

impl<'a> Heights<'a> {
    /// `None` if the tool meets nothing anywhere.
    fn new(
        contacts: &'a [Option<Contact>],
        rule: OffPart,
        machine: &'a Machine,
        clear: f64,
    ) -> Option<Self> {
        let first = contacts.iter().flatten().next()?.height;
        let held = (rule == OffPart::Hold).then(|| {
            let mut held = Vec::new();
            let mut last = first;
            for (i, contact) in contacts.iter().enumerate() {
                match contact {
                    Some(contact) => last = contact.height,
                    None => held.push((i, last)),
                }
            }
            held
        });
        Some(Self { contacts, machine, missed: held, clear })
    }

    fn word(&self, i: usize) -> f64 {
        let height = match (&self.contacts[i], &self.missed) {
            (Some(contact), _) => contact.height,
            (None, None) => return self.clear,
            (None, Some(held)) => held[held.partition_point(|(at, _)| *at < i)].1,
        };
        self.machine.axes[self.machine.attack].word(height)
    }

    fn greatest_rise(&self, n: usize) -> f64 {
        let rises = (1..n).map(|i| (self.word(i) - self.word(i - 1)).abs());
        rises.fold(0.0, f64::max)
    }

    fn thinned(&self, n: usize) -> Vec<[f64; 2]> {
        let stride = n.div_ceil(20_000).max(1);
        (0..n).step_by(stride).map(|i| [i as f64, self.word(i)]).collect()
    }
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

fn header(name: &str, tool: &Tool, machine: &Machine, options: &CamOptions, stock: f64) -> Header {
    let asked = serde_json::to_string(options).unwrap_or_default();
    Header {
        lines: vec![
            format!("part {name}"),
            format!("machine {}", machine.name),
            format!("tool T{} {}: {}", tool.number, tool.name, tool.profile),
            format!("options {asked}"),
            format!("made by horma {}", env!("CARGO_PKG_VERSION")),
        ],
        stock: Some(stock),
    }
}

/// The program as bytes, what reading them back says, and what the post had to say.
fn write_and_read_back(
    posted: Posted,
    dialect: &Dialect,
    machine: &Machine,
    toolpath: &Toolpath,
) -> Result<(Vec<u8>, CheckReport, Vec<String>), CamError> {
    let warnings = posted.warnings.iter().map(ToString::to_string).collect();
    let mut text = Vec::new();
    // Writing into memory does not fail.
    let _ = gcode::write(&posted.program, dialect, &mut text);
    drop(posted);
    let lost = |_| CamError::ReadBack { i_move: 0 };
    let program = gcode::read(&mut text.as_slice(), machine).map_err(lost)?;
    goes_along(&program, machine, toolpath, dialect)?;
    Ok((text, gcode::check(&program, machine), warnings))
}

/// Refuses a program that goes anywhere but along `toolpath`, after its approach and before its
/// retreat.
fn goes_along(
    program: &Program,
    machine: &Machine,
    toolpath: &Toolpath,
    dialect: &Dialect,
) -> Result<(), CamError> {
    let moves = program.steps(machine).filter(|step| step.kind != StepKind::Dwell);
    let mut ends = moves.filter_map(|step| step.values(program)).peekable();
    let mut at = None;
    for (i_move, planned) in toolpath.moves.iter().enumerate() {
        let is_near = |end: &AxisValues| is_near(machine, end, planned, dialect);
        if i_move == 0 {
            at = ends.find(is_near);
        } else if let Some(next) = ends.next_if(is_near) {
            at = Some(next);
        }
        // A move too small for a word has no block: the machine is there already.
        if !at.as_ref().is_some_and(is_near) {
            return Err(CamError::ReadBack { i_move });
        }
    }
    match ends.count() {
        0 | 1 => Ok(()),
        _ => Err(CamError::ReadBack { i_move: toolpath.moves.len() }),
    }
}

/// Within half the last decimal of every word.
fn is_near(machine: &Machine, end: &AxisValues, planned: &Move, dialect: &Dialect) -> bool {
    // A hundredth more: the comparison itself is rounded.
    let half = |decimals: u8| 0.505 * 10f64.powi(-i32::from(decimals));
    machine.axes.iter().enumerate().filter(|(_, axis)| axis.follows.is_none()).all(|(i, axis)| {
        let allowed = match axis.kind {
            AxisKind::Linear => half(dialect.decimals.linear),
            AxisKind::Rotary => half(dialect.decimals.rotary).to_radians(),
        };
        (end[i] - planned.to[i]).abs() <= allowed
    })
}

fn part_report(name: String, setup: &Setup, notes: Vec<String>) -> PartReport {
    let size = setup.part.size();
    let mode = if matches!(setup.surface, Surface::Points(_)) { "points" } else { "triangles" };
    PartReport { name, mode, n_primitives: setup.n_own, size: size.into(), notes }
}

fn setup_report(setup: &Setup, options: &CamOptions) -> SetupReport {
    let pose = setup.machine_from_file.to_homogeneous();
    let row = |i: usize| [0, 1, 2, 3].map(|j| pose[(i, j)]);
    SetupReport {
        axis: [0, 1, 2].map(|j| pose[(0, j)]),
        start_angle_deg: options.start_angle.unwrap_or(0.0),
        mirrored: options.mirror,
        swing: setup.swing,
        part_x: [setup.part.min.x, setup.part.max.x],
        clamped_x: setup.stretch,
        machine_from_file: [row(0), row(1), row(2)],
    }
}

fn pitch_range(stations: &[f64]) -> [f64; 2] {
    let pitches = stations.windows(2).map(|pair| pair[1] - pair[0]);
    let range = pitches.fold([f64::INFINITY, 0.0], |[low, high], p| [low.min(p), high.max(p)]);
    if range[1] == 0.0 { [0.0; 2] } else { range }
}

fn pitch_near(stations: &[f64], row: usize) -> f64 {
    let row = row.clamp(1, (stations.len() - 1).max(1));
    stations.get(row).map_or(0.0, |x| x - stations[row - 1])
}

impl OffPart {
    fn in_words(self) -> &'static str {
        match self {
            Self::Hold => {
                "hold: a position that meets nothing keeps the height of the last that did"
            }
            Self::Clear => "clear: a position that meets nothing is clear of the part",
        }
    }
}

impl CamReport {
    /// Adds what the user should know before pressing start.
    fn warn(&mut self) {
        let mut say = |text: String| self.warnings.push(text);
        say(format!(
            "the program assumes at most {:.1} mm of stock on the part: rough it first",
            self.stock
        ));
        if self.part.mode == "points" {
            say("digitized on points alone, as in the thesis: between points the tool may cut into \
                 the part; give triangles to be exact"
                .into());
        }
        if let Some(reach) = &self.reach {
            let share = |area: f64| 100.0 * area / reach.area;
            if share(reach.undercut) >= 0.05 {
                say(format!(
                    "{:.0} mm2 ({:.1} %) of the part are undercut: turned away from the tool in every \
                     pose",
                    reach.undercut,
                    share(reach.undercut)
                ));
            }
            if share(reach.hollow) >= 0.05 {
                say(format!(
                    "{:.0} mm2 ({:.1} %) lie in hollows the tool cannot enter: up to {:.2} mm stay on",
                    reach.hollow,
                    share(reach.hollow),
                    reach.deepest
                ));
            }
        }
        if let Some(rate) = self.program.block_rate.filter(|rate| rate.highest > rate.limit) {
            say(format!(
                "line {}: {:.0} blocks a second, the control reads {:.0}: it will stutter",
                rate.line, rate.highest, rate.limit
            ));
        }
    }
}
