//! The judge: LinuxCNC's own interpreter, run on a program.

use std::path::Path;
use std::process::Command;

/// A move as the interpreter hands it to the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CanonicalMove {
    /// Where it ends: X Y Z [mm], A B C [deg], to four decimals.
    pub(crate) to: [f64; 6],
    /// How fast the control would go [mm/min; deg/min without linear part]; `None` for a rapid.
    pub(crate) rate: Option<f64>,
    /// How long the move takes at that rate [s]; 0 for a rapid.
    pub(crate) seconds: f64,
}

/// True if the interpreter is there. If not, says that the test is skipped; with
/// `HORMA_REQUIRE_RS274=1` it fails instead.
pub(crate) fn is_here() -> bool {
    let runs = Command::new("rs274").arg("-h").output().is_ok();
    let required = std::env::var_os("HORMA_REQUIRE_RS274").is_some_and(|value| value == "1");
    assert!(runs || !required, "rs274 is not on the PATH; install the package linuxcnc-uspace");
    if !runs {
        eprintln!("skipped: rs274 is not on the PATH (package linuxcnc-uspace)");
    }
    runs
}

/// The moves and pauses (as moves to where the machine stands) of `program`.
pub(crate) fn interpret(program: &Path) -> Vec<CanonicalMove> {
    // It keeps parameters in its folder and maps its tool table into a file at home, where two that
    // run at once would crash: each gets a folder and a home of its own. It must not be told to go
    // on after an error (-n 0): then it ends as if there had been none.
    let folder = tempfile::tempdir().unwrap();
    let tools: Vec<_> = (1..100).map(|number| format!("T{number} P{number} D0\n")).collect();
    std::fs::write(folder.path().join("tool.tbl"), tools.concat()).unwrap();
    let mut command = Command::new("rs274");
    command.args(["-t", "tool.tbl", "-g"]).arg(program.canonicalize().unwrap());
    command.current_dir(folder.path()).env("HOME", folder.path());
    let output = command.output().unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr);
    let status = output.status;
    assert!(status.success(), "rs274 on {}: {status}; {complaint}", program.display());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("PROGRAM_END()"), "rs274 did not reach the end: {complaint}");
    canonical_moves(&text)
}

fn canonical_moves(text: &str) -> Vec<CanonicalMove> {
    let (mut at, mut feed, mut moves) = ([0.0; 6], 0.0, Vec::new());
    for line in text.lines() {
        let Some((name, numbers)) = call(line) else { continue };
        let (rate, seconds) = match name {
            "SET_FEED_RATE" => {
                feed = numbers[0];
                continue;
            }
            "DWELL" => (Some(0.0), numbers[0]),
            "STRAIGHT_TRAVERSE" => (None, 0.0),
            "STRAIGHT_FEED" => {
                (Some(feed), 60.0 * fed_length(&at, numbers.as_slice().try_into().unwrap()) / feed)
            }
            "USE_LENGTH_UNITS" => panic!("numbers follow the words that name units: {line}"),
            _ => continue,
        };
        if name != "DWELL" {
            at = numbers.try_into().unwrap();
        }
        moves.push(CanonicalMove { to: at, rate, seconds });
    }
    moves
}

/// Name and numbers of a line like `   12 N..... STRAIGHT_FEED(0.0000, 72.0000, ...)`.
fn call(line: &str) -> Option<(&str, Vec<f64>)> {
    let (before, rest) = line.split_once('(')?;
    let numbers = rest.strip_suffix(')')?.split(',').map(|number| number.trim().parse());
    Some((before.split_whitespace().last()?, numbers.collect::<Result<_, _>>().ok()?))
}

/// The rate is of the linear axes, or of the rotary ones if they move alone.
fn fed_length(from: &[f64; 6], to: &[f64; 6]) -> f64 {
    let length = |axes: std::ops::Range<usize>| {
        axes.map(|i_axis| (to[i_axis] - from[i_axis]).powi(2)).sum::<f64>().sqrt()
    };
    if length(0..3) > 1e-7 { length(0..3) } else { length(3..6) }
}

#[test]
fn what_rs274_prints_is_understood() {
    let text = "    7 N..... COMMENT(\"interpreter: feed mode set to inverse time\")
   10 N..... USE_LENGTH_UNITS(CANON_UNITS_MM)
   17 N..... STRAIGHT_TRAVERSE(0.0000, 100.0000, 0.0000, 0.0000, 0.0000, 0.0000)
   25 N..... SET_FEED_RATE(600.0000)
   26 N..... STRAIGHT_FEED(0.0000, 70.0000, 0.0000, 0.0000, 0.0000, 0.0000)
   31 N..... SET_FEED_RATE(200.0000)
   32 N..... STRAIGHT_FEED(0.0000, 70.0000, 0.0000, 4.0000, 0.0000, 0.0000)
   35 N..... DWELL(1.5000)";
    let moves = canonical_moves(text);
    let seconds: Vec<_> = moves.iter().map(|step| step.seconds).collect();
    assert_eq!(seconds, [0.0, 3.0, 1.2, 1.5]);
    assert_eq!(moves[3].to, [0.0, 70.0, 0.0, 4.0, 0.0, 0.0]);
    assert_eq!(moves[0].rate, None);
}
