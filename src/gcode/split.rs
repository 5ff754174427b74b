//! A program too large for its control, as several that run one after the other.
//!
//! Each part is a program of its own: it states its modes, mounts its tool, approaches and retreats
//! like the whole, so that any of them can be run, or run again, by itself.

use super::post::close;
use super::restart::farthest;
use super::write::Writer;
use super::{
    BlockKind, Coolant, Dialect, Motion, MoveWords, Program, RestartError, Spindle, SpindleRun,
    restart,
};
use crate::machine::Machine;

/// Room for the remark that tells the parts apart.
const REMARK: usize = 60;

/// Why a program cannot be split.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SplitError {
    /// Approach and retreat alone fill a part.
    #[error(
        "parts of {limit} bytes are too small: approach, one cut and retreat at line {line} need \
         {needed}; allow more"
    )]
    TooSmall {
        /// The most a part may have.
        limit: usize,
        /// The line a part would begin at.
        line: u32,
        /// What it needs.
        needed: usize,
    },
    /// There are more parts than numbers.
    #[error(
        "the parts would be numbered up to {last}, and controls take 9999; begin with a lower one"
    )]
    Numbers {
        /// The number of the last part.
        last: u32,
    },
    /// The program cannot be taken up where a part begins.
    #[error(transparent)]
    Restart(#[from] RestartError),
}

/// `program` in parts whose text in `dialect` has at most `limit` bytes each; itself, if that fits.
pub fn split(
    program: &Program,
    machine: &Machine,
    dialect: &Dialect,
    limit: usize,
) -> Result<Vec<Program>, SplitError> {
    let lengths = lengths(program, dialect);
    if lengths.iter().sum::<usize>() <= limit {
        return Ok(vec![program.clone()]);
    }
    let closing = closing(program, machine, dialect);
    let mut parts = Vec::new();
    let mut from = 0;
    while from < program.blocks.len() {
        let (mut part, n_before) = opened(program, machine, from)?;
        let before = bytes(&part.first(n_before), dialect) + REMARK;
        let room = Room { limit, before, closing: bytes(&closing, dialect) };
        let to = room.cut(program, &lengths, from)?;
        part.blocks.truncate(n_before + to - from);
        if to < program.blocks.len() {
            part.blocks.extend(closing.blocks.iter().cloned());
        }
        parts.push(part);
        from = to;
    }
    let n_parts = parts.len();
    for (i_part, part) in parts.iter_mut().enumerate() {
        name(part, i_part, n_parts)?;
    }
    Ok(parts)
}

/// What the text of a part is made of [bytes].
struct Room {
    limit: usize,
    before: usize,
    closing: usize,
}

impl Room {
    /// Where a part that begins at block `from` ends: before the last feed move that follows one
    /// and leaves room to retreat.
    fn cut(&self, program: &Program, lengths: &[usize], from: usize) -> Result<usize, SplitError> {
        let mut used = self.before;
        let mut cut = None;
        for (to, length) in lengths.iter().enumerate().skip(from) {
            if to > from && can_begin(program, to) && used + self.closing <= self.limit {
                cut = Some(to);
            }
            used += length;
            if used + self.closing > self.limit {
                break;
            }
        }
        let rest: usize = lengths[from..].iter().sum();
        if self.before + rest <= self.limit {
            return Ok(program.blocks.len());
        }
        let line = program.blocks[from].line;
        let first = (from + 1..program.blocks.len()).find(|&to| can_begin(program, to));
        let body: usize = lengths[from..first.unwrap_or(lengths.len())].iter().sum();
        let needed = self.before + body + self.closing;
        cut.ok_or(SplitError::TooSmall { limit: self.limit, line, needed })
    }
}

/// The program from block `from` on, and how many blocks stand before that one there.
fn opened(
    program: &Program,
    machine: &Machine,
    from: usize,
) -> Result<(Program, usize), RestartError> {
    if from == 0 {
        return Ok((program.clone(), 0));
    }
    let rest = restart(program, machine, program.blocks[from].line, None)?;
    let n_before = rest.blocks.len() - (program.blocks.len() - from);
    Ok((rest, n_before))
}

/// True if a part can begin at block `i`: a cut that goes on from another, on a line of its own.
fn can_begin(program: &Program, i: usize) -> bool {
    let cuts = |i: usize| match &program.blocks[i].kind {
        BlockKind::Move(words) => words.motion == Motion::Feed,
        _ => false,
    };
    i > 0 && cuts(i) && cuts(i - 1) && program.blocks[i - 1].line < program.blocks[i].line
}

/// Away from the part, everything off, the end.
fn closing(program: &Program, machine: &Machine, dialect: &Dialect) -> Program {
    let mut closing = program.first(0);
    let retract =
        MoveWords::new(Motion::Rapid).with_axis(machine.attack, farthest(program, machine));
    closing.push(BlockKind::Move(retract));
    let stop = Spindle { speed_rpm: None, run: Some(SpindleRun::Stop) };
    closing.push(BlockKind::Spindle(stop));
    if program.blocks.iter().any(|block| matches!(block.kind, BlockKind::Coolant(_))) {
        closing.push(BlockKind::Coolant(Coolant::Off));
    }
    close(&mut closing, dialect);
    closing
}

/// Tells the parts apart, by number and by a remark.
fn name(part: &mut Program, i_part: usize, n_parts: usize) -> Result<(), SplitError> {
    let mut blocks = part.blocks.iter_mut();
    if let Some(BlockKind::Number(number)) = blocks
        .find_map(|block| matches!(block.kind, BlockKind::Number(_)).then_some(&mut block.kind))
    {
        let last = number.saturating_add(i_part as u32);
        if last > 9999 {
            return Err(SplitError::Numbers { last });
        }
        *number = last;
    }
    let is_tape = |kind: &BlockKind| matches!(kind, BlockKind::Percent | BlockKind::Number(_));
    let n_tape = part.blocks.iter().take_while(|block| is_tape(&block.kind)).count();
    let remark = BlockKind::Comment(format!("part {} of {n_parts}", i_part + 1).into());
    part.blocks.insert(n_tape, super::Block { line: 0, kind: remark });
    for (line, block) in (1..).zip(&mut part.blocks) {
        block.line = line;
    }
    Ok(())
}

/// The length of each block's text.
fn lengths(program: &Program, dialect: &Dialect) -> Vec<usize> {
    let mut writer = Writer::new(program, dialect);
    let mut text = Vec::new();
    let mut length = |kind: &BlockKind| {
        text.clear();
        writer.push(&mut text, kind);
        text.len()
    };
    program.blocks.iter().map(|block| length(&block.kind)).collect()
}

fn bytes(program: &Program, dialect: &Dialect) -> usize {
    lengths(program, dialect).iter().sum()
}

impl Program {
    /// Its first `n` blocks.
    fn first(&self, n: usize) -> Self {
        let (axes, feeds) = (self.axes.clone(), self.feeds);
        Self { axes, feeds, blocks: self.blocks[..n].to_vec(), longest_line: None }
    }
}
