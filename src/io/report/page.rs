//! What a report says, before it is a page of HTML.

/// A whole report.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Page {
    /// Its heading.
    pub title: String,
    /// One line below the heading.
    pub subtitle: String,
    /// What the reader must know before anything is cut; shown first.
    pub warnings: Vec<String>,
    /// The few numbers that matter, shown large.
    pub figures: Vec<Figure>,
    /// Everything else, in order.
    pub sections: Vec<Section>,
}

/// A number that matters.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Figure {
    /// What it is.
    pub label: String,
    /// The number, as it shall be read.
    pub value: String,
    /// Its unit; may be empty.
    pub unit: String,
}

/// A part of the report under its own heading.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// What stands below it.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Names and their values.
    Facts(Vec<(String, String)>),
    /// Rows under column headings.
    Table(Table),
    /// Pictures, side by side where there is room.
    Pictures(Vec<Picture>),
}

/// Rows under column headings.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Table {
    /// The headings.
    pub columns: Vec<String>,
    /// One cell per heading each.
    pub rows: Vec<Vec<String>>,
}

/// A picture with words to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// What is seen, in a few words.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// The picture itself.
    pub image: Image,
}

/// How a picture is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Image {
    /// The bytes of a PNG file, as [`encode_png`](super::encode_png) makes them.
    Png(Vec<u8>),
    /// An `svg` element, as the charts make it; it goes into the page as it is.
    Svg(String),
}
