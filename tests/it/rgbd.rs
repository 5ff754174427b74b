//! Sequences and views from files, real ones and broken ones.

use crate::parts::real;
use horma::geom::Point3;
use horma::io::rgbd::{DepthCamera, open_sequence, read_scan};
use horma::rgbd::filter::{BilateralOptions, OutlierOptions, bilateral, drop_outliers};
use horma::rgbd::{Camera, NormalOptions};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder with pictures of 4 x 3 pixels.
struct Scan(tempfile::TempDir);

impl Scan {
    fn new() -> Self {
        let scan = Self(tempfile::tempdir().unwrap());
        scan.text(
            "camera.toml",
            "width = 4\nheight = 3\nfx = 4\nfy = 4\ncx = 1.5\ncy = 1\ndepth-scale = 1000\n",
        );
        scan
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str, text: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn png(&self, name: &str, size: [u32; 2], depth: png::BitDepth, color: png::ColorType) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let mut encoder = png::Encoder::new(fs::File::create(path).unwrap(), size[0], size[1]);
        encoder.set_depth(depth);
        encoder.set_color(color);
        let n_bytes = color.samples() * (depth as usize / 8) * (size[0] * size[1]) as usize;
        // In 16 bits 3 * 256 + 3 = 771 mm.
        encoder.write_header().unwrap().write_image_data(&vec![3; n_bytes]).unwrap();
    }

    fn depth(&self, name: &str) {
        self.png(name, [4, 3], png::BitDepth::Sixteen, png::ColorType::Grayscale);
    }

    fn color(&self, name: &str) {
        self.png(name, [4, 3], png::BitDepth::Eight, png::ColorType::Rgb);
    }

    /// What is wrong with opening it, or with its first bad frame.
    fn fault(&self) -> String {
        match open_sequence(self.0.path(), None) {
            Err(error) => error.to_string(),
            Ok(sequence) => {
                let bad = sequence.frames().find_map(Result::err);
                bad.expect("something is wrong with it").to_string()
            }
        }
    }

    /// Two good frames in TUM's format.
    fn tum() -> Self {
        let scan = Self::new();
        scan.text("depth.txt", "# d\n1.00 depth/a.png\n2.00 depth/b.png\n");
        scan.text("rgb.txt", "0.99 rgb/a.png\n2.01 rgb/b.png\n");
        for name in ["a", "b"] {
            scan.depth(&format!("depth/{name}.png"));
            scan.color(&format!("rgb/{name}.png"));
        }
        scan
    }
}

#[test]
fn a_tum_folder_pairs_by_stamps_and_counts_what_is_left_over() {
    let scan = Scan::tum();
    scan.text("depth.txt", "1.00 depth/a.png\n1.50 depth/none.png\n2.00 depth/b.png\n");
    scan.text("rgb.txt", "0.5 x.png\n0.99 rgb/a.png\n1.01 y.png\n2.01 rgb/b.png\n");
    let sequence = open_sequence(scan.0.path(), None).unwrap();
    assert_eq!((sequence.n_depth_alone, sequence.n_color_alone), (1, 2));
    let note =
        "1 depth picture and 2 colour pictures left out: none of the other kind within 0.02 s";
    assert_eq!(sequence.notes, [note]);
    let stamps: Vec<_> = sequence.files.iter().map(|f| (f.stamp, f.depth_stamp)).collect();
    assert_eq!(stamps, [(0.99, 1.0), (2.01, 2.0)]);
    for frame in sequence.frames() {
        let frame = frame.unwrap();
        assert!(frame.depth.pixels().iter().all(|z| *z == 771.0));
        assert_eq!(frame.color.unwrap().pixels(), [[3; 3]; 12]);
    }
}

#[test]
fn a_plain_folder_needs_nothing_but_depth() {
    let scan = Scan::new();
    for name in ["depth/10.png", "depth/9.png"] {
        scan.depth(name);
    }
    let sequence = open_sequence(scan.0.path(), None).unwrap();
    let names: Vec<_> = sequence.files.iter().map(|f| f.depth.file_stem().unwrap()).collect();
    assert_eq!(names, ["9", "10"]);
    assert!((sequence.files[1].stamp - 1.0 / 30.0).abs() < 1e-12);
    assert!(sequence.truth.is_none() && sequence.files[0].color.is_none());
    for name in ["color/10.png", "color/9.png"] {
        scan.color(name);
    }
    for name in ["confidence/10.png", "confidence/9.png"] {
        scan.png(name, [4, 3], png::BitDepth::Eight, png::ColorType::Grayscale);
    }
    scan.text("poses.txt", "0 1 2 3 0 0 0 1\n");
    let sequence = open_sequence(scan.0.path(), None).unwrap();
    assert_eq!(sequence.truth.as_ref().unwrap().poses()[0].world_from_camera.translation.x, 1000.0);
    let mut frame = sequence.frames().next().unwrap().unwrap();
    assert!(frame.color.is_some());
    assert_eq!(frame.drop_doubtful(0.5), 12, "3 of 255 is not sure");
}

#[test]
fn disparities_of_a_kinect_become_depth() {
    let scan = Scan::tum();
    let camera = fs::read_to_string(scan.path("camera.toml")).unwrap();
    let with = |offset: &str| scan.text("camera.toml", &format!("{camera}[disparity]\n{offset}\n"));
    with("offset = 1090");
    let frame = open_sequence(scan.0.path(), None).unwrap().frames().next().unwrap().unwrap();
    // 75 * 580 / ((1090 - 771) / 8).
    assert!(frame.depth.pixels().iter().all(|z| (z - 1_090.909).abs() < 1e-3));
    with("offset = 700");
    let told = scan.fault();
    assert!(
        told.contains("a.png") && told.contains("the disparity 771 at column 0 of row 0"),
        "{told}"
    );
}

#[test]
fn a_folder_without_a_camera_is_taken_for_a_kinects_and_that_is_told() {
    let scan = Scan::tum();
    fs::remove_file(scan.path("camera.toml")).unwrap();
    let sequence = open_sequence(scan.0.path(), None).unwrap();
    assert_eq!(sequence.camera, DepthCamera::KINECT);
    assert!(sequence.notes[0].starts_with("no camera.toml in it: taken for a Kinect"));
    let error = sequence.frames().next().unwrap().unwrap_err().to_string();
    assert!(error.contains("the depth image is 4 x 3, but the camera is 640 x 480"), "{error}");
    assert!(error.starts_with("frame 1: ") && error.contains("a.png"), "{error}");
}

/// What is done to a scan, and what it is refused with.
type Case<'a> = (&'a dyn Fn(&Scan), &'a [&'a str]);

#[test]
fn broken_scans_are_told_with_file_place_and_value() {
    let broken = |change: &dyn Fn(&Scan)| {
        let scan = Scan::tum();
        change(&scan);
        scan.fault()
    };
    let remove = |scan: &Scan, name: &str| fs::remove_file(scan.path(name)).unwrap();
    let cases: [Case; 14] = [
        (&|s| s.text("rgb.txt", "0.99\n"), &["rgb.txt", "line 1: 1 columns where there must be 2"]),
        (&|s| s.text("rgb.txt", "nan a.png\n"), &["line 1: \"nan\" where a finite number"]),
        (
            &|s| s.text("depth.txt", "2 a\n1 b\n"),
            &["depth.txt", "line 2: the stamp 1 does not come"],
        ),
        (&|s| s.text("rgb.txt", "50 a.png\n"), &["no picture of depth is listed that has one"]),
        (&|s| remove(s, "depth.txt"), &["depth.txt", "check that the file is there"]),
        (
            &|s| remove(s, "depth/b.png"),
            &["frame 2: ", "depth/b.png", "check that the file is there"],
        ),
        (&|s| remove(s, "rgb/b.png"), &["frame 2: ", "rgb/b.png"]),
        (&|s| s.text("rgb/a.png", "x"), &["frame 1: ", "rgb/a.png", "it is no whole PNG file"]),
        (
            &|s| s.png("depth/a.png", [4, 3], png::BitDepth::Eight, png::ColorType::Grayscale),
            &["frame 1: ", "it has 8 bits of grey, but depth is grey of 16 bits"],
        ),
        (
            &|s| s.png("rgb/a.png", [8, 6], png::BitDepth::Eight, png::ColorType::Rgb),
            &["frame 1: ", "the color image is 8 x 6, but the depth image is 4 x 3"],
        ),
        (
            &|s| s.png("depth/a.png", [8, 6], png::BitDepth::Sixteen, png::ColorType::Grayscale),
            &["the depth image is 8 x 6, but the camera is 4 x 3"],
        ),
        (&|s| s.text("camera.toml", "width = 4\n"), &["camera.toml:1:1: missing field `height`"]),
        (
            &|s| s.text("groundtruth.txt", "1 0 0 0 0 0 0 2\n"),
            &["groundtruth.txt", "the length 2.0000"],
        ),
        (&|s| s.text("groundtruth.txt", "1 0 0 0\n"), &["line 1: 4 columns where there must be 8"]),
    ];
    for (change, expected) in cases {
        let told = broken(change);
        for part in expected {
            assert!(told.contains(part), "{told:?} does not say {part:?}");
        }
    }
}

#[test]
fn broken_plain_folders_are_told() {
    let scan = Scan::new();
    assert!(scan.fault().contains("it is no scan"), "{}", scan.fault());
    scan.depth("depth/1.png");
    scan.color("color/2.png");
    let told = scan.fault();
    assert!(
        told.contains("color/1.png") && told.contains("check that the file is there"),
        "{told}"
    );
    assert!(open_sequence(Path::new("no-such-folder"), None).is_err());
}

#[test]
fn a_real_sequence_has_its_frames_and_its_truth() {
    for (name, n_frames) in [("tum_fr1_rpy_cut", 70), ("tum_fr1_rpy_fast_cut", 40)] {
        let Some(folder) = real(&format!("rgbd/{name}")) else { return };
        let sequence = open_sequence(&folder, Some(DepthCamera::FREIBURG1)).unwrap();
        assert_eq!((sequence.files.len(), sequence.notes.len()), (n_frames, 0), "{name}");
        let truth = sequence.truth.as_ref().unwrap();
        let frame = sequence.frames().next().unwrap().unwrap();
        assert!((truth.nearest(frame.stamp).unwrap().stamp - frame.stamp).abs() < 0.006);
        frame.check_depth().unwrap();
        let cloud = frame.cloud(&sequence.camera.camera).unwrap();
        assert!(cloud.n_points() > 640 * 480 / 2);
        let cloud = cloud.with_normals(&Point3::origin(), &NormalOptions::default());
        let (x, y) = (0..480)
            .flat_map(|y| (0..640).map(move |x| (x, y)))
            .find(|&(x, y)| cloud.normal(x, y).is_some())
            .unwrap();
        assert!(cloud.normal(x, y).unwrap().dot(&cloud.point(x, y).unwrap().coords) < 0.0);
    }
}

#[test]
fn filters_make_a_real_frame_smoother_and_keep_most_of_it() {
    let Some(folder) = real("rgbd/tum_fr1_rpy_cut") else { return };
    let sequence = open_sequence(&folder, Some(DepthCamera::FREIBURG1)).unwrap();
    let depth = sequence.frames().next().unwrap().unwrap().depth;
    let (left, outliers) = drop_outliers(&depth, &OutlierOptions::default());
    let n = depth.pixels().iter().filter(|z| **z > 0.0).count();
    let n_dropped = outliers.n_lone + outliers.n_flying;
    assert!(0 < n_dropped && n_dropped < n / 20, "{outliers:?} of {n}");
    let smooth = bilateral(&left, &BilateralOptions::default());
    let roughness = |image: &horma::rgbd::Image<f32>| {
        let bends = image.pixels().windows(3).filter(|w| w.iter().all(|z| *z > 0.0));
        let mut bends: Vec<f32> = bends.map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).collect();
        bends.sort_by(f32::total_cmp);
        bends[bends.len() * 9 / 10]
    };
    assert!(
        roughness(&smooth) < 0.5 * roughness(&left),
        "{} {}",
        roughness(&smooth),
        roughness(&left)
    );
    let moved = left.pixels().iter().zip(smooth.pixels()).map(|(a, b)| (a - b).abs() / a.max(1.0));
    assert!(moved.fold(0.0, f32::max) < 0.03);
}

#[test]
fn real_views_keep_their_rows_and_columns() {
    let Some(path) = real("scans/pcl_pairwise/capture0001.pcd") else { return };
    let view = read_scan(&path, None).unwrap().1.unwrap();
    let size = (view.points.width(), view.points.height());
    assert_eq!(size, (640, 480));
    // A Kinect's cloud in its own frame: its points lie on the rays of its pixels.
    let camera = Camera::KINECT;
    let off = |(x, y): (usize, usize)| {
        let [u, v] = camera.project(view.point(x, y)?)?;
        Some((u - x as f64).hypot(v - y as f64))
    };
    let pixels = (0..480).step_by(7).flat_map(|y| (0..640).step_by(7).map(move |x| (x, y)));
    let offs: Vec<f64> = pixels.filter_map(off).collect();
    assert!(offs.len() > 2000 && offs.iter().all(|off| *off < 2.0), "{}", offs.len());

    let Some(path) = real("scans/stanford_bunny/bun000.ply") else { return };
    let view = read_scan(&path, None).unwrap().1.unwrap();
    assert_eq!((view.points.width(), view.points.height()), (512, 400));
    assert_eq!(view.n_points(), 40_256);
    // Neighbours in the picture are neighbours in space.
    let near =
        (1..512).filter_map(|x| Some((view.point(x, 200)? - view.point(x - 1, 200)?).norm()));
    let mut steps: Vec<f64> = near.collect();
    steps.sort_by(f64::total_cmp);
    assert!(steps.len() > 50 && steps[steps.len() / 2] < 1.5, "{} {:?}", steps.len(), steps.last());
}
