//! Charts of bars: how much of something there is at each of evenly spaced values.

use super::chart::{Chart, Labels, PLOT};
use super::ticks::Ticks;

/// One bar of a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bar {
    /// The value in its middle.
    pub at: f64,
    /// How high it is: 0 or more.
    pub height: f64,
    /// Red, green, blue.
    pub color: [u8; 3],
}

/// Bars as wide as they stand apart, from left to right; thin lines around them keep even white ones
/// visible.
pub fn bar_chart(bars: &[Bar], labels: Labels) -> String {
    let half = match bars {
        [first, second, ..] => (second.at - first.at) / 2.0,
        _ => 0.5,
    };
    let x = Ticks::around(bars.iter().flat_map(|bar| [bar.at - half, bar.at + half]), 6);
    let highest = bars.iter().map(|bar| bar.height).fold(0.0, f64::max);
    let highest = if highest > 0.0 { highest } else { 1.0 };
    let y = Ticks::around([0.0, highest].into_iter(), 5).widened();
    let mut svg = Chart::new(&x, &y, labels);
    let [left, right, top, bottom] = PLOT;
    for bar in bars.iter().filter(|bar| bar.height > 0.0) {
        let [from, to] =
            [bar.at - half, bar.at + half].map(|at| left + (right - left) * x.share(at));
        let height = (bottom - top) * y.share(bar.height);
        let [r, g, b] = bar.color;
        svg.add(format_args!(
            "<rect x=\"{from:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{height:.2}\" \
             fill=\"rgb({r} {g} {b})\" stroke=\"currentColor\" stroke-opacity=\"0.45\" \
             stroke-width=\"0.6\"/>",
            bottom - height,
            to - from,
        ));
    }
    svg.finish()
}

#[cfg(test)]
mod tests {
    use super::super::html::tests::assert_balanced;
    use super::*;

    const LABELS: Labels = Labels { x: "off [mm] <&>", y: "surface" };

    fn bar(at: f64, height: f64) -> Bar {
        Bar { at, height, color: [1, 2, 3] }
    }

    #[test]
    fn bars_fill_the_plot_side_by_side_and_empty_ones_are_left_out() {
        let chart = bar_chart(&[bar(-1.0, 2.0), bar(0.0, 0.0), bar(1.0, 1.0)], LABELS);
        assert_balanced(&chart);
        assert_eq!(chart.matches("<rect").count(), 2);
        // From -1.5 to 1.5 over the whole plot; the highest bar is 2 of 2 high.
        let third = (PLOT[1] - PLOT[0]) / 3.0;
        let first = format!("x=\"{:.2}\" y=\"{:.2}\" width=\"{third:.2}\"", PLOT[0], PLOT[2]);
        assert!(chart.contains(&first), "{chart}");
        let last = format!("x=\"{:.2}\" ", PLOT[0] + 2.0 * third);
        assert!(chart.contains(&last), "{chart}");
        assert!(chart.contains("off [mm] &lt;&amp;&gt;"));
    }

    #[test]
    fn a_chart_without_bars_or_with_one_is_well_formed() {
        for bars in [&[][..], &[bar(3.0, 0.0)], &[bar(3.0, 7.0)]] {
            let chart = bar_chart(bars, LABELS);
            assert_balanced(&chart);
            assert!(!chart.contains("NaN") && !chart.contains("inf"), "{chart}");
        }
    }
}
