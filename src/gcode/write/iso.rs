//! Letters and numbers, and the few things Siemens writes otherwise.

use super::{Tape, Word, Writer};
use crate::gcode::number::{push_digits, push_fixed};
use crate::gcode::{
    BlockKind, Coolant, DwellWord, EndWord, Language, Motion, MoveWords, Spindle, SpindleRun,
    ToolChange,
};

impl Writer<'_> {
    /// Appends the line of one block.
    pub(super) fn push_iso(&self, text: &mut Vec<u8>, kind: &BlockKind) {
        match kind {
            BlockKind::Modes(modes) => {
                for (i, mode) in modes.iter().enumerate() {
                    text.extend_from_slice(if i == 0 { b"" } else { b" " });
                    text.extend_from_slice(mode.word(self.dialect.millimetres).as_bytes());
                }
            }
            BlockKind::ToolChange(tool) => {
                let change = match self.dialect.tool_change {
                    ToolChange::Automatic => "M6",
                    ToolChange::ByHand => "M0",
                };
                text.extend_from_slice(format!("T{tool} {change}").as_bytes());
            }
            BlockKind::Spindle(spindle) => self.push_spindle(text, *spindle),
            BlockKind::Coolant(coolant) => text.extend_from_slice(coolant_word(*coolant)),
            BlockKind::Feed(feed) => self.push_feed(text, *feed),
            BlockKind::Dwell(seconds) => self.push_dwell(text, *seconds),
            BlockKind::Move(words) => self.push_move(text, words),
            BlockKind::Rezero { i_axis, turns } => {
                let (letter, decimals) = self.address(*i_axis);
                let at = self.at[*i_axis].unwrap_or_default();
                text.extend_from_slice(&[b'G', b'9', b'2', b' ', letter]);
                let turns = f64::from(self.turns[*i_axis] + turns);
                push_fixed(text, at - 360.0 * turns, decimals);
            }
            BlockKind::Number(number) if self.dialect.tape == Tape::PercentNumber => {
                text.extend_from_slice(format!("O{number:04}").as_bytes());
            }
            BlockKind::Percent => text.push(b'%'),
            BlockKind::End => text.extend_from_slice(end_word(self.dialect.end)),
            // Without a word for it, or written by all languages alike.
            BlockKind::Number(_)
            | BlockKind::Comment(_)
            | BlockKind::Setup(_)
            | BlockKind::Smoothing(_) => {}
        }
    }

    fn push_spindle(&self, text: &mut Vec<u8>, spindle: Spindle) {
        if let Some(speed) = spindle.speed_rpm {
            text.push(b'S');
            push_fixed(text, speed, self.dialect.decimals.speed);
        }
        if let Some(run) = spindle.run {
            text.extend_from_slice(if spindle.speed_rpm.is_some() { b" " } else { b"" });
            text.extend_from_slice(run_word(run));
        }
    }

    fn push_dwell(&self, text: &mut Vec<u8>, seconds: f64) {
        let (word, value) = match self.dialect.dwell.word {
            DwellWord::PSeconds | DwellWord::Cycle9 => (b'P', seconds),
            DwellWord::PMilliseconds => (b'P', 1000.0 * seconds),
            DwellWord::XSeconds => (b'X', seconds),
            DwellWord::FSeconds => (b'F', seconds),
        };
        text.extend_from_slice(&[b'G', b'4', b' ', word]);
        push_fixed(text, value, self.dialect.dwell.decimals);
    }

    fn push_move(&self, text: &mut Vec<u8>, words: &MoveWords) {
        text.extend_from_slice(match words.motion {
            Motion::Rapid => b"G0",
            Motion::Feed => b"G1",
        });
        let siemens = self.dialect.language == Language::Siemens;
        for (i_axis, word) in self.words(words) {
            let (letter, decimals) = self.address(i_axis);
            text.extend_from_slice(&[b' ', letter]);
            let (open, value) = match word {
                Word::Shorter(value) if siemens => ("=DC(", value),
                Word::By(value) => ("=IC(", value),
                Word::To(value) | Word::Shorter(value) => ("", value),
            };
            text.extend_from_slice(open.as_bytes());
            push_fixed(text, value, decimals);
            text.extend_from_slice(if open.is_empty() { b"" } else { b")" });
        }
        if let Some(feed) = words.feed() {
            text.push(b' ');
            self.push_feed(text, feed);
        }
    }

    /// Appends an F word.
    pub(super) fn push_feed(&self, text: &mut Vec<u8>, feed: f64) {
        text.push(b'F');
        push_digits(text, feed, self.dialect.feed.digits, self.dialect.feed.decimals);
    }
}

/// The word for a coolant.
pub(super) fn coolant_word(coolant: Coolant) -> &'static [u8] {
    match coolant {
        Coolant::Off => b"M9",
        Coolant::Mist => b"M7",
        Coolant::Flood => b"M8",
    }
}

/// The word that starts or stops the spindle.
pub(super) fn run_word(run: SpindleRun) -> &'static [u8] {
    match run {
        SpindleRun::Clockwise => b"M3",
        SpindleRun::CounterClockwise => b"M4",
        SpindleRun::Stop => b"M5",
    }
}

/// The last word.
pub(super) fn end_word(end: EndWord) -> &'static [u8] {
    match end {
        EndWord::M2 => b"M2",
        EndWord::M30 => b"M30",
    }
}
