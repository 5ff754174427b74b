//! Table 2.2 and figure 2.12: the methods where texture or structure is missing. Morell (2014), experiment II of
//! section 2.4, on sequences of the fr3 set; here on simulated walks of the same four kinds.

use crate::fig_2_10::compare;
use crate::walks;
use std::path::Path;

/// Every method before every scene.
pub(crate) fn run(folder: &Path, share: f64) -> anyhow::Result<()> {
    println!("relative pose error from frame to frame [mm], mean ± standard deviation\n");
    compare(folder, "table-2-2", &walks::simulated(share)?)?;
    println!(
        "thesis: errors mostly below 20 mm, often larger than the camera's own step; KinectFusion best with"
    );
    println!(
        "structure (a, d); visual features with ICP best on texture without structure (c); b fails for all;"
    );
    println!("dense visual odometry worst on the mean over the four.\n");
    Ok(())
}
