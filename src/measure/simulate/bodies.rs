//! What of a tool does not cut, watched while the stock is cut.
//!
//! A body is compared with the stock as it stands before each piece of a move: what is in its way
//! then, nothing has cut. Stock only shrinks, so moves that would be clear of the stock as it is
//! *before all of them* are clear for good. Only where some would not be are they halved, down to
//! the piece that touches.

use crate::machine::{AxisKind, Machine};
use crate::progress::{Progress, Silent};
use crate::stock::{Crests, Cut, Stance, Stock, StockError, Sweep};
use crate::tool::{Cutter, Cylinder};
use rayon::prelude::*;

/// Bodies are looked at in places this far apart, at the block's greatest radius [mm].
const STRIDE: f64 = 2.0;
/// More pieces than this are not made of one move; they are longer instead.
const MOST_PIECES: f64 = 10_000.0;
/// A body may rub by this much to the side, or reach in so deep: rounding [mm].
const TOUCH: f64 = 0.02;

/// A tool with what of it does not cut.
pub(super) struct Bodied<'a> {
    pub(super) machine: &'a Machine,
    pub(super) cutter: &'a Cutter,
    pub(super) cylinders: &'a [Cylinder],
    /// After so many hits nobody looks any more.
    pub(super) most_hits: usize,
}

/// A move on which material reaches into a part of the tool's body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    pub(super) i_sweep: usize,
    pub(super) cylinder: Cylinder,
    /// How deep, along a ray [mm].
    pub(super) depth: f64,
}

/// Cuts `sweeps`, and tells what each took and where a body was in the way.
pub(super) fn remove_beside(
    stock: &mut Stock,
    tool: &Bodied,
    sweeps: &[Sweep],
    progress: &dyn Progress,
) -> Result<(Vec<Cut>, Vec<Hit>), StockError> {
    let pieces: Vec<Piece> = sweeps
        .iter()
        .enumerate()
        .flat_map(|(i, sweep)| pieces(tool.machine, stock.layout().reach(), i, sweep))
        .collect();
    let mut watch =
        Watch { stock, tool, cuts: vec![Cut::default(); sweeps.len()], hits: Vec::new(), progress };
    watch.run(&pieces)?;
    Ok((watch.cuts, watch.hits))
}

/// A piece of a move.
pub(super) struct Piece {
    pub(super) sweep: Sweep,
    i_sweep: usize,
    is_last: bool,
}

/// The stock while it is cut.
struct Watch<'a> {
    stock: &'a mut Stock,
    tool: &'a Bodied<'a>,
    cuts: Vec<Cut>,
    hits: Vec<Hit>,
    progress: &'a dyn Progress,
}

impl Watch<'_> {
    fn run(&mut self, pieces: &[Piece]) -> Result<(), StockError> {
        if self.hits.len() >= self.tool.most_hits || !self.touches(pieces)? {
            return self.remove(pieces);
        }
        if let [piece] = pieces {
            let hits = self.hits_of(&self.stock.crests(), piece)?;
            for hit in hits {
                self.keep(hit);
            }
            return self.remove(pieces);
        }
        let (first, second) = pieces.split_at(pieces.len() / 2);
        self.run(first)?;
        self.run(second)
    }

    /// True if a body would be in the way on any of the pieces, were nothing cut before.
    fn touches(&self, pieces: &[Piece]) -> Result<bool, StockError> {
        let crests = self.stock.crests();
        let touches = |piece: &Piece| match self.hits_of(&crests, piece) {
            Ok(hits) if hits.is_empty() => None,
            Ok(_) => Some(Ok(())),
            Err(problem) => Some(Err(problem)),
        };
        let found: Option<()> = pieces.par_iter().find_map_any(touches).transpose()?;
        Ok(found.is_some())
    }

    fn hits_of(&self, crests: &Crests, piece: &Piece) -> Result<Vec<Hit>, StockError> {
        let stance = Stance::at(self.tool.machine, &piece.sweep.to);
        let mut hits = Vec::new();
        for cylinder in self.tool.cylinders {
            let slimmer = Cylinder { radius: (cylinder.radius - TOUCH).max(0.0), ..*cylinder };
            let depth = self.stock.depth_in(crests, &stance, &slimmer)?;
            if depth > TOUCH + 2.0 * self.stock.sweep_error() {
                hits.push(Hit { i_sweep: piece.i_sweep, cylinder: *cylinder, depth });
            }
        }
        Ok(hits)
    }

    /// The deepest hit of each move and part.
    fn keep(&mut self, hit: Hit) {
        let same = |kept: &&mut Hit| kept.i_sweep == hit.i_sweep && kept.cylinder == hit.cylinder;
        let n = self.tool.cylinders.len();
        match self.hits.iter_mut().rev().take(n).find(same) {
            Some(kept) => kept.depth = kept.depth.max(hit.depth),
            None => self.hits.push(hit),
        }
    }

    fn remove(&mut self, pieces: &[Piece]) -> Result<(), StockError> {
        let sweeps: Vec<Sweep> = pieces.iter().map(|piece| piece.sweep).collect();
        // Pieces are not what the progress counts.
        let cuts = self.stock.remove(self.tool.machine, self.tool.cutter, &sweeps, &Silent)?;
        for (piece, cut) in pieces.iter().zip(cuts) {
            self.cuts[piece.i_sweep].add(&cut);
        }
        let n_moves = pieces.iter().filter(|piece| piece.is_last).count();
        Ok(self.progress.advance(n_moves as u64)?)
    }
}

/// A move in pieces no longer than the stride, at `lever` from the axis of what turns.
pub(super) fn pieces(
    machine: &Machine,
    lever: f64,
    i_sweep: usize,
    sweep: &Sweep,
) -> impl Iterator<Item = Piece> {
    let way = |(index, axis): (usize, &crate::machine::Axis)| {
        let way = (sweep.to[index] - sweep.from[index]).abs();
        if axis.kind == AxisKind::Rotary { way * lever } else { way }
    };
    let way: f64 = machine.axes.iter().enumerate().map(way).sum();
    let n = (way / STRIDE).ceil().clamp(1.0, MOST_PIECES) as usize;
    let whole = *sweep;
    let place = move |i: usize| whole.at(i as f64 / n as f64);
    (0..n).map(move |i| Piece {
        sweep: Sweep { from: place(i), to: place(i + 1), engages: whole.engages && i == 0 },
        i_sweep,
        is_last: i + 1 == n,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Aabb, Point3};
    use crate::stock::{Layout, Resolution};
    use crate::tool::{Axle, BodyPart, Profile};

    /// A block 40 mm high on a mill, a flat tool 6 mm wide, and its body.
    fn run(
        body: &[Cylinder],
        places: &[[f64; 3]],
        most_hits: usize,
    ) -> (Vec<Cut>, Vec<Hit>, Stock) {
        let machine = Machine::builtin("mill-3axis").unwrap();
        let block = Aabb { min: Point3::new(0.0, 0.0, 0.0), max: Point3::new(80.0, 40.0, 40.0) };
        let layout = Layout::new(&machine, &machine.at_rest(), &block, Resolution::even(0.5));
        let mut stock = Stock::cylinder(layout.unwrap(), 1.0);
        let cutter = Profile::Flat { radius: 3.0 }.cutter(0.0);
        let at = |[x, y, z]: [f64; 3]| [x, y, z, 0.0, 0.0, 0.0];
        let sweeps: Vec<Sweep> = places
            .windows(2)
            .enumerate()
            .map(|(i, pair)| Sweep { from: at(pair[0]), to: at(pair[1]), engages: i == 0 })
            .collect();
        let tool = Bodied { machine: &machine, cutter: &cutter, cylinders: body, most_hits };
        let (cuts, hits) = remove_beside(&mut stock, &tool, &sweeps, &Silent).unwrap();
        (cuts, hits, stock)
    }

    fn part(part: BodyPart, radius: f64, stretch: [f64; 2]) -> Cylinder {
        Cylinder { part, axle: Axle::Attack, radius, stretch }
    }

    #[test]
    fn a_shank_rubs_where_a_slot_is_milled_deeper_than_its_flutes_but_not_in_a_slot_there_is() {
        let shank = part(BodyPart::Shank, 3.0, [10.0, 60.0]);
        // In layers of 8 mm the flutes of 10 mm are long enough, though the slot gets 16 mm deep.
        let layers =
            [[-10.0, 20.0, 32.0], [90.0, 20.0, 32.0], [90.0, 20.0, 24.0], [-10.0, 20.0, 24.0]];
        let (_, hits, _) = run(&[shank], &layers, 9);
        assert_eq!(hits, []);
        // At once they are not: 6 mm of material stand above them, from where the tool enters on.
        let at_once = [[-10.0, 20.0, 24.0], [20.0, 20.0, 24.0], [40.0, 20.0, 24.0]];
        let (_, hits, _) = run(&[shank], &at_once, 9);
        let found: Vec<_> =
            hits.iter().map(|hit| (hit.i_sweep, (hit.depth * 1e6).round())).collect();
        assert_eq!(found, [(0, 6e6), (1, 6e6)]);
        assert_eq!(run(&[shank], &at_once, 1).1.len(), 1);
    }

    #[test]
    fn a_holder_is_in_the_way_only_while_there_is_material_for_it_to_meet() {
        let holder = part(BodyPart::Holder, 12.0, [30.0, 80.0]);
        // Over the block it would stand 5 mm deep in it; beyond its edge it does not.
        let over = [[-30.0, 20.0, 5.0], [-16.0, 20.0, 5.0]];
        assert_eq!(run(&[holder], &over, 9).1, []);
        let into = [[-30.0, 20.0, 5.0], [-11.0, 20.0, 5.0]];
        let (_, hits, _) = run(&[holder], &into, 9);
        let [hit] = hits[..] else { panic!("{hits:?}") };
        assert!((hit.depth - 5.0).abs() < 1e-9 && hit.cylinder.part == BodyPart::Holder);
    }

    #[test]
    fn pieces_take_together_what_the_whole_move_takes() {
        let places = [[-10.0, 20.0, 35.0], [90.0, 25.0, 30.0], [90.0, 10.0, 30.0]];
        let far = part(BodyPart::Holder, 5.0, [100.0, 200.0]);
        let (watched, _, with) = run(&[far], &places, 9);
        let (plain, _, without) = run(&[far], &places, 0);
        assert!((with.volume() - without.volume()).abs() < 1e-6);
        for (a, b) in watched.iter().zip(&plain) {
            assert!((a.removed - b.removed).abs() < 1e-6 && (a.depth - b.depth).abs() < 1e-6);
        }
        let removed: f64 = watched.iter().map(|cut| cut.removed).sum();
        assert!((80.0 * 40.0 * 40.0 - with.volume() - removed).abs() < 1e-6);
    }
}
