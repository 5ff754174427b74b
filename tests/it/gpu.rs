//! Digitizing on a device against the CPU, bit for bit.
//!
//! Without an adapter these tests say that they are skipped; `HORMA_REQUIRE_GPU=1` forbids that.

use crate::dropping::{bits, contacts};
use crate::parts::{mesh, real};
use crate::random_cases::{Draw, in_cube};
use crate::textbook::{Tool, tools};
use horma::cam::{Device, DigitizeError, Digitized, Digitizer, Method, Part};
use horma::compute::{Compute, Gpu, GpuError, Precision, adapters};
use horma::geom::{Point3, PointCloud, Pose, TriMesh, Vector3, shapes};
use horma::io::read_surface;
use horma::progress::{Cancelled, Progress, Silent};
use nalgebra::{Translation3, UnitQuaternion};
use rand::{RngExt, SeedableRng};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// The device all tests share.
pub(crate) fn device() -> Option<&'static Gpu> {
    static GPU: LazyLock<Result<Gpu, GpuError>> = LazyLock::new(|| Gpu::open(None));
    match &*GPU {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("HORMA_REQUIRE_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

fn digitizer<'a>(part: &'a Part, tool: &Tool) -> Digitizer<'a> {
    let cutter = tool.profile.cutter(tool.allowance);
    Digitizer { part, cutter, method: Method::Exhaustive }
}

fn on_device(
    device: &Device,
    part: &Part,
    tool: &Tool,
    method: Method,
    poses: &[Pose],
) -> Digitized {
    let digitizer = Digitizer { method, ..digitizer(part, tool) };
    digitizer.run_on_gpu(device, poses.len(), |i| poses[i], &Silent).unwrap()
}

/// Fails unless the device's contacts are the CPU's, by both methods; how many positions it could not
/// decide at most.
fn assert_same(device: &Device, part: &Part, tool: &Tool, poses: &[Pose]) -> usize {
    let expected = bits(&contacts(part, tool, Method::Indexed, poses));
    let n_undecided = [Method::Exhaustive, Method::Indexed].map(|method| {
        let found = on_device(device, part, tool, method, poses);
        for (i, (a, b)) in bits(&found.contacts).into_iter().zip(&expected).enumerate() {
            assert_eq!(a, *b, "{method:?} at {} by {tool:?} in {:?}", poses[i], device.precision);
        }
        found.n_undecided
    });
    n_undecided.into_iter().fold(0, usize::max)
}

/// Every precision the device has.
fn precisions(gpu: &Gpu) -> Vec<Device<'_>> {
    let all = [Precision::Single, Precision::Double];
    let has = all.into_iter().filter(|&precision| gpu.has(precision));
    has.map(|precision| Device { precision, ..Device::new(gpu) }).collect()
}

/// Turned about x, half of them tilted too, the tool over some place of a box of half sides `half`.
fn poses(n: usize, half: Vector3, seed: u64) -> Vec<Pose> {
    let mut draw = Draw::seed_from_u64(seed);
    let mut pose = |i| {
        let mut rotation =
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), draw.random_range(0.0..TAU));
        if i % 2 == 0 {
            rotation = UnitQuaternion::from_scaled_axis(in_cube(&mut draw)) * rotation;
        }
        let under = in_cube(&mut draw).component_mul(&half);
        Pose::from_parts(Translation3::from(-(rotation * under)), rotation)
    };
    (0..n).map(&mut pose).collect()
}

/// Just inside, on and outside the rim of the tool lies the part's farthest point along x or along z.
fn at_the_silhouette(mesh: &TriMesh, tool: &Tool, n: usize, seed: u64) -> Vec<Pose> {
    let reach = tool.profile.cutter(tool.allowance).reach();
    let mut draw = Draw::seed_from_u64(seed);
    let mut pose = |i: usize| {
        let turn = draw.random_range(0.0..TAU);
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), turn);
        let side = if i % 4 < 2 { 1.0 } else { -1.0 };
        let axis = if i.is_multiple_of(2) { 0 } else { 2 };
        let out = |point: &Vector3| side * point[axis];
        let seen = mesh.points.iter().map(|point| rotation * point.coords);
        let far = seen.max_by(|a, b| out(a).total_cmp(&out(b))).unwrap();
        // From 1e-2 down to 1e-14 mm off the rim.
        let off = match i % 8 {
            0 => 0.0,
            7 => 0.01 * draw.random_range(-1.0..1.0),
            _ => {
                draw.random_range(-1.0_f64..1.0).signum() * 10_f64.powf(-2.0 - (i / 8 % 13) as f64)
            }
        };
        let rim = if axis == 0 { reach.x } else { reach.z };
        let mut at = Vector3::zeros();
        at[axis] = -side * (rim + off);
        Pose::from_parts(Translation3::from(at - far), rotation)
    };
    (0..n).map(&mut pose).collect()
}

fn cloud(mesh: &TriMesh) -> Part {
    Part::points(&PointCloud { points: mesh.points.clone(), ..PointCloud::default() })
}

#[test]
fn a_device_finds_the_contacts_of_the_cpu_bit_for_bit_for_every_tool() {
    let Some(gpu) = device() else { return };
    let bumpy = shapes::bumpy_cylinder(3_000);
    let half = bumpy.aabb().size() * 0.55;
    let poses = poses(300, half, 5);
    for part in [Part::triangles(&bumpy), cloud(&bumpy)] {
        for (i, profile) in tools().into_iter().enumerate() {
            let tool = Tool { profile, allowance: [0.0, 0.4, 3.0][i % 3] };
            for device in precisions(gpu) {
                let n_undecided = assert_same(&device, &part, &tool, &poses);
                assert!(n_undecided < poses.len() / 20, "{n_undecided} undecided by {tool:?}");
            }
        }
    }
}

#[test]
fn a_device_finds_the_contacts_of_the_cpu_at_the_rim_of_the_tool() {
    let Some(gpu) = device() else { return };
    let bumpy = shapes::bumpy_cylinder(1_000);
    for part in [Part::triangles(&bumpy), cloud(&bumpy)] {
        for profile in tools() {
            let tool = Tool { profile, allowance: 0.0 };
            let poses = at_the_silhouette(&bumpy, &tool, 208, 11);
            for device in precisions(gpu) {
                assert_same(&device, &part, &tool, &poses);
            }
        }
    }
}

#[test]
fn workgroups_batches_and_pieces_change_no_bit() {
    let Some(gpu) = device() else { return };
    let bumpy = shapes::bumpy_cylinder(1_500);
    let poses = poses(150, bumpy.aabb().size() * 0.5, 6);
    let usual = Device::new(gpu);
    for part in [Part::triangles(&bumpy), cloud(&bumpy)] {
        let tool = Tool { profile: tools()[0], allowance: 0.0 };
        for device in [
            usual,
            Device { workgroup: 1, ..usual },
            Device { workgroup: 256, batch: 1, ..usual },
            Device { batch: 67, ..usual },
        ] {
            // Few poses for as many dispatches.
            let n = if device.batch == 1 { 9 } else { poses.len() };
            assert_same(&device, &part, &tool, &poses[..n]);
        }
        // Branches of the tree, and primitives a few at a time.
        assert_same(&Device { binding: 5_000, ..usual }, &part, &tool, &poses);
    }
}

#[test]
fn what_lies_equally_high_all_over_is_left_to_the_processor() {
    let Some(gpu) = device() else { return };
    // A flat end on a level top of many points: each of them holds it as high.
    for n in [20, 150] {
        let points = (0..n * n).map(|i| {
            let [x, z] = [i % n, i / n].map(|k| 10.0 * (f64::from(k) / f64::from(n - 1) - 0.5));
            Point3::new(x, 3.0, z)
        });
        let part = Part::points(&PointCloud { points: points.collect(), ..PointCloud::default() });
        let tool = Tool { profile: tools()[2], allowance: 0.0 };
        let poses = [Pose::identity(); 3];
        assert_eq!(assert_same(&Device::new(gpu), &part, &tool, &poses), 3);
    }
}

#[test]
fn what_a_driver_ends_before_its_time_is_done_by_the_processor() {
    let Some(gpu) = device() else { return };
    // More in one run than lavapipe has the patience for; other drivers come to the end of it.
    let part = cloud(&shapes::bumpy_cylinder(140_000));
    assert!(65_535 < part.n_primitives());
    let device = Device { run: usize::MAX, ..Device::new(gpu) };
    let tool = Tool { profile: tools()[0], allowance: 0.0 };
    let poses = poses(8, Vector3::repeat(20.0), 7);
    let n_undecided = assert_same(&device, &part, &tool, &poses);
    assert!(n_undecided == 0 || n_undecided == poses.len(), "{n_undecided}");
}

#[test]
fn nothing_is_met_where_there_is_nothing() {
    let Some(gpu) = device() else { return };
    let tool = Tool { profile: tools()[0], allowance: 0.0 };
    let nothing = Part::points(&PointCloud::default());
    let bumpy = Part::triangles(&shapes::bumpy_cylinder(100));
    let aside = Pose::translation(500.0, 0.0, 0.0);
    let device = Device::new(gpu);
    for method in [Method::Exhaustive, Method::Indexed] {
        let met = |part, poses: &[Pose]| on_device(&device, part, &tool, method, poses).contacts;
        assert_eq!(met(&nothing, &[Pose::identity()]), [None]);
        assert_eq!(met(&bumpy, &[aside]), [None]);
        assert!(met(&bumpy, &[]).is_empty());
    }
}

#[test]
fn a_part_beyond_the_numbers_of_a_device_is_refused() {
    let Some(gpu) = device() else { return };
    let part = Part::triangles(&shapes::bumpy_cylinder(100));
    let tool = Tool { profile: tools()[0], allowance: 0.0 };
    let far = Pose::translation(0.0, 1e12, 0.0);
    let refused =
        digitizer(&part, &tool).run_on_gpu(&Device::new(gpu), 1, |_| far, &Silent).unwrap_err();
    assert!(matches!(refused, DigitizeError::TooFar { .. }), "{refused}");
    assert!(refused.to_string().contains("--compute cpu"), "{refused}");
}

/// Asks to stop as soon as it can.
struct Stop;

impl Progress for Stop {
    fn start(&self, _stage: &str, _n_units: u64) {}

    fn advance(&self, _n_units: u64) -> Result<(), Cancelled> {
        Err(Cancelled)
    }
}

#[test]
fn a_device_is_stopped_between_two_dispatches() {
    let Some(gpu) = device() else { return };
    let part = Part::triangles(&shapes::bumpy_cylinder(100));
    let tool = Tool { profile: tools()[0], allowance: 0.0 };
    let stopped =
        digitizer(&part, &tool).run_on_gpu(&Device::new(gpu), 9, |_| Pose::identity(), &Stop);
    assert!(matches!(stopped, Err(DigitizeError::Cancelled(Cancelled))));
}

#[test]
fn an_adapter_is_opened_by_a_part_of_its_name_and_others_are_refused_with_a_list() {
    let Some(gpu) = device() else { return };
    let all = adapters();
    assert_eq!(all[0].name, gpu.name(), "the fastest kind comes first");
    assert!(all.iter().all(|adapter| 0 < adapter.limits.binding_bytes));
    let part_of_it = gpu.name()[1..].to_uppercase();
    assert_eq!(Compute::gpu(Some(&part_of_it)).unwrap().name(), gpu.name());
    let refused = Compute::gpu(Some("no such device")).unwrap_err().to_string();
    assert!(refused.contains(gpu.name()), "{refused}");
}

#[test]
fn a_device_finds_the_contacts_of_the_cpu_on_a_real_foot_and_at_its_toe_and_heel() {
    let Some(gpu) = device() else { return };
    let Some(foot) = foot() else { return };
    let half = foot.aabb().size() * 0.52;
    for (part, n) in [(Part::triangles(&foot), 64), (cloud(&foot), 500)] {
        for profile in [tools()[0], tools()[1], tools()[3]] {
            let tool = Tool { profile, allowance: 0.0 };
            let mut poses = poses(n, half, 21);
            poses.append(&mut at_the_silhouette(&foot, &tool, n, 22));
            let n_undecided = assert_same(&Device::new(gpu), &part, &tool, &poses);
            eprintln!("{n_undecided} of {} undecided by {profile}", poses.len());
            assert!(n_undecided < poses.len() / 10, "{n_undecided} undecided by {profile}");
        }
    }
}

#[test]
fn a_device_finds_the_contacts_of_the_cpu_at_100_000_positions_by_the_tree() {
    let Some(gpu) = device() else { return };
    for device in precisions(gpu) {
        assert_same_at_100_000_positions(&device);
    }
}

/// Fails unless the device's contacts on the foot are the CPU's; 1,000 of them are at the ends, toe and
/// heel, within 0.01 mm of the rim of the tool.
fn assert_same_at_100_000_positions(device: &Device) {
    let Some(foot) = foot() else { return };
    let half = foot.aabb().size() * 0.52;
    for part in [Part::triangles(&foot), cloud(&foot)] {
        for profile in [tools()[0], tools()[1], tools()[3]] {
            let tool = Tool { profile, allowance: 0.0 };
            let mut poses = poses(98_000, half, 23);
            // Half of these are at the sides.
            poses.append(&mut at_the_silhouette(&foot, &tool, 2_000, 24));
            let expected = bits(&contacts(&part, &tool, Method::Indexed, &poses));
            let found = on_device(device, &part, &tool, Method::Indexed, &poses);
            let pairs = std::iter::zip(bits(&found.contacts), expected);
            let n_off = pairs.filter(|(found, expected)| found != expected).count();
            assert_eq!(n_off, 0, "{profile} in {:?}", device.precision);
            eprintln!("{} of {} undecided by {profile}", found.n_undecided, poses.len());
            assert!(found.n_undecided < poses.len() / 4, "{} undecided", found.n_undecided);
        }
    }
}

/// The real foot about its middle.
fn foot() -> Option<TriMesh> {
    let path = real("lasts/find_foot/foot_mean_left.obj")?;
    let foot = mesh(read_surface(&path, None).unwrap());
    let center = foot.aabb().center();
    Some(foot.moved(&Pose::translation(-center.x, -center.y, -center.z)))
}
