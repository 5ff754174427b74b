//! From the bytes of a line to its words and comments.

use super::Language;

/// What is wrong with a place in a program.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A character that begins no word.
    #[error("{0:?} begins no word; words are a letter and a number, like X12.5")]
    Character(char),
    /// A letter without a number behind it.
    #[error("no number after {letter}; words are a letter and a number, like X12.5")]
    NoNumber {
        /// The letter.
        letter: char,
    },
    /// A parameter or an expression.
    #[error("parameters and expressions (# and [ ]) are not read yet; write the number itself")]
    Expression,
    /// `(` without `)`.
    #[error("this comment is not closed; add a ) on the same line")]
    OpenComment,
    /// A line no control would take.
    #[error("the line is longer than {limit} bytes; this is no program a control would read")]
    LineTooLong {
        /// The most a line may have.
        limit: usize,
    },
    /// A word that is not understood.
    #[error("{word} is not read yet; the reader knows {known}")]
    Unknown {
        /// The word.
        word: String,
        /// What is known of its kind.
        known: &'static str,
    },
    /// An arc.
    #[error("{word} arcs are not read yet; write them as short straight moves")]
    Arc {
        /// The word.
        word: String,
    },
    /// A word a line has already.
    #[error("the line has {letter} twice")]
    Twice {
        /// The letter.
        letter: char,
    },
    /// Two words of one modal group.
    #[error("{second} contradicts {first} on the same line; keep one of them")]
    Conflict {
        /// The word that stands first.
        first: String,
        /// The word that contradicts it.
        second: String,
    },
    /// A word of an axis the machine has not.
    #[error("the machine has no axis {letter}; it has {axes}")]
    NoSuchAxis {
        /// The letter.
        letter: char,
        /// The axes there are.
        axes: String,
    },
    /// Axis words, but nothing says how to move.
    #[error("axis words, but neither G0 nor G1 is in force here")]
    NoMotion,
    /// A feed move under inverse time without its own F.
    #[error("F word missing with inverse time G1 move; under G93 each G1 block needs its own F")]
    NoInverseTimeFeed,
    /// A feed move before any feed.
    #[error("G1 with zero feed rate: no F since the program began or G93 ended; add one")]
    NoFeed,
    /// A number that must be greater than zero, or not below it.
    #[error("{letter}{value} is out of range: it must be {bound}")]
    Range {
        /// The letter of the word.
        letter: char,
        /// Its number.
        value: f64,
        /// What it must be.
        bound: &'static str,
    },
    /// A dwell without its time.
    #[error("G4 without {letter}: say how long to wait, like G4 {letter}0.5")]
    NoDwellTime {
        /// The letter of the time.
        letter: char,
    },
    /// A dwell and axis words at once.
    #[error("G4 and axis words on one line; put the move on a line of its own")]
    DwellMoves,
    /// A tool change without a tool.
    #[error("M6 without a tool: no T word up to here")]
    NoTool,
    /// An increment from an unknown position.
    #[error("an increment (G91) of {letter}, which has had no position yet; give it one under G90")]
    UnknownStart {
        /// The axis.
        letter: char,
    },
    /// F under inverse time, but no feed move.
    #[error("F under G93 is the time of a G1 block, and this line has none")]
    StrayFeed,
    /// P without a dwell.
    #[error("P belongs to G4, and this line has none")]
    StrayTime,
    /// Whole turns alone can be taken off.
    #[error("G92 is read where it takes whole turns off a rotary axis, and here it does not")]
    Rezero,
    /// A program stop that is no tool change.
    #[error("{word} is read behind a T word, where tools are changed by hand, and not here")]
    Stop {
        /// The word.
        word: &'static str,
    },
    /// What plain text has no such line for.
    #[error(
        "{word} begins no line that is read; the reader knows BEGIN PGM, END PGM, L, TOOL CALL, \
         CYCL DEF 9, M words, comments, and what the dialect lists"
    )]
    Klartext {
        /// The word.
        word: String,
    },
    /// A dialect's modal line holds something else.
    #[error("modal words alone belong here, like G21 G90; programs are in millimetres, absolute")]
    NotModal,
}

/// One piece of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Token<'a> {
    /// A letter, upper case, and its number.
    Word(char, f64),
    /// The same, with how the number is meant.
    Turn(char, f64, Turning),
    /// The text of a comment.
    Comment(&'a [u8]),
    /// A `%`.
    Percent,
}

/// How the angle of a rotary axis is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turning {
    /// To it by the shorter way.
    Shorter,
    /// To it forwards.
    Forwards,
    /// To it backwards.
    Backwards,
    /// On by it.
    By,
}

/// Walks over a line. The column of a token is that of its first character, counted from 1.
pub(super) struct Scanner<'a> {
    line: &'a [u8],
    at: usize,
    language: Language,
}

impl<'a> Scanner<'a> {
    /// A walk over `line`, behind the `/` it may begin with: block delete is read as switched off.
    pub(super) fn new(line: &'a [u8], language: Language) -> Self {
        let first = line.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(line.len());
        Self { line, at: first + usize::from(line.get(first) == Some(&b'/')), language }
    }

    /// The next token and its column, `None` at the end of the line; an error has a column too.
    pub(super) fn next_token(&mut self) -> Result<Option<(u32, Token<'a>)>, (u32, Problem)> {
        self.skip_space();
        let column = self.at as u32 + 1;
        let Some(&byte) = self.line.get(self.at) else { return Ok(None) };
        self.at += 1;
        let token = match byte {
            b'%' => Ok(Token::Percent),
            b';' => Ok(Token::Comment(self.take(self.line.len()))),
            b'(' if self.language == Language::Iso => self.comment(),
            b'#' | b'[' => Err(Problem::Expression),
            letter if letter.is_ascii_alphabetic() => self.word(letter.to_ascii_uppercase().into()),
            _ => Err(Problem::Character(self.char_before())),
        };
        token.map(|token| Some((column, token))).map_err(|problem| (column, problem))
    }

    fn comment(&mut self) -> Result<Token<'a>, Problem> {
        let length = self.line[self.at..].iter().position(|&byte| byte == b')');
        let end = self.at + length.ok_or(Problem::OpenComment)?;
        let text = self.take(end);
        self.at += 1;
        Ok(Token::Comment(text))
    }

    fn word(&mut self, letter: char) -> Result<Token<'a>, Problem> {
        self.skip_space();
        let start = self.at;
        match self.line.get(start) {
            Some(b'#' | b'[') => return Err(Problem::Expression),
            Some(b'=') if self.language == Language::Siemens => {
                self.at += 1;
                return self.assigned(letter);
            }
            _ => {}
        }
        Ok(Token::Word(letter, self.number(letter)?))
    }

    /// What stands behind the `=` of a Siemens word: a number, or one in `DC( )` and its like.
    fn assigned(&mut self, letter: char) -> Result<Token<'a>, Problem> {
        self.skip_space();
        let length = self.line[self.at..].iter().take_while(|byte| byte.is_ascii_alphabetic());
        let name = self.take(self.at + length.count());
        if name.is_empty() {
            return Ok(Token::Word(letter, self.number(letter)?));
        }
        let turning = match name.to_ascii_uppercase().as_slice() {
            b"AC" => None,
            b"DC" => Some(Turning::Shorter),
            b"ACP" => Some(Turning::Forwards),
            b"ACN" => Some(Turning::Backwards),
            b"IC" => Some(Turning::By),
            _ => return Err(Problem::Expression),
        };
        self.expect(b'(', letter)?;
        let number = self.number(letter)?;
        self.expect(b')', letter)?;
        let word = Token::Word(letter, number);
        Ok(turning.map_or(word, |turning| Token::Turn(letter, number, turning)))
    }

    fn expect(&mut self, byte: u8, letter: char) -> Result<(), Problem> {
        self.skip_space();
        let is_there = self.line.get(self.at) == Some(&byte);
        self.at += usize::from(is_there);
        if is_there { Ok(()) } else { Err(Problem::NoNumber { letter }) }
    }

    fn number(&mut self, letter: char) -> Result<f64, Problem> {
        self.skip_space();
        let start = self.at;
        let is_number = |byte: &u8| byte.is_ascii_digit() || b"+-.".contains(byte);
        let length = self.line[start..].iter().take_while(|byte| is_number(byte)).count();
        let text = str::from_utf8(self.take(start + length)).unwrap_or_default();
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or(Problem::NoNumber { letter })
    }

    fn skip_space(&mut self) {
        while self.line.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    fn take(&mut self, end: usize) -> &'a [u8] {
        let taken = &self.line[self.at..end];
        self.at = end;
        taken
    }

    /// The character the last byte begins.
    fn char_before(&self) -> char {
        let rest = String::from_utf8_lossy(&self.line[self.at - 1..]);
        rest.chars().next().unwrap_or(char::REPLACEMENT_CHARACTER)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(line: &str) -> Result<Vec<(u32, Token<'_>)>, (u32, Problem)> {
        let mut scanner = Scanner::new(line.as_bytes(), Language::Iso);
        std::iter::from_fn(|| scanner.next_token().transpose()).collect()
    }

    #[test]
    fn words_come_in_any_case_and_spacing() {
        let words = tokens(" /n10g1 X 12.5y-.5(up)Z+3.;rest").unwrap();
        let expected = [
            (3, Token::Word('N', 10.0)),
            (6, Token::Word('G', 1.0)),
            (9, Token::Word('X', 12.5)),
            (15, Token::Word('Y', -0.5)),
            (19, Token::Comment(b"up")),
            (23, Token::Word('Z', 3.0)),
            (27, Token::Comment(b"rest")),
        ];
        assert_eq!(words, expected);
    }

    #[test]
    fn siemens_says_which_way_to_turn() {
        let mut scanner =
            Scanner::new(b"N5 X=1.5 A=DC(10.5)b = ic( -3 ) C=ACP(1)", Language::Siemens);
        let words: Vec<_> = std::iter::from_fn(|| scanner.next_token().unwrap()).collect();
        let expected = [
            (1, Token::Word('N', 5.0)),
            (4, Token::Word('X', 1.5)),
            (10, Token::Turn('A', 10.5, Turning::Shorter)),
            (20, Token::Turn('B', -3.0, Turning::By)),
            (33, Token::Turn('C', 1.0, Turning::Forwards)),
        ];
        assert_eq!(words, expected);
        for (line, problem) in [
            (&b"A=DC(1"[..], Problem::NoNumber { letter: 'A' }),
            (b"A=DC 1)", Problem::NoNumber { letter: 'A' }),
            (b"A=SIN(1)", Problem::Expression),
            (b"(MSG)", Problem::Character('(')),
        ] {
            assert_eq!(Scanner::new(line, Language::Siemens).next_token(), Err((1, problem)));
        }
    }

    #[test]
    fn what_is_no_word_is_refused_with_its_column() {
        assert_eq!(tokens("G1 X"), Err((4, Problem::NoNumber { letter: 'X' })));
        assert_eq!(tokens("G1 X1.2.3"), Err((4, Problem::NoNumber { letter: 'X' })));
        let huge = format!("X{}", "9".repeat(400));
        assert_eq!(tokens(&huge), Err((1, Problem::NoNumber { letter: 'X' })));
        assert_eq!(tokens("X[1+2]"), Err((1, Problem::Expression)));
        assert_eq!(tokens("#5=2"), Err((1, Problem::Expression)));
        assert_eq!(tokens("G0 (half"), Err((4, Problem::OpenComment)));
        assert_eq!(tokens("G0 é"), Err((4, Problem::Character('é'))));
        assert_eq!(tokens("G0 =1"), Err((4, Problem::Character('='))));
    }

    #[test]
    fn any_bytes_are_read_or_refused() {
        for first in 0..=u8::MAX {
            for second in [0, b'(', b'%', b'X', 0x80, 0xff] {
                let line = [first, second, first];
                for language in [Language::Iso, Language::Siemens] {
                    let mut scanner = Scanner::new(&line, language);
                    while let Ok(Some(_)) = scanner.next_token() {}
                }
            }
        }
    }
}
