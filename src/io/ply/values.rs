//! The values after a PLY header, one element at a time, whatever they are encoded in.

use super::header::{Element, Encoding, Scalar};
use crate::io::fault::{Fault, Place};
use crate::io::source::{Source, number, shown};

/// Reads elements one after the other.
pub(super) struct Values<'s, 'a> {
    source: &'s mut Source<'a>,
    encoding: Encoding,
    /// The line an ASCII element stands on, and how much of it is used.
    line: Vec<u8>,
    used: usize,
}

impl<'s, 'a> Values<'s, 'a> {
    /// `source` after its header.
    pub(super) fn new(source: &'s mut Source<'a>, encoding: Encoding) -> Self {
        Self { source, encoding, line: Vec::new(), used: 0 }
    }

    /// How many of `element` follow; refused if the file is too short for what it claims.
    pub(super) fn count(&self, element: &Element) -> Result<usize, Fault> {
        if element.properties.is_empty() {
            return Ok(0);
        }
        let what = format!("of the element {:?}", element.name);
        self.source.count(element.claimed, element.least_size(self.encoding), what)
    }

    /// Where the element read last stands.
    pub(super) fn place(&self) -> Place {
        match self.encoding {
            Encoding::Ascii => self.source.line_place(),
            _ => self.source.byte_place(),
        }
    }

    /// Reads one `element`: its values into `row` (0 for a list), and the list that is its property
    /// `i_list` into `list`.
    pub(super) fn read_element(
        &mut self,
        element: &Element,
        row: &mut [f64],
        i_list: Option<usize>,
        list: &mut Vec<i64>,
    ) -> Result<(), Fault> {
        self.begin(element)?;
        list.clear();
        for (i_property, (property, value)) in element.properties.iter().zip(row).enumerate() {
            let Some(length) = property.length else {
                *value = self.scalar(property.item)?;
                continue;
            };
            let length = self.integer(length)?;
            if length < 0 {
                let problem = format!("a list {:?} of length {length}", property.name);
                return Err(Fault::malformed(self.place(), problem));
            }
            for _ in 0..length {
                if i_list == Some(i_property) {
                    let item = self.integer(property.item)?;
                    list.push(item);
                } else {
                    self.scalar(property.item)?;
                }
            }
        }
        self.end(element)
    }

    /// An ASCII element begins a line; empty ones do not count.
    fn begin(&mut self, element: &Element) -> Result<(), Fault> {
        if self.encoding != Encoding::Ascii {
            return Ok(());
        }
        self.used = 0;
        loop {
            if !self.source.read_line(&mut self.line)? {
                let what = format!("the element {:?}", element.name);
                return Err(Fault::Truncated { place: self.place(), what });
            }
            if !self.line.trim_ascii().is_empty() {
                return Ok(());
            }
        }
    }

    /// An ASCII element ends its line; more on it means that header and values disagree.
    fn end(&mut self, element: &Element) -> Result<(), Fault> {
        match (self.encoding, self.word()) {
            (Encoding::Ascii, Some(word)) => {
                let name = &element.name;
                let problem = format!("{} is more than a {name:?} holds", shown(word));
                Err(Fault::malformed(self.place(), problem))
            }
            _ => Ok(()),
        }
    }

    fn integer(&mut self, kind: Scalar) -> Result<i64, Fault> {
        let value = self.scalar(kind)?;
        if value.fract() == 0.0 && value.abs() < 1e15 {
            Ok(value as i64)
        } else {
            Err(Fault::malformed(self.place(), format!("{value} where a whole number must be")))
        }
    }

    fn scalar(&mut self, kind: Scalar) -> Result<f64, Fault> {
        if self.encoding == Encoding::Ascii {
            let word = self.word().unwrap_or_default();
            let Some(value) = number(word) else {
                let problem = format!("{} where a number must be", shown(word));
                return Err(Fault::malformed(self.place(), problem));
            };
            return Ok(value);
        }
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..kind.size()];
        self.source.fill(bytes, "the values")?;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(decode(kind, bytes))
    }

    /// The next word of the line.
    fn word(&mut self) -> Option<&[u8]> {
        let rest = &self.line[self.used..];
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length =
            rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.used += start + length;
        Some(&self.line[self.used - length..self.used])
    }
}

/// A value from its bytes, the lowest first.
#[inline]
pub(super) fn decode(kind: Scalar, bytes: &[u8]) -> f64 {
    let mut wide = [0; 8];
    wide[..bytes.len()].copy_from_slice(bytes);
    let bits = u64::from_le_bytes(wide);
    match kind {
        Scalar::I8 => f64::from(bits as i8),
        Scalar::U8 => f64::from(bits as u8),
        Scalar::I16 => f64::from(bits as i16),
        Scalar::U16 => f64::from(bits as u16),
        Scalar::I32 => f64::from(bits as i32),
        Scalar::U32 => f64::from(bits as u32),
        Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
        Scalar::F64 => f64::from_bits(bits),
    }
}
