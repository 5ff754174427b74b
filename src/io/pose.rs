//! A rigid motion as text: four rows of four numbers.

use super::source::number;
use crate::geom::{LengthUnit, Matrix3, Pose};
use std::fmt::Write as _;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// No motion is longer; what is, is another file [bytes].
const LARGEST: u64 = 1 << 16;
/// How far a matrix may be from a rotation, by the digits people write.
const DIGITS: f64 = 1e-3;

/// Why a file holds no motion.
#[derive(Debug, thiserror::Error)]
pub enum PoseError {
    /// The system refused.
    #[error("cannot read {path:?}: {source}; check the path")]
    System {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is no matrix.
    #[error("{path:?} is no text of a 4 x 4 matrix: {what}")]
    NoMatrix {
        /// The file.
        path: PathBuf,
        /// What is there instead.
        what: String,
    },
    /// A word is no number.
    #[error("{path:?}, line {line}: {word:?} is no finite number")]
    Number {
        /// The file.
        path: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What stands there.
        word: String,
    },
    /// A matrix, but of no rigid motion.
    #[error("{path:?} is no rigid motion: {what}")]
    NotRigid {
        /// The file.
        path: PathBuf,
        /// Why.
        what: String,
    },
}

/// Reads a motion from the file `path`: four rows of four numbers, or the first three rows.
///
/// Lines that begin with `#` are comments. Its lengths are in the unit that a comment declares
/// (`# units m`), else in `unit`.
pub fn read_pose(path: &Path, unit: LengthUnit) -> Result<Pose, PoseError> {
    let system = |source| PoseError::System { path: path.into(), source };
    let no_matrix = |what: &str| PoseError::NoMatrix { path: path.into(), what: what.to_owned() };
    let file = File::open(path).map_err(system)?;
    let mut bytes = Vec::new();
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(system)?;
    if bytes.len() as u64 > LARGEST {
        return Err(no_matrix("it is larger than 64 KiB"));
    }
    let text = String::from_utf8(bytes).map_err(|_| no_matrix("it is not UTF-8"))?;
    let (rows, declared) = parse(&text, path)?;
    let unit = declared.unwrap_or(unit);
    let rotation = Matrix3::from_fn(|a, b| rows[4 * a + b]);
    check(&rows, &rotation)
        .map_err(|what| PoseError::NotRigid { path: path.into(), what: what.to_owned() })?;
    let shift = [3, 7, 11].map(|k| rows[k] * unit.in_mm());
    let rotation = nalgebra::UnitQuaternion::from_matrix(&rotation);
    Ok(Pose::from_parts(shift.into(), rotation))
}

/// The motion as text, its lengths in `unit`; a comment says so, in words that [`read_pose`] takes.
pub fn pose_text(name: &str, pose: &Pose, unit: LengthUnit) -> String {
    let mut text = format!("# {name}: 4 x 4, row by row; units {unit}\n");
    let mut matrix = pose.to_homogeneous();
    for k in 0..3 {
        matrix[(k, 3)] /= unit.in_mm();
    }
    for row in matrix.row_iter() {
        let cells: Vec<String> = row.iter().map(|x| format!("{:.17}", x + 0.0)).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", cells.join(" "));
    }
    text
}

/// The numbers of a matrix, twelve or sixteen, and the unit a comment declares.
fn parse(text: &str, path: &Path) -> Result<(Vec<f64>, Option<LengthUnit>), PoseError> {
    let mut numbers = Vec::new();
    let mut declared = None;
    for (line, i_line) in text.lines().zip(1..) {
        if let Some(comment) = line.trim_start().strip_prefix('#') {
            declared = declared.or(LengthUnit::declared_in(comment));
            continue;
        }
        let words = line.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty());
        for word in words {
            let value = number(word.as_bytes()).filter(|value| value.is_finite());
            numbers.push(value.ok_or_else(|| PoseError::Number {
                path: path.into(),
                line: i_line,
                word: word.chars().take(40).collect(),
            })?);
        }
    }
    if matches!(numbers.len(), 12 | 16) {
        return Ok((numbers, declared));
    }
    let what = format!("{} numbers where 16 (or the first 12) should be", numbers.len());
    Err(PoseError::NoMatrix { path: path.into(), what })
}

fn check(rows: &[f64], rotation: &Matrix3) -> Result<(), &'static str> {
    let is_last_row = |row: &[f64]| row.iter().zip([0.0, 0.0, 0.0, 1.0]).all(|(a, b)| *a == b);
    if !rows.get(12..).is_none_or(|row| row.is_empty() || is_last_row(row)) {
        return Err("its last row is not 0 0 0 1; is it written column by column?");
    }
    let off = (rotation.transpose() * rotation - Matrix3::identity()).amax();
    if off > DIGITS {
        return Err("its first three columns are not unit vectors square to each other; \
                    take the scale out of it");
    }
    if rotation.determinant() < 0.0 {
        return Err("it mirrors; mirror the part first and give a motion that turns");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vector3;

    fn read(text: &str) -> Result<Pose, PoseError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("T.txt");
        std::fs::write(&path, text).unwrap();
        read_pose(&path, LengthUnit::Metre)
    }

    fn refused(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    #[test]
    fn what_is_written_reads_back_in_the_unit_it_says() {
        let pose = Pose::new(Vector3::new(12.5, -3.0, 1e6), Vector3::new(0.3, -0.2, 0.1));
        for unit in [LengthUnit::Millimetre, LengthUnit::Metre, LengthUnit::Inch] {
            let text = pose_text("target_from_source", &pose, unit);
            assert!(
                text.starts_with(&format!(
                    "# target_from_source: 4 x 4, row by row; units {unit}\n"
                ))
            );
            let back = read(&text).unwrap();
            assert!((back.to_homogeneous() - pose.to_homogeneous()).amax() < 1e-8, "{text}");
        }
    }

    #[test]
    fn twelve_numbers_with_commas_and_no_unit_are_taken_in_the_unit_given() {
        let pose = read("1,0,0,0.5\n0,1,0,0\n\n0,0,1,-2\n").unwrap();
        assert_eq!(pose.translation.vector, Vector3::new(500.0, 0.0, -2000.0));
    }

    #[test]
    fn what_is_no_rigid_motion_is_refused_with_its_reason() {
        assert!(refused("1 0 0\n0 1 0\n").contains("6 numbers where 16 (or the first 12)"));
        assert!(refused("1 0 0 0\n0 1 x 0\n").contains("line 2: \"x\" is no finite number"));
        assert!(refused("1 0 0 inf 0 1 0 0 0 0 1 0").contains("line 1: \"inf\" is no finite"));
        assert!(refused("-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n").contains("it mirrors"));
        assert!(refused("2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n").contains("take the scale out"));
        assert!(refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n").contains("column by column"));
        assert!(refused(&"1 ".repeat(40_000)).contains("larger than 64 KiB"));
        let missing = read_pose(Path::new("no-such-file"), LengthUnit::Metre).unwrap_err();
        assert!(missing.to_string().contains("no-such-file"));
    }
}
