//! Digitizing points alone, as first published, lets the tool sink in between them; digitizing
//! triangles does not. How deep, on a last-like body, at several densities?
//!
//! The body is the same smooth one each time, ever finer: the wheel stops at `points` over its
//! vertices and at `triangles` over its facets, and what lies between the two is the gouge.
//!
//! ```sh
//! cargo run --release --example 02_exact_against_points
//! ```

use horma::cam::{Digitizer, Method, Part};
use horma::geom::{Pose, Surface, shapes, topology};
use horma::progress::{Cancelled, Silent};
use horma::tool::Profile;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// Positions a turn, and turns over the 200 mm in the middle of the body.
const RUN: (usize, usize) = (180, 50);

fn main() -> Result<(), Cancelled> {
    println!("wheel R40 r5 on the bumpy cylinder");
    println!("triangles  points/mm2  greatest gouge  mean gouge");
    for n_triangles in [2_000, 8_000, 32_000, 128_000] {
        let mesh = shapes::bumpy_cylinder(n_triangles);
        let density = mesh.points.len() as f64 / topology(&mesh).area;
        let exact = heights(&Part::triangles(&mesh))?;
        let cloud = Surface::Mesh(mesh).into_points();
        let on_points = heights(&Part::points(&cloud))?;
        // Over no point at all the tool would sink without end; so coarse no body here is.
        let gouges: Vec<f64> = exact.iter().zip(&on_points).map(|(e, p)| e - p).collect();
        let greatest = gouges.iter().copied().fold(0.0, f64::max);
        let mean = gouges.iter().sum::<f64>() / gouges.len() as f64;
        println!("{n_triangles:>9}  {density:>10.3}  {greatest:>11.4} mm  {mean:>7.4} mm");
    }
    Ok(())
}

/// Where the wheel stops at each position of a helix round the body's middle.
fn heights(part: &Part) -> Result<Vec<f64>, Cancelled> {
    let wheel = Profile::Wheel { major_radius: 40.0, minor_radius: 5.0 };
    let digitizer = Digitizer { part, cutter: wheel.cutter(0.0), method: Method::Indexed };
    let (per_turn, n_turns) = RUN;
    let pose = |i: usize| {
        let turns = i as f64 / per_turn as f64;
        let x = 20.0 + 200.0 * turns / n_turns as f64;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), TAU * turns);
        Pose::from_parts(Translation3::new(-x, 0.0, 0.0), turn)
    };
    let contacts = digitizer.run(per_turn * n_turns, pose, &Silent)?;
    Ok(contacts.iter().map(|contact| contact.map_or(f64::NAN, |contact| contact.height)).collect())
}
