//! What was cut, coloured by how far it is from the part.

use super::super::colour::signed;
use super::super::{
    Bar, Camera, Grid, Image, Labels, Picture, Scene, Solid, bar_chart, encode_png, render,
    signed_map,
};
use crate::geom::{TriMesh, Vector3};
use crate::measure::Bin;
use crate::workflow::verify::{Verified, VerifyReport};

/// Width and height of each picture: sharp on a screen of twice the density.
const SIZE_PX: [u32; 2] = [960, 600];
/// Cells of the unrolled map, across and up; finer ones are no more than pixels.
const MOST_CELLS: [usize; 2] = [400, 240];
/// What deviations are shown in full colour [mm].
const SCALES: [f64; 8] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0];
/// The scale holds this share of the surface.
const SHARE_WITHIN: f64 = 0.9;

/// The surface that was cut, its vertices coloured: red where it is too deep, blue where material is
/// left, both in full at `full` millimetres; grey where there is no part to compare with.
pub fn deviation_map(verified: &Verified, full: f64) -> TriMesh {
    let mut mesh = verified.stock.to_mesh();
    let n_points = mesh.points.len();
    let rays = verified.deviation.iter().map(|&distance| signed(distance / full));
    mesh.colors = Some(rays.chain(std::iter::repeat(signed(f64::NAN))).take(n_points).collect());
    mesh
}

/// Two views, the surface laid flat, and how much of it is how far off.
pub(super) fn pictures(verified: &Verified) -> std::io::Result<Vec<Picture>> {
    let report = &verified.report;
    let full = full_scale(&report.deviation.histogram, report.tolerance);
    let mut pictures = views(verified, full)?;
    pictures.push(laid_flat(verified, full)?);
    pictures.push(spread(report, full));
    Ok(pictures)
}

/// The least round scale on which most of the surface and the tolerance lie [mm].
fn full_scale(bins: &[Bin], tolerance: f64) -> f64 {
    let area: f64 = bins.iter().map(|bin| bin.area).sum();
    let holds_most = |full: f64| {
        let within = bins.iter().filter(|bin| bin.distance.abs() <= full).map(|bin| bin.area);
        within.sum::<f64>() >= SHARE_WITHIN * area
    };
    let fits = |full: &f64| tolerance <= *full && holds_most(*full);
    let last = SCALES[SCALES.len() - 1].max(tolerance);
    SCALES.into_iter().find(fits).unwrap_or(last)
}

fn views(verified: &Verified, full: f64) -> std::io::Result<Vec<Picture>> {
    let map = deviation_map(verified, full);
    let above = Camera::three_quarter(SIZE_PX);
    // What stands on a table has nothing to show from below.
    let is_turned = verified.stock.layout().is_turned();
    let tilt = if is_turned { 0.45 } else { -0.5 };
    let behind = Camera { direction: Vector3::new(-0.45, -0.8, tilt), ..above };
    let behind_title = if is_turned { "From the other side, below." } else { "From behind." };
    let view = |(title, camera): (&str, Camera)| {
        let solids = vec![Solid { mesh: &map, color: [200; 3] }];
        let image = encode_png(&render(&Scene { solids, paths: Vec::new() }, &camera))?;
        Ok(Picture {
            title: title.to_owned(),
            caption: format!(
                "What the program leaves. Red: cut too deep. Blue: material left. Both in full from \
                 {full} mm on. Grey: nothing to compare with."
            ),
            image: Image::Png(image),
        })
    };
    [("From the front, above.", above), (behind_title, behind)].into_iter().map(view).collect()
}

/// The rays as a grid: unrolled about the spindle, or seen along the tool.
fn laid_flat(verified: &Verified, full: f64) -> std::io::Result<Picture> {
    let layout = verified.stock.layout();
    let is_turned = layout.is_turned();
    let [x, across] = layout.extent();
    let (y, labels) = if is_turned {
        let x = if layout.is_on_turntable() {
            "along the table's axis [mm]"
        } else {
            "X along the spindle [mm]"
        };
        (across.map(f64::to_degrees), Labels { x, y: "angle about it [deg]" })
    } else {
        // Across the attack axis rows run against Y.
        ([-across[1], -across[0]], Labels { x: "X as the tool sees it [mm]", y: "Y [mm]" })
    };
    let n_columns = layout.n_columns();
    let (cells, values) = worst_of(&verified.deviation, [layout.n_rows(), n_columns], is_turned);
    let grid = Grid { n_columns: cells, values, x, y };
    let title = match (is_turned, layout.is_on_turntable()) {
        (true, false) => "Unrolled about the spindle.",
        (true, true) => "Unrolled about the table's axis.",
        _ => "Seen along the tool.",
    };
    Ok(Picture {
        title: title.to_owned(),
        caption:
            "Every cell has the colour of the place in it that is farthest off. Grey: nothing \
                  to compare with."
                .to_owned(),
        image: Image::Svg(signed_map(&grid, full, labels, "off by [mm]")?),
    })
}

/// The values of `n_rows` rows of rays in no more cells than the eye can tell apart: how many stand
/// beside each other, and of each the value farthest from 0, NaN where there is none. Columns run
/// up, or down.
fn worst_of(
    rays: &[f64],
    [n_rows, n_columns]: [usize; 2],
    columns_run_up: bool,
) -> (usize, Vec<f64>) {
    let stride = [n_rows.div_ceil(MOST_CELLS[0]), n_columns.div_ceil(MOST_CELLS[1])];
    let [wide, high] = [n_rows.div_ceil(stride[0]), n_columns.div_ceil(stride[1])];
    let mut cells = vec![f64::NAN; wide * high];
    for (i, &ray) in rays.iter().enumerate().filter(|(_, ray)| ray.is_finite()) {
        let (across, up) = (i / n_columns / stride[0], i % n_columns / stride[1]);
        let up = if columns_run_up { up } else { high - 1 - up };
        let cell = &mut cells[up * wide + across];
        if cell.is_nan() || cell.abs() < ray.abs() {
            *cell = ray;
        }
    }
    (wide, cells)
}

fn spread(report: &VerifyReport, full: f64) -> Picture {
    let bar = |bin: &Bin| Bar {
        at: bin.distance,
        height: bin.area / 100.0,
        color: signed(bin.distance / full),
    };
    let bars: Vec<Bar> = report.deviation.histogram.iter().map(bar).collect();
    let labels = Labels { x: "distance from the part [mm]", y: "surface [cm²]" };
    Picture {
        title: "Surface by distance.".to_owned(),
        caption:
            "Left of 0 too much is gone, right of it material is left; the outermost hundredth \
                  at either end is counted at the end."
                .to_owned(),
        image: Image::Svg(bar_chart(&bars, labels)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_holds_most_of_the_surface_and_the_tolerance() {
        let bins = |distances: &[f64]| -> Vec<Bin> {
            distances.iter().map(|&distance| Bin { distance, area: 1.0 }).collect()
        };
        assert_eq!(full_scale(&[], 0.05), 0.1);
        assert_eq!(full_scale(&bins(&[0.01; 20]), 0.3), 0.5);
        // One in twenty may lie beyond, one in five may not, whichever way it is off.
        let mut distances = [0.01; 20];
        distances[0] = -1.4;
        assert_eq!(full_scale(&bins(&distances), 0.05), 0.1);
        distances[..4].fill(-1.4);
        assert_eq!(full_scale(&bins(&distances), 0.05), 2.0);
        assert_eq!(full_scale(&bins(&[90.0]), 25.0), 25.0);
    }

    #[test]
    fn a_cell_shows_what_is_farthest_off_in_it_whichever_way() {
        // 800 rows of 2 rays: two rows share a cell.
        let mut rays = vec![0.01; 1600];
        rays[0] = f64::NAN;
        rays[1] = f64::NAN;
        rays[3] = -0.5;
        rays[1599] = 0.7;
        let (wide, up) = worst_of(&rays, [800, 2], true);
        assert_eq!((wide, up.len()), (400, 800));
        assert_eq!((up[0], up[400], up[799]), (0.01, -0.5, 0.7));
        let (_, down) = worst_of(&rays, [800, 2], false);
        assert_eq!((down[0], down[400], down[399]), (-0.5, 0.01, 0.7));
        assert!(worst_of(&[f64::NAN], [1, 1], true).1[0].is_nan());
    }
}
