//! From operations to the program that does them one after the other.

use super::ground::Ground;
use super::job::{CamError, Plan, Scene};
use super::options::CamOptions;
use super::program::{header, write_and_read_back};
use super::report::{CamReport, PartReport, RoughReport, RunReport, SetupReport, Work};
use crate::cam::{Certificate, ReachReport, Toolpath};
use crate::gcode::{self, CheckReport, Dialect, PostError};
use crate::geom::Point3;
use crate::machine::Machine;
use crate::tool::Tool;

/// What a strategy makes of its ground.
pub(super) struct Made {
    /// The moves.
    pub(super) path: Toolpath,
    /// How they came about.
    pub(super) run: RunReport,
    /// What they were roughed from, if they rough.
    pub(super) rough: Option<RoughReport>,
    /// What is proved of them.
    pub(super) certificate: Option<Certificate>,
    /// What of the part they can reach.
    pub(super) reach: Option<ReachReport>,
    /// Material the first cut may meet [mm].
    pub(super) stock: f64,
    /// Where the tool touches, and its heights, for the pictures.
    pub(super) shown: Option<(Vec<Point3>, Vec<[f64; 2]>)>,
}

/// A path and its tool, on their way into a program.
pub(super) struct Operation {
    /// The tool, at the speed asked for.
    pub(super) tool: Tool,
    path: Toolpath,
    /// All there is to tell before there is a program.
    pub(super) report: CamReport,
    scene: Option<Scene>,
}

impl Ground<'_> {
    /// The operation that cuts what was made.
    pub(super) fn operation(self, made: Made) -> Operation {
        let machine = self.machine();
        let Self { name, notes, tool, options, setup, run, .. } = self;
        let mut report = CamReport {
            part: PartReport::new(name, &setup, notes),
            machine: [machine.name.clone(), machine.title.clone()],
            tool: [tool.name.clone(), tool.profile.to_string()],
            setup: SetupReport::new(&setup, options),
            work: if made.rough.is_some() { Work::Rough } else { Work::Finish },
            run: made.run,
            rough: made.rough,
            certificate: made.certificate,
            reach: made.reach,
            stock: made.stock,
            program: CheckReport::default(),
            warnings: Vec::new(),
        };
        if run.line.is_some() {
            report.warn_of_table();
        }
        let scene = made.shown.map(|(path, heights)| Scene {
            n_own: setup.n_own,
            surface: setup.surface,
            path,
            heights,
        });
        let tool = Tool { speed_rpm: options.speed.unwrap_or(tool.speed_rpm), ..tool };
        Operation { tool, path: made.path, report, scene }
    }
}

/// The program that does `operations` one after the other, read back, and all there is to tell
/// about it: the last one's report, with what the roughing before it did.
pub(super) fn program(
    operations: Vec<Operation>,
    machine: &Machine,
    dialect: &Dialect,
    options: &CamOptions,
) -> Result<Plan, CamError> {
    let header = header(&operations, machine, options);
    let posts: Vec<_> = operations
        .iter()
        .map(|Operation { path, tool, .. }| gcode::Operation { path, tool })
        .collect();
    let posted = gcode::post_operations(&posts, machine, dialect, &header)?;
    let mut paths = Vec::new();
    let mut last: Option<(CamReport, Option<Scene>)> = None;
    for Operation { path, report, scene, .. } in operations {
        paths.push(path);
        let report = match last {
            Some((before, _)) => report.after(before),
            None => report,
        };
        last = Some((report, scene));
    }
    let (mut report, scene) = last.ok_or(PostError::Empty)?;
    let written = write_and_read_back(posted, dialect, machine, paths, options.split_bytes)?;
    report.program = written.check;
    report.warnings.extend(written.warnings);
    report.warn();
    Ok(Plan { text: written.text, parts: written.parts, report, scene })
}
