//! The header of a PCD file.

use crate::io::fault::Fault;
use crate::io::source::{Source, shown};

/// How the points are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary,
    Compressed,
}

/// What kind of number a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Signed,
    Unsigned,
    Float,
}

/// A field of every point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// Bytes a value.
    pub(super) size: usize,
    /// Values a point.
    pub(super) count: usize,
    /// Bytes of a point before it.
    pub(super) offset: usize,
    /// Values of a point before it.
    pub(super) first_value: usize,
}

/// A whole header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) fields: Vec<Field>,
    pub(super) n_points: u64,
    pub(super) encoding: Encoding,
    /// Columns and rows, where there are several rows.
    pub(super) grid: Option<[usize; 2]>,
}

impl Header {
    /// Reads up to and with the line `DATA`.
    pub(super) fn read(source: &mut Source<'_>) -> Result<Self, Fault> {
        let (mut names, mut sizes, mut kinds, mut counts) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut width, mut height, mut n_points) = (None, 1, None);
        let mut line = Vec::new();
        let encoding = loop {
            if !source.read_line(&mut line)? {
                let what = "the header, before its DATA".into();
                return Err(Fault::Truncated { place: source.line_place(), what });
            }
            let place = source.line_place();
            let bad = || Fault::malformed(place, format!("{} is no PCD header line", shown(&line)));
            let text = String::from_utf8_lossy(&line);
            let mut words = text.split_ascii_whitespace();
            match words.next() {
                Some("FIELDS" | "COLUMNS") => names = words.map(str::to_owned).collect(),
                Some("SIZE") => sizes = numbers(words).ok_or_else(bad)?,
                Some("TYPE") => {
                    kinds = words.map(Kind::called).collect::<Option<_>>().ok_or_else(bad)?;
                }
                Some("COUNT") => counts = numbers(words).ok_or_else(bad)?,
                Some("WIDTH") => width = Some(number(words).ok_or_else(bad)?),
                Some("HEIGHT") => height = number(words).ok_or_else(bad)?,
                Some("POINTS") => n_points = Some(number(words).ok_or_else(bad)?),
                Some("DATA") => break Encoding::called(words.next()).ok_or_else(bad)?,
                Some("VERSION" | "VIEWPOINT") | None => {}
                Some(word) if word.starts_with('#') => {}
                Some(_) => return Err(bad()),
            }
        };
        let place = source.line_place();
        if counts.is_empty() {
            counts = vec![1; names.len()];
        }
        if names.is_empty() || [sizes.len(), kinds.len(), counts.len()] != [names.len(); 3] {
            let (n, sizes, kinds, counts) = (names.len(), sizes.len(), kinds.len(), counts.len());
            let problem =
                format!("{n} FIELDS with {sizes} SIZEs, {kinds} TYPEs and {counts} COUNTs");
            return Err(Fault::malformed(place, problem));
        }
        let n_points = n_points.or_else(|| width?.checked_mul(height)).ok_or_else(|| {
            Fault::malformed(place, "neither POINTS nor WIDTH and HEIGHT say how many points")
        })?;
        let mut fields: Vec<Field> = Vec::with_capacity(names.len());
        for (((name, kind), size), count) in names.into_iter().zip(kinds).zip(sizes).zip(counts) {
            let is_known = matches!(
                (kind, size),
                (Kind::Float, 4 | 8) | (Kind::Signed | Kind::Unsigned, 1 | 2 | 4 | 8)
            );
            // Beyond this a record is nonsense, and offsets could overflow.
            if !is_known || count > 1 << 20 {
                let problem = format!("the field {name:?} has SIZE {size} and COUNT {count}");
                return Err(Fault::malformed(place, problem));
            }
            let (offset, first_value) = fields.last().map_or((0, 0), |last| {
                (last.offset + last.size * last.count, last.first_value + last.count)
            });
            // PCL reads a COUNT of 0 as 1.
            let (size, count) = (size as usize, (count as usize).max(1));
            fields.push(Field { name, kind, size, count, offset, first_value });
        }
        let grid = width.filter(|width| 1 < height && width.checked_mul(height) == Some(n_points));
        let grid = grid.map(|width| [width as usize, height as usize]);
        Ok(Self { fields, n_points, encoding, grid })
    }

    /// Bytes a point.
    pub(super) fn record_size(&self) -> usize {
        self.fields.iter().map(|field| field.size * field.count).sum()
    }
}

fn numbers<'w>(words: impl Iterator<Item = &'w str>) -> Option<Vec<u64>> {
    words.map(|word| word.parse().ok()).collect()
}

fn number<'w>(mut words: impl Iterator<Item = &'w str>) -> Option<u64> {
    words.next()?.parse().ok()
}

impl Kind {
    fn called(word: &str) -> Option<Self> {
        Some(match word {
            "I" => Self::Signed,
            "U" => Self::Unsigned,
            "F" => Self::Float,
            _ => return None,
        })
    }
}

impl Encoding {
    fn called(word: Option<&str>) -> Option<Self> {
        Some(match word? {
            "ascii" => Self::Ascii,
            "binary" => Self::Binary,
            "binary_compressed" => Self::Compressed,
            _ => return None,
        })
    }
}
