//! What the points of each cell sum up to.

use crate::geom::{Cells, CloudPart, CloudParts, PartError, Point3, PointCloud, Vector3};
use crate::progress::Progress;
use rayon::prelude::*;

/// Points sorted at a time: sums are the same for any number of threads.
const CHUNK: usize = 1 << 20;

/// The points of a cell, summed up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct CellSum {
    /// Which cell.
    pub(in super::super) key: u64,
    /// How many points it has.
    pub(in super::super) n: u64,
    /// From the middle of the cell [mm].
    pub(in super::super) shift: Vector3,
    pub(in super::super) normal: Option<Vector3>,
    pub(in super::super) color: Option<[u64; 3]>,
}

/// The sums of all cells that have points, in the order of the cells.
pub(in super::super) fn cell_sums(
    parts: &mut dyn CloudParts,
    cells: &Cells,
    progress: &dyn Progress,
) -> Result<Vec<CellSum>, PartError> {
    let mut all = Vec::new();
    parts.each_part(&mut |part| {
        for begin in (0..part.points.len()).step_by(CHUNK) {
            let chunk = part.range(begin, CHUNK);
            let sums = sums_of(chunk, cells);
            all = if all.is_empty() { sums } else { merged(&all, &sums) };
            progress.advance(chunk.points.len() as u64)?;
        }
        Ok(())
    })?;
    Ok(all)
}

fn sums_of(part: CloudPart<'_>, cells: &Cells) -> Vec<CellSum> {
    let points = part.points.par_iter().enumerate();
    let mut keyed: Vec<(u64, u32)> = points.map(|(i, p)| (cells.key(p), i as u32)).collect();
    keyed.par_sort_unstable();
    let runs: Vec<&[(u64, u32)]> = keyed.chunk_by(|a, b| a.0 == b.0).collect();
    runs.par_iter().map(|run| sum_of(part, run, cells)).collect()
}

fn sum_of(part: CloudPart<'_>, run: &[(u64, u32)], cells: &Cells) -> CellSum {
    let key = run[0].0;
    let middle = cells.middle(key);
    let points = || run.iter().map(|&(_, i)| i as usize);
    CellSum {
        key,
        n: run.len() as u64,
        shift: points().map(|i| part.points[i] - middle).sum(),
        normal: part.normals.map(|normals| points().map(|i| normals[i]).sum()),
        color: part
            .colors
            .map(|colors| [0, 1, 2].map(|k| points().map(|i| u64::from(colors[i][k])).sum())),
    }
}

/// Both, in the order of the cells, cells that are in both as one.
pub(in super::super) fn merged(a: &[CellSum], b: &[CellSum]) -> Vec<CellSum> {
    let mut all = Vec::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    while let (Some(x), Some(y)) = (a.peek(), b.peek()) {
        all.push(match x.key.cmp(&y.key) {
            std::cmp::Ordering::Less => **x,
            std::cmp::Ordering::Equal => x.and(y),
            std::cmp::Ordering::Greater => **y,
        });
        let (from_a, from_b) = (x.key <= y.key, y.key <= x.key);
        a.next_if(|_| from_a);
        b.next_if(|_| from_b);
    }
    all.extend(a);
    all.extend(b);
    all
}

impl CellSum {
    /// The sums of both, taken from the same middle.
    pub(in super::super) fn and(&self, other: &Self) -> Self {
        let add = |(a, b): ([u64; 3], [u64; 3])| [0, 1, 2].map(|k| a[k] + b[k]);
        Self {
            key: self.key,
            n: self.n + other.n,
            shift: self.shift + other.shift,
            normal: self.normal.zip(other.normal).map(|(a, b)| a + b),
            color: self.color.zip(other.color).map(add),
        }
    }

    /// The mean normal; z where normals cancel out.
    pub(in super::super) fn mean_normal(&self) -> Option<Vector3> {
        self.normal.map(|sum| sum.try_normalize(1e-9).unwrap_or_else(Vector3::z))
    }

    pub(in super::super) fn mean_color(&self) -> Option<[u8; 3]> {
        self.color.map(|color| color.map(|total| ((total + self.n / 2) / self.n) as u8))
    }

    /// The mean normals and colours of all, at `points`.
    pub(in super::super) fn cloud_of<'a>(
        points: Vec<Point3>,
        sums: impl Iterator<Item = &'a Self> + Clone,
    ) -> PointCloud {
        let is_any = !points.is_empty();
        PointCloud {
            points,
            normals: sums.clone().map(Self::mean_normal).collect::<Option<_>>().filter(|_| is_any),
            colors: sums.map(Self::mean_color).collect::<Option<_>>().filter(|_| is_any),
        }
    }
}
