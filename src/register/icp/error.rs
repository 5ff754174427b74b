//! Why two clouds could not even be tried.

use crate::geom::VoxelError;
use crate::progress::Cancelled;
use crate::rgbd::RgbdError;
use std::fmt;

/// Why two clouds could not even be tried.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IcpError {
    /// A number that means nothing.
    #[error("{option} is {value}; it must be {must}")]
    Option {
        /// The flag.
        option: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        must: String,
    },
    /// A coordinate is NaN or infinite.
    #[error("point {} of the {role} is not finite; leave such points out", index + 1)]
    NotFinite {
        /// Which cloud.
        role: Role,
        /// Its place in the cloud.
        index: usize,
    },
    /// Nothing to hold on to.
    #[error(
        "the {role} has {n_points} points in voxels of {voxel:.4} mm; {least} are needed: use smaller \
         voxels or a denser scan"
    )]
    TooFew {
        /// Which cloud.
        role: Role,
        /// Its points, one to a voxel.
        n_points: usize,
        /// The side of a voxel [mm].
        voxel: f64,
        /// How many are needed.
        least: usize,
    },
    /// A line has no surface.
    #[error(
        "all points of the {role} lie on one line: a line can turn about itself; scan a surface"
    )]
    Collinear {
        /// Which cloud.
        role: Role,
    },
    /// The voxels do not suit the cloud.
    #[error(transparent)]
    Voxel(#[from] VoxelError),
    /// The metric needs colours.
    #[error(
        "the {role} has no colours, which the coloured metric needs; choose another with --fine"
    )]
    NoColours {
        /// Which cloud.
        role: Role,
    },
    /// Nobody says where the cloud was seen from.
    #[error(
        "the {role} has no camera, which pairing by the picture needs; use its frame, or the tree"
    )]
    NoCamera {
        /// Which cloud.
        role: Role,
    },
    /// A frame and its camera do not go together.
    #[error(transparent)]
    Frame(#[from] RgbdError),
    /// The start is no number.
    #[error("the start is not finite; give a pose of numbers")]
    Start,
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Which of the two clouds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The one that is moved.
    Source,
    /// The one that stays.
    Target,
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Source => "source",
            Self::Target => "target",
        })
    }
}
