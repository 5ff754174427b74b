//! A list of errors in six numbers.

/// Errors in six numbers, as the TUM benchmark tells them.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct Statistics {
    /// Root of the mean square.
    pub rmse: f64,
    /// Mean.
    pub mean: f64,
    /// The middle one; of an even number the mean of the middle two.
    pub median: f64,
    /// Standard deviation from the mean, of all there are (divided by n).
    pub std: f64,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
}

impl Statistics {
    /// The same in another unit: `f` multiplies by a constant.
    #[must_use]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            rmse: f(self.rmse),
            mean: f(self.mean),
            median: f(self.median),
            std: f(self.std),
            min: f(self.min),
            max: f(self.max),
        }
    }

    /// Those of `values`; all 0 if there are none.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (Some(&min), Some(&max)) = (sorted.first(), sorted.last()) else {
            return Self::default();
        };
        let mean = values.iter().sum::<f64>() / n;
        let middle = sorted.len() / 2;
        let is_even = sorted.len().is_multiple_of(2);
        let before = if is_even { sorted[middle - 1] } else { sorted[middle] };
        Self {
            rmse: (values.iter().map(|v| v * v).sum::<f64>() / n).sqrt(),
            mean,
            median: f64::midpoint(before, sorted[middle]),
            std: (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt(),
            min,
            max,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_numbers_of_four() {
        let expected = Statistics {
            rmse: 7.5_f64.sqrt(),
            mean: 2.5,
            median: 2.5,
            std: 1.25_f64.sqrt(),
            min: 1.0,
            max: 4.0,
        };
        assert_eq!(Statistics::of(&[4.0, 1.0, 3.0, 2.0]), expected);
        assert_eq!(Statistics::of(&[5.0, 1.0, 3.0]).median, 3.0);
        assert_eq!(Statistics::of(&[]), Statistics::default());
    }
}
