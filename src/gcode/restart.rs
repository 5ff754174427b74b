//! A program that takes up another one in its midst.

use super::number::round_to;
use super::{
    BlockKind, Coolant, Mode, Modes, Motion, MoveWords, Position, Program, Spindle, StepKind,
};
use crate::machine::{MAX_AXES, Machine};

/// Why a program cannot be taken up where it should be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RestartError {
    /// Nothing is cut from there on.
    #[error("nothing is cut from line {line} on; the last cut is in line {last}")]
    NothingLeft {
        /// The line asked for.
        line: u32,
        /// The line of the last feed move; 0 if there is none.
        last: u32,
    },
    /// The machine's position there is unknown.
    #[error(
        "line {line} stands before the program has placed {axis}; run the program from its start"
    )]
    NotPlaced {
        /// The line asked for.
        line: u32,
        /// The axis.
        axis: char,
    },
    /// No feed for the way down.
    #[error("the program has no plunge feed (an F under G94); give one")]
    NoPlungeFeed,
    /// A feed that is none.
    #[error("the plunge feed {feed} mm/min must be a number greater than 0")]
    PlungeFeed {
        /// The feed asked for [mm/min].
        feed: f64,
    },
}

/// The rest of `program` from `line` on, with a safe approach in front of it.
///
/// The attack axis goes first, to the farthest word `program` takes it to; then tool and spindle as
/// they were there, the other axes to where they stood before `line`, and a plunge at `plunge_feed`
/// [mm/min], or else at the feed of the nearest G94 move, at or before `line` if there is one. Where
/// whole turns were taken off an axis, angles are called as they were there.
pub fn restart(
    program: &Program,
    machine: &Machine,
    line: u32,
    plunge_feed: Option<f64>,
) -> Result<Program, RestartError> {
    let scene = Scene::at(program, machine, line)?;
    let plunge_feed = match plunge_feed.or(scene.plunge_feed) {
        Some(feed) if feed.is_finite() && feed > 0.0 => feed,
        Some(feed) => return Err(RestartError::PlungeFeed { feed }),
        None => return Err(RestartError::NoPlungeFeed),
    };
    let (axes, feeds) = (program.axes.clone(), program.feeds);
    let mut rest = Program { axes, feeds, ..Program::default() };
    scene.open(&mut rest, program, line);
    scene.approach(&mut rest, machine.attack, plunge_feed);
    for block in &program.blocks[scene.i_block..] {
        rest.push(scene.renamed(&block.kind));
    }
    Ok(rest)
}

/// What holds just before the block a program is taken up at.
struct Scene {
    /// The block.
    i_block: usize,
    modes: Modes,
    setup: Vec<Box<str>>,
    smoothing: Option<f64>,
    coolant: Option<Coolant>,
    /// How many turns were taken off each axis.
    turns: [i32; MAX_AXES],
    /// The modal feed, under G94.
    feed: Option<f64>,
    plunge_feed: Option<f64>,
    tool: Option<u32>,
    spindle: Spindle,
    /// Where the axes stand [mm or deg].
    at: [f64; MAX_AXES],
    /// Where the attack axis is out of the way [mm].
    clear: f64,
}

impl Scene {
    fn at(program: &Program, machine: &Machine, line: u32) -> Result<Self, RestartError> {
        let last = program.steps(machine).filter(|step| step.kind == StepKind::Feed).last();
        let last = last.map_or(0, |step| step.line);
        if last < line || last == 0 {
            return Err(RestartError::NothingLeft { line, last });
        }
        let i_block = program.blocks.partition_point(|block| block.line < line);
        let mut scene = Self {
            i_block,
            modes: Modes::default(),
            setup: Vec::new(),
            smoothing: None,
            coolant: None,
            turns: [0; MAX_AXES],
            feed: None,
            plunge_feed: None,
            tool: None,
            spindle: Spindle { speed_rpm: None, run: None },
            at: [0.0; MAX_AXES],
            clear: farthest(program, machine),
        };
        let mut words = [None; MAX_AXES];
        for block in &program.blocks[..i_block] {
            scene.take(&block.kind, &mut words);
        }
        for (i_axis, axis) in program.axes.iter().enumerate() {
            let unplaced = RestartError::NotPlaced { line, axis: axis.letter };
            scene.at[i_axis] = scene.renamed_word(i_axis, words[i_axis].ok_or(unplaced)?);
        }
        scene.plunge_feed = scene.plunge_feed.or_else(|| first_plunge_feed(program));
        Ok(scene)
    }

    /// Lets a block change the scene.
    fn take(&mut self, kind: &BlockKind, words: &mut Position) {
        match kind {
            BlockKind::Modes(modes) => {
                let before = self.modes.contains(Mode::InverseTime);
                self.modes.set_all(*modes);
                if before != self.modes.contains(Mode::InverseTime) {
                    self.feed = None;
                }
            }
            BlockKind::Feed(feed) => self.feed = Some(*feed),
            BlockKind::ToolChange(tool) => {
                self.tool = Some(*tool);
                self.spindle.run = None;
            }
            BlockKind::Spindle(Spindle { speed_rpm, run }) => {
                self.spindle.speed_rpm = speed_rpm.or(self.spindle.speed_rpm);
                self.spindle.run = run.or(self.spindle.run);
            }
            BlockKind::Move(step) => {
                for (i_axis, word) in words.iter_mut().enumerate() {
                    *word = step.axis(i_axis).or(*word);
                }
                if !self.modes.contains(Mode::InverseTime) {
                    self.feed = step.feed().or(self.feed);
                    self.plunge_feed = self.feed.or(self.plunge_feed);
                }
            }
            BlockKind::Setup(line) => self.setup.push(line.clone()),
            BlockKind::Smoothing(tolerance) => self.smoothing = *tolerance,
            BlockKind::Coolant(coolant) => {
                self.coolant = Some(*coolant).filter(|coolant| *coolant != Coolant::Off);
            }
            BlockKind::Rezero { i_axis, turns } => self.turns[*i_axis] += turns,
            BlockKind::Comment(_)
            | BlockKind::Number(_)
            | BlockKind::Dwell(_)
            | BlockKind::Percent
            | BlockKind::End => {}
        }
    }

    /// A block with its angles as they are called once turns were taken off.
    fn renamed(&self, kind: &BlockKind) -> BlockKind {
        match kind {
            BlockKind::Move(words) if self.turns != [0; MAX_AXES] => {
                let named = (0..MAX_AXES).filter_map(|i| Some((i, words.axis(i)?)));
                BlockKind::Move(named.fold(*words, |words, (i_axis, word)| {
                    words.with_axis(i_axis, self.renamed_word(i_axis, word))
                }))
            }
            other => other.clone(),
        }
    }

    fn renamed_word(&self, i_axis: usize, word: f64) -> f64 {
        match self.turns[i_axis] {
            0 => word,
            // Differences of decimals are decimals again.
            turns => round_to(word - 360.0 * f64::from(turns), 9),
        }
    }

    /// Comments and modes, feeds per minute.
    fn open(&self, rest: &mut Program, program: &Program, line: u32) {
        let kinds = program.blocks.iter().map(|block| &block.kind);
        let opens = |kind: &&BlockKind| {
            matches!(kind, BlockKind::Comment(_) | BlockKind::Percent | BlockKind::Number(_))
        };
        let head = kinds.take_while(opens);
        for kind in head.take(self.i_block) {
            rest.push(kind.clone());
        }
        let text = format!("taken up at line {line}; the figures above are of the whole program");
        rest.push(BlockKind::Comment(text.into()));
        let mut modes: Modes = [Mode::Millimetres, Mode::Absolute].into_iter().collect();
        modes.set_all(self.modes);
        modes.set(Mode::PerMinute);
        rest.push(BlockKind::Modes(modes));
        for line in &self.setup {
            rest.push(BlockKind::Setup(line.clone()));
        }
        if self.smoothing.is_some() {
            rest.push(BlockKind::Smoothing(self.smoothing));
        }
    }

    /// The way to where the program is taken up, and the feed mode it goes on in.
    fn approach(&self, rest: &mut Program, attack: usize, plunge_feed: f64) {
        let rapid = || MoveWords::new(Motion::Rapid);
        let retract = BlockKind::Move(rapid().with_axis(attack, self.clear));
        rest.push(retract.clone());
        if let Some(tool) = self.tool {
            rest.push(BlockKind::ToolChange(tool));
        }
        if self.spindle != (Spindle { speed_rpm: None, run: None }) {
            rest.push(BlockKind::Spindle(self.spindle));
        }
        if let Some(coolant) = self.coolant {
            rest.push(BlockKind::Coolant(coolant));
        }
        // A tool change may have moved the machine anywhere.
        rest.push(retract);
        let others = (0..rest.axes.len()).filter(|&i_axis| i_axis != attack);
        let over = others.fold(rapid(), |words, i| words.with_axis(i, self.at[i]));
        rest.push(BlockKind::Move(over));
        if self.at[attack] != self.clear {
            let down = MoveWords::new(Motion::Feed).with_axis(attack, self.at[attack]);
            rest.push(BlockKind::Move(down.with_feed(plunge_feed)));
        }
        if self.modes.contains(Mode::InverseTime) {
            rest.push(BlockKind::Modes([Mode::InverseTime].into_iter().collect()));
        } else if let Some(feed) = self.feed {
            rest.push(BlockKind::Feed(feed));
        }
    }
}

/// The attack word farthest from the part that the program takes the axis to.
pub(super) fn farthest(program: &Program, machine: &Machine) -> f64 {
    let away = machine.axes.get(machine.attack).map_or(1.0, |axis| axis.sign);
    let words = program.blocks.iter().filter_map(|block| match &block.kind {
        BlockKind::Move(words) => words.axis(machine.attack),
        _ => None,
    });
    away * words.map(|word| away * word).fold(f64::NEG_INFINITY, f64::max)
}

/// The first feed that a program gives under G94.
fn first_plunge_feed(program: &Program) -> Option<f64> {
    let mut inverse_time = false;
    program.blocks.iter().find_map(|block| match &block.kind {
        BlockKind::Modes(modes) => {
            inverse_time = modes.contains(Mode::InverseTime)
                || inverse_time && !modes.contains(Mode::PerMinute);
            None
        }
        BlockKind::Feed(feed) => Some(*feed),
        BlockKind::Move(words) if !inverse_time => words.feed(),
        _ => None,
    })
}
