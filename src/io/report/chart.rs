//! The frame every chart stands in: axes, numbers, legend.

use super::colour::SERIES;
use super::ticks::Ticks;
use super::{Raster, encode_png, html::escape};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use std::fmt::Write as _;

/// Size of the drawing, in its own units: CSS pixels where a report shows it two abreast.
pub(super) const WIDTH: f64 = 560.0;
pub(super) const HEIGHT: f64 = 320.0;
/// Left, right, top and bottom edge of the plot inside the chart.
pub(super) const PLOT: [f64; 4] = [62.0, 546.0, 28.0, 262.0];
/// What the two axes of a chart are called, with their units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Labels<'a> {
    /// Below the horizontal axis.
    pub x: &'a str,
    /// Beside the vertical axis.
    pub y: &'a str,
}

/// Charts below each other as one SVG file that needs no page around it.
pub fn sheet(charts: &[String]) -> String {
    let height = HEIGHT * charts.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" \
         height=\"{height}\" color=\"#222\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (i, chart) in charts.iter().enumerate() {
        let y = HEIGHT * i as f64;
        let place = format!("<svg y=\"{y}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" ");
        svg.push_str(&chart.replacen("<svg ", &place, 1));
        svg.push('\n');
    }
    svg.push_str("</svg>\n");
    svg
}

/// A chart being written.
pub(super) struct Chart(String);

impl Chart {
    /// The frame without axes.
    pub(super) fn empty() -> Self {
        Self(format!(
            "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" font-size=\"12\" \
             font-family=\"system-ui, sans-serif\" fill=\"currentColor\">"
        ))
    }

    /// The frame with the axes of a plot of the full width.
    pub(super) fn new(x: &Ticks, y: &Ticks, labels: Labels) -> Self {
        let mut chart = Self::empty();
        chart.axes(x, y, labels, PLOT[1]);
        chart
    }

    /// Grid lines, numbers and names of both axes, for a plot that ends at `right`.
    pub(super) fn axes(&mut self, x: &Ticks, y: &Ticks, labels: Labels, right: f64) {
        let [left, _, top, bottom] = PLOT;
        for (value, text) in y.labels() {
            let at = bottom - (bottom - top) * y.share(value);
            self.line([left, at], [right, at], 0.14);
            self.text([left - 8.0, at + 4.0], "end", &text);
        }
        for (value, text) in x.labels() {
            let at = left + (right - left) * x.share(value);
            self.line([at, bottom], [at, bottom + 5.0], 0.5);
            self.text([at, bottom + 20.0], "middle", &text);
        }
        self.line([left, bottom], [right, bottom], 0.5);
        self.text([f64::midpoint(left, right), HEIGHT - 12.0], "middle", labels.x);
        self.add(format_args!(
            "<text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            f64::midpoint(top, bottom),
            escape(labels.y)
        ));
    }

    /// The `names` of the series in their colours, above the plot, in two rows if they
    /// are many; an empty one is left out.
    pub(super) fn legend<'a>(&mut self, names: impl Iterator<Item = &'a str>) {
        let mut at = [PLOT[0] + 4.0, 12.0];
        for (i, name) in names.enumerate().filter(|(_, name)| !name.is_empty()) {
            let width = 44.0 + 6.5 * name.chars().count() as f64;
            if WIDTH < at[0] + width - 24.0 {
                at = [PLOT[0] + 4.0, at[1] + 13.0];
            }
            let [x, y] = at;
            self.add(format_args!(
                "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"14\" height=\"4\" rx=\"2\" fill=\"{}\"/>",
                y - 6.0,
                SERIES[i % SERIES.len()]
            ));
            self.text([x + 20.0, y], "start", name);
            at[0] += width;
        }
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], opacity: f64) {
        self.add(format_args!(
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"currentColor\" \
             stroke-opacity=\"{opacity}\"/>",
            from[0], from[1], to[0], to[1]
        ));
    }

    /// A text that starts, centres or ends at a place.
    pub(super) fn text(&mut self, [x, y]: [f64; 2], anchor: &str, text: &str) {
        let text = escape(text);
        self.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
        ));
    }

    /// Pixels stretched over a box: left, top, width, height.
    pub(super) fn image(
        &mut self,
        [x, y, width, height]: [f64; 4],
        raster: &Raster,
    ) -> std::io::Result<()> {
        let data = BASE64.encode(encode_png(raster)?);
        self.add(format_args!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
             href=\"data:image/png;base64,{data}\"/>"
        ));
        Ok(())
    }

    /// An element as it is.
    pub(super) fn add(&mut self, element: std::fmt::Arguments) {
        // Text in memory takes everything.
        let _ = self.0.write_fmt(element);
    }

    /// The whole SVG element.
    pub(super) fn finish(mut self) -> String {
        self.0.push_str("</svg>");
        self.0
    }
}
