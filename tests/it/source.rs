//! Rust sources as words, for tests that hold rules over them: comments and test code left out.

/// A piece of a source, with the line it stands on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Token {
    /// What it is.
    pub(crate) kind: Kind,
    /// Counted from 1.
    pub(crate) line: usize,
}

/// What a [`Token`] is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Kind {
    /// An identifier or keyword.
    Word(String),
    /// What stands between the quotes of a string literal.
    Text(String),
    /// Any other character; `::` is one mark.
    Mark(&'static str),
    /// A literal or sign no rule asks about.
    Other(char),
}

/// The tokens of `source` without comments and without anything marked `#[cfg(test)]`.
pub(crate) fn tokens(source: &str) -> Vec<Token> {
    without_tests(&Lexer { rest: source, line: 1 }.run())
}

struct Lexer<'a> {
    rest: &'a str,
    line: usize,
}

impl<'a> Lexer<'a> {
    fn run(mut self) -> Vec<Token> {
        let mut tokens = Vec::new();
        while let Some(first) = self.rest.chars().next() {
            let line = self.line;
            if let Some(kind) = self.next(first) {
                tokens.push(Token { kind, line });
            }
        }
        tokens
    }

    /// Takes one token or one stretch that is none.
    fn next(&mut self, first: char) -> Option<Kind> {
        if self.rest.starts_with("//") {
            self.take(self.rest.find('\n').unwrap_or(self.rest.len()));
            return None;
        }
        if self.rest.starts_with("/*") {
            self.block_comment();
            return None;
        }
        if let Some(text) = self.string() {
            return Some(Kind::Text(text));
        }
        if first == '\'' {
            self.char_or_lifetime();
            return None;
        }
        if first.is_alphabetic() || first == '_' {
            let end = self.rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            return Some(Kind::Word(self.take(end.unwrap_or(self.rest.len())).to_owned()));
        }
        for mark in
            ["::", "#", "[", "]", "(", ")", "{", "}", "<", ">", ",", ";", "!", ".", "*", "="]
        {
            if self.rest.starts_with(mark) {
                self.take(mark.len());
                return Some(Kind::Mark(mark));
            }
        }
        self.take(first.len_utf8());
        (!first.is_whitespace()).then_some(Kind::Other(first))
    }

    fn take(&mut self, n_bytes: usize) -> &'a str {
        let (taken, rest) = self.rest.split_at(n_bytes);
        self.line += taken.matches('\n').count();
        self.rest = rest;
        taken
    }

    fn block_comment(&mut self) {
        let mut depth = 0;
        loop {
            if self.rest.starts_with("/*") {
                depth += 1;
                self.take(2);
            } else if self.rest.starts_with("*/") {
                depth -= 1;
                self.take(2);
            } else if let Some(c) = self.rest.chars().next() {
                self.take(c.len_utf8());
            }
            if depth == 0 || self.rest.is_empty() {
                return;
            }
        }
    }

    /// A string literal of any kind: `"`, `b"`, `c"`, `r"`, `r#"`, `br##"`.
    fn string(&mut self) -> Option<String> {
        let prefix = self.rest.find(|c| !matches!(c, 'b' | 'c' | 'r' | '#'))?;
        let (letters, quote) = self.rest.split_at(prefix);
        let n_hashes = letters.len() - letters.trim_end_matches('#').len();
        let raw = letters.contains('r');
        let known = matches!(letters.trim_end_matches('#'), "" | "b" | "c" | "r" | "br" | "cr");
        if !quote.starts_with('"') || !known || (0 < n_hashes && !raw) {
            return None;
        }
        self.take(prefix + 1);
        let length = if raw {
            self.rest.find(&format!("\"{}", "#".repeat(n_hashes)))
        } else {
            let mut escaped = false;
            self.rest.find(|c| {
                let ends = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                ends
            })
        };
        let length = length.unwrap_or(self.rest.len());
        let text = self.take(length).to_owned();
        self.take((1 + n_hashes).min(self.rest.len()));
        Some(text)
    }

    fn char_or_lifetime(&mut self) {
        let mut inside = self.rest[1..].chars();
        let length = match (inside.next(), inside.next()) {
            // The character after the backslash may itself be a quote.
            (Some('\\'), Some(escaped)) => {
                let from = 2 + escaped.len_utf8();
                self.rest[from..].find('\'').map_or(self.rest.len(), |at| from + at + 1)
            }
            (Some(c), Some('\'')) => 2 + c.len_utf8(),
            _ => 1,
        };
        self.take(length);
    }
}

fn without_tests(tokens: &[Token]) -> Vec<Token> {
    let mut kept = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        if is_test_attribute(&tokens[i..]) {
            i = end_of_item(tokens, i);
        } else {
            kept.push(tokens[i].clone());
            i += 1;
        }
    }
    kept
}

/// True at `#[cfg(test)]` and `#[cfg(all(test, ...))]`.
fn is_test_attribute(tokens: &[Token]) -> bool {
    let starts_with = |expected: &[&str]| {
        let found = tokens.iter().map(|token| match &token.kind {
            Kind::Word(word) => word.as_str(),
            Kind::Mark(mark) => mark,
            _ => "",
        });
        found.take(expected.len()).eq(expected.iter().copied())
    };
    starts_with(&["#", "[", "cfg", "(", "test", ")", "]"])
        || starts_with(&["#", "[", "cfg", "(", "all", "(", "test", ","])
}

/// Where the item that `tokens[from..]` begins with ends: after its `;` or its braces.
fn end_of_item(tokens: &[Token], from: usize) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(from) {
        match token.kind {
            Kind::Mark("{" | "[" | "(") => depth += 1,
            Kind::Mark("}" | "]" | ")") => {
                depth -= 1;
                if depth == 0 && token.kind == Kind::Mark("}") {
                    return i + 1;
                }
            }
            Kind::Mark(";") if depth == 0 => return i + 1,
            _ => {}
        }
    }
    tokens.len()
}

/// Every path a source names: those in expressions and types, and the leaves of its `use` trees.
/// With each comes the line it stands on.
pub(crate) fn paths(tokens: &[Token]) -> Vec<(Vec<String>, usize)> {
    let mut found = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        if matches!(tokens[i].kind, Kind::Word(_)) {
            i = branch(tokens, i, &[], &mut found);
        } else {
            i += 1;
        }
    }
    found
}

/// Reads one path, or one branch of a tree, that begins at `i`; returns where it ends.
fn branch(
    tokens: &[Token],
    mut i: usize,
    prefix: &[String],
    found: &mut Vec<(Vec<String>, usize)>,
) -> usize {
    let mut path = prefix.to_vec();
    let line = tokens[i].line;
    loop {
        match tokens.get(i).map(|token| &token.kind) {
            Some(Kind::Word(word)) => path.push(word.clone()),
            Some(Kind::Mark("*")) => path.push("*".to_owned()),
            Some(Kind::Mark("{")) => {
                i += 1;
                while let Some(token) = tokens.get(i) {
                    match token.kind {
                        Kind::Mark("}") => return i + 1,
                        Kind::Word(_) | Kind::Mark("*") => i = branch(tokens, i, &path, found),
                        _ => i += 1,
                    }
                }
                return i;
            }
            _ => break,
        }
        i += 1;
        if tokens.get(i).map(|token| &token.kind) != Some(&Kind::Mark("::")) {
            break;
        }
        i += 1;
    }
    found.push((path, line));
    i
}

#[test]
fn comments_strings_and_tests_are_told_from_code() {
    let source = r##"
        // crate::a  /* still a line
        /* crate::b /* nested */ crate::c */
        const S: &str = "crate::d \" // no comment"; const R: &str = r#"a "quoted" G1"#;
        fn f<'a>(x: &'a str) -> char { '"' } const Q: char = '\''; const B: u8 = b'{';
        use crate::{e::{F, self}, g};
        #[cfg(test)]
        #[expect(dead_code)]
        mod tests { use crate::h; fn t() { let x = "}"; } }
        #[cfg(test)] use crate::i;
        fn after() { crate::j::k() }
    "##;
    let tokens = tokens(source);
    let texts: Vec<_> = tokens
        .iter()
        .filter_map(|token| match &token.kind {
            Kind::Text(text) => Some(text.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(texts, ["crate::d \\\" // no comment", "a \"quoted\" G1"]);
    let ours: Vec<_> = paths(&tokens)
        .into_iter()
        .filter(|(path, _)| path[0] == "crate")
        .map(|(path, line)| (path.join("::"), line))
        .collect();
    let expected =
        [("crate::e::F", 6), ("crate::e::self", 6), ("crate::g", 6), ("crate::j::k", 11)];
    assert_eq!(ours, expected.map(|(path, line)| (path.to_owned(), line)));
}
