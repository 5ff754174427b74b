//! The roughing program: from a block down to what finishing leaves for itself.

use super::heights::Heights;
use super::options::CamOptions;
use super::plan::{
    CamError, Job, Plan, Scene, depth_of_cut, held, in_mode, pace, prepared, run_of, way_of,
    within_travel,
};
use super::program::{header, write_and_read_back};
use super::report::{CamReport, PartReport, RoughReport, RunReport, SetupReport};
use super::spacing;
use crate::cam::{
    Block, Contact, Cut, Digitizer, FeedReport, Move, Pace, Part, Pass, PassOptions, Position,
    RoughOptions, Roughing, Stand, Toolpath, Trajectory, clear_word, pass, set_up, within,
};
use crate::gcode;
use crate::geom::Point3;
use crate::machine::Clamping;
use crate::progress::{Cancelled, Progress, Silent};
use crate::tool::Tool;
use std::f64::consts::TAU;

/// Left for finishing where nothing is said [mm].
const ALLOWANCE: f64 = 1.0;
/// Pitch where nothing is said [mm].
const PITCH: f64 = 4.0;

/// Makes the program that brings `block` down to the part of `job` and its allowance, in layers of
/// at most `max_depth` (by default what the tool's nose takes).
pub fn rough(
    job: Job,
    block: &Block,
    max_depth: Option<f64>,
    progress: &dyn Progress,
) -> Result<Plan, CamError> {
    let Job { name, surface, notes, machine, tool, dialect, options, keep_scene } = job;
    let options = &CamOptions {
        allowance: Some(options.allowance.unwrap_or(ALLOWANCE)),
        pitch: options.pitch.or(options.scallop.is_none().then_some(PITCH)),
        ..options.clone()
    };
    options.check()?;
    tool.profile.check()?;
    machine.check_tool(&tool)?;
    let allowance = options.allowance.unwrap_or(ALLOWANCE);
    let [cutter, bare] = [allowance, 0.0].map(|allowance| tool.profile.cutter(allowance));
    let mut setup = set_up(in_mode(surface, options.mode)?, machine, &options.setup()?)?;
    let stand = Stand { machine, rest: held(machine, &options.hold)? };
    let run = run_of(&mut setup, stand, options, &tool.profile)?;
    let over_part = clear_word(&setup, machine, &stand.rest, run.line.as_ref(), cutter.reach())?;
    let part = prepared(&setup.surface);
    let method = options.method.unwrap_or_default();
    let digitizer = Digitizer { part: &part, cutter, method };

    let spacing = spacing::spacing(&run, &digitizer, &tool.profile, options, progress)?;
    let way = way_of(&setup, &run, spacing)?;
    within_travel(machine, &way)?;
    let pose = |i: usize| machine.attack_from_part(&way.values(i));
    let contacts = digitizer.run(way.n_positions(), pose, progress)?;
    let of_block = Part::triangles(&block.around(&setup, machine, allowance)?);
    let on_block = Digitizer { part: &of_block, cutter: bare, method };
    let block_contacts = on_block.run(way.n_positions(), pose, progress)?;

    let attack = &machine.axes[machine.attack];
    let [on_part, on_block] = [&contacts, &block_contacts].map(|contacts| heights(contacts));
    drop(block_contacts);
    let max_depth = max_depth.unwrap_or_else(|| depth_of_cut(&tool.profile));
    let rough_options = RoughOptions {
        max_depth,
        clearance: machine.clearance,
        floor: if machine.clamping == Clamping::Table { 0.0 } else { f64::NEG_INFINITY },
    };
    let roughing = Roughing::new(&on_part, &on_block, way.per_row() as usize, &rough_options)?;
    let over_block = on_block.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    let clear = attack.motion(over_part).max(over_block + machine.clearance);
    let clear = attack.word(clear);
    within(machine, attack, clear, "take a smaller block or a larger machine")?;

    let cutting = Cutting {
        way: &way,
        roughing: &roughing,
        contacts: &contacts,
        pace: pace(&tool, options, clear),
        top: bare.reach().top,
        turning: machine
            .spindle
            .or(run.line.map(|line| line.axis))
            .filter(|&axis| machine.axes[axis].limits.is_none()),
    };
    let Pass { path: toolpath, feed } = cutting.toolpath(progress)?;
    let held_heights =
        Heights::new(&contacts, options.off_part.unwrap_or_default(), machine, clear);
    let held_heights = held_heights.ok_or(CamError::Missed)?;
    let mut run_report = RunReport::new(&way, &setup, &tool, options, &held_heights);
    run_report.held = feed;
    let path = keep_scene.then(|| (cutting.path(), held_heights.thinned()));
    let rough_report = RoughReport {
        block: block.to_string(),
        max_depth,
        n_layers: roughing.levels.len(),
        n_cuts: roughing.cuts.len(),
        n_positions: roughing.cuts.iter().map(|cut| cut.positions.len()).sum(),
    };
    let tool = Tool { speed_rpm: options.speed.unwrap_or(tool.speed_rpm), ..tool };
    let mut header = header(&name, &tool, machine, options, max_depth);
    header.lines.push(format!("roughing from {block}, {max_depth} mm at most a layer"));
    let posted = gcode::post(&toolpath, machine, &tool, dialect, &header)?;
    let written = write_and_read_back(posted, dialect, machine, toolpath, options.split_bytes)?;
    let mut report = CamReport {
        part: PartReport::new(name, &setup, notes),
        machine: [machine.name.clone(), machine.title.clone()],
        tool: [tool.name.clone(), tool.profile.to_string()],
        setup: SetupReport::new(&setup, options),
        run: run_report,
        rough: Some(rough_report),
        certificate: None,
        reach: None,
        stock: max_depth,
        program: written.check,
        warnings: written.warnings,
    };
    report.warn();
    let scene = path.map(|(path, heights)| Scene {
        n_own: setup.n_own,
        surface: setup.surface,
        path,
        heights,
    });
    Ok(Plan { text: written.text, parts: written.parts, report, scene })
}

fn heights(contacts: &[Option<Contact>]) -> Vec<Option<f64>> {
    contacts.iter().map(|contact| contact.map(|contact| contact.height)).collect()
}

/// The cuts on their way to moves.
struct Cutting<'a> {
    way: &'a Trajectory<'a>,
    roughing: &'a Roughing<'a>,
    contacts: &'a [Option<Contact>],
    pace: PassOptions,
    /// From the tool's programmed point to its lowest one [mm].
    top: f64,
    /// The axis that turns the part without end.
    turning: Option<usize>,
}

impl Cutting<'_> {
    /// All cuts with the links between them: straight up, across above all stock, straight down to
    /// it, and with the plunging feed into it. An axis that turns without end is never wound back.
    fn toolpath(&self, progress: &dyn Progress) -> Result<Pass, Cancelled> {
        let clear = self.pace.clear;
        let cuts = &self.roughing.cuts;
        progress.start("scheduling", cuts.len() as u64);
        let mut all = Toolpath { moves: Vec::new(), clear };
        let mut feed = FeedReport::default();
        for (i, cut) in cuts.iter().enumerate() {
            let is_first = i == 0;
            let link = if is_first { clear } else { self.word(cut.link) };
            // The last move of the cut before leaves the stock straight up, now as far as this link.
            if let Some(leave) = all.moves.last_mut() {
                leave.to[self.way.machine().attack] = link;
            }
            let wound = self.whole_turns(all.moves.last(), cut.positions.start);
            let positions = cut.positions.clone().map(|i| {
                let mut position = self.position(cut, i);
                if let Some(axis) = self.turning {
                    position.words[axis] += wound;
                }
                position
            });
            let pace = PassOptions { clear: link, ..self.pace };
            let cut_pass = pass(self.way.machine(), positions, pace, &Silent)?;
            feed.take(&cut_pass.feed);
            let mut moves = cut_pass.path.moves.into_iter();
            if let Some(over) = moves.next() {
                let mut down = over.to;
                down[self.way.machine().attack] = self.word(cut.above);
                all.moves.extend([over, Move { to: down, pace: Pace::Rapid }]);
            }
            all.moves.extend(moves);
            progress.advance(1)?;
        }
        if let Some(leave) = all.moves.last_mut() {
            leave.to[self.way.machine().attack] = clear;
        }
        Ok(Pass { path: all, feed })
    }

    /// The whole turns that bring position `i` nearest to where the last move ended [rad].
    fn whole_turns(&self, last: Option<&Move>, i: usize) -> f64 {
        let (Some(axis), Some(last)) = (self.turning, last) else { return 0.0 };
        ((last.to[axis] - self.way.values(i)[axis]) / TAU).round() * TAU
    }

    /// The words of a position in a cut, and the point of the stock it is about.
    fn position(&self, cut: &Cut, i: usize) -> Position {
        let height = self.roughing.height(cut.layer, i);
        let mut words = self.way.values(i);
        words[self.way.machine().attack] = self.word(height);
        Position { words, touched: Some(self.touched(cut, i, height)) }
    }

    fn touched(&self, cut: &Cut, i: usize, height: f64) -> Point3 {
        match &self.contacts[i] {
            Some(contact) if self.roughing.is_on_part(cut.layer, i) => contact.point,
            _ => {
                let pose = self.way.machine().attack_from_part(&self.way.values(i));
                pose.inverse() * Point3::new(0.0, height - self.top, 0.0)
            }
        }
    }

    /// What is touched, cut by cut, for the picture.
    fn path(&self) -> Vec<Point3> {
        let cuts = self.roughing.cuts.iter();
        let at = |cut: &Cut, i: usize| self.touched(cut, i, self.roughing.height(cut.layer, i));
        cuts.flat_map(|cut| cut.positions.clone().map(move |i| at(cut, i))).collect()
    }

    fn word(&self, height: f64) -> f64 {
        let machine = self.way.machine();
        machine.axes[machine.attack].word(height)
    }
}
