//! Virtual digitizing of 10,000 random triangles by random tools, against dense sampling.

use crate::dropping::{agreed, soup};
use crate::random_cases::Case;
use crate::textbook::ROUNDING;
use horma::cam::{Contact, ContactKind, Part};
use horma::geom::{Point3, Vector3};
use rayon::prelude::*;
use std::fmt::Debug;

const N_CASES: u64 = 10_000;

/// What a case came to.
#[derive(Debug)]
struct Checked {
    kind: Option<ContactKind>,
    /// The range that sampling leaves for the height [mm].
    left: f64,
}

impl Case {
    /// Holds the contact against dense sampling. A search by golden section ends within less than
    /// the slack of the peak, and a tool drawn in by the slack stands over it at least as high
    /// there as the true tool over the peak: this bounds what the sampling missed.
    fn check(&self) -> Result<Checked, String> {
        let part = Part::triangles(&soup(&[self.triangle]));
        let contact = agreed(&part, &self.tool, &[self.attack_from_part])[0];
        let seen = self.triangle.map(|corner| (self.attack_from_part * corner).coords);
        let slack = self.slack();
        let least = self.tool.highest(&seen, slack);
        let most = self.tool.highest(&seen, -slack);
        let Some(contact) = contact else {
            ensure("not missed", least.is_none(), least)?;
            return Ok(Checked { kind: None, left: 0.0 });
        };
        let height = contact.height;
        let above = least.map_or(f64::INFINITY, |least| height - least);
        ensure("not below a sample", -ROUNDING <= above, above)?;
        ensure("touches something", most.is_some(), contact)?;
        let below = most.map_or(f64::INFINITY, |most| most - height);
        ensure("not above all samples", -ROUNDING <= below, (below, contact))?;
        self.check_point(&contact)?;
        self.check_normal(&contact)?;
        Ok(Checked { kind: Some(contact.kind), left: above + below })
    }

    /// The contact point lies on the tool, and on what of the triangle is said to be touched.
    fn check_point(&self, contact: &Contact) -> Result<(), String> {
        let point = contact.point.coords;
        let [a, b, c] = self.triangle.map(|corner| corner.coords);
        let edges = [(a, b), (b, c), (c, a)];
        let least = |distances: [f64; 3]| distances.into_iter().fold(f64::INFINITY, f64::min);
        let to_edge = least(edges.map(|(p, q)| distance_to_segment(&point, &p, &q)));
        let to_corner = least([a, b, c].map(|corner| (corner - point).norm()));
        let across = (b - a).cross(&(c - a));
        let is_inside = edges.iter().all(|(p, q)| 0.0 < (q - p).cross(&(point - p)).dot(&across));
        let is_there = match contact.kind {
            ContactKind::Facet => to_edge <= ROUNDING || is_inside,
            ContactKind::Edge => to_edge <= ROUNDING,
            ContactKind::Vertex => to_corner <= ROUNDING,
            ContactKind::Point => false,
        };
        ensure("on what is touched", is_there, (to_edge, to_corner, contact))?;
        let at = self.attack_from_part * contact.point;
        let reach = contact.height - at.y;
        let least = self.tool.height(at.x, at.z, self.slack());
        let most = self.tool.height(at.x, at.z, -self.slack());
        let is_on_tool = least.is_none_or(|least| least - ROUNDING <= reach)
            && most.is_some_and(|most| reach <= most + ROUNDING);
        ensure("on the tool", is_on_tool, (least, reach, most, contact))
    }

    /// The plane across the normal holds the facet, if that is touched, and has all of the tool on
    /// one side.
    fn check_normal(&self, contact: &Contact) -> Result<(), String> {
        let off_unit = contact.normal.norm() - 1.0;
        ensure("of unit length", off_unit.abs() < 1e-12, (off_unit, contact))?;
        if contact.kind == ContactKind::Facet {
            let off = self.triangle.map(|corner| (corner - contact.point).dot(&contact.normal));
            ensure(
                "across the facet",
                off.iter().all(|off| off.abs() <= ROUNDING),
                (off, contact),
            )?;
        }
        let normal = self.attack_from_part.rotation * contact.normal;
        ensure("towards the tool", -1e-15 <= normal.y, (normal, contact))?;
        let at = self.attack_from_part * contact.point;
        let tool_at = |out: Vector3| Point3::new(out.x, contact.height + out.y, out.z);
        let nearest = self.tool.underside().map(|out| (tool_at(out) - at).dot(&normal));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        ensure("the tool's normal", -ROUNDING <= nearest, (nearest, normal, contact))
    }
}

/// What must hold, what was seen if it does not.
fn ensure(what: &str, holds: bool, seen: impl Debug) -> Result<(), String> {
    if holds { Ok(()) } else { Err(format!("{what}: {seen:?}")) }
}

fn distance_to_segment(point: &Vector3, a: &Vector3, b: &Vector3) -> f64 {
    let way = b - a;
    let length = way.norm_squared();
    let share = if length > 0.0 { (point - a).dot(&way) / length } else { 0.0 };
    (a + way * share.clamp(0.0, 1.0) - point).norm()
}

#[test]
fn ten_thousand_random_cases_agree_with_dense_sampling() {
    let check = |i| {
        let case = Case::draw(i);
        case.check().map_err(|fault| format!("{fault} in case {i}, {case:?}"))
    };
    let checked: Vec<_> = (0..N_CASES).into_par_iter().map(check).collect();
    let faults: Vec<_> = checked.iter().filter_map(|checked| checked.as_ref().err()).collect();
    assert!(faults.is_empty(), "{} faults, the first {:#?}", faults.len(), &faults[..1]);
    // Most cases must be decided sharply, and every outcome must be common.
    for kind in [None, Some(ContactKind::Facet), Some(ContactKind::Edge), Some(ContactKind::Vertex)]
    {
        let left = checked.iter().flatten().filter(|of| of.kind == kind).map(|of| of.left);
        let n = left.clone().count();
        let n_sharp = left.filter(|left| *left < 1e-8).count();
        assert!(1000 < n && 3 * n < 4 * n_sharp, "{kind:?}: {n_sharp} of {n} are sharp");
    }
}
