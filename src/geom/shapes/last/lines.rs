//! The lines of the drawing: figures [mm] at stations from heel (0) to toe (1), for a last of
//! 265 mm. Chosen by eye, and so that the default measures as a men's last does.

use super::super::spline::Spline;

type Knots<const N: usize> = [[f64; 2]; N];

// Half widths of the bottom on either side of its middle, before heel and toe are rounded off.
#[rustfmt::skip]
const MEDIAL: Knots<8> = [
    [0.0, 29.0], [0.14, 29.5], [0.3, 27.0], [0.43, 26.0], [0.56, 33.5], [0.68, 43.0], [0.81, 42.0],
    [1.0, 35.0],
];
#[rustfmt::skip]
const LATERAL: Knots<8> = [
    [0.0, 29.0], [0.14, 29.5], [0.3, 29.0], [0.43, 33.0], [0.55, 41.8], [0.64, 43.3], [0.8, 41.6],
    [1.0, 41.0],
];

// The plan is bent like a banana: out at the waist, in at the toe.
const MIDDLE: Knots<6> =
    [[0.0, 0.0], [0.14, 0.0], [0.4, 2.5], [0.62, 1.5], [0.8, -2.2], [1.0, -11.0]];

// How deep the bottom hangs between its feather edges.
const CROWN: Knots<5> = [[0.0, 2.5], [0.15, 2.5], [0.4, 2.0], [0.65, 3.5], [1.0, 1.5]];

// How far the ridge lies off the middle, to the medial side.
const RIDGE_OFFSET: Knots<6> =
    [[0.0, 0.0], [0.2, 0.0], [0.4, -2.0], [0.6, -6.0], [0.8, -4.0], [1.0, 0.0]];

// The handles of the side curves: out from and up from the feather edge, out from the ridge.
const LATERAL_BULGE: Knots<6> =
    [[0.0, 15.0], [0.15, 12.0], [0.4, 12.0], [0.62, 9.0], [0.85, 7.0], [1.0, 6.0]];
const MEDIAL_BULGE: Knots<6> =
    [[0.0, 15.0], [0.15, 12.0], [0.4, 15.0], [0.68, 9.0], [0.85, 7.0], [1.0, 6.0]];
const RISE: Knots<6> =
    [[0.0, 34.0], [0.2, 34.0], [0.4, 30.0], [0.65, 20.0], [0.85, 14.0], [1.0, 9.0]];
#[rustfmt::skip]
const DOME: Knots<7> = [
    [0.0, 3.0], [0.25, 7.0], [0.4, 19.0], [0.55, 25.0], [0.7, 25.0], [0.85, 24.0], [1.0, 14.0],
];

/// The lines of a last, each a function of the station.
pub(super) struct Lines {
    /// Half width of the bottom, medial side.
    pub(super) medial: Spline,
    /// Half width of the bottom, lateral side.
    pub(super) lateral: Spline,
    /// Middle of the bottom, lateral side positive.
    pub(super) middle: Spline,
    /// Height of the middle of the bottom over the ground.
    pub(super) bottom: Spline,
    /// Depth of the middle of the bottom under its feather edges.
    pub(super) crown: Spline,
    /// Height of the ridge over the ground; above the cone, of the timber that is sawn off.
    pub(super) ridge: Spline,
    /// The ridge off the middle, lateral side positive.
    pub(super) ridge_offset: Spline,
    /// Lateral, then medial: handle at the feather edge, outwards.
    pub(super) bulge: [Spline; 2],
    /// Handle at the feather edge, upwards.
    pub(super) rise: Spline,
    /// Handle at the ridge, outwards.
    pub(super) dome: Spline,
}

impl Lines {
    /// The lines for a heel height, a toe spring, a cone top that begins at station and height
    /// `cone_front`, and a forepart of some `fullness`.
    pub(super) fn new(heel: f64, spring: f64, cone_front: [f64; 2], fullness: f64) -> Self {
        Self {
            medial: Spline::through(&MEDIAL),
            lateral: Spline::through(&LATERAL),
            middle: Spline::through(&MIDDLE),
            bottom: bottom(heel, spring),
            crown: Spline::through(&CROWN),
            ridge: ridge(cone_front, spring, fullness),
            ridge_offset: Spline::through(&RIDGE_OFFSET),
            bulge: [Spline::through(&LATERAL_BULGE), Spline::through(&MEDIAL_BULGE)],
            rise: Spline::through(&RISE),
            dome: Spline::through(&DOME),
        }
    }
}

/// The seat, the fall of the shank, the tread and the rise to the toe.
fn bottom(heel: f64, spring: f64) -> Spline {
    Spline::through(&[
        [0.0, heel],
        [0.08, 0.97 * heel],
        [0.2, 0.84 * heel],
        [0.4, 0.36 * heel],
        [0.54, 0.06 * heel],
        [0.64, 0.0],
        [0.74, 0.06 * spring],
        [0.86, 0.4 * spring],
        [1.0, spring],
    ])
}

fn ridge([u_cone, z_cone]: [f64; 2], spring: f64, fullness: f64) -> Spline {
    let full = |height: f64| height * fullness;
    Spline::through(&[
        [0.0, z_cone + 34.0],
        [0.55 * u_cone, z_cone + 16.0],
        [u_cone, z_cone],
        [0.63, full(60.0)],
        [0.8, full(38.5) + 0.2 * spring],
        [0.91, full(29.0) + 0.55 * spring],
        [1.0, full(21.0) + 0.9 * spring],
    ])
}
