//! Figure 2.10: relative pose errors of the five methods on each sequence, mean and deviation. Morell (2014),
//! experiment I of section 2.4.

use crate::chart::row;
use crate::walks::{self, METHODS};
use horma::io::{Overwrite, write_file};
use std::path::Path;

/// Every method on every recorded sequence.
pub(crate) fn run(folder: &Path, share: f64) -> anyhow::Result<()> {
    println!("relative pose error from frame to frame [mm], mean ± standard deviation\n");
    compare(folder, "fig-2-10", &walks::recorded(share)?)?;
    println!("thesis, on other sequences of the same benchmark:");
    println!("- dense visual odometry is the most robust and among the best everywhere;");
    println!("- ICP after visual features improves them, most of all where the camera turns fast;");
    println!("- ICP alone and visual features alone have single errors that end a scan;");
    println!(
        "- KinectFusion gets lost where there is too little shape (two of its six sequences).\n"
    );
    Ok(())
}

/// A row for each method, a column for each walk; the same as CSV.
pub(crate) fn compare(folder: &Path, name: &str, walks: &[walks::Walk]) -> anyhow::Result<()> {
    let heads = || walks.iter().map(|walk| walk.name.clone());
    println!("{}", row("method", heads()));
    println!("{}", row("---", walks.iter().map(|_| "---".to_owned())));
    let mut csv = vec!["method,sequence,mean_mm,std_mm,placed,frames".to_owned()];
    for (method, how) in METHODS {
        let mut cells = Vec::new();
        for walk in walks {
            let followed = walk.follow(how)?;
            let numbers =
                followed.errors.map_or(",".to_owned(), |e| format!("{:.4},{:.4}", e.mean, e.std));
            let (n_placed, n_frames) = (followed.n_placed, followed.n_frames);
            csv.push(format!("{method},\"{}\",{numbers},{n_placed},{n_frames}", walk.name));
            cells.push(followed.cell());
        }
        println!("{}", row(method, cells.into_iter()));
    }
    let steps = walks.iter().map(|walk| format!("{:.2}", walk.steps().mean));
    println!("{}\n", row("the camera's own step", steps));
    std::fs::create_dir_all(folder)?;
    let path = folder.join(format!("{name}.csv"));
    let text = csv.join("\n") + "\n";
    write_file(&path, Overwrite::Replace, |out| out.write_all(text.as_bytes()))?;
    println!("written: {}\n", path.display());
    Ok(())
}
