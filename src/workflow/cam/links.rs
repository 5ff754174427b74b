//! Rapids of a roughing, held against the stock as it stands at that moment.
//!
//! Links are laid over all that stands between two cuts, position by position. Here they are proved
//! as a whole: the cuts are replayed on stock, and every rapid must be clear of it, along the attack
//! axis, by the machine's clearance less what the stock is not looked at.

use super::ground::Ground;
use super::job::CamError;
use super::report::LinkReport;
use crate::cam::{Move, Pace, Toolpath};
use crate::geom::{Aabb, TriMesh, Vector3};
use crate::machine::{AxisValues, Machine};
use crate::progress::{Progress, Silent};
use crate::stock::{Layout, Resolution, Stock, Sweep};
use crate::tool::Cutter;

/// How far apart the stock is looked at, at most: the clearance is many times that [mm].
const RESOLUTION: f64 = 2.0;
/// A tool that leaves its cut touches it; what is no deeper than this is the stock's own error [mm].
const TOUCHES: f64 = 0.1;

/// Proves that no rapid of `path` meets what is left of `block` by then.
pub(super) fn prove_links(
    ground: &Ground,
    block: &TriMesh,
    path: &Toolpath,
    progress: &dyn Progress,
) -> Result<LinkReport, CamError> {
    let machine = ground.machine();
    let resolution = RESOLUTION.min(machine.clearance / 4.0);
    // Rays about a table that turns stand for any of its angles; others are held as at rest.
    let layout = match (&ground.run.line, path.moves.first()) {
        (Some(line), _) => {
            let (space, even) = (Aabb::around(&block.points), Resolution::even(resolution));
            Layout::about(machine, &ground.run.stand.rest, line.axis, &space, even)?
        }
        (None, Some(first)) => {
            let space = space(ground, block, path, &first.to);
            Layout::new(machine, &first.to, &space, Resolution::even(resolution))?
        }
        (None, None) => {
            return Ok(LinkReport { n_rapids: 0, clearance: machine.clearance, resolution });
        }
    };
    let mut proof = Proof {
        machine,
        cutter: ground.tool.profile.cutter(0.0),
        clearance: machine.clearance - resolution,
        stock: Stock::of_mesh(layout, block),
    };
    progress.start("proving links", path.moves.len() as u64);
    let n_rapids = proof.follow(&path.moves, progress)?;
    let clearance = proof.clearance;
    Ok(LinkReport { n_rapids, clearance, resolution })
}

/// The block, and on a table all that lies beneath it down to where the tool is looked for: a ray says
/// of a tool below its foot that it went through.
fn space(ground: &Ground, block: &TriMesh, path: &Toolpath, at: &AxisValues) -> Aabb {
    let machine = ground.machine();
    let space = Aabb::around(&block.points);
    if machine.spindle.is_some() {
        return space;
    }
    let attack_from_part = machine.attack_from_part(at);
    let bottom = block.points.iter().map(|point| (attack_from_part * point).y);
    let bottom = bottom.fold(f64::INFINITY, f64::min);
    let axis = &machine.axes[machine.attack];
    let heights = path.moves.iter().map(|step| axis.motion(step.to[machine.attack]));
    let below = machine.clearance + ground.tool.profile.cutter(0.0).reach().top + 1.0;
    let lowest = heights.fold(f64::INFINITY, f64::min) - below;
    let down = attack_from_part.rotation.inverse() * -Vector3::y() * (bottom - lowest).max(0.0);
    block.points.iter().fold(space, |space, point| space.with(&(point + down)))
}

struct Proof<'a> {
    machine: &'a Machine,
    cutter: Cutter,
    /// To be kept along the attack axis [mm].
    clearance: f64,
    stock: Stock,
}

impl Proof<'_> {
    /// Cuts what is cut and proves what is not, from where the first move ends; how many rapids there
    /// are.
    fn follow(&mut self, moves: &[Move], progress: &dyn Progress) -> Result<usize, CamError> {
        let mut n_rapids = 0;
        let mut cut = Vec::new();
        for (i_move, pair) in (1..).zip(moves.windows(2)) {
            let [Move { to: from, .. }, step] = pair else { continue };
            let sweep = Sweep { from: *from, to: step.to, engages: cut.is_empty() };
            if step.pace == Pace::Rapid {
                let leaves = !cut.is_empty();
                self.cut(&mut cut, progress)?;
                self.is_clear(i_move, step, &sweep, leaves)?;
                n_rapids += 1;
            } else {
                cut.push(sweep);
            }
        }
        Ok(n_rapids)
    }

    /// Takes away what was cut since the last rapid.
    fn cut(&mut self, sweeps: &mut Vec<Sweep>, progress: &dyn Progress) -> Result<(), CamError> {
        if !sweeps.is_empty() {
            self.stock.remove(self.machine, &self.cutter, sweeps, &Silent)?;
            progress.advance(sweeps.len() as u64)?;
            sweeps.clear();
        }
        Ok(())
    }

    /// Refuses a rapid that comes too near: on the way out of a cut it must not go deeper, else it
    /// must be clear even if the tool came down by the clearance.
    fn is_clear(
        &self,
        i_move: usize,
        step: &Move,
        sweep: &Sweep,
        leaves: bool,
    ) -> Result<(), CamError> {
        let clearance = if leaves { 0.0 } else { self.clearance };
        let lowered = |values: &AxisValues| self.lowered(values, clearance);
        let sweep = Sweep { from: lowered(&sweep.from), to: lowered(&sweep.to), ..*sweep };
        let depth = self.stock.depth_of(self.machine, &self.cutter, &sweep)?;
        if depth <= TOUCHES {
            return Ok(());
        }
        let attack = self.machine.attack;
        let (axis, word) = (self.machine.axes[attack].letter, step.to[attack]);
        Err(CamError::Link { i_move, axis, word, depth: depth - clearance, clearance })
    }

    fn lowered(&self, values: &AxisValues, by: f64) -> AxisValues {
        let attack = self.machine.attack;
        let axis = &self.machine.axes[attack];
        let mut lowered = *values;
        lowered[attack] = axis.word(axis.motion(values[attack]) - by);
        lowered
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point3;
    use crate::tool::Profile;

    /// R + r of the wheel, and the radius of the bar [mm].
    const TOP: f64 = 70.0;
    const BAR: f64 = 40.0;

    /// Follows moves of a wheel over a bar, from X 0, Y 150; what is said of them.
    fn follow(moves: &[(f64, f64, Pace)]) -> Result<usize, CamError> {
        let machine = Machine::builtin("last-lathe").unwrap();
        let space = Aabb { min: Point3::new(0.0, -BAR, -BAR), max: Point3::new(200.0, BAR, BAR) };
        let layout =
            Layout::new(&machine, &machine.at_rest(), &space, Resolution::even(2.0)).unwrap();
        let wheel = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 };
        let mut proof = Proof {
            machine: &machine,
            cutter: wheel.cutter(0.0),
            clearance: 18.0,
            stock: Stock::cylinder(layout, BAR),
        };
        let start = (0.0, 150.0, Pace::Rapid);
        let moves = std::iter::once(&start).chain(moves);
        let moves: Vec<Move> =
            moves.map(|&(x, y, pace)| Move { to: [x, y, 0.0, 0.0, 0.0, 0.0], pace }).collect();
        proof.follow(&moves, &Silent)
    }

    /// Down to a depth of 6 mm at X 100, along to X 140, and out again.
    fn groove(out: (f64, f64)) -> Vec<(f64, f64, Pace)> {
        let (depth, feed) = (BAR + TOP - 6.0, Pace::Feed(10.0));
        vec![
            (100.0, 150.0, Pace::Rapid),
            (100.0, depth, feed),
            (140.0, depth, feed),
            (out.0, out.1, Pace::Rapid),
        ]
    }

    #[test]
    fn rapids_over_the_bar_and_out_of_a_cut_are_clear() {
        let mut moves = groove((140.0, 150.0));
        moves.push((120.0, BAR + TOP + 18.5, Pace::Rapid));
        // Down into the groove, which lies deeper than the bar.
        moves.push((120.0, BAR + TOP + 12.5, Pace::Rapid));
        assert_eq!(follow(&moves).unwrap(), 4);
    }

    #[test]
    fn a_rapid_that_comes_too_near_or_through_is_named() {
        let refusal = |moves: &[_]| match follow(moves).unwrap_err() {
            CamError::Link { i_move, depth, .. } => (i_move, depth),
            other => panic!("{other}"),
        };
        let (i_move, depth) = refusal(&[(150.0, BAR + TOP + 8.0, Pace::Rapid)]);
        assert_eq!(i_move, 1);
        assert!((depth + 8.0).abs() < 0.1, "{depth} mm deep, 8 mm off");
        let (i_move, depth) = refusal(&[(150.0, BAR + TOP - 5.0, Pace::Rapid)]);
        assert_eq!(i_move, 1);
        assert!((depth - 5.0).abs() < 0.1, "{depth} mm deep, not 5");
        // Out of the groove along X, not up.
        let (i_move, depth) = refusal(&groove((170.0, BAR + TOP - 6.0)));
        assert_eq!(i_move, 4);
        assert!((depth - 6.0).abs() < 0.1, "{depth} mm deep, not 6");
    }
}
