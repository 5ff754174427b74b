//! What a simulation tells.

use super::fixtures::Fixture;
use crate::measure::Spot;
use crate::stock::Resolution;
use crate::tool::BodyPart;
use serde::Serialize;

/// Collisions are all counted, but only so many told.
const MOST_COLLISIONS: usize = 100;

/// What happened while a program ran. Lengths in millimetres, volumes in mm3, times in seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct SimulationReport {
    /// Moves, rapids and feeds.
    pub n_moves: usize,
    /// The block before the program.
    pub start_volume: f64,
    /// What is left of it.
    pub end_volume: f64,
    /// What was taken away.
    pub removed: f64,
    /// Time of the feed moves that are no leads.
    pub feed_seconds: f64,
    /// The part of it in which less than 0.01 mm is cut.
    pub air_seconds: f64,
    /// That as a share of it.
    pub air_share: f64,
    /// The most material over the tool, along a ray, since its engagement (since the last rapid)
    /// began. What `--max-depth` bounds; where the tool runs down a wall, the height of the wall.
    pub greatest_depth: Option<Extreme>,
    /// The deepest cut: how thick a layer an engagement took, from a place of the new surface to the
    /// nearest of the old one. At most what `greatest_depth` is; a sliver thinner than the way from
    /// ray to ray counts for that at most.
    pub thickest_cut: Option<Spot>,
    /// The most material in a second, over one move [mm3/s].
    pub greatest_rate: Option<Extreme>,
    /// What of the tools does not cut, and was looked at.
    pub bodies: BodiesReport,
    /// What stands around the part and was looked at.
    pub fixtures: Vec<Fixture>,
    /// How many collisions there were.
    pub n_collisions: usize,
    /// The first hundred of them.
    pub collisions: Vec<Collision>,
    /// Moves that passed beneath material standing over the tool, as seen along a ray: it was kept
    /// whole, with what they took from below it.
    pub n_overhanging: usize,
    /// How exact all this is.
    pub resolution: ResolutionReport,
}

/// The greatest of something, and where.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Extreme {
    /// How great.
    pub value: f64,
    /// The line of the program.
    pub line: u32,
}

/// A move that must not be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Collision {
    /// The line of the program.
    pub line: u32,
    /// What collides.
    pub kind: CollisionKind,
    /// What runs into a fixture, if it is not what cuts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by: Option<BodyPart>,
    /// How deep [mm].
    pub depth: f64,
}

/// What collides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CollisionKind {
    /// A rapid runs through material.
    Rapid,
    /// The tool cuts the part off: it lies across the spindle axis.
    AcrossAxis,
    /// The tool goes below the block: into the table.
    BelowBlock,
    /// Material reaches into what carries a wheel.
    Arbor,
    /// Material reaches into the shank of an end mill: it rubs above its flutes.
    Shank,
    /// Material reaches into what holds an end mill.
    Holder,
    /// Material reaches into the spindle.
    Spindle,
    /// The tool runs into what holds an end of the part.
    Dog,
    /// The tool runs into the table.
    Table,
}

/// What of the tools does not cut, and was looked at.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct BodiesReport {
    /// The parts looked at, tool by tool.
    pub checked: Vec<CheckedBody>,
    /// Tools whose library does not say what of them does not cut: nothing of it was looked at.
    pub unknown: Vec<String>,
    /// After so many collisions of bodies nobody looked any more: the line of the last.
    pub stopped_at: Option<u32>,
}

/// A tool whose body was looked at.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct CheckedBody {
    /// The tool's name.
    pub tool: String,
    /// What of it was looked at.
    pub parts: Vec<BodyPart>,
}

/// How exact a simulation is. What the rays show is right to within `sweep`; between them lies what
/// the others bound.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ResolutionReport {
    /// From ray to ray along X [mm].
    pub along: f64,
    /// From ray to ray around the part, at the block's greatest radius; across X on a table [mm].
    pub across: f64,
    /// Rays end no more than this too far out, because moves are followed in steps; along the
    /// surface's normal [mm].
    pub sweep: f64,
    /// A hollow cut by the tool is no deeper than shown by more than this; absent for a tool with a
    /// sharp edge or point, whose cut may hide between two rays [mm].
    pub hollow: Option<f64>,
    /// Ridges along X stand no higher than shown by more than this, on 99 % of the rays [mm].
    pub ridge: f64,
}

impl Collision {
    /// What it is, for people.
    pub fn in_words(&self) -> String {
        match self.kind {
            CollisionKind::Rapid => {
                format!("a rapid runs {:.2} mm deep through material", self.depth)
            }
            CollisionKind::AcrossAxis => {
                "the tool lies across the spindle axis and cuts the part in two".into()
            }
            CollisionKind::BelowBlock => "the tool goes below the block, into the table".into(),
            CollisionKind::Shank => {
                format!("the shank rubs, {:.2} mm of material above the flutes", self.depth)
            }
            CollisionKind::Arbor => self.body("arbor"),
            CollisionKind::Holder => self.body("holder"),
            CollisionKind::Spindle => self.body("spindle"),
            CollisionKind::Dog => self.fixture("a dog"),
            CollisionKind::Table => self.fixture("the table"),
        }
    }

    fn fixture(&self, fixture: &str) -> String {
        let part = self.by.map_or("tool", BodyPart::word);
        format!("the {part} runs {:.2} mm deep into {fixture}", self.depth)
    }

    fn body(&self, part: &str) -> String {
        format!("the {part} runs {:.2} mm deep into material", self.depth)
    }
}

impl From<Fixture> for CollisionKind {
    fn from(fixture: Fixture) -> Self {
        match fixture {
            Fixture::Dog => Self::Dog,
            Fixture::Table => Self::Table,
        }
    }
}

impl From<BodyPart> for CollisionKind {
    fn from(part: BodyPart) -> Self {
        match part {
            BodyPart::Arbor => Self::Arbor,
            BodyPart::Shank => Self::Shank,
            BodyPart::Holder => Self::Holder,
            BodyPart::Spindle => Self::Spindle,
        }
    }
}

impl SimulationReport {
    /// A report of nothing done yet to a block of so much volume.
    pub(super) fn new(start_volume: f64, resolution: Resolution) -> Self {
        Self {
            n_moves: 0,
            start_volume,
            end_volume: start_volume,
            removed: 0.0,
            feed_seconds: 0.0,
            air_seconds: 0.0,
            air_share: 0.0,
            greatest_depth: None,
            thickest_cut: None,
            greatest_rate: None,
            bodies: BodiesReport::default(),
            fixtures: Vec::new(),
            n_collisions: 0,
            collisions: Vec::new(),
            n_overhanging: 0,
            resolution: ResolutionReport {
                along: resolution.along,
                across: resolution.across,
                sweep: 0.0,
                hollow: None,
                ridge: 0.0,
            },
        }
    }

    pub(super) fn collide(&mut self, collision: Collision) {
        self.n_collisions += 1;
        if self.collisions.len() < MOST_COLLISIONS {
            self.collisions.push(collision);
        }
    }
}
