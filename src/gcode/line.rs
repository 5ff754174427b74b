//! The words of one line, sorted by what they mean; nothing is carried out here.

use super::scan::{Scanner, Token, Turning};
use super::{Coolant, Language, MillimetreWord, Mode, Modes, Motion, Problem, SpindleRun};

/// The words of a line. Filled again and again, so that a long program allocates nothing per line.
#[derive(Default)]
pub(super) struct Line {
    pub(super) comments: Vec<Box<str>>,
    pub(super) percent: bool,
    /// G and M words: letter, tenfold number, column.
    codes: Vec<(char, u32, u32)>,
    /// All other words by their letter, A first: number and column.
    words: [Option<(f64, u32)>; 26],
    /// How they are meant, where that is said.
    turnings: [Option<Turning>; 26],
}

/// What the G and M words of a line ask for.
#[derive(Default)]
pub(super) struct Sorted {
    pub(super) modes: Modes,
    pub(super) inches: Option<bool>,
    pub(super) increments: Option<bool>,
    pub(super) motion: Option<Motion>,
    /// Column of G4.
    pub(super) dwells: Option<u32>,
    /// Column of M6.
    pub(super) changes_tool: Option<u32>,
    /// Column of M0.
    pub(super) stops: Option<u32>,
    /// Column of G92.
    pub(super) rezeroes: Option<u32>,
    pub(super) run: Option<SpindleRun>,
    pub(super) coolant: Option<Coolant>,
    pub(super) ends: bool,
}

impl Line {
    /// Takes in the words of `bytes` in place of those before.
    pub(super) fn fill(&mut self, bytes: &[u8], language: Language) -> Result<(), (u32, Problem)> {
        self.clear();
        let mut scanner = Scanner::new(bytes, language);
        while let Some((column, token)) = scanner.next_token()? {
            match token {
                Token::Percent => self.percent = true,
                Token::Comment(text) => {
                    self.comments.push(String::from_utf8_lossy(text).trim().into());
                }
                Token::Word(letter @ ('G' | 'M'), number) => {
                    self.add_code(letter, number, column)?;
                }
                Token::Word(letter, number) => self.add_word(letter, number, None, column)?,
                Token::Turn(letter, number, turning) => {
                    self.add_word(letter, number, Some(turning), column)?;
                }
            }
        }
        Ok(())
    }

    /// Forgets the words of the line before.
    pub(super) fn clear(&mut self) {
        self.comments.clear();
        self.percent = false;
        self.codes.clear();
        self.words = [None; 26];
        self.turnings = [None; 26];
    }

    /// Takes in a G or M word.
    pub(super) fn add_code(
        &mut self,
        letter: char,
        number: f64,
        column: u32,
    ) -> Result<(), (u32, Problem)> {
        let tenths = (number * 10.0).round();
        if !(0.0..1e4).contains(&tenths) || (number * 10.0 - tenths).abs() > 1e-9 {
            return Err((column, unknown(letter, number)));
        }
        self.codes.push((letter, tenths as u32, column));
        Ok(())
    }

    /// Takes in any other word, of an upper case letter.
    pub(super) fn add_word(
        &mut self,
        letter: char,
        number: f64,
        turning: Option<Turning>,
        column: u32,
    ) -> Result<(), (u32, Problem)> {
        let index = usize::from(letter as u8 - b'A');
        if self.words[index].replace((number, column)).is_some() {
            return Err((column, Problem::Twice { letter }));
        }
        self.turnings[index] = turning;
        Ok(())
    }

    /// The modes of a line that asks for nothing else, as a dialect lists them.
    pub(super) fn modes_alone(
        text: &str,
        millimetres: MillimetreWord,
    ) -> Result<Modes, (u32, Problem)> {
        let mut line = Self::default();
        line.fill(text.as_bytes(), Language::Iso)?;
        let sorted = line.sorted(millimetres)?;
        let asked = sorted.modes;
        // Inches and increments come out as modes too, but not as the ones they are.
        let all_modes = asked.iter().count() == line.codes.len()
            && sorted.inches != Some(true)
            && sorted.increments != Some(true);
        let nothing_else =
            line.comments.is_empty() && !line.percent && line.words.iter().all(Option::is_none);
        let is_modal = all_modes && nothing_else && !asked.is_empty();
        if is_modal { Ok(asked) } else { Err((1, Problem::NotModal)) }
    }

    /// The number behind `letter` and its column.
    pub(super) fn word(&self, letter: u8) -> Option<(f64, u32)> {
        self.words[usize::from(letter - b'A')]
    }

    /// How the number behind `letter` is meant, where that is said.
    pub(super) fn turning(&self, letter: u8) -> Option<Turning> {
        self.turnings[usize::from(letter - b'A')]
    }

    /// Letter, number and column of the words that are not F, N, P, S or T: those of axes.
    pub(super) fn others(&self) -> impl Iterator<Item = (u8, f64, u32)> {
        let letters = (b'A'..=b'Z').filter(|letter| !b"FNPST".contains(letter));
        letters.filter_map(|letter| self.word(letter).map(|(word, column)| (letter, word, column)))
    }

    /// What its G and M words ask for; two of one group contradict each other.
    pub(super) fn sorted(&self, millimetres: MillimetreWord) -> Result<Sorted, (u32, Problem)> {
        let mut sorted = Sorted::default();
        let units = millimetres.codes();
        let mut seen: [Option<(char, u32)>; Group::N] = [None; Group::N];
        for &(letter, tenths, column) in &self.codes {
            let group = match units.iter().position(|&unit| letter == 'G' && tenths == 10 * unit) {
                Some(i_unit) => sorted.take_unit(i_unit == 0),
                None => sorted.take(letter, tenths, column).map_err(|problem| (column, problem))?,
            };
            if let Some((first, first_tenths)) = seen[group as usize].replace((letter, tenths)) {
                let first = name(first, f64::from(first_tenths) / 10.0);
                let second = name(letter, f64::from(tenths) / 10.0);
                return Err((column, Problem::Conflict { first, second }));
            }
        }
        Ok(sorted)
    }
}

/// Modal groups: of each, a line has one word at most.
#[derive(Clone, Copy)]
enum Group {
    Motion,
    Dwell,
    Plane,
    Units,
    Distance,
    FeedMode,
    Radius,
    Length,
    Offset,
    Tool,
    Spindle,
    Coolant,
    End,
}

impl Group {
    const N: usize = Self::End as usize + 1;
}

impl Sorted {
    /// Takes in the word for inches, or for millimetres.
    fn take_unit(&mut self, inches: bool) -> Group {
        self.inches = Some(inches);
        self.modes.set(Mode::Millimetres);
        Group::Units
    }

    /// Takes in one code and says which group it is of.
    fn take(&mut self, letter: char, tenths: u32, column: u32) -> Result<Group, Problem> {
        let mut mode = |mode, group| {
            self.modes.set(mode);
            group
        };
        Ok(match (letter, tenths) {
            ('G', 170) => mode(Mode::PlaneXy, Group::Plane),
            ('G', 400) => mode(Mode::NoRadiusOffset, Group::Radius),
            ('G', 490) => mode(Mode::NoLengthOffset, Group::Length),
            ('G', 540) => mode(Mode::WorkOffset, Group::Offset),
            ('G', 800) => mode(Mode::NoCycle, Group::Motion),
            ('G', 930) => mode(Mode::InverseTime, Group::FeedMode),
            ('G', 940) => mode(Mode::PerMinute, Group::FeedMode),
            ('G', 900 | 910) => {
                self.increments = Some(tenths == 910);
                self.modes.set(Mode::Absolute);
                Group::Distance
            }
            ('G', 0 | 10) => {
                self.motion = Some(if tenths == 0 { Motion::Rapid } else { Motion::Feed });
                Group::Motion
            }
            ('G', 40) => {
                self.dwells = Some(column);
                Group::Dwell
            }
            ('G', 920) => {
                self.rezeroes = Some(column);
                Group::Dwell
            }
            ('M', 0) => {
                self.stops = Some(column);
                Group::Tool
            }
            ('M', 70 | 80 | 90) => {
                self.coolant = Some(match tenths {
                    70 => Coolant::Mist,
                    80 => Coolant::Flood,
                    _ => Coolant::Off,
                });
                Group::Coolant
            }
            ('M', 60) => {
                self.changes_tool = Some(column);
                Group::Tool
            }
            ('M', 30 | 40 | 50) => {
                self.run = Some(match tenths {
                    30 => SpindleRun::Clockwise,
                    40 => SpindleRun::CounterClockwise,
                    _ => SpindleRun::Stop,
                });
                Group::Spindle
            }
            ('M', 20 | 300) => {
                self.ends = true;
                Group::End
            }
            _ => return Err(unknown(letter, f64::from(tenths) / 10.0)),
        })
    }
}

fn unknown(letter: char, number: f64) -> Problem {
    let word = name(letter, number);
    match (letter, number) {
        ('G', 2.0 | 3.0) => Problem::Arc { word },
        ('G', _) => {
            let known = "G0 G1 G4 G17 G20 G21 G40 G49 G54 G80 G90 G91 G92 G93 G94";
            Problem::Unknown { word, known }
        }
        _ => Problem::Unknown { word, known: "M0 M2 M3 M4 M5 M6 M7 M8 M9 M30" },
    }
}

fn name(letter: char, number: f64) -> String {
    format!("{letter}{number}")
}
