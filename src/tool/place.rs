//! Where in a file something is wrong: line, column, and the line itself to look at.
//!
//! Tool libraries and machine files share it, so that all their errors read alike.

use std::fmt::{Display, Formatter};
use std::ops::Range;

/// The most characters of an offending line that are shown.
const WIDEST_EXCERPT: usize = 100;

/// A place in a text file. Prints as `file:line:column`, both counted from 1, columns in characters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file, as the user called it.
    pub file: String,
    /// Its line, from 1.
    pub line: usize,
    /// The character in that line, from 1.
    pub column: usize,
    excerpt: String,
}

impl Place {
    /// The place of the bytes `span` of `text`, which came from `file`.
    pub fn new(text: &str, file: &str, span: Range<usize>) -> Self {
        let start = text.floor_char_boundary(span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |end| end + 1);
        let line_text = text[line_start..].lines().next().unwrap_or_default();
        let line = text[..line_start].matches('\n').count() + 1;
        let column = text[line_start..start].chars().count() + 1;
        let end = text.floor_char_boundary(span.end).max(start);
        let n_marked = text[start..end].lines().next().map_or(0, |marked| marked.chars().count());
        let excerpt = excerpt(line_text, line, column, n_marked.max(1));
        Self { file: file.to_owned(), line, column, excerpt }
    }

    /// The line with a mark under the place, for the end of an error message; begins with a line
    /// break.
    pub fn excerpt(&self) -> &str {
        &self.excerpt
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

fn excerpt(line_text: &str, line: usize, column: usize, n_marked: usize) -> String {
    // A long line is shown from shortly before the place on.
    let skip = if column < WIDEST_EXCERPT { 0 } else { column - WIDEST_EXCERPT / 2 };
    let shown: String = line_text.chars().skip(skip).take(WIDEST_EXCERPT).collect();
    let shown = printable(&shown);
    let before = column - 1 - skip;
    let marks = "^".repeat(n_marked.min(WIDEST_EXCERPT - before));
    let margin = " ".repeat(line.to_string().len());
    format!("\n{margin} |\n{line} | {shown}\n{margin} | {:before$}{marks}", "")
}

/// `text` with blanks for control characters: a terminal must not obey what stands in a file.
pub(crate) fn printable(text: &str) -> String {
    text.replace(char::is_control, " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_counts_lines_and_columns_from_one_in_characters() {
        let text = "a = 1\nb = \"ñ\" # x\n";
        let start = text.find('#').unwrap();
        let place = Place::new(text, "t.toml", start..start + 3);
        assert_eq!(place.to_string(), "t.toml:2:9");
        assert_eq!(place.excerpt(), "\n  |\n2 | b = \"ñ\" # x\n  |         ^^^");
    }

    #[test]
    fn a_place_past_the_end_of_the_text_is_its_end() {
        assert_eq!(Place::new("", "t", 0..0).to_string(), "t:1:1");
        assert_eq!(Place::new("a\n", "t", 7..9).to_string(), "t:2:1");
    }

    #[test]
    fn an_endless_line_is_shown_around_the_place_and_without_control_characters() {
        let text = format!("{}\x1b[31m!", "x".repeat(5000));
        let place = Place::new(&text, "t", 5005..5006);
        assert_eq!((place.line, place.column), (1, 5006));
        let widest = place.excerpt().lines().map(|line| line.chars().count()).max();
        assert!(widest.unwrap() <= WIDEST_EXCERPT + 4);
        assert!(!place.excerpt().contains('\x1b'));
        assert!(place.excerpt().contains("[31m!"));
    }
}
