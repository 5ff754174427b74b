//! Remarks in the text of a program.

use crate::gcode::{CommentStyle, Dialect};

/// The comment `text` as lines that fit the dialect, in characters every control takes.
pub(in crate::gcode) fn comment_lines(text: &str, dialect: &Dialect) -> Vec<Box<str>> {
    let plain: String = text.chars().map(plain_char).collect();
    // Leaves room for the marks around it and for a block number.
    let room = dialect.line_length.saturating_sub(16).max(16);
    let mut lines = Vec::new();
    let mut rest = plain.trim();
    while rest.len() > room {
        let cut = rest[..room].rfind(' ').filter(|&cut| cut > 0).unwrap_or(room);
        lines.push(rest[..cut].trim_end().into());
        rest = rest[cut..].trim_start();
    }
    lines.push(rest.into());
    lines
}

/// Appends a comment that is plain already.
pub(super) fn push_comment(text: &mut Vec<u8>, comment: &str, style: CommentStyle) {
    let plain = comment.chars().map(plain_char).map(|c| c as u8);
    match style {
        CommentStyle::Parentheses => {
            text.push(b'(');
            text.extend(plain);
            text.push(b')');
        }
        CommentStyle::Semicolon => {
            text.extend_from_slice(b"; ");
            text.extend(plain);
        }
    }
}

fn plain_char(c: char) -> char {
    match c {
        '(' => '[',
        ')' => ']',
        ' '..='~' => c,
        c if c.is_whitespace() => ' ',
        _ => '?',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_comments_are_wrapped_and_every_character_is_plain() {
        let mut dialect = Dialect::named("linuxcnc").unwrap();
        dialect.line_length = 40;
        let lines = comment_lines("pie de señora (izquierdo)\nnúmero treinta y siete", &dialect);
        let expected = ["pie de se?ora", "[izquierdo] n?mero", "treinta y siete"];
        assert_eq!(lines, expected.map(Box::from));
    }
}
