//! A fusion in words.

use horma::register::pose_delay::PoseDelay;
use horma::workflow::fuse::FuseReport;
use horma::workflow::turns::TurnReport;

/// Skipped frames that are told one by one.
const MOST_TOLD: usize = 5;

/// A fusion in words.
pub(super) fn summary(report: &FuseReport) -> String {
    let line = |head: &str, text: String| format!("{head:<10}{text}");
    let placed = if report.tracked { "placed by tracking" } else { "placed as given" };
    let mut lines =
        vec![line("frames", format!("{} of {} fused, {placed}", report.n_fused, report.n_frames))];
    lines.extend(report.pose_delay.as_ref().map(|delay| line("delay", late(delay))));
    if let Some(table) = &report.turntable {
        let [x, y, z] = table.axis;
        let [u, v, w] = table.through;
        lines.push(line(
            "turntable",
            format!(
                "{:.3} deg a step about ({x:.4}, {y:.4}, {z:.4}) through {u:.1} {v:.1} {w:.1} mm",
                table.step_deg
            ),
        ));
        lines.extend(table.reasons.iter().map(|reason| line("doubtful", reason.clone())));
    }
    for turn in &report.turns {
        lines.push(line(if turn.is_in() { "turn" } else { "left out" }, in_words(turn)));
    }
    for skipped in report.skipped.iter().take(MOST_TOLD) {
        lines.push(line("skipped", format!("frame {}: {}", skipped.number, skipped.reason)));
    }
    if report.skipped.len() > MOST_TOLD {
        lines.push(line("", format!("and {} more", report.skipped.len() - MOST_TOLD)));
    }
    lines.push(line(
        "model",
        format!(
            "voxel {} mm, truncation {} mm, {} blocks, {:.0} MB",
            report.voxel, report.truncation, report.n_blocks, report.memory_mb
        ),
    ));
    let why = report.compute.why.as_ref().map_or(String::new(), |why| format!(" ({why})"));
    lines.push(line("", format!("computed on {}{why}", report.compute.on)));
    let mesh = &report.mesh;
    let [x, y, z] = mesh.size;
    lines.push(line(
        "surface",
        format!("{} triangles, {x:.1} x {y:.1} x {z:.1} mm", mesh.n_triangles),
    ));
    lines.push(match (mesh.is_closed, mesh.volume) {
        (true, Some(volume)) => line("", format!("closed, {:.1} cm3", volume / 1000.0)),
        (true, None) => line("", "closed".to_owned()),
        (false, _) => line("", format!("open: {} edges on its borders", mesh.n_open_edges)),
    });
    if mesh.n_pieces > 1 {
        lines.push(line("", format!("in {} pieces", mesh.n_pieces)));
    }
    if report.n_small_pieces > 0 {
        lines.push(line("", format!("{} smaller pieces dropped", report.n_small_pieces)));
    }
    if let Some(off) = &report.kept_out {
        lines.push(line(
            "kept out",
            format!(
                "{} frames: {:.2} mm off in the median, {:.2} mm rms within 50 mm, {:.0} % within a voxel",
                off.n_frames,
                off.median,
                off.rmse_within_50,
                100.0 * off.share_within_voxel
            ),
        ));
    }
    if let Some(truth) = &report.against_truth {
        let n = truth.n_poses - truth.n_unmatched;
        let ate = truth.ate_mm.rmse;
        lines.push(line("truth", format!("{ate:.2} mm off (ATE, root mean square of {n})")));
    }
    lines.extend(report.notes.iter().map(|note| line("note", note.clone())));
    lines.join("\n")
}

fn late(delay: &PoseDelay) -> String {
    let ([at_stamps, then], n) = (delay.apart, delay.n_pairs);
    if delay.seconds == 0.0 {
        return format!(
            "none: frames lie nearest at their stamps, {then:.2} mm apart, by {n} pairs"
        );
    }
    let taken = if delay.seconds < 0.0 { "after" } else { "before" };
    let seconds = delay.seconds.abs();
    format!(
        "taken {seconds:.4} s {taken} the stamps: {then:.2} mm apart instead of {at_stamps:.2}, by {n} pairs"
    )
}

fn in_words(turn: &TurnReport) -> String {
    let TurnReport { name, n_frames, .. } = turn;
    if !turn.is_in() {
        return format!("{name}: {}", turn.reasons.join("; "));
    }
    let step = turn.turntable.as_ref().map_or(0.0, |table| table.step_deg);
    let fit = turn.lies_on_others.map_or_else(String::new, |fit| {
        format!(", {:.0} % of it lies on another turn", 100.0 * fit)
    });
    let mut told = vec![format!("{name}: {n_frames} frames, {step:.3} deg a step{fit}")];
    let doubts = turn.turntable.iter().flat_map(|table| &table.reasons);
    told.extend(doubts.map(|doubt| format!("doubtful: {doubt}")));
    told.join("; ")
}
