//! Where a tool coming down touches one primitive: a concave maximum over a triangle or a point.
//!
//! Over a triangle `y + u(x, z)` is concave. Its maximum lies inside the facet, else on an edge,
//! else at a vertex (ARCHITECTURE section 4). All coordinates are in the attack frame.

use super::view::View;
use crate::geom::{Point3, Vector3};
use crate::tool::HeightFunction;

/// A height below another by less than this may still be rounding [mm].
const ROUNDING: f64 = 1e-9;
/// An edge search ends when a paraboloid above the tool leaves less than this to gain [mm].
const LEAST_GAIN: f64 = 1e-12;
/// Or when a tangent, which rounding lets fall less far, leaves less than this [mm].
const LEAST_RISE: f64 = 1e-10;
/// Newton steps, mixed with halvings, before an edge search is cut short; six are usual.
const MOST_STEPS: usize = 128;
/// A triangle of less than half this area has only edges: squares of it are no numbers any more
/// [mm2].
const LEAST_AREA: f64 = 1e-140;
/// Below this `normal.y` the facet's contact is too vague to tell which edges it lies behind.
const STEEP: f64 = 1e-4;

/// A triangle prepared for digitizing: corners in lexicographic order, so that an edge shared by
/// two triangles is evaluated from the same end with the same bits, and the unit normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    pub(super) corners: [Point3; 3],
    /// Zero for a triangle without area.
    pub(super) normal: Vector3,
}

/// Where the tool touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Touch {
    /// Height of the tool's programmed point.
    pub(super) height: f64,
    /// Contact seen from the programmed point's foot (attack height 0).
    pub(super) at: Vector3,
    /// What is touched.
    pub(super) kind: ContactKind,
    /// The side of a triangle it was found on, in the part frame.
    pub(super) side: Option<[Point3; 2]>,
}

/// What a tool touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactKind {
    /// The inside of a triangle.
    Facet,
    /// An edge.
    Edge,
    /// A corner.
    Vertex,
    /// A point of a cloud.
    Point,
}

impl Facet {
    pub(super) fn new(mut corners: [Point3; 3]) -> Self {
        let [a, b, c] = corners;
        let across = cross(&(b - a), &(c - a));
        let normal = across.try_normalize(LEAST_AREA).unwrap_or_else(Vector3::zeros);
        corners.sort_by(|a, b| {
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
        });
        Self { corners, normal }
    }
}

/// The cross product with each coordinate rounded but for its last bits: a sliver's sides are so
/// nearly parallel that plain products would leave little more than their rounding, and a plane
/// that misses the corners by far.
fn cross(u: &Vector3, v: &Vector3) -> Vector3 {
    // Kahan's difference of products: the rounding of the second is given back.
    let difference = |a: f64, b: f64, c: f64, d: f64| {
        let product = c * d;
        a.mul_add(b, -product) + (-c).mul_add(d, product)
    };
    Vector3::new(
        difference(u.y, v.z, u.z, v.y),
        difference(u.z, v.x, u.x, v.z),
        difference(u.x, v.y, u.y, v.x),
    )
}

/// Where the tool touches a single point, if it does not pass it by. Morell (2014), eq. 4.7,
/// solved for the centre.
#[inline(always)]
pub(super) fn on_point(tool: &impl HeightFunction, at: Vector3) -> Option<Touch> {
    let height = at.y + tool.height(at.x, at.z)?;
    Some(Touch { height, at, kind: ContactKind::Point, side: None })
}

/// Where the tool touches `facet`; `None` if it passes by or if that is surely below `best`, the
/// highest of the triangles tried before.
#[inline(always)]
pub(super) fn on_triangle(
    tool: &impl HeightFunction,
    view: &View,
    facet: &Facet,
    best: Option<&Touch>,
) -> Option<Touch> {
    let least = best.map_or(f64::NEG_INFINITY, |best| best.height);
    let [a, b, c] = &facet.corners;
    let corners = [view.see(a), view.see(b), view.see(c)];
    let normal = view.facing(&facet.normal);
    let mut behind = [true; 3];
    if 0.0 < normal.y {
        let support = tool.support(&normal);
        // The facet's whole plane bounds what the triangle can reach.
        let reach = normal.dot(&(corners[0] - support));
        if reach + ROUNDING < least * normal.y {
            return None;
        }
        let height = reach / normal.y;
        let at = Vector3::new(support.x, support.y + height, support.z);
        behind = sides_behind(&corners, &normal, &at);
        if behind == [false; 3] {
            return Some(Touch { height, at, kind: ContactKind::Facet, side: None });
        }
        if normal.y < STEEP {
            behind = [true; 3];
        }
    }
    // Concave with its peak over the plane at `at`: the greatest value of the triangle lies on a
    // side that parts it from `at`.
    let sides = [[0, 1], [0, 2], [1, 2]];
    let mut highest: Option<Touch> = None;
    for ([from, to], _) in sides.into_iter().zip(behind).filter(|(_, behind)| *behind) {
        let least = highest.map_or(least, |highest| highest.height);
        let side = Some([facet.corners[from], facet.corners[to]]);
        let touch = match best {
            // Most sides are shared by two triangles: this one has been searched.
            Some(best) if best.side == side => Some(*best),
            _ => on_edge(tool, &corners[from], &corners[to], least),
        };
        if let Some(touch) = touch
            && highest.is_none_or(|highest| highest.is_beaten_by(&touch))
        {
            highest = Some(Touch { side, ..touch });
        }
    }
    highest
}

impl Touch {
    /// Higher wins; at the same height an edge wins over a vertex.
    fn is_beaten_by(&self, other: &Self) -> bool {
        (self.height, other.kind) < (other.height, self.kind)
    }
}

/// For the sides 0-1, 0-2 and 1-2: does `at`, in the triangle's plane, lie beyond it?
#[inline(always)]
fn sides_behind(corners: &[Vector3; 3], normal: &Vector3, at: &Vector3) -> [bool; 3] {
    let drop = normal.iamax();
    let (i, j) = ((drop + 1) % 3, (drop + 2) % 3);
    let turn = |a: &Vector3, b: &Vector3, c: &Vector3| {
        (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i])
    };
    let [a, b, c] = corners;
    let sense = turn(a, b, c).signum();
    [turn(a, b, at), turn(c, a, at), turn(b, c, at)].map(|side| side * sense < 0.0)
}

/// Where the tool touches the edge from `p` to `q`: the maximum of a concave function of one
/// variable on the part of the edge in the tool's shadow, by Newton steps kept between brackets.
#[inline(always)]
fn on_edge(tool: &impl HeightFunction, p: &Vector3, q: &Vector3, least: f64) -> Option<Touch> {
    let way = q - p;
    if way.x == 0.0 && way.z == 0.0 {
        let top = if p.y < q.y { q } else { p };
        return on_point(tool, *top).map(|touch| Touch { kind: ContactKind::Vertex, ..touch });
    }
    let ends = tool.clip(p.x, p.z, way.x, way.z)?;
    let at = |s: f64| if s == 1.0 { *q } else { p + way * s };
    let climb = |s: f64| {
        let at = at(s);
        let jet = tool.along(at.x, at.z, way.x, way.z);
        (at.y + jet.value, way.y + jet.slope, jet.bend)
    };
    let touch = |s: f64, height: f64| {
        let kind = if s == 0.0 || s == 1.0 { ContactKind::Vertex } else { ContactKind::Edge };
        Touch { height, at: at(s), kind, side: None }
    };
    // The tool bends everywhere at least so much, so that from a slope less than the square root of
    // `level` nothing is left to gain. What the local bend promises is no bound: past a corner arc
    // lies a flat or a flank with a slope that is small but does not end.
    let [bend_x, bend_z] = tool.least_bend();
    let level = 2.0 * LEAST_GAIN * (bend_x * way.x * way.x + bend_z * way.z * way.z);
    let [mut low, mut high] = ends;
    let mut end_seen = [false; 2];
    let mut s = f64::midpoint(low, high);
    let mut height = f64::NEG_INFINITY;
    for _ in 0..MOST_STEPS {
        let (value, slope, bend) = climb(s);
        height = value;
        // A tangent of a concave function bounds all of it.
        let rise = (slope * (high - s)).max(slope * (low - s));
        if value + rise + ROUNDING < least {
            return None;
        }
        if slope * slope < level || rise < LEAST_RISE || high <= low {
            break;
        }
        let uphill = usize::from(0.0 < slope);
        if uphill == 1 {
            low = s;
        } else {
            high = s;
        }
        let mut next = s - slope / bend;
        if !(low < next && next < high) {
            let bracket = [low, high][uphill];
            if bracket == ends[uphill] && !end_seen[uphill] {
                end_seen[uphill] = true;
                let (value, slope, _) = climb(bracket);
                if (uphill == 1 && 0.0 <= slope) || (uphill == 0 && slope <= 0.0) {
                    return Some(touch(bracket, value));
                }
            }
            next = f64::midpoint(low, high);
            if next == low || next == high {
                break;
            }
        }
        s = next;
    }
    Some(touch(s, height))
}
