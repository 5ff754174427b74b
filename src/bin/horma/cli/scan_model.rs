//! `horma scan --method kinfu`: from the frames of a depth camera to a mesh.

use super::Shell;
use super::fuse::{self, FuseArgs};
use super::scan::ScanArgs;
use horma::workflow::fuse::FuseOptions;

/// Fuses as `horma fuse` does, with what a scan sets.
pub(super) fn run(args: &ScanArgs, shell: &Shell) -> anyhow::Result<()> {
    let fusing = FuseArgs {
        inputs: args.inputs.clone(),
        output: args.output.clone(),
        trajectory: args.trajectory.clone(),
        report: args.report.clone(),
        truth_poses: false,
        poses: None,
        find_pose_delay: false,
        turntable: args.turntable.clone(),
        camera: args.camera.clone(),
        force: args.force,
        options: options(args),
    };
    fuse::run(&fusing, shell)
}

fn options(args: &ScanArgs) -> FuseOptions {
    let mut options = FuseOptions::default();
    options.track.most_moved = args.options.odometry.most_moved;
    options.track.most_turned_deg = args.options.odometry.most_turned_deg;
    options.volume.voxel = args.options.voxel.unwrap_or(options.volume.voxel);
    options
}
