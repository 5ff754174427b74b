//! Colours of charts and maps.

/// Stops of the *viridis* map (Smith and van der Walt, 2015; CC0): evenly rising lightness, and
/// told apart by colour-blind eyes too.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// What a place without a value gets: grey enough to lie flat on a light and on a dark page.
pub(super) const MISSING: [u8; 3] = [150, 156, 165];

/// What a place beyond any scale gets: orange, which no step of the map comes near.
pub(super) const BEYOND: [u8; 3] = [213, 94, 0];

/// Colours of series after Okabe and Ito (2008), without yellow and black, which vanish on a light
/// or a dark page, and with a grey.
pub(super) const SERIES: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#888888"];

/// Too deep, right, and material left: red, nearly white, blue, as colour-blind eyes see them too.
const GOUGE: [f64; 3] = [202.0, 0.0, 32.0];
const RIGHT: [f64; 3] = [238.0, 238.0, 232.0];
const LEFT: [f64; 3] = [5.0, 80.0, 175.0];

/// The colour of `share` of the way from dark (0) to bright (1); what lies outside is cut to the
/// ends, and a share that is no number is grey.
pub fn heat(share: f64) -> [u8; 3] {
    if share.is_nan() {
        return MISSING;
    }
    let place = share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let i = (place as usize).min(VIRIDIS.len() - 2);
    let part = place - i as f64;
    std::array::from_fn(|k| {
        let (from, to) = (f64::from(VIRIDIS[i][k]), f64::from(VIRIDIS[i + 1][k]));
        (from + (to - from) * part).round() as u8
    })
}

/// The colour of a deviation that is `share` of the full scale, -1 to 1: red where too much is gone,
/// blue where material is left; a share that is no number is grey.
pub(super) fn signed(share: f64) -> [u8; 3] {
    if share.is_nan() {
        return MISSING;
    }
    let share = share.clamp(-1.0, 1.0);
    let end = if share < 0.0 { GOUGE } else { LEFT };
    [0, 1, 2].map(|k| (RIGHT[k] + (end[k] - RIGHT[k]) * share.abs()).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn red_is_too_deep_blue_is_left_and_grey_is_no_part() {
        let [r, _, b] = signed(-1.0);
        assert!(r > 150 && b < 60);
        let [r, _, b] = signed(1.0);
        assert!(b > 150 && r < 60);
        assert_eq!(signed(f64::NAN), MISSING);
        assert_eq!(signed(0.0), [238, 238, 232]);
        assert_eq!(signed(-9.0), signed(-1.0));
    }

    #[test]
    fn heat_grows_lighter_all_the_way() {
        let lightness = |share: f64| {
            let [r, g, b] = heat(share).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for i in 0..100 {
            let [here, next] = [f64::from(i) / 100.0, f64::from(i + 1) / 100.0];
            assert!(lightness(here) < lightness(next), "at {here}");
        }
    }

    #[test]
    fn heat_is_cut_at_its_ends_and_grey_for_no_number() {
        assert_eq!(heat(-3.0), VIRIDIS[0]);
        assert_eq!(heat(f64::INFINITY), VIRIDIS[8]);
        assert_eq!(heat(f64::NAN), MISSING);
    }
}
