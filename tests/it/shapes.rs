//! The parametric last as flags, as a file and as a picture.

use clap::Parser;
use horma::geom::TriMesh;
use horma::geom::shapes::{LastParameters, Side, last};
use horma::io::report::{Camera, Raster, Scene, Solid, encode_png, render};

#[derive(Parser)]
struct Command {
    #[command(flatten)]
    last: LastParameters,
}

fn coarse(side: Side) -> TriMesh {
    last(&LastParameters { side, resolution: Some(5.0), ..LastParameters::default() }).unwrap()
}

fn seen(mesh: &TriMesh, camera: &Camera) -> Raster {
    let solids = vec![Solid { mesh, color: [214, 178, 132] }];
    render(&Scene { solids, paths: vec![] }, camera)
}

/// Pixels the last covers: wood has more red than blue, the background less.
fn wood(raster: &Raster) -> impl Iterator<Item = bool> {
    raster.pixels.iter().map(|[red, _, blue]| red > blue)
}

#[test]
fn flags_file_and_default_describe_the_same_last() {
    let default = LastParameters::default();
    assert_eq!(Command::try_parse_from(["last"]).unwrap().last, default);
    assert_eq!(toml::from_str::<LastParameters>("").unwrap(), default);
    let flags = ["last", "--length", "287", "--side", "right", "--ball-girth", "280"];
    let file = "length = 287.0\nside = 'right'\nball-girth = 280.0";
    let from_file: LastParameters = toml::from_str(file).unwrap();
    assert_eq!(Command::try_parse_from(flags).unwrap().last, from_file);
    assert_eq!(from_file.ball_girth, Some(280.0));
}

#[test]
fn unknown_key_of_a_last_is_refused_by_name() {
    let error = toml::from_str::<LastParameters>("heel-hight = 20.0").unwrap_err();
    assert!(error.to_string().contains("heel-hight"), "{error}");
}

#[test]
fn last_fills_its_picture_from_every_side() {
    let mesh = coarse(Side::Left);
    let size_px = [240, 160];
    for camera in [Camera::three_quarter(size_px), Camera::side(size_px), Camera::top(size_px)] {
        let raster = seen(&mesh, &camera);
        let share = wood(&raster).filter(|&is_wood| is_wood).count() as f64 / (240.0 * 160.0);
        assert!((0.15..0.8).contains(&share), "{share} of the picture from {camera:?}");
        assert!(encode_png(&raster).unwrap().starts_with(b"\x89PNG"));
    }
}

#[test]
fn right_last_is_seen_from_above_as_the_left_one_in_a_mirror() {
    let camera = Camera::top([240, 160]);
    let [left, right] = [Side::Left, Side::Right].map(|side| seen(&coarse(side), &camera));
    let rows = |raster: &Raster| -> Vec<Vec<bool>> {
        wood(raster).collect::<Vec<_>>().chunks(240).map(<[bool]>::to_vec).collect()
    };
    let n_different = |a: &[Vec<bool>], b: &[Vec<bool>]| {
        a.iter().flatten().zip(b.iter().flatten()).filter(|(a, b)| a != b).count()
    };
    let (left, right) = (rows(&left), rows(&right));
    let mirrored: Vec<Vec<bool>> = left.iter().rev().cloned().collect();
    // Samples on the outline may fall to either side.
    assert!(n_different(&mirrored, &right) < 20);
    assert!(n_different(&left, &right) > 500, "left and right must differ");
}

#[test]
fn picture_is_the_same_for_any_number_of_threads() {
    let mesh = coarse(Side::Left);
    let with = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| seen(&mesh, &Camera::three_quarter([300, 200])))
    };
    assert_eq!(with(1), with(3));
}
