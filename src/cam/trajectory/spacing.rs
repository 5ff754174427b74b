//! How far apart positions and lines are.

use super::TrajectoryError;

/// How far apart positions and lines are.
#[derive(Debug, Clone, PartialEq)]
pub struct Spacing {
    /// Positions per turn, or lines around the part.
    pub per_turn: u32,
    /// Positions along a line are this far apart [mm].
    pub step: f64,
    /// Where the turns of a helix end, rings stand or raster rows run: the coordinate after each
    /// turn or row, ascending, first and last the ends of the run [mm].
    pub stations: Vec<f64>,
}

/// More positions than this are refused.
pub(super) const MOST_POSITIONS: f64 = 2e8;

impl Spacing {
    /// The least and the greatest distance of neighbouring stations [mm].
    pub fn pitch_range(&self) -> [f64; 2] {
        let pitches = self.stations.windows(2).map(|pair| pair[1] - pair[0]);
        let range = |[low, high]: [f64; 2], pitch: f64| [low.min(pitch), high.max(pitch)];
        pitches
            .fold(None, |found, pitch| Some(range(found.unwrap_or([pitch; 2]), pitch)))
            .unwrap_or_default()
    }

    /// Stations from `from` to `to`, `pitch` apart or a little less so that the last one fits.
    pub fn even(from: f64, to: f64, pitch: f64) -> Result<Vec<f64>, TrajectoryError> {
        Self::graded(from, to, |_| pitch)
    }

    /// Stations from `from` to `to`, apart by what `pitch` asks for at each.
    pub fn graded(
        from: f64,
        to: f64,
        pitch: impl Fn(f64) -> f64,
    ) -> Result<Vec<f64>, TrajectoryError> {
        let mut stations = vec![from];
        let mut x = from;
        while x < to {
            let next = pitch(x);
            if !(next > 0.0 && next.is_finite()) {
                return Err(TrajectoryError::NotPositive { what: "pitch", value: next });
            }
            if stations.len() as f64 > MOST_POSITIONS / 100.0 {
                let positions = (to - from) / next;
                return Err(TrajectoryError::TooMany { positions, most: MOST_POSITIONS });
            }
            x += next;
            stations.push(x);
        }
        // What the last station overshoots is taken from all of them alike.
        let overshoot = (to - from) / (x - from);
        if x > from {
            for station in &mut stations {
                *station = from + (*station - from) * overshoot;
            }
        }
        Ok(stations)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pitch_of_nothing_is_refused() {
        let error = Spacing::even(0.0, 10.0, 0.0).unwrap_err().to_string();
        assert!(error.contains("the pitch is 0"), "{error}");
    }
}
