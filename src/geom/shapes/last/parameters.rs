//! What a last is asked to be, and the sizes that follow.

/// The last to draw. What is not given follows from the length, as on a men's last.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct LastParameters {
    /// Stick length: back of the heel to tip of the toe [mm].
    #[arg(long, value_name = "MM", default_value_t = Self::default().length)]
    pub length: f64,
    /// The foot it is for.
    #[arg(long, value_enum, default_value_t = Self::default().side)]
    pub side: Side,
    /// Taut tape round the ball [mm; default: 0.945 of the length].
    #[arg(long, value_name = "MM")]
    pub ball_girth: Option<f64>,
    /// Ground to the rear of the heel seat [mm; default: 0.085 of the length].
    #[arg(long, value_name = "MM")]
    pub heel_height: Option<f64>,
    /// Ground to the bottom's foremost point [mm; default: 0.038 of the length].
    #[arg(long, value_name = "MM")]
    pub toe_spring: Option<f64>,
    /// Ground to the front edge of the cone top [mm; default: 0.31 of the length over the seat].
    #[arg(long, value_name = "MM")]
    pub cone_height: Option<f64>,
    /// Back of the heel to the front edge of the cone top [mm; default: 0.4 of the length].
    #[arg(long, value_name = "MM")]
    pub cone_length: Option<f64>,
    /// Outline of the toe: 1.6 pointed, 2 round, 4 square.
    #[arg(long, value_name = "N", default_value_t = Self::default().toe_roundness)]
    pub toe_roundness: f64,
    /// Size of the triangles, about [mm; default: 0.0075 of the length].
    #[arg(long, value_name = "MM")]
    pub resolution: Option<f64>,
}

impl Default for LastParameters {
    fn default() -> Self {
        Self {
            length: 265.0,
            side: Side::Left,
            ball_girth: None,
            heel_height: None,
            toe_spring: None,
            cone_height: None,
            cone_length: None,
            toe_roundness: 2.0,
            resolution: None,
        }
    }
}

/// Left or right foot.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// Medial side at negative Y.
    Left,
    /// Medial side at positive Y: the mirror image.
    Right,
}

/// Why a last cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LastError {
    /// A parameter lies outside what makes a last of this length.
    #[error("{name} is {value}, but this last takes {min:.1} to {max:.1}; change it or the length")]
    OutOfRange {
        /// The parameter as the command line spells it.
        name: &'static str,
        /// What was asked for.
        value: f64,
        /// The least possible.
        min: f64,
        /// The greatest possible.
        max: f64,
    },
    /// No fullness of the form gives the girth.
    #[error("no last of length {length} mm has a ball girth of {girth} mm; change one of the two")]
    Unfitted {
        /// The girth asked for [mm].
        girth: f64,
        /// The length asked for [mm].
        length: f64,
    },
}

/// Every size settled and checked [mm].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sizes {
    pub(super) length: f64,
    pub(super) ball_girth: f64,
    pub(super) heel_height: f64,
    pub(super) toe_spring: f64,
    pub(super) cone_height: f64,
    pub(super) cone_length: f64,
    pub(super) toe_roundness: f64,
    pub(super) resolution: f64,
}

impl LastParameters {
    /// What follows from the length filled in, and all of it checked.
    pub(super) fn sizes(&self) -> Result<Sizes, LastError> {
        let length = within("length", self.length, 20.0, 2000.0)?;
        let part = |name, given: Option<f64>, usual: f64, min, max| {
            within(name, given.unwrap_or(usual * length), min * length, max * length)
        };
        let heel_height = part("heel-height", self.heel_height, 0.085, 0.0, 0.3)?;
        let seat = heel_height / length;
        let lowest = (seat + 0.24).max(0.3);
        Ok(Sizes {
            length,
            heel_height,
            ball_girth: part("ball-girth", self.ball_girth, 0.945, 0.75, 1.2)?,
            toe_spring: part("toe-spring", self.toe_spring, 0.038, 0.0, 0.12)?,
            // The cone must stand clear of the fullest forepart.
            cone_height: part("cone-height", self.cone_height, seat + 0.31, lowest, seat + 0.4)?,
            cone_length: part("cone-length", self.cone_length, 0.4, 0.34, 0.46)?,
            toe_roundness: within("toe-roundness", self.toe_roundness, 1.6, 4.0)?,
            // Finer than this would be millions of triangles.
            resolution: part("resolution", self.resolution, 0.0075, 0.0015, 0.05)?,
        })
    }
}

fn within(name: &'static str, value: f64, min: f64, max: f64) -> Result<f64, LastError> {
    // Written so that NaN is refused too.
    if (min..=max).contains(&value) {
        Ok(value)
    } else {
        Err(LastError::OutOfRange { name, value, min, max })
    }
}
