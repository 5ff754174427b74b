//! Axis words: where they send what, however the control calls it.

use super::Control;
use crate::gcode::line::{Line, Sorted};
use crate::gcode::number::round_to;
use crate::gcode::scan::Turning;
use crate::gcode::{BlockKind, DwellWord, Motion, MoveWords, Problem, Rotary};
use crate::machine::AxisKind;

/// More than any dialect writes.
const ANGLE_DECIMALS: u8 = 9;

impl Control<'_> {
    /// The move of a line: its axis words in millimetres and degrees, absolute.
    pub(super) fn move_words(
        &mut self,
        line: &Line,
        sorted: &Sorted,
    ) -> Result<Option<MoveWords>, (u32, Problem)> {
        let mut found = None;
        if sorted.rezeroes.is_some() {
            return Ok(None);
        }
        for (letter, word, column) in line.others() {
            if self.is_aside(letter, sorted) {
                continue;
            }
            let Some(i_axis) = self.axis_of[usize::from(letter - b'A')] else {
                return Err((column, self.unknown(letter)));
            };
            let motion = self.motion.ok_or((column, Problem::NoMotion))?;
            if sorted.dwells.is_some() {
                return Err((column, Problem::DwellMoves));
            }
            let to = self.position(i_axis, word, line.turning(letter), column)?;
            self.at[i_axis] = Some(to);
            let words = found.unwrap_or_else(|| MoveWords::new(motion));
            found = Some(words.with_axis(i_axis, to));
        }
        if found.is_some_and(|words: MoveWords| words.motion == Motion::Feed) {
            self.needs_feed(line)?;
        }
        Ok(found)
    }

    /// Where a word sends an axis [mm or deg].
    fn position(
        &self,
        i_axis: usize,
        word: f64,
        turning: Option<Turning>,
        column: u32,
    ) -> Result<f64, (u32, Problem)> {
        let axis = self.program.axes[i_axis];
        let at = || {
            let letter = axis.letter;
            self.at[i_axis].ok_or((column, Problem::UnknownStart { letter }))
        };
        if axis.kind == AxisKind::Linear {
            let by = self.incremental || turning == Some(Turning::By);
            return Ok(if by { at()? } else { 0.0 } + word * self.unit);
        }
        let modulo = (self.dialect.rotary == Rotary::Modulo).then_some(Turning::Shorter);
        let to = match (turning.or(modulo), self.at[i_axis]) {
            _ if self.incremental => at()? + word,
            (Some(Turning::By), _) => at()? + word,
            (Some(Turning::Shorter), Some(at)) => {
                let way = word - at;
                at + way - 360.0 * (way / 360.0).round()
            }
            (Some(Turning::Forwards), Some(at)) => at + (word - at).rem_euclid(360.0),
            (Some(Turning::Backwards), Some(at)) => at - (at - word).rem_euclid(360.0),
            (Some(_), None) => word,
            (None, _) => word + 360.0 * f64::from(self.turns[i_axis]),
        };
        // Sums of decimals are decimals again.
        Ok(round_to(to, ANGLE_DECIMALS))
    }

    /// True for an axis letter that is none on this line: the time of a pause, or a name.
    fn is_aside(&self, letter: u8, sorted: &Sorted) -> bool {
        match letter {
            b'X' => sorted.dwells.is_some() && self.dialect.dwell.word == DwellWord::XSeconds,
            b'O' => self.names_programs(),
            _ => false,
        }
    }

    /// Takes turns off what the position of an axis is called.
    pub(super) fn rezero(
        &mut self,
        line: &Line,
        sorted: &Sorted,
        number: u32,
    ) -> Result<(), (u32, Problem)> {
        let Some(column) = sorted.rezeroes else { return Ok(()) };
        for (letter, word, _) in line.others() {
            let i_axis = self.axis_of[usize::from(letter - b'A')];
            let i_axis = i_axis.ok_or((column, self.unknown(letter)))?;
            let rotary = self.program.axes[i_axis].kind == AxisKind::Rotary;
            let at = self.at[i_axis].filter(|_| rotary).ok_or((column, Problem::Rezero))?;
            let turns = (at - word) / 360.0;
            if (turns - turns.round()).abs() > 1e-9 || turns.abs() > 1e6 {
                return Err((column, Problem::Rezero));
            }
            let turns = turns.round() as i32;
            let off = turns - std::mem::replace(&mut self.turns[i_axis], turns);
            self.push(number, BlockKind::Rezero { i_axis, turns: off });
        }
        Ok(())
    }

    fn unknown(&self, letter: u8) -> Problem {
        let letter = char::from(letter);
        if "XYZABCUVW".contains(letter) {
            let letters: Vec<_> =
                self.program.axes.iter().map(|axis| axis.letter.to_string()).collect();
            Problem::NoSuchAxis { letter, axes: letters.join(" ") }
        } else {
            let known = "F G M N P S T and the axes of the machine";
            Problem::Unknown { word: letter.to_string(), known }
        }
    }
}
