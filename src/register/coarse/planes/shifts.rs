//! Shifts that lay planes on planes, once these are parallel.

use super::consensus::{Meeting, Meetings};
use super::{INDEPENDENT, PARALLEL};
use crate::geom::{Matrix3, Vector3};

/// Wishes kept, the weightiest first.
const MOST_WISHES: usize = 12;
/// Two wishes that leave a direction open are looked into for so many of them,
const MOST_OPEN: usize = 3;
/// and as many pairs of patches say how far to go along it.
const MOST_ENDS: usize = 4;

/// What planes want the shift to be along their normal.
#[derive(Debug, Clone, Copy)]
struct Wish {
    along: Vector3,
    by: f64,
    weight: f64,
}

/// Shifts that planes agree on, three directions at a time; and two at a time, with patches' middles
/// and ends laid on each other along the third, for where no planes fix that.
pub(super) fn shifts(meetings: &Meetings, tolerance: f64) -> Vec<Vector3> {
    let wishes = wishes(meetings, tolerance);
    let n = wishes.len();
    let mut shifts = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                shifts.extend(met([&wishes[a], &wishes[b], &wishes[c]]));
            }
        }
    }
    let two = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b)));
    let is_open =
        |(a, b): &(usize, usize)| wishes[*a].along.cross(&wishes[*b].along).norm() > INDEPENDENT;
    for (a, b) in two.filter(is_open).take(MOST_OPEN) {
        let along = wishes[a].along.cross(&wishes[b].along).normalize();
        let both = [&wishes[a], &wishes[b]];
        let agreeing = meetings
            .all
            .iter()
            .filter(|meeting| both.iter().any(|wish| wish.has(meeting, tolerance)));
        let mut agreeing: Vec<&Meeting> = agreeing.collect();
        agreeing.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        for meeting in agreeing.into_iter().take(MOST_ENDS) {
            let middle = along.dot(&meeting.gap);
            let ends = meeting.half_length(&along);
            for by in [middle, middle + ends, middle - ends] {
                shifts.extend(met([both[0], both[1], &Wish { along, by, weight: 0.0 }]));
            }
        }
    }
    shifts
}

/// What all that meet want, equal wishes as one, the weightiest first.
fn wishes(meetings: &Meetings, tolerance: f64) -> Vec<Wish> {
    let mut order: Vec<&Meeting> = meetings.all.iter().collect();
    order.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let mut wishes: Vec<Wish> = Vec::new();
    for meeting in order {
        let (along, weight) = (meeting.normal, meeting.weight);
        if let Some(wish) = wishes.iter_mut().find(|wish| wish.has(meeting, tolerance)) {
            let by = along.dot(&meeting.gap) * along.dot(&wish.along).signum();
            wish.by = (wish.by * wish.weight + by * weight) / (wish.weight + weight);
            wish.weight += weight;
        } else {
            wishes.push(Wish { along, by: along.dot(&meeting.gap), weight });
        }
    }
    wishes.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    wishes.truncate(MOST_WISHES);
    wishes
}

impl Wish {
    /// True if two planes that meet want the same.
    fn has(&self, meeting: &Meeting, tolerance: f64) -> bool {
        let cosine = self.along.dot(&meeting.normal);
        let by = meeting.normal.dot(&meeting.gap) * cosine.signum();
        cosine.abs() > 1.0 - PARALLEL * PARALLEL / 2.0 && (by - self.by).abs() < tolerance
    }
}

/// The shift that grants three wishes; `None` if they are not independent.
fn met(wishes: [&Wish; 3]) -> Option<Vector3> {
    let rows = Matrix3::from_rows(&wishes.map(|wish| wish.along.transpose()));
    if rows.determinant().abs() < INDEPENDENT {
        return None;
    }
    rows.try_inverse().map(|inverse| inverse * Vector3::from(wishes.map(|wish| wish.by)))
}
