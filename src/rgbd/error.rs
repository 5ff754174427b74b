//! Why pictures, cameras or paths cannot be used.

/// Why a camera, an image, a frame or a path cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RgbdError {
    /// A number of a camera or a sensor out of range.
    #[error("{key} is {value}: it must be {rule}")]
    Number {
        /// What it is called, as in files and flags.
        key: &'static str,
        /// What was given.
        value: f64,
        /// What it must be.
        rule: &'static str,
    },
    /// Not as many pixels as a size says.
    #[error("{n_pixels} pixels are no picture of {width} x {height}")]
    Pixels {
        /// How many there are.
        n_pixels: usize,
        /// Pixels per row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Two pictures that belong together differ in size.
    #[error(
        "the {what} is {found_width} x {found_height}, but the {other} is {width} x {height}; \
         register and resize them to one size first"
    )]
    Size {
        /// The picture.
        what: &'static str,
        /// Its pixels per row.
        found_width: usize,
        /// Its rows.
        found_height: usize,
        /// What it belongs to.
        other: &'static str,
        /// Pixels per row there.
        width: usize,
        /// Rows there.
        height: usize,
    },
    /// A disparity without a depth.
    #[error(
        "the disparity {value} at column {column} of row {row} is not below the offset {offset}: its \
         depth would be infinite or negative; give the offset this sensor was calibrated to"
    )]
    Disparity {
        /// Its column, from 0.
        column: usize,
        /// Its row, from 0.
        row: usize,
        /// The disparity.
        value: u16,
        /// The offset of the sensor.
        offset: f64,
    },
    /// Nothing was measured.
    #[error(
        "no pixel has a depth: the sensor was covered, too close, or its pictures are no depth"
    )]
    NoReadings,
    /// Depths no such camera sees.
    #[error(
        "half of the depths lie below {median} mm, where depth cameras see 100 mm to 20 m: the depth \
         scale is wrong; state how many units of the picture are a metre (depth-scale)"
    )]
    Scale {
        /// The median of the readings [mm].
        median: f32,
    },
    /// A path whose stamps do not rise.
    #[error(
        "pose {number} has the stamp {stamp}, but the one before has {before}: stamps must rise; \
         sort them and leave repeated ones out"
    )]
    Stamps {
        /// The pose, counted from 1.
        number: usize,
        /// Its stamp [s].
        stamp: f64,
        /// The stamp before [s].
        before: f64,
    },
    /// A pose that is no number somewhere.
    #[error("pose {number} (stamp {stamp}) has a value that is no finite number; leave it out")]
    Pose {
        /// The pose, counted from 1.
        number: usize,
        /// Its stamp [s].
        stamp: f64,
    },
}

/// A frame of a sequence that cannot be had.
#[derive(Debug, thiserror::Error)]
#[error("frame {number}: {problem}")]
pub struct SequenceError {
    /// The frame, counted from 1.
    pub number: usize,
    /// What is wrong with it: most often a file that cannot be read.
    pub problem: Box<dyn std::error::Error + Send + Sync>,
}
