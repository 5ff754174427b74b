//! Lines that a dialect lists and nobody else knows: its setup, and its words for smoothing.

use crate::gcode::{BlockKind, Dialect};

/// The lines a dialect lists.
pub(super) struct Phrases {
    phrases: Vec<Phrase>,
    /// The line looked at, without blanks, in capitals.
    plain: Vec<u8>,
}

/// What a listed line says.
#[derive(Debug, PartialEq)]
pub(super) enum Listed {
    /// This.
    Says(BlockKind),
    /// Nothing by itself: another line of the same phrase does.
    Part,
}

/// One line of a dialect: what stands before its number and behind, and what it means.
struct Phrase {
    before: Vec<u8>,
    after: Vec<u8>,
    has_number: bool,
    meaning: Meaning,
}

enum Meaning {
    Setup(Box<str>),
    /// Smooths by this, unless the line says by how much [mm].
    Smooth(f64),
    Exact,
    /// One of several lines that mean something together, and not the one that counts.
    Part,
}

impl Phrases {
    pub(super) fn new(dialect: &Dialect) -> Self {
        let setup = dialect.setup.iter().map(|line| (line, Meaning::Setup(line.as_str().into())));
        let mut listed: Vec<(&String, Meaning)> = setup.collect();
        if let Some(smoothing) = &dialect.smoothing {
            let counts = |lines: &[String]| {
                let numbered = lines.iter().position(|line| line.contains("{}"));
                numbered.unwrap_or(lines.len().saturating_sub(1))
            };
            let (on, off) = (counts(&smoothing.on), counts(&smoothing.off));
            listed.extend(smoothing.on.iter().enumerate().map(|(i, line)| {
                let smooths = Meaning::Smooth(smoothing.tolerance);
                (line, if i == on { smooths } else { Meaning::Part })
            }));
            listed.extend(
                smoothing
                    .off
                    .iter()
                    .enumerate()
                    .map(|(i, line)| (line, if i == off { Meaning::Exact } else { Meaning::Part })),
            );
        }
        let phrases = listed.into_iter().map(|(line, meaning)| Phrase::new(line, meaning));
        Self { phrases: phrases.collect(), plain: Vec::new() }
    }

    /// What a line says, if the dialect lists it.
    pub(super) fn find(&mut self, line: &[u8]) -> Option<Listed> {
        if self.phrases.is_empty() {
            return None;
        }
        self.plain.clear();
        let solid = line.iter().filter(|byte| !byte.is_ascii_whitespace());
        self.plain.extend(solid.map(u8::to_ascii_uppercase));
        let bare = without_number(&self.plain);
        self.phrases.iter().find_map(|phrase| phrase.read(bare))
    }
}

impl Phrase {
    fn new(line: &str, meaning: Meaning) -> Self {
        let solid = |part: &str| {
            let bytes = part.bytes().filter(|byte| !byte.is_ascii_whitespace());
            bytes.map(|byte| byte.to_ascii_uppercase()).collect()
        };
        let (before, after) = line.split_once("{}").unwrap_or((line, ""));
        let has_number = line.contains("{}");
        Self { before: solid(before), after: solid(after), has_number, meaning }
    }

    fn read(&self, line: &[u8]) -> Option<Listed> {
        let middle = line.strip_prefix(&self.before[..])?.strip_suffix(&self.after[..])?;
        let number = if self.has_number {
            let number: f64 = str::from_utf8(middle).ok()?.parse().ok()?;
            Some(number).filter(|number| number.is_finite() && *number >= 0.0).map(Some)?
        } else {
            middle.is_empty().then_some(None)?
        };
        Some(match &self.meaning {
            Meaning::Setup(line) => Listed::Says(BlockKind::Setup(line.clone())),
            Meaning::Smooth(usual) => {
                Listed::Says(BlockKind::Smoothing(Some(number.unwrap_or(*usual))))
            }
            Meaning::Exact => Listed::Says(BlockKind::Smoothing(None)),
            Meaning::Part => Listed::Part,
        })
    }
}

/// What stands behind the number of a line, with an N or without.
fn without_number(line: &[u8]) -> &[u8] {
    let digits = line.strip_prefix(b"N").unwrap_or(line);
    let n_digits = digits.iter().take_while(|byte| byte.is_ascii_digit()).count();
    if n_digits == 0 { line } else { &digits[n_digits..] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(dialect: &str, line: &str) -> Option<Listed> {
        Phrases::new(&Dialect::named(dialect).unwrap()).find(line.as_bytes())
    }

    #[test]
    fn a_tolerance_is_read_where_the_dialect_has_it() {
        let smooth = |tolerance| Some(Listed::Says(BlockKind::Smoothing(Some(tolerance))));
        assert_eq!(found("linuxcnc", "n10 g64p0.02"), smooth(0.02));
        assert_eq!(found("fanuc", "G5.1 Q1"), smooth(0.01));
        assert_eq!(found("fanuc", "G5.1 Q0"), Some(Listed::Says(BlockKind::Smoothing(None))));
        assert_eq!(found("siemens-840d", "N20 CYCLE832(0.05,_FINISH,1)"), smooth(0.05));
        assert_eq!(found("heidenhain", "7 CYCL DEF 32.0 TOLERANCE"), Some(Listed::Part));
        assert_eq!(found("heidenhain", "8 CYCL DEF 32.1 T0.02"), smooth(0.02));
    }

    #[test]
    fn other_lines_are_left_to_the_reader() {
        for line in ["G64", "G64 P", "G64 Px", "G64 P0.1 G54", "G64 P-1", "N10", ""] {
            assert_eq!(found("linuxcnc", line), None, "{line}");
        }
        assert_eq!(found("grbl", "G64 P0.1"), None);
    }

    #[test]
    fn a_setup_line_is_kept_as_the_dialect_has_it() {
        let setup = Some(Listed::Says(BlockKind::Setup("SOFT".into())));
        assert_eq!(found("siemens-840d", "n40 soft"), setup);
    }
}
