//! Which format a file is in: by what it holds; its name only helps where text could be anything.

use super::source::{number, words};
use crate::geom::Surface;
use std::fmt;
use std::path::Path;

/// A format that parts come in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// STL of 50 bytes a triangle.
    StlBinary,
    /// STL as text.
    StlAscii,
    /// Stanford PLY, ASCII or binary.
    Ply,
    /// Wavefront OBJ.
    Obj,
    /// glTF 2.0 in one binary file.
    Glb,
    /// glTF 2.0 as JSON, its buffers inside or beside it.
    Gltf,
    /// The Point Cloud Library's PCD; read only.
    Pcd,
    /// A point a line: XYZ, ASC, TXT, CSV.
    ///
    /// Columns are `x y z`, then what a line of names says (`nx ny nz`, `r g b`) or, without one,
    /// what the values look like. Cells are apart by white space, commas or semicolons; lines that
    /// begin with `#`, `//`, `;` or `%` are comments.
    Points,
    /// Ordered sections as CSV, in one of two forms.
    ///
    /// *Points*: a first line `# horma sections columns=N`, then `x,y,z` rows, N to a station,
    /// station after station along the spindle. *Radii*: a line of names whose first cell is a word
    /// (or empty) and whose others are the angles in degrees, then a row a station: its place along
    /// X, and the radius at each angle a; the point is (x, r cos a, r sin a).
    Sections,
}

impl Format {
    /// All of them, for messages.
    pub const NAMES: &str =
        "STL, PLY, OBJ, glTF/GLB, PCD, points as XYZ/ASC/TXT/CSV, section grids as CSV";
    /// The extensions horma writes.
    pub const WRITTEN_EXTENSIONS: &str = ".stl .ply .obj .glb .xyz .asc .txt .csv";

    /// The format of a file of `size` bytes that begins with `head` (1 KiB and more where there is
    /// so much); `None` if it is none.
    pub fn detect(head: &[u8], size: u64, path: &Path) -> Option<Self> {
        let extension = extension(path);
        let text = trim_front(head);
        if head.starts_with(b"glTF") {
            Some(Self::Glb)
        } else if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") {
            Some(Self::Ply)
        } else if is_pcd(text) {
            Some(Self::Pcd)
        } else if is_whole_binary_stl(head, size) {
            Some(Self::StlBinary)
        } else if !is_text(head) {
            // Cut off or lying: the reader says which.
            (extension == "stl").then_some(Self::StlBinary)
        } else if text.len() >= 5 && text[..5].eq_ignore_ascii_case(b"solid") {
            Some(Self::StlAscii)
        } else if text.starts_with(b"{") {
            (extension == "gltf" || contains(head, b"\"asset\"")).then_some(Self::Gltf)
        } else {
            of_lines(head, &extension)
        }
    }

    /// The format that the name `path` asks `surface` to be written in.
    pub fn to_write(path: &Path, surface: &Surface) -> Option<Self> {
        match extension(path).as_str() {
            "csv" if matches!(surface, Surface::Sections(_)) => Some(Self::Sections),
            "stl" => Some(Self::StlBinary),
            "ply" => Some(Self::Ply),
            "obj" => Some(Self::Obj),
            "glb" => Some(Self::Glb),
            "xyz" | "asc" | "txt" | "csv" => Some(Self::Points),
            _ => None,
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::StlBinary => "STL (binary)",
            Self::StlAscii => "STL (ASCII)",
            Self::Ply => "PLY",
            Self::Obj => "OBJ",
            Self::Glb => "GLB",
            Self::Gltf => "glTF",
            Self::Pcd => "PCD",
            Self::Points => "points as text",
            Self::Sections => "section grid (CSV)",
        })
    }
}

/// The extension of `path` in small letters, empty if there is none.
pub(super) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Without a byte order mark and leading white space.
fn trim_front(head: &[u8]) -> &[u8] {
    head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start()
}

fn is_pcd(text: &[u8]) -> bool {
    text.starts_with(b"# .PCD")
        || (contains(text, b"FIELDS ") && contains(text, b"POINTS ") && contains(text, b"DATA "))
}

/// The size gives a binary STL away, even where its header begins with `solid`.
fn is_whole_binary_stl(head: &[u8], size: u64) -> bool {
    let Some(count) = head.get(80..84).and_then(|bytes| bytes.try_into().ok()) else {
        return false;
    };
    84 + 50 * u64::from(u32::from_le_bytes(count)) == size
}

fn is_text(head: &[u8]) -> bool {
    head.iter().all(|byte| matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c | 0x20..=0x7e | 0x80..))
}

fn contains(head: &[u8], needle: &[u8]) -> bool {
    head.windows(needle.len()).any(|window| window == needle)
}

/// Tells OBJ, points and sections by the first lines that are no comment.
fn of_lines(head: &[u8], extension: &str) -> Option<Format> {
    if super::sections::is_marked(head) {
        return Some(Format::Sections);
    }
    let lines = trim_front(head).split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    for line in lines.filter(|line| !super::points::is_comment(line)).take(100) {
        if super::sections::is_angle_header(line) {
            return Some(Format::Sections);
        }
        let first = words(line).next().unwrap_or_default();
        if is_obj_keyword(first) && !line.contains(&b',') {
            return Some(Format::Obj);
        }
        if super::points::cells(line).filter_map(|cell| number(&cell)).count() >= 3 {
            return Some(Format::Points);
        }
        // One line of names over the columns is allowed, and so are a few words over an OBJ.
        if !matches!(extension, "obj" | "xyz" | "asc" | "txt" | "csv") {
            break;
        }
    }
    // An OBJ of comments alone is an OBJ with nothing in it.
    (extension == "obj").then_some(Format::Obj)
}

fn is_obj_keyword(word: &[u8]) -> bool {
    matches!(word, b"v" | b"vn" | b"vt" | b"f" | b"o" | b"g" | b"s" | b"mtllib" | b"usemtl")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detect(head: &[u8], name: &str) -> Option<Format> {
        Format::detect(head, head.len() as u64, Path::new(name))
    }

    #[test]
    fn content_wins_over_the_name() {
        assert_eq!(detect(b"ply\nformat ascii 1.0\n", "part.stl"), Some(Format::Ply));
        assert_eq!(detect(b"glTF\x02\0\0\0", "part.obj"), Some(Format::Glb));
        assert_eq!(detect(b"# .PCD v0.7\nVERSION 0.7\n", "part"), Some(Format::Pcd));
        assert_eq!(detect(b"\n  solid a\nfacet normal", "part"), Some(Format::StlAscii));
        assert_eq!(detect(b"{ \"asset\": {} }", "part"), Some(Format::Gltf));
        assert_eq!(detect(b"# made by hand\nv 1 2 3\nv 4 5 6\n", "part"), Some(Format::Obj));
        assert_eq!(detect(b"// scan\n1 2 3\n4 5 6\n", "part"), Some(Format::Points));
        assert_eq!(detect(b"1;2;3\n4;5;6\n", "part"), Some(Format::Points));
        assert_eq!(detect(b"x,y,z\n1,2,3\n", "part.csv"), Some(Format::Points));
        assert_eq!(detect(b"station,0,120,240\n1,2,3,4\n", "part.csv"), Some(Format::Sections));
    }

    #[test]
    fn a_binary_stl_whose_header_says_solid_is_binary() {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(84 + 50, 0);
        bytes[80] = 1;
        assert_eq!(detect(&bytes, "part.stl"), Some(Format::StlBinary));
    }

    #[test]
    fn what_is_nothing_stays_nothing() {
        assert_eq!(detect(b"\x89PNG\r\n\x1a\n\0\0", "part.png"), None);
        assert_eq!(detect(b"Dear Sir or Madam", "letter.txt"), None);
        assert_eq!(detect(b"ISO-10303-21;\nHEADER;\n", "part.step"), None);
    }
}
