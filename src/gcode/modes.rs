//! The modal words a program can rely on.

use super::MillimetreWord;

/// A modal state of the control that a [`Program`](super::Program) can ask for.
///
/// Inches and increments are missing on purpose: the reader turns them into millimetres and
/// absolute words, so that every program says what it says in one way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Words of linear axes are millimetres.
    Millimetres,
    /// Words are positions, not ways.
    Absolute,
    /// F is a speed per minute.
    PerMinute,
    /// F is one over the minutes a block takes, and each block has its own.
    InverseTime,
    /// Arcs lie in XY; stated although no arc is written.
    PlaneXy,
    /// No cutter radius compensation.
    NoRadiusOffset,
    /// No tool length offset: the programmed point is the one the toolpath was made for.
    NoLengthOffset,
    /// No canned cycle.
    NoCycle,
    /// The first work offset.
    WorkOffset,
}

impl Mode {
    /// All of them, in the order a line lists them.
    pub const ALL: [Self; 9] = [
        Self::Millimetres,
        Self::Absolute,
        Self::PerMinute,
        Self::InverseTime,
        Self::PlaneXy,
        Self::NoRadiusOffset,
        Self::NoLengthOffset,
        Self::NoCycle,
        Self::WorkOffset,
    ];

    /// The word for it, where millimetres are called `millimetres`.
    pub fn word(self, millimetres: MillimetreWord) -> &'static str {
        match self {
            Self::Millimetres => millimetres.word(),
            Self::Absolute => "G90",
            Self::PerMinute => "G94",
            Self::InverseTime => "G93",
            Self::PlaneXy => "G17",
            Self::NoRadiusOffset => "G40",
            Self::NoLengthOffset => "G49",
            Self::NoCycle => "G80",
            Self::WorkOffset => "G54",
        }
    }

    fn bit(self) -> u16 {
        1 << self as u16
    }

    /// The modes that cannot hold together with this one, itself included.
    fn group(self) -> u16 {
        match self {
            Self::PerMinute | Self::InverseTime => Self::PerMinute.bit() | Self::InverseTime.bit(),
            other => other.bit(),
        }
    }
}

/// A set of modes that hold together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Modes(u16);

impl Modes {
    /// Sets `mode`, in place of one that contradicts it.
    pub fn set(&mut self, mode: Mode) {
        self.0 = self.0 & !mode.group() | mode.bit();
    }

    /// Sets every mode of `other`.
    pub fn set_all(&mut self, other: Self) {
        other.iter().for_each(|mode| self.set(mode));
    }

    /// True if `mode` is set.
    pub fn contains(self, mode: Mode) -> bool {
        self.0 & mode.bit() != 0
    }

    /// True if no mode is set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The modes, in the order a line lists them.
    pub fn iter(self) -> impl Iterator<Item = Mode> {
        Mode::ALL.into_iter().filter(move |&mode| self.contains(mode))
    }
}

impl FromIterator<Mode> for Modes {
    fn from_iter<T: IntoIterator<Item = Mode>>(modes: T) -> Self {
        let mut set = Self::default();
        modes.into_iter().for_each(|mode| set.set(mode));
        set
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_feed_mode_replaces_the_other_and_nothing_else() {
        let mut modes: Modes = [Mode::Absolute, Mode::PerMinute].into_iter().collect();
        modes.set(Mode::InverseTime);
        let words: Vec<_> = modes.iter().map(|mode| mode.word(MillimetreWord::G21)).collect();
        assert_eq!(words, ["G90", "G93"]);
    }
}
