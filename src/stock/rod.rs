//! A cylinder among the rays: a part of a tool's body, whichever way it lies.
//!
//! A ray runs through it on one stretch: the roots of a quadratic, between its two ends. In the plane
//! of a row it lies within a rectangle, along the attack direction and across it, which says what
//! rays are worth a look.

use super::layout::{Kind, Layout};
use super::{Stance, StockError};
use crate::tool::{Axle, Cylinder, disc_chord};

/// A cylinder as a row sees it: X, the attack direction, and across both. Its axis lies square to the
/// last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rod {
    /// Where the axis' stretch is counted from.
    foot: [f64; 3],
    /// The way the axis runs, along X and along the attack direction: a unit vector.
    way: [f64; 2],
    radius: f64,
    stretch: [f64; 2],
    pub(super) attack: [f64; 2],
}

/// Where a body may be in the plane of a row: along the attack direction, and across it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    along: [f64; 2],
    across: [f64; 2],
}

/// A ray in the plane of its row.
pub(super) struct Ray {
    from: [f64; 2],
    /// Unit vector.
    along: [f64; 2],
}

impl Rod {
    pub(super) fn of(
        layout: &Layout,
        stance: &Stance,
        cylinder: &Cylinder,
    ) -> Result<Self, StockError> {
        let at = layout.locate(stance)?;
        let [along, across] = at.along_and_across();
        let way = match cylinder.axle {
            Axle::X => [1.0, 0.0],
            Axle::Attack => [at.lean.sin(), at.lean.cos()],
        };
        let Cylinder { radius, stretch, .. } = *cylinder;
        Ok(Self { foot: [at.point.x, along, across], way, radius, stretch, attack: at.attack })
    }

    /// Where it may be in any row.
    pub(super) fn whole(&self) -> Frame {
        let [along_x, outwards] = self.way;
        // A rod along X may have no end; it is no farther out there.
        let begins = if outwards > 0.0 { self.stretch[0] * outwards } else { 0.0 };
        let lowest = self.foot[1] + begins - self.radius * along_x.abs();
        Frame { along: [lowest, f64::INFINITY], across: self.across() }
    }

    /// The stretch of X on which it lies nearer than `crest`.
    pub(super) fn reach(&self, crest: f64) -> [f64; 2] {
        let [along_x, outwards] = self.way;
        let [from, mut to] = self.stretch;
        if outwards > 0.0 {
            to = to.min((crest - self.foot[1] + self.radius * along_x.abs()) / outwards).max(from);
        }
        let [a, b] = [from * along_x, to * along_x];
        let beside = self.radius * outwards;
        [self.foot[0] + a.min(b) - beside, self.foot[0] + a.max(b) + beside]
    }

    /// Where it may be in the row at `x`; `None` where it is not.
    pub(super) fn frame(&self, x: f64) -> Option<Frame> {
        let [along_x, outwards] = self.way;
        let beside = x - self.foot[0];
        let by_ends = within(self.stretch, beside * along_x, outwards);
        let by_side = within([-self.radius, self.radius], beside * outwards, -along_x);
        let [low, high] = [by_ends[0].max(by_side[0]), by_ends[1].min(by_side[1])];
        let along = [self.foot[1] + low, self.foot[1] + high];
        (low <= high).then(|| Frame { along, across: self.across() })
    }

    fn across(&self) -> [f64; 2] {
        [self.foot[2] - self.radius, self.foot[2] + self.radius]
    }

    /// Where a ray in the row at `x` enters it, and where it leaves it.
    pub(super) fn stretch(&self, x: f64, ray: &Ray) -> Option<[f64; 2]> {
        let ([cos, sin], [along_x, outwards]) = (self.attack, self.way);
        let turned = |v: [f64; 2]| [v[0] * cos + v[1] * sin, v[1] * cos - v[0] * sin];
        let (from, way) = (turned(ray.from), turned(ray.along));
        let beside = [x, from[0], from[1]];
        let [x, along, across] = [0, 1, 2].map(|k| beside[k] - self.foot[k]);
        let by_ends = within(self.stretch, x * along_x + along * outwards, way[0] * outwards);
        let off_axis = x * outwards - along * along_x;
        let by_side = disc_chord(off_axis, across, -way[0] * along_x, way[1], self.radius)?;
        let [enters, leaves] = [by_ends[0].max(by_side[0]), by_ends[1].min(by_side[1])];
        (enters <= leaves).then_some([enters, leaves])
    }
}

impl Frame {
    /// Nothing of it is nearer to where the rays begin than this.
    pub(super) fn nearest(&self, layout: &Layout) -> f64 {
        match layout.kind {
            Kind::Turned => away(self.along).hypot(away(self.across)),
            Kind::Table => self.along[0],
        }
    }

    /// The columns that may meet it before `crest`; beyond both ends of a turn they count on.
    pub(super) fn columns(
        &self,
        layout: &Layout,
        attack: [f64; 2],
        crest: f64,
    ) -> std::ops::RangeInclusive<i64> {
        let n = layout.n_columns_signed();
        let [first, step] = layout.across;
        let Self { along: [from, _], across: [low, high] } = *self;
        let place = |across: f64| (across - first) / step;
        if layout.kind == Kind::Table {
            let (low, high) = (place(low).floor().max(0.0), place(high).ceil());
            return (low as i64)..=(high.min((n - 1) as f64) as i64);
        }
        if from <= 0.0 {
            return 0..=n - 1;
        }
        // A place beside the attack line is seen under the widest angle where it is nearest, and
        // under the narrowest where it is as far out as the crest.
        let widest = |across: f64, outwards: f64| {
            let along = if across * outwards > 0.0 { from } else { from.max(crest) };
            attack[1].atan2(attack[0]) + across.atan2(along)
        };
        let low = place(widest(low, -1.0)).floor();
        let high = place(widest(high, 1.0)).ceil();
        if high - low >= n as f64 { 0..=n - 1 } else { low as i64..=high as i64 }
    }
}

impl Ray {
    pub(super) fn of(layout: &Layout, column: usize) -> Self {
        match layout.kind {
            Kind::Turned => {
                Self { from: [0.0; 2], along: [layout.turns[0][column], layout.turns[1][column]] }
            }
            Kind::Table => {
                let z = layout.across[0] + layout.across[1] * column as f64;
                Self { from: [0.0, z], along: [1.0, 0.0] }
            }
        }
    }
}

/// How far a stretch of numbers is from 0.
fn away([from, to]: [f64; 2]) -> f64 {
    from.max(-to).max(0.0)
}

/// On what stretch of `from + s way` a number lies within a slab; an empty one if never.
fn within(slab: [f64; 2], from: f64, way: f64) -> [f64; 2] {
    if way == 0.0 {
        let is_inside = (slab[0]..=slab[1]).contains(&from);
        return if is_inside { [f64::NEG_INFINITY, f64::INFINITY] } else { [1.0, 0.0] };
    }
    let [a, b] = slab.map(|border| (border - from) / way);
    [a.min(b), a.max(b)]
}
