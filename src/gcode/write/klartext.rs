//! Heidenhain's plain text: `L X+12.5 A+370.0 F600.0`, calls and cycles by name.

use super::iso::{coolant_word, end_word, run_word};
use super::{Word, Writer};
use crate::gcode::number::push_fixed;
use crate::gcode::{BlockKind, Motion, MoveWords, Spindle};

impl Writer<'_> {
    /// Appends the lines of one block. Modes and rezeroing have no words there; the post and the
    /// dialect's rules see to it that none is asked for.
    pub(super) fn push_klartext(&self, text: &mut Vec<u8>, kind: &BlockKind) {
        match kind {
            BlockKind::Number(number) => {
                text.extend_from_slice(format!("BEGIN PGM HORMA{number:04} MM").as_bytes());
            }
            BlockKind::Percent => {
                text.extend_from_slice(format!("END PGM HORMA{:04} MM", self.name).as_bytes());
            }
            BlockKind::ToolChange(tool) => {
                text.extend_from_slice(format!("TOOL CALL {tool} Z").as_bytes());
            }
            BlockKind::Spindle(spindle) => self.push_tool_speed(text, *spindle),
            BlockKind::Coolant(coolant) => text.extend_from_slice(coolant_word(*coolant)),
            BlockKind::Feed(feed) => {
                text.extend_from_slice(b"L ");
                self.push_feed(text, *feed);
            }
            BlockKind::Dwell(seconds) => {
                text.extend_from_slice(b"CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL ");
                push_fixed(text, *seconds, self.dialect.dwell.decimals);
            }
            BlockKind::Move(words) => self.push_line(text, words),
            BlockKind::End => text.extend_from_slice(end_word(self.dialect.end)),
            BlockKind::Comment(_)
            | BlockKind::Modes(_)
            | BlockKind::Setup(_)
            | BlockKind::Smoothing(_)
            | BlockKind::Rezero { .. } => {}
        }
    }

    fn push_tool_speed(&self, text: &mut Vec<u8>, spindle: Spindle) {
        if let Some(speed) = spindle.speed_rpm {
            text.extend_from_slice(b"TOOL CALL S");
            push_fixed(text, speed, self.dialect.decimals.speed);
            text.push(b'\n');
        }
        if let Some(run) = spindle.run {
            text.extend_from_slice(run_word(run));
        }
    }

    fn push_line(&self, text: &mut Vec<u8>, words: &MoveWords) {
        text.push(b'L');
        for (i_axis, word) in self.words(words) {
            let (letter, decimals) = self.address(i_axis);
            let (before, value) = match word {
                Word::To(value) | Word::Shorter(value) => (" ", value),
                Word::By(value) => (" I", value),
            };
            text.extend_from_slice(before.as_bytes());
            text.push(letter);
            let from = text.len();
            push_fixed(text, value, decimals);
            if text.get(from) != Some(&b'-') {
                text.insert(from, b'+');
            }
        }
        match (words.motion, words.feed()) {
            (Motion::Rapid, _) => text.extend_from_slice(b" FMAX"),
            (Motion::Feed, Some(feed)) => {
                text.push(b' ');
                self.push_feed(text, feed);
            }
            (Motion::Feed, None) => {}
        }
    }
}
