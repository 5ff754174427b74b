//! How far what was cut is from the part.
//!
//! Every ray of the stock is compared with the outermost place at which it meets the part. Whether
//! too much or too little is there shows along the ray; how much, the distance to the nearest place
//! of the part's surface. Where a clamp lies outermost the ray says nothing about the part.

use super::limit::limit;
use crate::cam::Part;
use crate::geom::{OnMesh, Point3, TriMesh};
use crate::progress::Progress;
use crate::stock::{Stock, StockError};
use crate::tool::Cutter;
use rayon::prelude::*;
use serde::Serialize;

/// Rows measured between two reports.
const ROWS_AT_A_TIME: usize = 64;
/// Less than this left is not material to be explained [mm].
const LEFT: f64 = 0.05;
/// Shares of the surface within these distances are told [mm].
const BANDS: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 0.5];
/// Bins of the histogram.
const N_BINS: usize = 41;
/// The histogram spans this share of the surface; what lies outside goes into its end bins.
const SPAN: f64 = 0.98;

/// What the cut is compared with.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// The part, then its clamps, as they stand on the machine.
    pub mesh: &'a TriMesh,
    /// How many of the triangles are the part's own.
    pub n_own: usize,
    /// The same triangles, ready for digitizing.
    pub part: &'a Part,
}

/// How far what was cut is from the part, ray by ray.
#[derive(Debug, Clone)]
pub struct Deviation {
    /// Distance from the part at the end of each ray, row by row: positive where material is left,
    /// negative where too much is gone; NaN where nothing was to be cut [mm].
    pub values: Vec<f64>,
    /// The numbers.
    pub report: DeviationReport,
}

/// How far what was cut is from the part. Lengths in millimetres, areas in mm2.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct DeviationReport {
    /// The surface compared.
    pub area: f64,
    /// The deepest place cut into the part, as a positive depth.
    pub gouge: Option<Spot>,
    /// Surface cut deeper than the tolerance.
    pub gouged_area: f64,
    /// The deepest place cut into a clamp, along the ray.
    pub clamp_gouge: Option<Spot>,
    /// The most material left.
    pub left: Option<Spot>,
    /// The most material left that the tool is too large to take, of that.
    pub left_by_tool: Option<Spot>,
    /// The most material left that the tool could take, had its path gone there: ridges between
    /// turns, and whatever was passed by.
    pub left_by_path: Option<Spot>,
    /// Surface with more than 0.05 mm left.
    pub left_area: f64,
    /// Of that, surface on which the tool could take no more than 0.05 mm of it.
    pub left_area_by_tool: f64,
    /// Root of the mean square distance.
    pub rms: f64,
    /// Shares of the surface within some distances.
    pub within: Vec<Within>,
    /// How much surface lies how far off.
    pub histogram: Vec<Bin>,
}

/// A place of the surface and how far it is off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Spot {
    /// How far.
    pub value: f64,
    /// Where, in the part's frame on the machine.
    pub at: [f64; 3],
    /// The line of the program that cut there last, where somebody looked for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
}

/// How much of the surface lies within a distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Within {
    /// The distance.
    pub distance: f64,
    /// The share, 0 to 1.
    pub share: f64,
}

/// How much of the surface is off by so much.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Bin {
    /// The middle of the bin.
    pub distance: f64,
    /// The surface in it.
    pub area: f64,
}

impl DeviationReport {
    /// The places cut too deep, by more than `tolerance`.
    pub fn faults(&mut self, tolerance: f64) -> impl Iterator<Item = &mut Spot> {
        let spots = [&mut self.gouge, &mut self.clamp_gouge];
        spots.into_iter().flatten().filter(move |spot| spot.value > tolerance)
    }
}

/// What one ray has to say.
#[derive(Debug, Clone, Copy)]
struct Ray {
    point: Point3,
    area: f64,
    /// Signed distance from the part; NaN on a clamp, where `into_clamp` tells.
    distance: f64,
    into_clamp: f64,
    /// What of it the tool could still take.
    by_path: f64,
}

/// Compares `stock` with `target`; `cutter` is the tool that cut last, `tolerance` the depth from
/// which on a place counts as gouged [mm].
pub fn deviation(
    stock: &Stock,
    target: &Target,
    cutter: &Cutter,
    tolerance: f64,
    progress: &dyn Progress,
) -> Result<Deviation, StockError> {
    let reachable = limit(stock, target, cutter, progress)?;
    let piece =
        |triangles: &[[u32; 3]]| TriMesh::new(target.mesh.points.clone(), triangles.to_vec());
    let (own, clamps) = target.mesh.triangles.split_at(target.n_own);
    let layout = stock.layout();
    let own = Stock::of_mesh(layout.clone(), &piece(own));
    let clamps = Stock::of_mesh(layout.clone(), &piece(clamps));
    let nearest = OnMesh::new(target.mesh, target.n_own);
    let measure = Measure { stock, own: &own, clamps: &clamps, reachable: &reachable, nearest };
    progress.start("measuring", layout.n_rows() as u64);
    let n = layout.n_columns();
    let mut values = Vec::with_capacity(layout.n_rows() * n);
    let mut sums = Sums::default();
    for first in (0..layout.n_rows()).step_by(ROWS_AT_A_TIME) {
        let rows = first..(first + ROWS_AT_A_TIME).min(layout.n_rows());
        let n_rows = rows.len() as u64;
        let measured: Vec<Vec<Option<Ray>>> = rows
            .into_par_iter()
            .map(|row| (0..n).map(|column| measure.ray(row, column)).collect())
            .collect();
        for ray in measured.iter().flatten() {
            values.push(ray.map_or(f64::NAN, |ray| ray.distance));
            if let Some(ray) = ray {
                sums.add(ray, tolerance);
            }
        }
        progress.advance(n_rows)?;
    }
    Ok(Deviation { report: sums.report(), values })
}

struct Measure<'a> {
    stock: &'a Stock,
    own: &'a Stock,
    clamps: &'a Stock,
    reachable: &'a Stock,
    nearest: OnMesh,
}

impl Measure<'_> {
    /// `None` where nothing was to be cut, and so nothing can be wrong.
    fn ray(&self, row: usize, column: usize) -> Option<Ray> {
        let [own, clamp] = [self.own, self.clamps].map(|stock| stock.end(row, column));
        let floor = self.stock.layout().reach();
        let end = self.stock.end(row, column);
        let point = self.stock.point(row, column);
        let area = self.stock.area_at(row, column);
        let mut ray = Ray { point, area, distance: f64::NAN, into_clamp: 0.0, by_path: 0.0 };
        // Nothing left at all is as deep as the ray itself.
        let over = |wanted: f64| end.map_or(-floor, |end| end - wanted);
        match (own, clamp) {
            (own, Some(clamp)) if own.is_none_or(|own| own <= clamp) => {
                ray.into_clamp = (-over(clamp)).max(0.0);
                Some(ray)
            }
            (None, _) => None,
            (Some(own), _) => {
                let over = over(own);
                let distance = self.nearest.distance(&point, over.abs());
                ray.distance = distance.copysign(over);
                let taken = self.stock.end(row, column).zip(self.reachable.end(row, column));
                let along = taken.map_or(0.0, |(end, reachable)| end - reachable);
                // As steep as the ray is to the surface.
                let steep = if over.abs() > 0.0 { distance / over.abs() } else { 1.0 };
                // No more than is left at all: a ray along an end face is cut at any length.
                ray.by_path = (along * steep).min(ray.distance).max(0.0);
                Some(ray)
            }
        }
    }
}

/// What all rays say together.
#[derive(Default)]
struct Sums {
    area: f64,
    squares: f64,
    gouge: Option<Spot>,
    gouged_area: f64,
    clamp_gouge: Option<Spot>,
    left: Option<Spot>,
    left_by_tool: Option<Spot>,
    left_by_path: Option<Spot>,
    left_area: f64,
    left_area_by_tool: f64,
    within: [f64; BANDS.len()],
    /// Distances with their areas.
    all: Vec<(f32, f32)>,
}

impl Sums {
    fn add(&mut self, ray: &Ray, tolerance: f64) {
        if ray.distance.is_nan() {
            keep(&mut self.clamp_gouge, ray.into_clamp, &ray.point);
            return;
        }
        let (distance, area) = (ray.distance, ray.area);
        self.area += area;
        self.squares += distance * distance * area;
        keep(&mut self.gouge, -distance, &ray.point);
        keep(&mut self.left, distance, &ray.point);
        keep(&mut self.left_by_path, ray.by_path, &ray.point);
        keep(&mut self.left_by_tool, distance - ray.by_path, &ray.point);
        self.gouged_area += if -distance > tolerance { area } else { 0.0 };
        if distance > LEFT {
            self.left_area += area;
            self.left_area_by_tool += if ray.by_path <= LEFT { area } else { 0.0 };
        }
        for (share, band) in self.within.iter_mut().zip(BANDS) {
            *share += if distance.abs() <= band { area } else { 0.0 };
        }
        self.all.push((distance as f32, area as f32));
    }

    fn report(self) -> DeviationReport {
        let share = |area: f64| if self.area > 0.0 { area / self.area } else { 0.0 };
        let bands = BANDS.iter().zip(self.within);
        DeviationReport {
            area: self.area,
            gouge: self.gouge,
            gouged_area: self.gouged_area,
            clamp_gouge: self.clamp_gouge,
            left: self.left,
            left_by_tool: self.left_by_tool,
            left_by_path: self.left_by_path,
            left_area: self.left_area,
            left_area_by_tool: self.left_area_by_tool,
            rms: share(self.squares).sqrt(),
            within: bands
                .map(|(&distance, area)| Within { distance, share: share(area) })
                .collect(),
            histogram: histogram(self.all),
        }
    }
}

fn keep(spot: &mut Option<Spot>, value: f64, at: &Point3) {
    if value > spot.map_or(0.0, |found| found.value) {
        *spot = Some(Spot { value, at: at.coords.into(), line: None });
    }
}

fn histogram(mut all: Vec<(f32, f32)>) -> Vec<Bin> {
    if all.is_empty() {
        return Vec::new();
    }
    all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let at = |share: f64| f64::from(all[((all.len() - 1) as f64 * share) as usize].0);
    let tail = (1.0 - SPAN) / 2.0;
    let (low, high) = (at(tail), at(1.0 - tail).max(at(tail) + 1e-6));
    let width = (high - low) / N_BINS as f64;
    let middle = |i: usize| low + width * (i as f64 + 0.5);
    let mut bins: Vec<Bin> = (0..N_BINS).map(|i| Bin { distance: middle(i), area: 0.0 }).collect();
    for (distance, area) in all {
        let i = ((f64::from(distance) - low) / width).clamp(0.0, (N_BINS - 1) as f64);
        bins[i as usize].area += f64::from(area);
    }
    bins
}
