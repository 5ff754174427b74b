//! `horma register` on views that keep their rows and columns: what a camera looked through counts.

use crate::command::horma;
use crate::parts::real;
use horma::rgbd::{Camera, Image, OrganisedCloud, RgbdFrame};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

const CAMERA: Camera = Camera::pinhole([160, 120], [160.0, 160.0], [79.5, 59.5]);

/// A wall at 1 m with waves of 4 mm, and a board before it, if asked for.
fn view(has_board: bool) -> OrganisedCloud {
    let depth = Image::from_rows(160, 120, 0.0, |v, row: &mut [f32]| {
        for (u, z) in row.iter_mut().enumerate() {
            let [x, y] = CAMERA.ray([u as f64, v as f64]);
            let wall = 1000.0 + 4.0 * ((x * 11.0).sin() + (y * 14.0 + x * 5.0).cos());
            let is_board = has_board && x.abs() < 0.1 && y.abs() < 0.08;
            *z = if is_board { 700.0 } else { wall as f32 };
        }
    });
    let frame = RgbdFrame { stamp: 0.0, color: None, depth, confidence: None };
    frame.cloud(&CAMERA).unwrap()
}

/// A PCD of `rows` rows, in metres.
fn pcd(view: &OrganisedCloud, rows: usize) -> String {
    let points = view.points.pixels();
    let width = points.len() / rows;
    let mut text = format!(
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {width}\nHEIGHT {rows}\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA ascii\n",
        points.len()
    );
    for point in points {
        let [x, y, z]: [f64; 3] = (point.coords / 1e3).into();
        writeln!(text, "{x:.7} {y:.7} {z:.7}").unwrap();
    }
    text
}

fn registered(source: &Path, target: &Path) -> Value {
    let names = [source, target].map(|path| path.to_str().unwrap());
    let still = ["--coarse", "none", "--units", "m", "--voxel", "12", "--json"];
    let output = horma(&[&["register", names[0], names[1]][..], &still].concat());
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_board_that_hangs_where_the_other_camera_looked_through_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, has_board: bool, rows: usize| {
        let path = folder.path().join(name);
        std::fs::write(&path, pcd(&view(has_board), rows)).unwrap();
        path
    };
    let [with, without] = [put("with.pcd", true, 120), put("without.pcd", false, 120)];
    let told = registered(&with, &without);
    assert!(told["reasons"].to_string().contains("looked through"), "{}", told["reasons"]);
    assert_ne!(told["verdict"], "ok");
    assert!(told["free_space"]["n_contradicting"][0].as_u64().unwrap() > 100);
    // The same view agrees with itself.
    let told = registered(&with, &with);
    assert_eq!(told["free_space"]["n_contradicting"], serde_json::json!([0, 0]));
    // The same points in a row: nobody knows what was looked through.
    let told = registered(&put("row.pcd", true, 1), &without);
    assert!(told["free_space"].is_null(), "{told}");
    assert!(!told["reasons"].to_string().contains("looked through"), "{}", told["reasons"]);
}

#[test]
fn views_of_a_kinect_tell_their_camera_and_what_it_looked_through() {
    let views = (1..=5).map(|i| real(&format!("scans/pcl_pairwise/capture000{i}.pcd")));
    let Some(views) = views.collect::<Option<Vec<_>>>() else { return };
    for pair in views.windows(2) {
        let [target, source] = [&pair[0], &pair[1]].map(|path| path.to_str().unwrap());
        let output = horma(&["register", source, target, "--json"]);
        let told: Value = serde_json::from_slice(&output.stdout).unwrap();
        // Nobody knows the truth: 1.3 to 3.4 % of the readings contradict, and that is told.
        assert_ne!(told["verdict"], "failed", "{source}: {}", told["reasons"]);
        let of = |count: &str| told["free_space"][count][0].as_f64().unwrap();
        let (agreeing, against) = (of("n_agreeing"), of("n_contradicting"));
        assert!(agreeing > 1e4 && against < 0.05 * agreeing, "{source}: {}", told["free_space"]);
        let is_told = told["reasons"].to_string().contains("looked through");
        assert!(is_told || against < 0.011 * agreeing, "{source}: {}", told["reasons"]);
    }
}
