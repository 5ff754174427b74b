//! Where a tool coming down touches one primitive: a concave maximum over a triangle or a point.
//!
//! Over a triangle `y + u(x, z)` is concave. Its maximum lies inside the facet, else on an edge,
//! else at a vertex (DESIGN section 3). All coordinates are in the attack frame.

use super::view::View;
use crate::geom::{Point3, Vector3};
use crate::tool::HeightFunction;

/// A height below another by less than this may still be rounding [mm].
const ROUNDING: f64 = 1e-9;
/// An edge search ends when the next Newton step would gain less than this [mm].
const LEAST_GAIN: f64 = 1e-13;
/// Newton steps, mixed with halvings, before an edge search is cut short; six are usual.
const MOST_STEPS: usize = 128;
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
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        corners.sort_by(|a, b| {
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
        });
        Self { corners, normal }
    }
}

/// Where the tool touches a single point, if it does not pass it by. Morell (2014), eq. 4.7,
/// solved for the centre.
#[inline(always)]
pub(super) fn on_point(tool: &impl HeightFunction, at: Vector3) -> Option<Touch> {
    let height = at.y + tool.height(at.x, at.z)?;
    Some(Touch { height, at, kind: ContactKind::Point })
}

/// Where the tool touches `facet`; `None` if it passes by or if that is surely below `least`.
#[inline(always)]
pub(super) fn on_triangle(
    tool: &impl HeightFunction,
    view: &View,
    facet: &Facet,
    least: f64,
) -> Option<Touch> {
    let corners = facet.corners.map(|corner| view.see(&corner));
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
            return Some(Touch { height, at, kind: ContactKind::Facet });
        }
        if normal.y < STEEP {
            behind = [true; 3];
        }
    }
    // Concave with its peak over the plane at `at`: the greatest value of the triangle lies on a
    // side that parts it from `at`.
    let sides = [[0, 1], [0, 2], [1, 2]];
    let mut best: Option<Touch> = None;
    for ([from, to], _) in sides.into_iter().zip(behind).filter(|(_, behind)| *behind) {
        let least = best.map_or(least, |best| best.height);
        if let Some(touch) = on_edge(tool, &corners[from], &corners[to], least)
            && best.is_none_or(|best| best.is_beaten_by(&touch))
        {
            best = Some(touch);
        }
    }
    best
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
        Touch { height, at: at(s), kind }
    };
    let [mut low, mut high] = ends;
    let mut end_seen = [false; 2];
    let mut s = f64::midpoint(low, high);
    let mut height = f64::NEG_INFINITY;
    for _ in 0..MOST_STEPS {
        let (value, slope, bend) = climb(s);
        height = value;
        // A tangent of a concave function bounds all of it.
        let bound = value + (slope * (high - s)).max(slope * (low - s));
        if bound + ROUNDING < least {
            return None;
        }
        let gain = slope * slope / (-2.0 * bend);
        if gain < LEAST_GAIN || high <= low {
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
