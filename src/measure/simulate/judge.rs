//! What each move did, judged.

use super::bodies::{Bodied, Hit, remove_beside};
use super::fixtures::{Fixtures, Touch};
use super::moves::{Batch, Fact};
use super::report::{CheckedBody, Collision, CollisionKind, Extreme, SimulationReport};
use super::{Blank, SimulateError, Simulation};
use crate::machine::{Clamping, Machine};
use crate::measure::Spot;
use crate::measure::blame::{SAME, first_to_cut};
use crate::measure::ridge::ridge_error;
use crate::progress::Progress;
use crate::stock::{Cut, Layer, Stock, StockError, Sweep};
use crate::tool::{Cutter, Cylinder, Tool};
use rayon::prelude::*;
use std::ops::Range;

/// A feed move that cuts no deeper than this cuts air [mm].
const AIR: f64 = 0.01;
/// A rapid this deep in the material is a collision: what is less, rounding explains [mm].
const TOUCH: f64 = 0.01;
/// After so many collisions of bodies nobody looks any more: such a program must not run.
const MOST_BODY_COLLISIONS: usize = 100;

/// The stock while a program runs, and what there is to tell of it so far.
pub(super) struct Judge<'a> {
    machine: &'a Machine,
    stock: Stock,
    fixtures: Fixtures,
    pub(super) report: SimulationReport,
    /// The least sharp edge that cut [mm]; none if one was sharp.
    roundest: Option<[f64; 2]>,
    n_body_collisions: usize,
}

impl<'a> Judge<'a> {
    pub(super) fn new(machine: &'a Machine, Blank { stock, fixtures }: Blank) -> Self {
        let mut report = SimulationReport::new(stock.volume(), stock.layout().resolution());
        report.fixtures = fixtures.kinds();
        let roundest = Some([f64::INFINITY; 2]);
        Self { machine, stock, fixtures, report, roundest, n_body_collisions: 0 }
    }

    /// Cuts, and judges what came of it.
    pub(super) fn run(
        &mut self,
        batch: &Batch,
        progress: &dyn Progress,
    ) -> Result<(), SimulateError> {
        let cutter = batch.tool.profile.cutter(0.0);
        let cylinders = self.cylinders(batch.tool);
        let problem = |problem| SimulateError::between(batch.lines(), problem);
        for stroke in batch.strokes() {
            self.stroke(batch, stroke, (&cutter, &cylinders), progress).map_err(problem)?;
        }
        self.roundest = self
            .roundest
            .zip(roundness(&cutter))
            .map(|([along, across], new)| [along.min(new[0]), across.min(new[1])]);
        Ok(())
    }

    /// Cuts some rapids and the feed moves they lead to, and judges them.
    fn stroke(
        &mut self,
        batch: &Batch,
        stroke: Range<usize>,
        (cutter, cylinders): (&Cutter, &[Cylinder]),
        progress: &dyn Progress,
    ) -> Result<(), StockError> {
        let (sweeps, facts) = (&batch.sweeps[stroke.clone()], &batch.facts[stroke]);
        let touched = self.touched(sweeps, cutter, cylinders)?;
        let (cuts, hits) = if cylinders.is_empty() {
            (self.stock.remove(self.machine, cutter, sweeps, progress)?, Vec::new())
        } else {
            let most_hits = MOST_BODY_COLLISIONS.saturating_sub(self.n_body_collisions);
            let tool = Bodied { machine: self.machine, cutter, cylinders, most_hits };
            remove_beside(&mut self.stock, &tool, sweeps, progress)?
        };
        let mut hits = hits.into_iter().peekable();
        for (i, (fact, cut)) in facts.iter().zip(&cuts).enumerate() {
            self.judge(fact, cut);
            for Touch { fixture, part, depth } in touched.get(i).into_iter().flatten() {
                let kind = CollisionKind::from(*fixture);
                self.report.collide(Collision { line: fact.line, kind, by: *part, depth: *depth });
            }
            while let Some(hit) = hits.next_if(|hit| hit.i_sweep == i) {
                self.hit(fact.line, &hit);
            }
        }
        self.keep_thickest(cutter, sweeps, (facts, &cuts))
    }

    /// What of the tool runs into fixtures, move by move; nothing at all if there are none.
    fn touched(
        &self,
        sweeps: &[Sweep],
        cutter: &Cutter,
        cylinders: &[Cylinder],
    ) -> Result<Vec<Vec<Touch>>, StockError> {
        if self.report.fixtures.is_empty() {
            return Ok(Vec::new());
        }
        let tool = (cutter, cylinders);
        let touched =
            sweeps.par_iter().map(|sweep| self.fixtures.touched(self.machine, tool, sweep));
        touched.collect()
    }

    /// Remembers the thickest layer the feed moves of a stroke have taken, and the line that did.
    fn keep_thickest(
        &mut self,
        cutter: &Cutter,
        sweeps: &[Sweep],
        (facts, cuts): (&[Fact], &[Cut]),
    ) -> Result<(), StockError> {
        let known = self.report.thickest_cut.map_or(0.0, |spot| spot.value);
        let feeds = facts.iter().zip(cuts).filter(|(fact, _)| !fact.is_rapid);
        // No layer is thicker than it is deep along a ray.
        if feeds.map(|(_, cut)| cut.depth).fold(0.0, f64::max) <= known {
            return Ok(());
        }
        let Some(Layer { thickness, ray: [row, column] }) = self.stock.thickest_layer(known) else {
            return Ok(());
        };
        // Cut in other pieces a ray may end a little farther out.
        let slack = SAME + self.stock.sweep_error();
        let end = self.stock.end(row, column).map_or(f64::NEG_INFINITY, |end| end + slack);
        let is_cut = |row: &Stock| row.end(0, column).is_none_or(|here| here <= end);
        let mut before = self.stock.row_before(row);
        let i_sweep = first_to_cut(&mut before, self.machine, cutter, sweeps, is_cut)?;
        self.report.thickest_cut = Some(Spot {
            value: thickness,
            at: self.stock.point(row, column).coords.into(),
            line: i_sweep.map(|i| facts[i].line),
        });
        Ok(())
    }

    /// What of a tool does not cut and is to be looked at; the report says so.
    fn cylinders(&mut self, tool: &Tool) -> Vec<Cylinder> {
        let bodies = &mut self.report.bodies;
        let cylinders = tool.cylinders();
        let parts = cylinders.iter().map(|cylinder| cylinder.part).collect();
        let checked = CheckedBody { tool: tool.name.clone(), parts };
        if cylinders.is_empty() {
            if !bodies.unknown.contains(&tool.name) {
                bodies.unknown.push(tool.name.clone());
            }
        } else if !bodies.checked.contains(&checked) {
            bodies.checked.push(checked);
        }
        if bodies.stopped_at.is_some() { Vec::new() } else { cylinders }
    }

    fn hit(&mut self, line: u32, hit: &Hit) {
        self.n_body_collisions += 1;
        let kind = CollisionKind::from(hit.cylinder.part);
        self.report.collide(Collision { line, kind, by: None, depth: hit.depth });
        if self.n_body_collisions >= MOST_BODY_COLLISIONS {
            self.report.bodies.stopped_at = Some(line);
        }
    }

    fn judge(&mut self, fact: &Fact, cut: &Cut) {
        let report = &mut self.report;
        report.removed += cut.removed;
        report.n_overhanging += usize::from(cut.n_overhangs > 0);
        let is_turned = self.stock.layout().is_turned();
        // Ends that nothing holds may be faced; into the part it is a gouge.
        let is_free = is_turned && !matches!(self.machine.clamping, Clamping::Nibs { .. });
        if cut.is_through && !is_free {
            let kind =
                if is_turned { CollisionKind::AcrossAxis } else { CollisionKind::BelowBlock };
            report.collide(Collision { line: fact.line, kind, by: None, depth: cut.depth });
        }
        if fact.is_rapid {
            if cut.depth > TOUCH + 2.0 * self.stock.sweep_error() {
                let kind = CollisionKind::Rapid;
                report.collide(Collision { line: fact.line, kind, by: None, depth: cut.depth });
            }
            return;
        }
        keep_greatest(&mut report.greatest_depth, cut.depth, fact.line);
        if fact.seconds > 0.0 {
            keep_greatest(&mut report.greatest_rate, cut.removed / fact.seconds, fact.line);
        }
        if !fact.is_lead {
            report.feed_seconds += fact.seconds;
            report.air_seconds += if cut.depth < AIR { fact.seconds } else { 0.0 };
        }
    }

    /// The stock, and all there is to tell.
    pub(super) fn finish(mut self) -> Simulation {
        let report = &mut self.report;
        report.end_volume = self.stock.volume();
        if report.feed_seconds > 0.0 {
            report.air_share = report.air_seconds / report.feed_seconds;
        }
        let resolution = &mut report.resolution;
        resolution.sweep = self.stock.sweep_error();
        resolution.ridge = ridge_error(&self.stock);
        // A surface hollow with radius r sinks s^2 / (8 r) between rays s apart; around a part the
        // part's own roundness comes on top.
        let round = |[along, across]: [f64; 2]| {
            let layout = self.stock.layout();
            let around = if layout.is_turned() { 1.0 / layout.reach() } else { 0.0 };
            resolution.along.powi(2) / (8.0 * along)
                + resolution.across.powi(2) / 8.0 * (1.0 / across + around)
        };
        resolution.hollow = self.roundest.filter(|round| round[0] > 0.0).map(round);
        Simulation { stock: self.stock, report: self.report }
    }
}

fn keep_greatest(extreme: &mut Option<Extreme>, value: f64, line: u32) {
    if value > extreme.map_or(0.0, |found| found.value) {
        *extreme = Some(Extreme { value, line });
    }
}

/// The least radii of a tool along X and across it; `None` if it has an edge or a point.
fn roundness(cutter: &Cutter) -> Option<[f64; 2]> {
    match cutter {
        Cutter::Wheel(wheel) => Some([wheel.minor, wheel.major + wheel.minor]),
        Cutter::Mill(mill) => mill.ball_radius().map(|radius| [radius; 2]),
    }
}
