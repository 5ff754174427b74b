//! Text files of the TUM benchmark: a stamp and more in each line, `#` before what is no data.

use crate::io::fault::{Fault, Place};
use crate::io::source::{Source, number, shown, words};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// A line: where it stands, its stamp, and the words behind it.
pub(super) struct Line {
    pub(super) place: Place,
    /// [s]
    pub(super) stamp: f64,
    pub(super) rest: Vec<Vec<u8>>,
}

/// The lines of the file `path` that hold data; their stamps rise. `columns` says what they hold, `n`
/// words in all.
pub(super) fn read_lines(path: &Path, n: usize, columns: &str) -> Result<Vec<Line>, Fault> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    parse(&mut Source::new(&mut BufReader::new(file), size), n, columns)
}

fn parse(source: &mut Source<'_>, n: usize, columns: &str) -> Result<Vec<Line>, Fault> {
    let mut lines: Vec<Line> = Vec::new();
    let mut text = Vec::new();
    while source.read_line(&mut text)? {
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
        if text.trim_ascii_start().starts_with(b"#") || text.trim_ascii().is_empty() {
            continue;
        }
        let place = source.line_place();
        // Some tools put commas between the columns.
        let text: Vec<u8> = text.iter().map(|&b| if b == b',' { b' ' } else { b }).collect();
        let found: Vec<&[u8]> = words(&text).collect();
        if found.len() != n {
            let problem = format!("{} columns where there must be {n} ({columns})", found.len());
            return Err(wrong(place, problem));
        }
        let stamp = finite(found[0], place)?;
        if let Some(last) = lines.last().filter(|last| stamp <= last.stamp) {
            let before = last.stamp;
            return Err(Fault::Malformed {
                place,
                problem: format!(
                    "the stamp {stamp} does not come after {before}, that of the line before"
                ),
                remedy: "sort the lines by their stamps and leave repeated ones out",
            });
        }
        let rest = found[1..].iter().map(|word| word.to_vec()).collect();
        lines.push(Line { place, stamp, rest });
    }
    Ok(lines)
}

/// A number that is neither infinite nor none.
pub(super) fn finite(word: &[u8], place: Place) -> Result<f64, Fault> {
    let value = number(word).filter(|value| value.is_finite());
    value.ok_or_else(|| wrong(place, format!("{} where a finite number must be", shown(word))))
}

fn wrong(place: Place, problem: String) -> Fault {
    Fault::Malformed { place, problem, remedy: "mend the line, or put # before it" }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Vec<Line>, Fault> {
        parse(&mut Source::new(&mut text.as_bytes(), text.len() as u64), 2, "stamp file")
    }

    #[test]
    fn comments_and_empty_lines_hold_no_data() {
        let lines = parsed("\u{feff}# a\n1.5 rgb/a.png\n\n  # b\n2.5,rgb/b.png\r\n").unwrap();
        assert_eq!(lines.iter().map(|l| l.stamp).collect::<Vec<_>>(), [1.5, 2.5]);
        assert_eq!(lines[1].rest, [b"rgb/b.png"]);
        assert_eq!(lines[1].place, Place::Line(5));
    }

    #[test]
    fn faults_name_line_and_value() {
        for (text, message) in [
            ("1.5\n", "line 1: 1 columns where there must be 2 (stamp file)"),
            ("1.5 a b\n", "line 1: 3 columns where"),
            ("# x\nten a\n", "line 2: \"ten\" where a finite number must be"),
            ("nan a\n", "line 1: \"nan\" where a finite number"),
            ("2 a\n1 b\n", "line 2: the stamp 1 does not come after 2"),
            ("2 a\n2 b\n", "line 2: the stamp 2 does not come after 2"),
        ] {
            let error = parsed(text).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
