//! Parts of known form, tools dropped on them by both methods, and what must be near.

use crate::textbook::Tool;
use horma::cam::{Contact, ContactKind, Digitizer, Method, Part};
use horma::geom::{Point3, Pose, TriMesh, Vector3};
use horma::progress::Silent;
use horma::tool::Profile;
use std::f64::consts::TAU;

/// Triangles that share no vertex.
pub(crate) fn soup(triangles: &[[Point3; 3]]) -> TriMesh {
    let numbers = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    TriMesh::new(triangles.as_flattened().to_vec(), numbers.collect())
}

/// A triangle of some metres about `center`, across `normal`.
pub(crate) fn plane(center: &Vector3, normal: &Vector3) -> TriMesh {
    let along = normal.cross(&Vector3::new(0.3, 0.2, 0.9)).normalize();
    let across = normal.cross(&along);
    let corner = |i| {
        let (sin, cos) = (TAU * f64::from(i) / 3.0 + 0.4).sin_cos();
        Point3::from(center + (along * cos + across * sin) * 3000.0)
    };
    soup(&[[0, 1, 2].map(corner)])
}

/// An upright triangle hanging from the edge from `p` to `q`: nothing else of it can be touched.
pub(crate) fn edge(p: Vector3, q: Vector3) -> TriMesh {
    let below = (p + q) / 2.0 - Vector3::y() * 1000.0;
    soup(&[[p, q, below].map(Point3::from)])
}

/// A long edge of `slope` through height 3 that passes the tool's axis at `distance`, seen from
/// above in direction `turn`.
pub(crate) fn passing_edge(slope: f64, distance: f64, turn: f64) -> TriMesh {
    let (sin, cos) = turn.sin_cos();
    let foot = Vector3::new(-sin * distance, 3.0, cos * distance);
    let way = Vector3::new(cos, slope, sin);
    edge(foot - way * 170.0, foot + way * 230.0)
}

/// An upright needle that can only be touched at its point.
pub(crate) fn needle(point: Vector3) -> TriMesh {
    let foot = point - Vector3::y() * 1e6;
    soup(&[[point, foot + Vector3::x(), foot - Vector3::z()].map(Point3::from)])
}

/// Unit normals all over the half that faces the tool, from level to steep.
pub(crate) fn normals() -> impl Iterator<Item = Vector3> {
    (0..60).map(|i| {
        let steepness = f64::from(i) / 60.0 * 1.4;
        let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
        Vector3::new(steepness.sin() * cos, steepness.cos(), steepness.sin() * sin)
    })
}

/// The contacts at `poses` by one method.
pub(crate) fn contacts(
    part: &Part,
    tool: &Tool,
    method: Method,
    poses: &[Pose],
) -> Vec<Option<Contact>> {
    let cutter = tool.profile.cutter(tool.allowance);
    Digitizer { part, cutter, method }.run(poses.len(), |i| poses[i], &Silent).unwrap()
}

/// The contacts at `poses` by both methods, which must agree in every bit.
pub(crate) fn agreed(part: &Part, tool: &Tool, poses: &[Pose]) -> Vec<Option<Contact>> {
    let exhaustive = contacts(part, tool, Method::Exhaustive, poses);
    let indexed = contacts(part, tool, Method::Indexed, poses);
    for (i, (a, b)) in bits(&exhaustive).into_iter().zip(bits(&indexed)).enumerate() {
        let [a_seen, b_seen] = [exhaustive[i], indexed[i]];
        assert_eq!(a, b, "{a_seen:?} is not {b_seen:?} at {} by {tool:?}", poses[i]);
    }
    exhaustive
}

/// All of a contact as integers, so that equal means equal.
pub(crate) type Bits = Option<([u64; 7], u32, ContactKind)>;

/// The bits of each contact.
pub(crate) fn bits(contacts: &[Option<Contact>]) -> Vec<Bits> {
    let of = |Contact { height, point, normal, primitive, kind }| {
        let numbers = [height, point.x, point.y, point.z, normal.x, normal.y, normal.z];
        (numbers.map(f64::to_bits), primitive, kind)
    };
    contacts.iter().map(|contact| contact.map(of)).collect()
}

/// What a tool that cannot miss touches of a part, all seen in the attack frame, by both methods.
///
/// `part` is given in the attack frame; it is digitized in several frames of its own, between which
/// the height may differ by rounding only.
pub(crate) fn touched(part: &TriMesh, profile: Profile, allowance: f64) -> Contact {
    let tool = Tool { profile, allowance };
    let frames = [
        Pose::identity(),
        Pose::new(Vector3::new(-40.0, 5.0, 12.0), Vector3::x() * 2.0),
        Pose::new(Vector3::new(11.0, -30.0, 7.0), Vector3::new(0.3, -1.1, 0.7)),
    ];
    let [first, others @ ..] = frames.map(|attack_from_part| {
        let part = Part::triangles(&part.clone().moved(&attack_from_part.inverse()));
        let contact = agreed(&part, &tool, &[attack_from_part])[0]
            .unwrap_or_else(|| panic!("{tool:?} meets nothing at {attack_from_part}"));
        let point = attack_from_part * contact.point;
        Contact { point, normal: attack_from_part.rotation * contact.normal, ..contact }
    });
    for other in others {
        assert_near(other.height, first.height);
    }
    first
}

/// Within 1e-9 mm, what positions and heights of some 100 mm can be held to after many roundings.
#[track_caller]
pub(crate) fn assert_near(found: f64, expected: f64) {
    let off = (found - expected).abs();
    assert!(off <= 1e-9, "{found} is {off:e} from {expected}");
}

/// As [`assert_near`], coordinate by coordinate.
#[track_caller]
pub(crate) fn assert_near_all(found: &Vector3, expected: &Vector3) {
    let off = (found - expected).amax();
    assert!(off <= 1e-9, "{found:?} is {off:e} from {expected:?}");
}
