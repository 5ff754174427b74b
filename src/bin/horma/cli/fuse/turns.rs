//! Several turns of a part made one surface.

use super::{FuseArgs, stamps};
use anyhow::bail;
use horma::io::rgbd::Sequence;
use horma::progress::Progress;
use horma::workflow::fuse::Fused;
use horma::workflow::turns::{Turn, TurnsJob, fuse_turns};

/// The surface of `turns`, each with its name.
pub(super) fn fused(
    args: &FuseArgs,
    turns: &[(String, Sequence)],
    progress: &dyn Progress,
) -> anyhow::Result<Fused> {
    if !args.turntable.is_asked() {
        bail!(
            "several folders are the turns of a part on a turntable: give --turntable too; scans that are no \
             turns are laid on each other by horma register"
        );
    }
    if args.turntable.write_turntable.is_some() {
        bail!(
            "each of several turns has a turntable of its own: leave --write-turntable out, or give one turn"
        );
    }
    args.refuse_two_places()?;
    let camera = turns[0].1.camera;
    if let Some((name, _)) = turns.iter().find(|(_, turn)| turn.camera != camera) {
        bail!(
            "{name} was taken by another camera than {}: all turns must be taken by one, or --camera say which",
            turns[0].0
        );
    }
    let mut notes: Vec<String> = Vec::new();
    for note in turns.iter().flat_map(|(_, turn)| &turn.notes) {
        if !notes.contains(note) {
            notes.push(note.clone());
        }
    }
    let job = TurnsJob {
        turns: turns.iter().map(turn).collect(),
        camera: camera.camera,
        turntable: args.turntable.given()?,
        calibration: &args.turntable.options,
        notes,
        options: &args.options,
    };
    Ok(fuse_turns(&job, progress)?)
}

fn turn((name, sequence): &(String, Sequence)) -> Turn<'_> {
    Turn {
        name: name.clone(),
        stamps: stamps(sequence),
        frames: Box::new(|| Box::new(sequence.frames())),
    }
}
