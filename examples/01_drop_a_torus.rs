//! One wheel comes down on one triangle: where it stops, what it touches, and that lifting the
//! triangle lifts the wheel by as much.
//!
//! ```sh
//! cargo run --example 01_drop_a_torus
//! ```

use horma::cam::{Contact, Digitizer, Method, Part};
use horma::geom::{Point3, Pose, TriMesh};
use horma::progress::{Cancelled, Silent};
use horma::tool::Profile;

fn main() -> Result<(), Cancelled> {
    // A slope that falls along X, wide enough for the wheel to touch it inside.
    let corners = [[-100.0, 50.0, -40.0], [100.0, 30.0, -40.0], [0.0, 40.0, 60.0]];
    let triangle = TriMesh::new(corners.map(Point3::from).into(), vec![[0, 1, 2]]);
    // Torus: its tube of radius 10 runs around at 60 from the wheel's axis, which lies along X.
    let wheel = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 };
    for x in [-115.0, -105.0, -60.0, 0.0] {
        match drop(&triangle, wheel, x)? {
            Some(contact) => {
                let Contact { height, point, kind, .. } = contact;
                println!(
                    "wheel at x = {x:>6.1}: centre stops at y = {height:.4}, touching the {} at \
                     ({:.3}, {:.3}, {:.3})",
                    format!("{kind:?}").to_lowercase(),
                    point.x,
                    point.y,
                    point.z
                );
            }
            None => println!("wheel at x = {x:>6.1}: passes the triangle by"),
        }
    }
    Ok(())
}

/// Brings the wheel down the attack axis Y over x and z = 0.
fn drop(triangle: &TriMesh, wheel: Profile, x: f64) -> Result<Option<Contact>, Cancelled> {
    let part = Part::triangles(triangle);
    let digitizer =
        Digitizer { part: &part, cutter: wheel.cutter(0.0), method: Method::Exhaustive };
    // Digitizing sees the part from the tool: the wheel at x is the part at -x.
    let contacts = digitizer.run(1, |_| Pose::translation(-x, 0.0, 0.0), &Silent)?;
    Ok(contacts[0])
}
