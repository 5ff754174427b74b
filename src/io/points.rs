//! Points as text, one a line: XYZ, ASC, TXT, CSV.
//!
//! Columns are `x y z`, then what the line of names says (`nx ny nz`, `r g b`); without names, three
//! further columns are colours if all are whole numbers from 0 to 255 and normals if they have
//! length 1, six are normals and colours. Cells are separated by white space, commas or semicolons;
//! beside semicolons, or inside cells apart by white space, a comma is the decimal point. Lines
//! that begin with `#`, `//`, `;` or `%` are comments.

use super::fault::Fault;
use super::raw::{Raw, counted};
use super::source::{Source, number, shown};
use crate::geom::{LengthUnit, Point3, PointCloud, Surface, Vector3};
use std::borrow::Cow;
use std::io::Write;

/// Reads points.
pub(super) fn read(source: &mut Source<'_>) -> Result<Raw, Fault> {
    let mut table = Table::default();
    let mut declared = None;
    let mut line = Vec::new();
    while source.read_line(&mut line)? {
        let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&line).trim_ascii();
        if is_comment(line) {
            declared = declared.or_else(|| LengthUnit::declared_in(&String::from_utf8_lossy(line)));
        } else if table.names.is_none() && table.points.is_empty() && is_names(line) {
            let name = |cell: Cow<'_, [u8]>| String::from_utf8_lossy(&cell).to_ascii_lowercase();
            table.names = Some(cells(line).map(name).collect());
        } else {
            table.take(line).map_err(|problem| Fault::malformed(source.line_place(), problem))?;
        }
    }
    let mut raw = table.finish();
    raw.declared = declared;
    Ok(raw)
}

/// True for an empty line and for one that only people read.
pub(super) fn is_comment(line: &[u8]) -> bool {
    line.is_empty() || line.starts_with(b"//") || matches!(line[0], b'#' | b';' | b'%')
}

/// The cells of a line, decimal commas turned into points.
pub(super) fn cells(line: &[u8]) -> impl Iterator<Item = Cow<'_, [u8]>> {
    let has = |byte| line.contains(&byte);
    let is_spaced = line.trim_ascii().iter().any(u8::is_ascii_whitespace);
    // "1,5 2,5 3,5": no comma of it stands beside a space.
    let has_comma_beside_space = line
        .windows(2)
        .any(|pair| pair.contains(&b',') && pair.iter().any(u8::is_ascii_whitespace));
    let (separator, decimal_comma) = if has(b';') {
        (Some(b';'), true)
    } else if has(b',') && (!is_spaced || has_comma_beside_space) {
        (Some(b','), false)
    } else {
        (None, has(b','))
    };
    let is_end = move |byte: &u8| separator.map_or(byte.is_ascii_whitespace(), |end| *byte == end);
    line.split(is_end)
        .map(<[u8]>::trim_ascii)
        .filter(move |cell| separator.is_some() || !cell.is_empty())
        .map(move |cell| {
            if decimal_comma && cell.contains(&b',') {
                cell.iter().map(|byte| if *byte == b',' { b'.' } else { *byte }).collect()
            } else {
                Cow::Borrowed(cell)
            }
        })
}

/// True if no cell is a number.
fn is_names(line: &[u8]) -> bool {
    cells(line).all(|cell| number(&cell).is_none())
}

/// The numbers read so far.
#[derive(Default)]
struct Table {
    names: Option<Vec<String>>,
    n_columns: usize,
    points: Vec<Point3>,
    /// What follows x, y and z, `n_columns - 3` numbers a point.
    rest: Vec<f64>,
}

impl Table {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        let mut position = [0.0; 3];
        let mut n_columns = 0;
        let mut cells = cells(line).peekable();
        while let Some(cell) = cells.next() {
            // A separator at the end of the line opens no further cell.
            if cell.is_empty() && cells.peek().is_none() {
                break;
            }
            let value =
                number(&cell).ok_or_else(|| format!("{} where a number must be", shown(&cell)))?;
            match position.get_mut(n_columns) {
                Some(coordinate) => *coordinate = value,
                None => self.rest.push(value),
            }
            n_columns += 1;
        }
        if n_columns < 3 {
            return Err(format!("{} where a point needs 3", counted(n_columns, "number")));
        }
        if self.points.is_empty() {
            self.n_columns = n_columns;
        }
        if n_columns != self.n_columns {
            let expected = self.n_columns;
            return Err(format!("{n_columns} numbers where the lines before have {expected}"));
        }
        self.points.push(Point3::from(position));
        Ok(())
    }

    fn finish(self) -> Raw {
        let n_rest = self.n_columns.saturating_sub(3);
        let (normal, color) = self.columns();
        let rows = || self.rest.chunks_exact(n_rest.max(1));
        let three = |row: &[f64], at: usize| [row[at], row[at + 1], row[at + 2]];
        let normals = normal.map(|at| rows().map(|row| Vector3::from(three(row, at))).collect());
        let colors =
            color.map(|at| rows().map(|row| three(row, at).map(|c| c.round() as u8)).collect());
        let n_used = 3 * (usize::from(normal.is_some()) + usize::from(color.is_some()));
        let n_left_out = n_rest.saturating_sub(n_used);
        let cloud = PointCloud { points: self.points, normals, colors };
        let mut raw = Raw::new(Surface::Points(cloud));
        if n_left_out > 0 {
            let n = counted(n_left_out, "column");
            raw.notes.push(format!("{n} that are neither normals nor colours left out"));
        }
        raw
    }

    /// Where normals and colours begin, counted after z.
    fn columns(&self) -> (Option<usize>, Option<usize>) {
        let n_rest = self.n_columns.saturating_sub(3);
        if let Some(names) = self.names.as_ref().filter(|names| names.len() == self.n_columns) {
            let starts_with = |firsts: &[&str]| {
                let at = names.iter().position(|name| firsts.contains(&name.as_str()))?;
                at.checked_sub(3).filter(|at| at + 3 <= n_rest)
            };
            return (starts_with(&["nx", "normal_x"]), starts_with(&["r", "red"]));
        }
        match n_rest {
            3 if self.are_colors(0) => (None, Some(0)),
            3 if self.are_normals(0) => (Some(0), None),
            6 if self.are_normals(0) && self.are_colors(3) => (Some(0), Some(3)),
            _ => (None, None),
        }
    }

    fn are_colors(&self, at: usize) -> bool {
        self.rest
            .chunks_exact(self.n_columns - 3)
            .flat_map(|row| &row[at..at + 3])
            .all(|value| value.fract() == 0.0 && (0.0..=255.0).contains(value))
    }

    fn are_normals(&self, at: usize) -> bool {
        self.rest
            .chunks_exact(self.n_columns - 3)
            .map(|row| Vector3::new(row[at], row[at + 1], row[at + 2]).norm())
            .all(|length| (0.99..1.01).contains(&length))
    }
}

/// Writes points with what normals and colours they have, cells apart by `separator`; a line of
/// names says which is which.
pub(super) fn write(
    out: &mut dyn Write,
    cloud: &PointCloud,
    separator: char,
) -> std::io::Result<()> {
    let mut names = vec!["x", "y", "z"];
    names.extend(cloud.normals.iter().flat_map(|_| ["nx", "ny", "nz"]));
    names.extend(cloud.colors.iter().flat_map(|_| ["r", "g", "b"]));
    writeln!(out, "# points by horma, units mm")?;
    writeln!(out, "{}", names.join(&separator.to_string()))?;
    for (i_point, point) in cloud.points.iter().enumerate() {
        write!(out, "{}{separator}{}{separator}{}", point.x, point.y, point.z)?;
        for value in cloud.normals.iter().flat_map(|normals| normals[i_point].iter()) {
            write!(out, "{separator}{value}")?;
        }
        for value in cloud.colors.iter().flat_map(|colors| colors[i_point]) {
            write!(out, "{separator}{value}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(text: &str) -> PointCloud {
        parse(text).unwrap().surface.into_points()
    }

    fn parse(text: &str) -> Result<Raw, Fault> {
        read(&mut Source::new(&mut text.as_bytes(), text.len() as u64))
    }

    #[test]
    fn any_separator_and_either_decimal_sign_gives_the_same_points() {
        for text in [
            "1.5 -2 3e1\n",
            "1.5,-2,3e1\n",
            "1.5, -2, 3e1,\n",
            "1.5\t-2\t3e1\r\n",
            "1,5;-2;3e1;\n",
            "1,5 -2,0 30,0\n",
            "\u{feff}# units mm\n// x\n\nX Y Z\n1.5 -2 30\n",
        ] {
            assert_eq!(cloud(text).points, [Point3::new(1.5, -2.0, 30.0)], "{text}");
        }
    }

    #[test]
    fn further_columns_are_told_by_name_or_by_value() {
        let up = Some(vec![Vector3::z()]);
        let red = Some(vec![[255, 0, 7]]);
        assert_eq!(cloud("1 2 3 0 0.0 -1.0\n").normals, Some(vec![-Vector3::z()]));
        assert_eq!(cloud("1 2 3 255 0 7\n").colors, red);
        let both = cloud("1 2 3 0 0 1 255 0 7\n");
        assert_eq!((both.normals, both.colors), (up.clone(), red));
        assert_eq!(cloud("x,y,z,nx,ny,nz\n1,2,3,0,0,1\n").normals, up);
        let left_out = parse("1 2 3 0.5\n").unwrap();
        assert_eq!(left_out.notes.len(), 1);
    }

    #[test]
    fn faults_name_line_and_value() {
        for (text, message) in [
            ("1 2 3\n4 5\n", "line 2: 2 numbers where a point needs 3"),
            ("1 2 3\n\n4 5 6 7\n", "line 3: 4 numbers where the lines before have 3"),
            ("# a\n1 2 three\n", "line 2: \"three\" where a number must be"),
            ("1,2,3\n1,,3\n", "line 2: \"\" where a number must be"),
        ] {
            let error = parse(text).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
