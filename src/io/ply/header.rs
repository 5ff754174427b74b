//! The header of a PLY file: which elements follow, and what they are made of.

use crate::geom::LengthUnit;
use crate::io::fault::{Fault, Place};
use crate::io::source::{Source, shown, words};

/// How the values after the header are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// One value of an element, or a list of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) item: Scalar,
    /// The type of a list's length, if it is a list.
    pub(super) length: Option<Scalar>,
}

/// A kind of thing the file lists.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) claimed: u64,
    pub(super) properties: Vec<Property>,
}

/// A whole header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    pub(super) declared: Option<LengthUnit>,
    /// Columns and rows of the scanner's picture, as `obj_info` has it.
    pub(super) grid: [Option<usize>; 2],
}

impl Header {
    /// Reads up to and with `end_header`.
    pub(super) fn read(source: &mut Source<'_>) -> Result<Self, Fault> {
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut declared = None;
        let mut grid = [None; 2];
        let mut line = Vec::new();
        loop {
            if !source.read_line(&mut line)? {
                let what = "the header, before its end_header".into();
                return Err(Fault::Truncated { place: source.line_place(), what });
            }
            let place = source.line_place();
            let bad = || Fault::malformed(place, format!("{} is no PLY header line", shown(&line)));
            let words: Vec<&str> =
                words(&line).map(|word| std::str::from_utf8(word).unwrap_or_default()).collect();
            match words.as_slice() {
                ["end_header"] => break,
                ["obj_info", "num_cols", n] => grid[0] = n.parse().ok(),
                ["obj_info", "num_rows", n] => grid[1] = n.parse().ok(),
                ["ply"] | ["obj_info", ..] | [] => {}
                ["comment", ..] => {
                    declared = declared
                        .or_else(|| LengthUnit::declared_in(&String::from_utf8_lossy(&line)));
                }
                ["format", name, ..] => encoding = Some(Encoding::called(name).ok_or_else(bad)?),
                ["element", name, count] => {
                    let claimed = count.parse().map_err(|_| bad())?;
                    let name = (*name).to_owned();
                    elements.push(Element { name, claimed, properties: Vec::new() });
                }
                ["property", rest @ ..] => {
                    let property = Property::parse(rest).ok_or_else(bad)?;
                    elements.last_mut().ok_or_else(bad)?.properties.push(property);
                }
                _ => return Err(bad()),
            }
        }
        let encoding = encoding
            .ok_or_else(|| Fault::malformed(Place::Line(2), "the header has no format line"))?;
        Ok(Self { encoding, elements, declared, grid })
    }
}

impl Encoding {
    fn called(name: &str) -> Option<Self> {
        Some(match name {
            "ascii" => Self::Ascii,
            "binary_little_endian" => Self::LittleEndian,
            "binary_big_endian" => Self::BigEndian,
            _ => return None,
        })
    }
}

impl Element {
    /// Bytes one of them takes at least.
    pub(super) fn least_size(&self, encoding: Encoding) -> u64 {
        // As text, a digit and what separates it from the next.
        let size = |property: &Property| match encoding {
            Encoding::Ascii => 2,
            _ => property.length.unwrap_or(property.item).size() as u64,
        };
        self.properties.iter().map(size).sum()
    }

    /// Where the value of that name stands among the properties.
    pub(super) fn position(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| {
            property.length.is_none() && names.contains(&property.name.as_str())
        })
    }
}

impl Property {
    fn parse(words: &[&str]) -> Option<Self> {
        Some(match words {
            ["list", length, item, name] => Self {
                name: (*name).to_owned(),
                item: Scalar::called(item)?,
                length: Some(Scalar::called(length)?),
            },
            [item, name] => {
                Self { name: (*name).to_owned(), item: Scalar::called(item)?, length: None }
            }
            _ => return None,
        })
    }
}

impl Scalar {
    fn called(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// True if fractions cannot be stored: a colour of it runs to 255 and not to 1.
    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}
