//! Reading a file from front to back while knowing where one is and how much is left.

use super::fault::{Fault, Place};
use std::io::BufRead;

/// An opened file of known size.
pub(super) struct Source<'a> {
    reader: &'a mut dyn BufRead,
    size: u64,
    offset: u64,
    n_lines: u64,
}

impl<'a> Source<'a> {
    /// `reader` at the front of a file of `size` bytes.
    pub(super) fn new(reader: &'a mut dyn BufRead, size: u64) -> Self {
        Self { reader, size, offset: 0, n_lines: 0 }
    }

    /// Bytes not yet read: what bounds every allocation.
    pub(super) fn remaining(&self) -> u64 {
        self.size.saturating_sub(self.offset)
    }

    /// The line read last.
    pub(super) fn line_place(&self) -> Place {
        Place::Line(self.n_lines)
    }

    /// The byte to be read next.
    pub(super) fn byte_place(&self) -> Place {
        Place::Byte(self.offset)
    }

    /// The next line without its end, into `line`; false at the end of the file.
    pub(super) fn read_line(&mut self, line: &mut Vec<u8>) -> Result<bool, Fault> {
        line.clear();
        let n_read = self.reader.read_until(b'\n', line)?;
        self.offset += n_read as u64;
        self.n_lines += u64::from(n_read > 0);
        while matches!(line.last(), Some(b'\n' | b'\r')) {
            line.pop();
        }
        Ok(n_read > 0)
    }

    /// Fills `buffer`, which lies inside `what`.
    pub(super) fn fill(&mut self, buffer: &mut [u8], what: &str) -> Result<(), Fault> {
        let place = Place::Byte(self.size);
        self.reader.read_exact(buffer).map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => Fault::Truncated { place, what: what.into() },
            _ => Fault::System(error),
        })?;
        self.offset += buffer.len() as u64;
        Ok(())
    }

    /// The next `N` bytes.
    pub(super) fn bytes<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Fault> {
        let mut buffer = [0; N];
        self.fill(&mut buffer, what)?;
        Ok(buffer)
    }

    /// The next `n_bytes`, if there are so many.
    pub(super) fn block(&mut self, n_bytes: u64, what: &str) -> Result<Vec<u8>, Fault> {
        if n_bytes > self.remaining() {
            return Err(Fault::Truncated { place: Place::Byte(self.size), what: what.into() });
        }
        let mut block = vec![0; n_bytes as usize];
        self.fill(&mut block, what)?;
        Ok(block)
    }

    /// `claimed` as a count, if that many things of at least `least_size` bytes can still follow.
    pub(super) fn count(
        &self,
        claimed: u64,
        least_size: u64,
        what: impl Into<String>,
    ) -> Result<usize, Fault> {
        // One separator fewer than values: the last line of a text need not end.
        let room = self.remaining();
        let possible = (room + 1) / least_size.max(1);
        if claimed > possible {
            return Err(Fault::Lies { what: what.into(), claimed, room, possible });
        }
        Ok(claimed as usize)
    }
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A number as text has it; `nan` and `inf` in any spelling are numbers too.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| {
        // What C libraries print: -nan(ind), 1.#QNAN, -1.#IND, 1.#INF.
        let lower = text.to_ascii_lowercase();
        if lower.contains("nan(") || lower.contains(".#qnan") || lower.contains(".#ind") {
            Some(f64::NAN)
        } else if lower.contains(".#inf") {
            Some(if lower.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY })
        } else {
            None
        }
    })
}

/// A word as a message can show it.
pub(super) fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(word);
    if text.chars().count() <= 40 {
        format!("{text:?}")
    } else {
        format!("{:?}...", text.chars().take(40).collect::<String>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_way_and_are_counted() {
        let mut text = &b"one\r\n\ntwo words"[..];
        let mut source = Source::new(&mut text, 14);
        let mut line = Vec::new();
        let mut lines = Vec::new();
        while source.read_line(&mut line).unwrap() {
            lines.push(line.clone());
        }
        assert_eq!(lines, [&b"one"[..], b"", b"two words"]);
        assert_eq!(source.line_place(), Place::Line(3));
    }

    #[test]
    fn a_block_larger_than_the_file_is_refused_before_it_is_allocated() {
        let mut bytes = &[0_u8; 4][..];
        let mut source = Source::new(&mut bytes, 4);
        let error = source.block(u64::MAX, "the buffer").unwrap_err().to_string();
        assert!(error.contains("ends at byte 4, in the middle of the buffer"), "{error}");
    }

    #[test]
    fn numbers_are_read_as_c_prints_them() {
        assert_eq!(number(b"-1.5e3"), Some(-1500.0));
        assert!(number(b"-nan(ind)").unwrap().is_nan() && number(b"1.#QNAN0").unwrap().is_nan());
        assert_eq!(number(b"-1.#INF"), Some(f64::NEG_INFINITY));
        assert_eq!(number(b"1,5"), None);
    }
}
