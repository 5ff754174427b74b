//! From the bytes of a line to its words and comments.

use super::{Language, Problem};

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
