//! What a page of a scan shows, however the scan was made.

use super::super::{Block, Figure, Page, Picture, Section, Table};
use super::pictures;
use crate::geom::{Point3, TriMesh};

/// Rows of a table that are listed at most.
const MOST_LISTED: usize = 100;

/// What a scan leaves to be shown. All places are in the frame of the first camera: x to its right, y
/// down, z ahead [mm].
pub(super) struct Shown {
    pub(super) title: String,
    pub(super) subtitle: String,
    pub(super) warnings: Vec<String>,
    pub(super) figures: Vec<Figure>,
    pub(super) seen: Seen,
    /// The way of the camera, and where it goes on elsewhere another one.
    pub(super) ways: Vec<Vec<Point3>>,
    /// Both ends of every loop that closed.
    pub(super) loops: Vec<[Point3; 2]>,
    /// What is known of every frame.
    pub(super) curves: Vec<Curve>,
    /// How many frames became what.
    pub(super) counts: Vec<(String, String)>,
    /// Frames that are not simply believed: number, stamp, what they became, why.
    pub(super) odd: Vec<Vec<String>>,
    /// What else there is to tell.
    pub(super) sections: Vec<Section>,
    pub(super) facts: Vec<(String, String)>,
    pub(super) notes: Vec<String>,
}

/// What was seen, as a surface that can be drawn.
pub(super) struct Seen {
    /// What it is called.
    pub(super) title: &'static str,
    /// How to read its pictures.
    pub(super) caption: &'static str,
    pub(super) mesh: TriMesh,
    /// Points of it, for plans; some of them are drawn.
    pub(super) points: Vec<Point3>,
}

/// A number of every frame over time, a gap where there is none.
pub(super) struct Curve {
    pub(super) title: &'static str,
    pub(super) caption: &'static str,
    /// What it is and its unit.
    pub(super) label: &'static str,
    /// Seconds since the first frame, and the number.
    pub(super) points: Vec<[f64; 2]>,
}

impl Shown {
    /// The page.
    pub(super) fn page(self) -> std::io::Result<Page> {
        let mut sections = Vec::new();
        if !self.seen.points.is_empty() {
            let pictures = pictures::seen(&self)?;
            sections.push(section(self.seen.title, vec![Block::Pictures(pictures)]));
        }
        let plans = pictures::plans(&self);
        sections.push(section("Way of the camera", vec![Block::Pictures(plans)]));
        let curves: Vec<Picture> = self.curves.iter().filter_map(pictures::curve).collect();
        let mut frames = Vec::new();
        if !curves.is_empty() {
            frames.push(Block::Pictures(curves));
        }
        frames.push(Block::Facts(self.counts));
        frames.extend(listed(&["Frame", "Stamp [s]", "Became", "Because"], self.odd));
        sections.push(section("Frames", frames));
        sections.extend(self.sections);
        sections.push(section("How it was done", vec![Block::Facts(self.facts)]));
        if !self.notes.is_empty() {
            sections.push(section("Notes", self.notes.into_iter().map(Block::Text).collect()));
        }
        let Self { title, subtitle, warnings, figures, .. } = self;
        Ok(Page { title, subtitle, warnings, figures, sections })
    }
}

/// A section.
pub(super) fn section(title: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_owned(), blocks }
}

/// A number that matters.
pub(super) fn figure(label: &str, value: String, unit: &str) -> Figure {
    Figure { label: label.to_owned(), value, unit: unit.to_owned() }
}

/// The first rows as a table, and how many more there are; nothing of none.
pub(super) fn listed(columns: &[&str], mut rows: Vec<Vec<String>>) -> Vec<Block> {
    if rows.is_empty() {
        return Vec::new();
    }
    let n_more = rows.len().saturating_sub(MOST_LISTED);
    rows.truncate(MOST_LISTED);
    let columns = columns.iter().map(|&column| column.to_owned()).collect();
    let mut blocks = vec![Block::Table(Table { columns, rows })];
    if n_more > 0 {
        blocks.push(Block::Text(format!("And {n_more} more.")));
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_table_is_cut_and_says_so() {
        let rows = |n: usize| (0..n).map(|i| vec![i.to_string()]).collect::<Vec<_>>();
        assert_eq!(listed(&["Frame"], rows(0)), []);
        assert_eq!(listed(&["Frame"], rows(MOST_LISTED)).len(), 1);
        let blocks = listed(&["Frame"], rows(MOST_LISTED + 7));
        let Block::Table(table) = &blocks[0] else { panic!("{blocks:?}") };
        assert_eq!(table.rows.len(), MOST_LISTED);
        assert_eq!(blocks[1], Block::Text("And 7 more.".into()));
    }
}
