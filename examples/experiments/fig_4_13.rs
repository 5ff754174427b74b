//! Figure 4.13: computing time over the precision of the trajectory. Morell (2014), experiment I.

use crate::contender::Task;
use crate::lathe::Lathe;
use crate::sweep::Sweep;
use std::path::Path;

/// Of the trajectory, as the thesis has them [points/mm].
const PRECISIONS: [f64; 5] = [0.22, 0.44, 0.87, 1.75, 3.49];
/// Of the surface, the finest of the thesis [points/mm2].
const SURFACE: f64 = 0.72;

pub(crate) fn run(folder: &Path, share: f64) -> anyhow::Result<()> {
    let lathe = Lathe::new()?;
    let cloud = lathe.points(SURFACE * share);
    println!("{lathe}: {} points, {SURFACE} a mm2", cloud.points.len());
    let sweep = Sweep {
        figure: "fig-4-13",
        over: "trajectory precision [points/mm]",
        precisions: PRECISIONS,
    };
    sweep.run(folder, |precision| Task::new(&cloud, lathe.spiral(precision * share)))
}
