//! `horma rough`: from a block to the part and its allowance.

use super::Shell;
use super::cam::{Aim, CamArgs, run_for};
use clap::Args;

/// Compute the program that roughs a part out of its block, layer by layer.
#[derive(Debug, Args)]
#[command(
    after_help = "Leaves --allowance (1 mm) for finishing; the tool goes only where stock is. `horma cam
--rough-with` roughs and finishes in one go.

For example:
  horma rough last.stl -m last-lathe --block cylinder:60 --max-depth 6 -o rough.ngc
  horma cam   last.stl -m last-lathe -o finish.ngc"
)]
pub(crate) struct RoughArgs {
    #[command(flatten)]
    cam: CamArgs,
}

/// Plans the roughing and writes the program and its reports: all of them, or none.
pub(crate) fn run(args: &RoughArgs, shell: &Shell) -> anyhow::Result<()> {
    run_for(Aim::Rough, &args.cam, shell)
}
