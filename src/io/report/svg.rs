//! Charts as SVG text: lines and maps of colours.
//!
//! The charts take their ink from the page they stand on (CSS `currentColor`), so they are legible
//! in light and dark and need nothing from outside.

use super::Raster;
use super::chart::{Chart, Labels, PLOT, WIDTH};
use super::colour::{BEYOND, MISSING, SERIES, heat, signed};
use super::ticks::Ticks;

/// More points than twice this many columns are drawn as the range in each column.
const COLUMNS: usize = 484;

/// One line of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What the legend calls it; empty for none.
    pub name: String,
    /// Its points from left to right. One that is no number leaves a gap.
    pub points: Vec<[f64; 2]>,
}

/// Values on a grid, drawn as coloured cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Cells from left to right; `values` holds whole rows of as many.
    pub n_columns: usize,
    /// Row by row from the bottom up; NaN where there is nothing, infinite where no scale would do.
    pub values: Vec<f64>,
    /// The least and the greatest x.
    pub x: [f64; 2],
    /// The least and the greatest y.
    pub y: [f64; 2],
}

/// Values over another quantity.
pub fn line_chart(series: &[Series], labels: Labels) -> String {
    let points = || series.iter().flat_map(|s| &s.points);
    let x = Ticks::around(points().map(|p| p[0]), 6);
    let y = Ticks::around(points().map(|p| p[1]), 5).widened();
    lines(&all_thinned(series), labels, &x, &y)
}

/// The same where both axes go by powers of ten; what is not above 0 is left out.
pub fn log_log_chart(series: &[Series], labels: Labels) -> String {
    let points = || series.iter().flat_map(|s| &s.points);
    let x = Ticks::decades(points().map(|p| p[0]));
    let y = Ticks::decades(points().map(|p| p[1])).widened();
    lines(&all_thinned(series), labels, &x, &y)
}

/// Places on a map: both axes in one scale. Points may come in any order along their line.
pub fn plan_chart(series: &[Series], labels: Labels) -> String {
    let points = || series.iter().flat_map(|s| &s.points);
    let [left, right, top, bottom] = PLOT;
    let ranges = [0, 1].map(|k| Ticks::around(points().map(|p| p[k]), 5).range);
    let sizes = [right - left, bottom - top];
    let lengths = ranges.map(|[min, max]| max - min);
    let scale = (lengths[0] / sizes[0]).max(lengths[1] / sizes[1]);
    let [x, y] = [0, 1].map(|k| {
        let middle = f64::midpoint(ranges[k][0], ranges[k][1]);
        let half = scale * sizes[k] / 2.0;
        Ticks::around([middle - half, middle + half].into_iter(), 5)
    });
    lines(series, labels, &x, &y)
}

fn lines(series: &[Series], labels: Labels, x: &Ticks, y: &Ticks) -> String {
    let mut svg = Chart::new(x, y, labels);
    for (i, line) in series.iter().enumerate() {
        let color = SERIES[i % SERIES.len()];
        for run in runs(&line.points) {
            let places = run.iter().map(|&[px, py]| place(x, y, px, py));
            let corners: Vec<String> = places.map(|[px, py]| format!("{px:.1},{py:.1}")).collect();
            svg.add(format_args!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.6\" \
                 stroke-linejoin=\"round\"/>",
                corners.join(" ")
            ));
        }
    }
    svg.legend(series.iter().map(|line| line.name.as_str()));
    svg.finish()
}

/// A grid of values as colours, with the bar that explains them called `value_label`.
pub fn heat_map(grid: &Grid, labels: Labels, value_label: &str) -> std::io::Result<String> {
    let ticks = Ticks::around(grid.values.iter().copied(), 5);
    colour_map(grid, labels, value_label, &Scale { ticks, color: heat })
}

/// A grid of values above and below 0, blue and red, both in full at `full`; otherwise a
/// [`heat_map`].
pub fn signed_map(
    grid: &Grid,
    full: f64,
    labels: Labels,
    value_label: &str,
) -> std::io::Result<String> {
    let ticks = Ticks::around([-full, full].into_iter(), 5);
    colour_map(grid, labels, value_label, &Scale { ticks, color: |at| signed(2.0 * at - 1.0) })
}

/// Which values get which colours.
struct Scale {
    ticks: Ticks,
    /// Of a share of the range.
    color: fn(f64) -> [u8; 3],
}

fn colour_map(
    grid: &Grid,
    labels: Labels,
    value_label: &str,
    scale: &Scale,
) -> std::io::Result<String> {
    let (x, y) = (Ticks::around(grid.x.into_iter(), 5), Ticks::around(grid.y.into_iter(), 6));
    let mut svg = Chart::empty();
    // Only the bar's width is taken from the plot, on the right.
    let right = PLOT[1] - 70.0;
    svg.image([PLOT[0], PLOT[2], right - PLOT[0], PLOT[3] - PLOT[2]], &cells(grid, scale))?;
    svg.axes(&x, &y, labels, right);
    let bar = (0..128).rev().map(|i| (scale.color)(f64::from(i) / 127.0)).collect();
    let bar = Raster { width: 1, height: 128, pixels: bar };
    svg.image([right + 20.0, PLOT[2], 14.0, PLOT[3] - PLOT[2]], &bar)?;
    for (value, text) in scale.ticks.labels() {
        let y = PLOT[3] - (PLOT[3] - PLOT[2]) * scale.ticks.share(value);
        svg.text([right + 40.0, y + 4.0], "start", &text);
    }
    svg.text([WIDTH - 4.0, PLOT[2] - 11.0], "end", value_label);
    Ok(svg.finish())
}

/// The grid as a picture of one pixel per cell, top row first.
fn cells(grid: &Grid, scale: &Scale) -> Raster {
    let n = grid.n_columns.max(1);
    let rows = grid.values.chunks_exact(n).rev();
    let color = |v: &f64| match *v {
        v if v.is_finite() => (scale.color)(scale.ticks.share(v)),
        v if v.is_infinite() => BEYOND,
        _ => MISSING,
    };
    let pixels: Vec<[u8; 3]> = rows.flatten().map(color).collect();
    Raster { width: n as u32, height: (pixels.len() / n) as u32, pixels }
}

/// Where a point of the plot lies in the chart.
fn place(x: &Ticks, y: &Ticks, px: f64, py: f64) -> [f64; 2] {
    let [left, right, top, bottom] = PLOT;
    [left + (right - left) * x.share(px), bottom - (bottom - top) * y.share(py)]
}

/// The points between gaps.
fn runs(points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
    let is_number = |p: &[f64; 2]| p[0].is_finite() && p[1].is_finite();
    points.split(move |p| !is_number(p)).filter(|run| !run.is_empty())
}

fn all_thinned(series: &[Series]) -> Vec<Series> {
    let thin = |line: &Series| Series { name: line.name.clone(), points: thinned(&line.points) };
    series.iter().map(thin).collect()
}

/// No more points than the eye can tell apart: of each column the least and the greatest, in order,
/// and a gap wherever there was one.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= 2 * COLUMNS {
        return points.to_vec();
    }
    let extremes = |chunk: &[[f64; 2]]| {
        let is_number = |p: &[f64; 2]| (p[0] + p[1]).is_finite();
        let by_y = |a: &usize, b: &usize| chunk[*a][1].total_cmp(&chunk[*b][1]);
        let numbers = || (0..chunk.len()).filter(|&i| is_number(&chunk[i]));
        let mut kept: Vec<usize> = numbers().min_by(by_y).into_iter().collect();
        kept.extend(numbers().max_by(by_y));
        kept.extend((0..chunk.len()).find(|&i| !is_number(&chunk[i])));
        kept.sort_unstable();
        kept.into_iter().map(|i| chunk[i]).collect::<Vec<_>>()
    };
    points.chunks(points.len().div_ceil(COLUMNS)).flat_map(extremes).collect()
}

#[cfg(test)]
mod tests {
    use super::super::html::tests::assert_balanced;
    use super::*;

    const LABELS: Labels = Labels { x: "turn", y: "Y [mm] <&>" };

    fn heat_of(grid: &Grid) -> Scale {
        Scale { ticks: Ticks::around(grid.values.iter().copied(), 5), color: heat }
    }

    fn series(points: Vec<[f64; 2]>) -> Series {
        Series { name: "height".into(), points }
    }

    #[test]
    fn charts_are_well_formed_and_escape_their_labels() {
        let grid = Grid {
            n_columns: 3,
            values: vec![0.0, 1.0, f64::NAN, 3.0, 4.0, 5.0],
            x: [0.0, 9.0],
            y: [0.0, 6.3],
        };
        let charts = [
            line_chart(
                &[series(vec![[0.0, 1.0], [1.0, 3.0], [2.0, f64::NAN], [3.0, 2.0]])],
                LABELS,
            ),
            line_chart(&[], LABELS),
            heat_map(&grid, LABELS, "gap <mm>").unwrap(),
            signed_map(&grid, 0.1, LABELS, "gap <mm>").unwrap(),
        ];
        for chart in charts {
            assert_balanced(&chart);
            assert!(chart.contains("Y [mm] &lt;&amp;&gt;"));
            assert!(!chart.contains("NaN") && !chart.contains("inf"), "{chart}");
        }
    }

    #[test]
    fn value_that_is_no_number_leaves_a_gap_in_the_line() {
        let points = vec![[0.0, 1.0], [1.0, 3.0], [2.0, f64::NAN], [3.0, 2.0], [4.0, 2.0]];
        assert_eq!(line_chart(&[series(points)], LABELS).matches("<polyline").count(), 2);
    }

    #[test]
    fn a_plan_is_drawn_in_one_scale() {
        let square = vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let plan = plan_chart(&[series(square)], LABELS);
        assert_balanced(&plan);
        let (_, rest) = plan.split_once("<polyline points=\"").unwrap();
        let corners: Vec<[f64; 2]> = rest[..rest.find('"').unwrap()]
            .split(' ')
            .map(|c| c.split_once(',').unwrap())
            .map(|(x, y)| [x.parse().unwrap(), y.parse().unwrap()])
            .collect();
        let (across, up) = (corners[1][0] - corners[0][0], corners[1][1] - corners[2][1]);
        assert!((across - up).abs() < 0.2 && up > 200.0, "{across} {up}");
    }

    #[test]
    fn dots_of_a_plan_stay_apart_however_many_they_are() {
        let dot = |i: u32| {
            let [x, y] = [f64::from(i % 97), f64::from(i % 89)];
            [[x, y], [x + 0.1, y], [f64::NAN; 2]]
        };
        let points = (0..4000).flat_map(dot).collect();
        let svg = plan_chart(&[series(points)], Labels { x: "x", y: "y" });
        assert_eq!(svg.matches("<polyline").count(), 4000);
    }

    #[test]
    fn thinning_keeps_the_peaks() {
        let mut points: Vec<[f64; 2]> =
            (0..100_000).map(|i| [f64::from(i), (f64::from(i) / 9.0).sin()]).collect();
        points[54_321][1] = 50.0;
        points[77_777][1] = -50.0;
        points[77_770][1] = f64::NAN;
        let few = thinned(&points);
        assert!(few.len() <= 2 * COLUMNS + 1);
        assert_eq!(runs(&few).count(), 2, "the gap is kept");
        assert!(few.contains(&points[54_321]) && few.contains(&points[77_777]));
        assert!(few.windows(2).all(|w| w[0][0] <= w[1][0]), "the order is kept");
    }

    #[test]
    fn a_signed_map_is_red_below_and_blue_above_and_cut_at_its_full_scale() {
        let values = vec![-9.0, -0.1, 0.0, 0.1];
        let grid = Grid { n_columns: 4, values, x: [0.0, 1.0], y: [0.0, 1.0] };
        let ticks = Ticks::around([-0.1, 0.1].into_iter(), 5);
        let scale = Scale { ticks, color: |at| signed(2.0 * at - 1.0) };
        let raster = cells(&grid, &scale);
        assert_eq!(raster.pixels, [signed(-1.0), signed(-1.0), signed(0.0), signed(1.0)]);
    }

    #[test]
    fn heat_map_has_its_first_row_at_the_bottom() {
        let grid =
            Grid { n_columns: 2, values: vec![0.0, 0.0, 1.0, 1.0], x: [0.0, 1.0], y: [0.0, 1.0] };
        let raster = cells(&grid, &heat_of(&grid));
        assert_eq!(raster.pixels, [heat(1.0), heat(1.0), heat(0.0), heat(0.0)]);
    }

    #[test]
    fn heat_map_tells_what_is_beyond_its_scale_from_nothing() {
        let values = vec![0.0, f64::NAN, f64::INFINITY, 1.0];
        let grid = Grid { n_columns: 4, values, x: [0.0, 1.0], y: [0.0, 1.0] };
        let raster = cells(&grid, &heat_of(&grid));
        assert_eq!(raster.pixels, [heat(0.0), MISSING, BEYOND, heat(1.0)]);
    }

    #[test]
    fn heat_map_without_cells_is_refused() {
        let grid = Grid { n_columns: 3, values: vec![], x: [0.0, 1.0], y: [0.0, 1.0] };
        assert!(heat_map(&grid, LABELS, "v").is_err());
    }
}
