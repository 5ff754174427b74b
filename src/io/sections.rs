//! Ordered sections as CSV, in two forms.
//!
//! *Points*: a first line `# horma sections columns=N`, then `x,y,z` rows, N to a station, station
//! after station along the spindle; this is the form horma writes.
//!
//! *Radii*: a line of names whose first cell is a word (or empty) and whose others are the angles
//! [deg], then a row a station: its place along X, and the radius at each angle. The point at angle
//! a is (x, r cos a, r sin a).

use super::fault::{Fault, Place};
use super::points::{cells, is_comment};
use super::raw::Raw;
use super::source::{Source, number, shown};
use crate::geom::{LengthUnit, Point3, SectionGrid, Surface};
use std::io::Write;

const MARK: &str = "# horma sections columns=";

/// True if a file says in its first line that it holds sections.
pub(super) fn is_marked(head: &[u8]) -> bool {
    head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).starts_with(MARK.as_bytes())
}

/// True for the first line of a grid of radii: a word or nothing, then three angles at least; not
/// apart by spaces, or the `v 1 2 3` of an OBJ would be one.
pub(super) fn is_angle_header(line: &[u8]) -> bool {
    if !line.iter().any(|byte| matches!(byte, b',' | b';' | b'\t')) {
        return false;
    }
    let mut cells = cells(line);
    let is_named = cells.next().is_some_and(|cell| number(&cell).is_none());
    let mut n_angles = 0;
    is_named
        && cells.all(|cell| {
            n_angles += 1;
            number(&cell).is_some()
        })
        && n_angles >= 3
}

/// Reads a grid of either form.
pub(super) fn read(source: &mut Source<'_>) -> Result<Raw, Fault> {
    let mut grid = Grid::default();
    let mut declared = None;
    let mut line = Vec::new();
    while source.read_line(&mut line)? {
        let place = source.line_place();
        let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&line).trim_ascii();
        if is_comment(line) {
            let text = String::from_utf8_lossy(line);
            declared = declared.or_else(|| LengthUnit::declared_in(&text));
            if let Some(rest) = text.strip_prefix(MARK) {
                grid.mark(rest, place)?;
            }
        } else if grid.form.is_none() && is_angle_header(line) {
            grid.form = Some(Form::Radii(row(line, 1, place)?));
        } else {
            grid.take(line, place)?;
        }
    }
    let grid = grid.finish(source.line_place())?;
    Ok(Raw { declared, ..Raw::new(Surface::Sections(grid)) })
}

#[derive(Default)]
struct Grid {
    form: Option<Form>,
    points: Vec<Point3>,
}

enum Form {
    /// So many points a station.
    Points(usize),
    /// Radii at these angles [deg].
    Radii(Vec<f64>),
}

impl Grid {
    fn mark(&mut self, rest: &str, place: Place) -> Result<(), Fault> {
        let count = rest.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default();
        let n_columns = count.parse().ok().filter(|n| *n >= 3).ok_or_else(|| {
            Fault::malformed(place, format!("columns={count} where 3 and more must be"))
        })?;
        self.form = Some(Form::Points(n_columns));
        Ok(())
    }

    fn take(&mut self, line: &[u8], place: Place) -> Result<(), Fault> {
        match &self.form {
            None => Err(Fault::malformed(place, "a row before the line that tells the columns")),
            // A line of names over the columns.
            Some(Form::Points(_)) if cells(line).all(|cell| number(&cell).is_none()) => Ok(()),
            Some(Form::Points(_)) => {
                let [x, y, z] = row(line, 0, place)?.try_into().map_err(|row: Vec<f64>| {
                    Fault::malformed(place, format!("{} numbers where x, y, z must be", row.len()))
                })?;
                self.points.push(Point3::new(x, y, z));
                Ok(())
            }
            Some(Form::Radii(angles)) => {
                let row = row(line, 0, place)?;
                if row.len() != angles.len() + 1 {
                    let (n, expected) = (row.len(), angles.len());
                    let problem = format!("{n} cells where a station and {expected} radii must be");
                    return Err(Fault::malformed(place, problem));
                }
                if let Some(radius) = row[1..].iter().find(|radius| **radius < 0.0) {
                    return Err(Fault::malformed(place, format!("the radius {radius}")));
                }
                self.points.extend(angles.iter().zip(&row[1..]).map(|(angle_deg, radius)| {
                    let (sin, cos) = angle_deg.to_radians().sin_cos();
                    Point3::new(row[0], radius * cos, radius * sin)
                }));
                Ok(())
            }
        }
    }

    fn finish(self, end: Place) -> Result<SectionGrid, Fault> {
        let n_columns = match &self.form {
            Some(Form::Points(n_columns)) => *n_columns,
            Some(Form::Radii(angles)) => {
                let span = angles[angles.len() - 1] - angles[0];
                if !angles.is_sorted_by(|a, b| a < b) || span >= 360.0 {
                    let problem = "the angles do not rise within one turn";
                    return Err(Fault::malformed(Place::Line(1), problem));
                }
                angles.len()
            }
            None => return Err(Fault::Nothing("sections")),
        };
        let n_points = self.points.len();
        if !n_points.is_multiple_of(n_columns) || n_points < 2 * n_columns {
            let problem = format!(
                "{n_points} points are no whole number of stations (two or more) of {n_columns}"
            );
            return Err(Fault::malformed(end, problem));
        }
        Ok(SectionGrid { n_columns, points: self.points })
    }
}

/// The numbers of a line after the first `n_skipped` cells.
fn row(line: &[u8], n_skipped: usize, place: Place) -> Result<Vec<f64>, Fault> {
    cells(line)
        .skip(n_skipped)
        .map(|cell| {
            number(&cell).ok_or_else(|| {
                Fault::malformed(place, format!("{} where a number must be", shown(&cell)))
            })
        })
        .collect()
}

/// Writes the form of points.
pub(super) fn write(out: &mut dyn Write, grid: &SectionGrid) -> std::io::Result<()> {
    writeln!(out, "{MARK}{} units mm\nx,y,z", grid.n_columns)?;
    for point in &grid.points {
        writeln!(out, "{},{},{}", point.x, point.y, point.z)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<SectionGrid, Fault> {
        let raw = read(&mut Source::new(&mut text.as_bytes(), text.len() as u64))?;
        let Surface::Sections(grid) = raw.surface else { panic!("a grid") };
        Ok(grid)
    }

    #[test]
    fn radii_turn_from_y_towards_z() {
        let grid = parse("x\\angle;0;90;180\n0;1;2;3\n10;1,5;2;3\n").unwrap();
        assert_eq!((grid.n_columns, grid.n_rows()), (3, 2));
        let near = |i: usize, x, y, z| {
            assert!((grid.points[i] - Point3::new(x, y, z)).norm() < 1e-12, "{:?}", grid.points[i]);
        };
        near(1, 0.0, 0.0, 2.0);
        near(2, 0.0, -3.0, 0.0);
        near(3, 10.0, 1.5, 0.0);
    }

    #[test]
    fn faults_name_line_and_value() {
        let mark = "# horma sections columns=3\n";
        for (text, message) in [
            (format!("{mark}1,2,3\n1,2,3\n1,2,3\n1,2,3\n"), "line 5: 4 points are no whole"),
            (format!("{mark}1,2,3\n1,2,3\n1,2,3\n"), "line 4: 3 points are no whole number"),
            (format!("{mark}1,2\n"), "line 2: 2 numbers where x, y, z must be"),
            ("# horma sections columns=2\n".into(), "line 1: columns=2 where 3 and more"),
            ("s,0,120,240\n1,2,3\n".into(), "line 2: 3 cells where a station and 3 radii"),
            ("s,0,120,240\n1,2,-3,1\n".into(), "line 2: the radius -3"),
            ("s,0,240,120\n1,2,3,1\n".into(), "line 1: the angles do not rise"),
            ("s,0,120,360\n1,2,3,1\n".into(), "line 1: the angles do not rise"),
        ] {
            let error = parse(&text).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
