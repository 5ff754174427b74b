//! `horma rough`: from a block to the part and its allowance.

use super::Shell;
use super::block::read_block;
use super::cam::{CamArgs, run_with};
use clap::Args;
use horma::workflow::cam::rough;

/// Compute the program that roughs a part out of its block, layer by layer.
#[derive(Debug, Args)]
#[command(
    after_help = "Leaves --allowance (1 mm) for finishing; the tool goes only where stock is.

For example:
  horma rough last.stl -m last-lathe --block cylinder:60 --max-depth 6 -o rough.ngc
  horma cam   last.stl -m last-lathe -o finish.ngc"
)]
pub(crate) struct RoughArgs {
    #[command(flatten)]
    cam: CamArgs,
    /// What the part is cut from: cylinder or cylinder:RADIUS, box or box:MARGIN, or the file of a
    /// moulded block that lies about the part as the part's file has it.
    #[arg(long, value_name = "BLOCK", default_value = "cylinder")]
    block: String,
    /// What the tool may take at once [mm; default: what its nose takes].
    #[arg(long, value_name = "MM")]
    max_depth: Option<f64>,
}

/// Plans the roughing and writes the program and its reports: all of them, or none.
pub(crate) fn run(args: &RoughArgs, shell: &Shell) -> anyhow::Result<()> {
    let block = read_block(&args.block, args.cam.units())?;
    run_with(&args.cam, shell, Some(&block), |job, progress| {
        rough(job, &block, args.max_depth, progress)
    })
}
