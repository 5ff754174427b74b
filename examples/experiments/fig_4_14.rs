//! Figure 4.14: computing time over the precision of the surface. Morell (2014), experiment II.

use crate::contender::Task;
use crate::lathe::Lathe;
use crate::sweep::Sweep;
use std::path::Path;

/// Of the surface, over the thesis' range [points/mm2].
pub(crate) const PRECISIONS: [f64; 5] = [0.17, 0.25, 0.36, 0.51, 0.72];
/// Of the trajectory, as the thesis has it [points/mm].
pub(crate) const TRAJECTORY: f64 = 0.72;

pub(crate) fn run(folder: &Path, share: f64) -> anyhow::Result<()> {
    let lathe = Lathe::new()?;
    let spiral = lathe.spiral(TRAJECTORY * share);
    println!("{lathe}: {} steps, {TRAJECTORY} a mm", spiral.n);
    let sweep = Sweep {
        figure: "fig-4-14",
        over: "surface precision [points/mm2]",
        precisions: PRECISIONS,
    };
    sweep.run(folder, |precision| Task::new(&lathe.points(precision * share), spiral))
}
