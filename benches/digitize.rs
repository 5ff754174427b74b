//! scratch
use horma::cam::{Digitizer, Method, Part};
use horma::geom::{Point3, PointCloud, Pose, TriMesh};
use horma::progress::Silent;
use horma::tool::Profile;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use std::time::Instant;

fn load(path: &str) -> TriMesh {
    let (models, _) = tobj::load_obj(
        path,
        &tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() },
    )
    .unwrap();
    let m = &models[0].mesh;
    let points =
        m.positions.chunks(3).map(|p| Point3::new(p[0] as f64, p[1] as f64, p[2] as f64)).collect();
    let triangles = m.indices.chunks(3).map(|t| [t[0], t[1], t[2]]).collect();
    TriMesh::new(points, triangles)
}

fn subdivide(mesh: &TriMesh) -> TriMesh {
    let mut points = mesh.points.clone();
    let mut map = std::collections::HashMap::new();
    let mut tris = vec![];
    for t in &mesh.triangles {
        let mut mid = |a: u32, b: u32| {
            *map.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push(nalgebra::center(&points[a as usize], &points[b as usize]));
                (points.len() - 1) as u32
            })
        };
        let (ab, bc, ca) = (mid(t[0], t[1]), mid(t[1], t[2]), mid(t[2], t[0]));
        tris.extend([[t[0], ab, ca], [ab, t[1], bc], [ca, bc, t[2]], [ab, bc, ca]]);
    }
    TriMesh::new(points, tris)
}

fn main() {
    let dir = std::env::var("HORMA_DATA").unwrap() + "/lasts/find_foot/";
    let mesh = load(&(dir + "foot_mean_left.obj"));
    let levels = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(0);
    let mut mesh = mesh;
    for _ in 0..levels {
        mesh = subdivide(&mesh);
    }
    let aabb = mesh.aabb();
    let c = aabb.center();
    let mesh = mesh.moved(&Pose::translation(-aabb.min.x, -c.y, -c.z));
    let t = Instant::now();
    let part = Part::triangles(&mesh);
    println!("{} triangles, built in {:?}", mesh.triangles.len(), t.elapsed());
    let pitch = 2.0;
    let n = 360;
    let len = aabb.size().x;
    let total = (len / pitch) as usize * n;
    let pose = |i: usize| {
        let a = (i % n) as f64 / n as f64 * std::f64::consts::TAU;
        let x = i as f64 / n as f64 * pitch;
        Pose::from_parts(
            Translation3::new(-x, 0.0, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), a),
        )
    };
    let wheel = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }.cutter(0.0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let d = Digitizer { part: &part, cutter: wheel, method: Method::Indexed };
    for _ in 0..3 {
        let t = Instant::now();
        let a = pool.install(|| d.run(total, pose, &Silent)).unwrap();
        let per = t.elapsed().as_secs_f64() / total as f64 * 1e6;
        println!(
            "indexed {total} positions {per:.2} us each, {} missed",
            a.iter().filter(|c| c.is_none()).count()
        );
        let stride = total / 100;
        let t = Instant::now();
        let e = Digitizer { method: Method::Exhaustive, ..d };
        let b = pool.install(|| e.run(100, |i| pose(i * stride), &Silent)).unwrap();
        println!("exhaustive {:.1} us each", t.elapsed().as_secs_f64() / 100.0 * 1e6);
        let diff = (0..100).filter(|&i| a[i * stride] != b[i]).count();
        println!("differences {diff}");
        for i in (0..100).filter(|&i| a[i * stride] != b[i]).take(2) {
            println!("{:?}\n{:?}", a[i * stride], b[i]);
        }
    }
    let _ = PointCloud::default();
}
