//! `horma last`: a last from a few measures, whole in its file or not there at all.

use crate::command::horma;
use crate::parts::{Folder, mesh};
use horma::geom::topology;
use horma::io::read_surface;
use std::path::Path;
use std::process::Output;

/// Runs `horma last` for a file with further arguments.
fn last(file: &Path, arguments: &[&str]) -> Output {
    horma(&[&["last", "-o", file.to_str().unwrap()], arguments].concat())
}

fn told(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn a_last_is_written_closed_and_as_long_as_asked_in_every_format_of_meshes() {
    let folder = Folder::new();
    for name in ["a.stl", "a.ply", "a.obj", "a.glb"] {
        let file = folder.path(name);
        let output = last(&file, &["--length", "230", "--side", "right", "--resolution", "4"]);
        assert_eq!(output.status.code(), Some(0), "{}", told(&output));
        let mesh = mesh(read_surface(&file, None).unwrap());
        assert!(topology(&mesh).is_closed(), "{name}");
        // Single precision, as STL and GLB hold it.
        assert!((mesh.aabb().size().x - 230.0).abs() < 1e-4, "{name}");
        // The toe of a right last leans to positive Y.
        let toe = mesh.points.iter().max_by(|a, b| a.x.total_cmp(&b.x)).unwrap();
        assert!(toe.y > 4.0 || name == "a.glb", "{name}: toe at {toe}");
    }
}

#[test]
fn the_report_says_how_large_the_last_came_out() {
    let folder = Folder::new();
    let output = last(&folder.path("a.stl"), &["--json", "--ball-girth", "240"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["last"]["ball-girth"], 240.0);
    assert!((report["size"][0].as_f64().unwrap() - 265.0).abs() < 1e-9);
    let n_triangles = report["n_triangles"].as_u64().unwrap();
    assert_eq!(std::fs::metadata(folder.path("a.stl")).unwrap().len(), 84 + 50 * n_triangles);
    let in_words = String::from_utf8(last(&folder.path("b.stl"), &[]).stdout).unwrap();
    assert!(in_words.contains("\nsize    265.0 x "), "{in_words}");
    assert!(last(&folder.path("c.stl"), &["--quiet"]).stdout.is_empty());
}

#[test]
fn a_last_that_is_there_is_kept_unless_forced() {
    let folder = Folder::new();
    let file = folder.put("a.stl", "mine");
    let output = last(&file, &[]);
    assert_eq!(output.status.code(), Some(73));
    assert!(told(&output).contains("exists already"), "{}", told(&output));
    assert_eq!(std::fs::read(&file).unwrap(), b"mine");
    assert_eq!(last(&file, &["--force"]).status.code(), Some(0));
    assert_ne!(std::fs::read(&file).unwrap(), b"mine");
}

#[test]
fn measures_that_make_no_last_are_refused_and_leave_no_file() {
    let folder = Folder::new();
    let file = folder.path("a.stl");
    for (arguments, code, expected) in [
        (["--heel-height", "200"], 65, "heel-height is 200, but this last takes 0.0 to 79.5"),
        (["--length", "nan"], 65, "length is NaN"),
        (["--length", "long"], 2, "invalid value 'long' for '--length <MM>'"),
        (["--side", "both"], 2, "[possible values: left, right]"),
    ] {
        let output = last(&file, &arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(told(&output).contains(expected), "{arguments:?}: {}", told(&output));
        assert!(!file.exists());
    }
    let output = last(&folder.path("a.dwg"), &[]);
    assert_eq!(output.status.code(), Some(73));
    assert!(told(&output).contains("its extension is none of those"), "{}", told(&output));
}

/// A limit on the size of files fails a write half-way, as a full disk does.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_half_way_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let script =
        format!("trap '' XFSZ; ulimit -f 8; {} last -o big.stl", env!("CARGO_BIN_EXE_horma"));
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(73), "{}", told(&output));
    assert_eq!(
        told(&output),
        "error: cannot write \"big.stl\": File too large (os error 27); \
         make room or write somewhere else\n"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
