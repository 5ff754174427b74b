//! Where an axis carries numbers, and how they are written.

/// The range of an axis and the round numbers on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ticks {
    /// From the least to the greatest value shown.
    pub(super) range: [f64; 2],
    /// The distance of two numbers: 1, 2 or 5 times a power of ten.
    step: f64,
    /// Range and step are powers of ten.
    is_logarithmic: bool,
}

impl Ticks {
    /// About `n` ticks that hold all `values` that are numbers; 0 to 1 if there are none.
    pub(super) fn around(values: impl Iterator<Item = f64>, n: usize) -> Self {
        let finite = values.filter(|v| v.is_finite());
        let (min, max) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let (min, max) = if min <= max { (min, max) } else { (0.0, 1.0) };
        // A range too narrow for f64 to divide is widened.
        let least = 1e-9 * min.abs().max(max.abs()).max(1e-9);
        let half = ((max - min) / 2.0).max(least);
        let middle = min / 2.0 + max / 2.0;
        let (min, max) = (middle - half, middle + half);
        Self {
            range: [min, max],
            step: round_step((max - min) / n.max(1) as f64),
            is_logarithmic: false,
        }
    }

    /// Of an axis that goes by powers of ten, around all `values` above 0; 1 to 10 if they
    /// span nothing.
    pub(super) fn decades(values: impl Iterator<Item = f64>) -> Self {
        let powers = values.filter(|&v| 0.0 < v && v.is_finite()).map(f64::log10);
        let (min, max) =
            powers.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let (min, max) = if min < max { (min, max) } else { (0.0, 1.0) };
        Self { range: [min, max], step: 1.0, is_logarithmic: true }
    }

    /// The same ticks with the range widened to the next ones.
    pub(super) fn widened(mut self) -> Self {
        let [min, max] = self.range;
        // A hair less than a whole step, or a value on a tick could get a step of its own.
        self.range = [
            (min / self.step + 1e-6).floor() * self.step,
            (max / self.step - 1e-6).ceil() * self.step,
        ];
        self
    }

    /// The part of the range that lies below `value`, 0 to 1.
    pub(super) fn share(&self, value: f64) -> f64 {
        let value = if self.is_logarithmic { value.log10() } else { value };
        (value - self.range[0]) / (self.range[1] - self.range[0])
    }

    /// The numbers on the axis, and how they are written.
    pub(super) fn labels(&self) -> Vec<(f64, String)> {
        if self.is_logarithmic { self.powers() } else { self.steps() }
    }

    /// Powers of ten; where they are few, twice and five times them as well.
    fn powers(&self) -> Vec<(f64, String)> {
        let [min, max] = self.range;
        let factors: &[f64] = if max - min < 3.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let decades = min.floor() as i32..=max.ceil() as i32;
        let values = decades.flat_map(|power| factors.iter().map(move |f| f * 10_f64.powi(power)));
        let within = values.filter(|value| (-1e-9..=1.0 + 1e-9).contains(&self.share(*value)));
        within.map(|value| (value, format!("{value}"))).collect()
    }

    fn steps(&self) -> Vec<(f64, String)> {
        let [first, last] =
            [(self.range[0] / self.step - 1e-6).ceil(), (self.range[1] / self.step + 1e-6).floor()];
        // Of a range of n steps there are n + 1 numbers; the limit guards against no numbers.
        let n = (last - first).clamp(0.0, 100.0) as usize;
        (0..=n).map(|i| (first + i as f64) * self.step).map(|v| (v, self.label(v))).collect()
    }

    fn label(&self, value: f64) -> String {
        let size = value.abs().max(self.step);
        if size >= 1e6 || self.step < 1e-4 {
            return format!("{value:.1e}");
        }
        let decimals = (-self.step.log10().floor()).max(0.0) as usize;
        // Adding zero turns -0 into 0.
        format!("{:.decimals$}", value + 0.0)
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below `step`.
fn round_step(step: f64) -> f64 {
    let power = 10_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * power >= step * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(values: [f64; 2]) -> Vec<String> {
        let ticks = Ticks::around(values.into_iter(), 5).widened();
        ticks.labels().into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_numbers_around_the_values() {
        assert_eq!(texts([0.0, 100.0]), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(texts([-0.13, 0.21]), ["-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(texts([31.0, 31.9]), ["31.0", "31.2", "31.4", "31.6", "31.8", "32.0"]);
        assert_eq!(texts([0.0, 2e7])[1], "5.0e6");
    }

    #[test]
    fn a_logarithmic_axis_has_powers_of_ten_and_between_few_of_them_more() {
        let texts = |values: [f64; 2]| {
            let labels = Ticks::decades(values.into_iter()).labels();
            labels.into_iter().map(|(_, text)| text).collect::<Vec<_>>()
        };
        assert_eq!(texts([0.5, 20_000.0]), ["1", "10", "100", "1000", "10000"]);
        assert_eq!(texts([0.17, 0.72]), ["0.2", "0.5"]);
        let ticks = Ticks::decades([0.0, 1.0, 100.0, f64::NAN].into_iter());
        assert!((ticks.share(10.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn ticks_of_one_value_or_none_still_span_a_range() {
        for values in [vec![], vec![f64::NAN], vec![7.0], vec![1e300, -1e300], vec![0.0]] {
            let ticks = Ticks::around(values.clone().into_iter(), 5);
            assert!(ticks.range[0] < ticks.range[1], "{values:?}");
            assert!((1..12).contains(&ticks.labels().len()), "{values:?}: {:?}", ticks.labels());
        }
    }
}
