//! Tools by their textbook, written apart from the code under test, and the highest of many samples
//! of a triangle under them.

use horma::geom::{Point3, Pose, Vector3};
use horma::tool::Profile;

/// A tool and the stock it leaves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tool {
    pub(crate) profile: Profile,
    pub(crate) allowance: f64,
}

/// How high a sample holds the tool: whether it lies in the shadow, then the height, or else how
/// far it lies outside, below zero. Over a triangle both are concave, so that this has one peak.
pub(crate) type Level = (bool, f64);

/// What a height may be off by for rounding alone, over parts of up to some metres [mm].
pub(crate) const ROUNDING: f64 = 1e-9;
/// Roundings of a coordinate on its way from the part to the tool.
const N_ROUNDINGS: f64 = 32.0;
/// Each step of a search leaves this share of the interval.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// After so many steps 2e-17 of the interval is left.
const N_STEPS: usize = 80;
/// Samples along a side of a triangle that a search could not lead astray.
const N_GRID: usize = 16;

impl Tool {
    /// The height of the programmed point over a part point that lies at `(x, z)` from it and that
    /// the tool touches; the point is first moved `outwards` from the tool's axes.
    pub(crate) fn height(&self, x: f64, z: f64, outwards: f64) -> Option<f64> {
        let (inside, height) = self.level(x, z, outwards);
        inside.then_some(height)
    }

    /// The wheel is Morell (2014), eq. 4.7: at distance 0 from the torus
    /// `Ty - y = sqrt((R + sqrt(r^2 - (x - Tx)^2))^2 - z^2)`, within the capsule of its shadow.
    pub(crate) fn level(&self, x: f64, z: f64, outwards: f64) -> Level {
        let away = |coordinate: f64| (coordinate.abs() + outwards).max(0.0);
        if let Profile::Wheel { major_radius, minor_radius } = self.profile {
            let (x, z) = (away(x), away(z));
            let tube = minor_radius + self.allowance;
            let gap = x.hypot((z - major_radius).max(0.0)) - tube;
            let radius = major_radius + (tube * tube - x * x).max(0.0).sqrt();
            let height = (radius * radius - z * z).max(0.0).sqrt();
            return if gap <= 0.0 { (true, height) } else { (false, -gap) };
        }
        let rho = away(x.hypot(z));
        let gap = rho - (self.profile.reach() + self.allowance);
        if gap <= 0.0 { (true, self.outline(rho)) } else { (false, -gap) }
    }

    /// How far the outline of an end mill lies below its programmed tip, negative above: the lowest
    /// of the balls and straight lines that a ball of the allowance sweeps along the bare tool.
    fn outline(&self, rho: f64) -> f64 {
        let a = self.allowance;
        let within = |to: f64, height: f64| if rho <= to { height } else { f64::NEG_INFINITY };
        let ball = |ball: &Ball| {
            let out = (rho - ball.center).abs();
            (ball.radius * ball.radius - out * out).max(0.0).sqrt() - ball.above
        };
        let [tip, rim] = &self.balls();
        match self.profile {
            Profile::Flat { .. } | Profile::Bull { .. } => within(tip.center, a).max(ball(tip)),
            Profile::Cone { half_angle, .. } | Profile::BallCone { half_angle, .. } => {
                let from = tip.radius * half_angle.cos();
                let to = rim.center + rim.radius * half_angle.cos();
                let flank = tip.radius / half_angle.sin() - tip.above - rho / half_angle.tan();
                let flank = if from <= rho { within(to, flank) } else { f64::NEG_INFINITY };
                within(tip.radius, ball(tip)).max(flank).max(ball(rim))
            }
            _ => ball(tip),
        }
    }

    /// The balls whose hull, turned about the axis, is the underside of an end mill: at the tip
    /// and, on cones, where the flank ends.
    fn balls(&self) -> [Ball; 2] {
        let a = self.allowance;
        let one = |center, above| {
            let ball = Ball { center, above, radius: above + a };
            [ball, ball]
        };
        match self.profile {
            Profile::Wheel { .. } => unreachable!("a wheel is no end mill"),
            Profile::Ball { radius } => one(0.0, radius),
            Profile::Flat { radius } => one(radius, 0.0),
            Profile::Bull { radius, corner_radius } => one(radius - corner_radius, corner_radius),
            Profile::Cone { radius, half_angle } => {
                let above = radius / half_angle.tan();
                [
                    Ball { center: 0.0, above: 0.0, radius: a },
                    Ball { center: radius, above, radius: a },
                ]
            }
            Profile::BallCone { radius, tip_radius, half_angle } => {
                let above = radius / half_angle.tan() - tip_radius / half_angle.sin() + tip_radius;
                let tip = Ball { center: 0.0, above: tip_radius, radius: tip_radius + a };
                [tip, Ball { center: radius, above, radius: a }]
            }
        }
    }

    /// Points of its underside, from the programmed point.
    pub(crate) fn underside(&self) -> impl Iterator<Item = Vector3> {
        let size = self.profile.reach() + self.allowance;
        let grid = (-12..=12).flat_map(|i| (-12..=12).map(move |j| [i, j]));
        grid.filter_map(move |[i, j]| {
            let [x, z] = [i, j].map(|k| f64::from(k) / 12.0 * size);
            self.height(x, z, 0.0).map(|height| Vector3::new(x, -height, z))
        })
    }

    /// How far rounding may move points on the way from the part to the tool: near the rim of its
    /// shadow, where a height falls off without bound, nothing can be told more exactly than this.
    pub(crate) fn slack(&self, points: &[Point3], attack_from_part: &Pose) -> f64 {
        let seen = points.iter().map(|point| attack_from_part * point);
        let all = seen.chain(points.iter().copied()).map(|point| point.coords.amax());
        let shift = attack_from_part.translation.vector.amax();
        let size = self.profile.reach() + self.allowance;
        N_ROUNDINGS * f64::EPSILON * all.fold(shift.max(size), f64::max)
    }

    /// Where the tool touches a plane of unit normal `normal` it comes down on, from the programmed
    /// point.
    pub(crate) fn support(&self, normal: &Vector3) -> Vector3 {
        if let Profile::Wheel { major_radius, minor_radius } = self.profile {
            let across = Vector3::new(0.0, normal.y, normal.z).normalize();
            return -across * major_radius - normal * (minor_radius + self.allowance);
        }
        let level = Vector3::new(normal.x, 0.0, normal.z);
        let outwards = level.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let [tip, rim] = self
            .balls()
            .map(|ball| -outwards * ball.center + Vector3::y() * ball.above - normal * ball.radius);
        if rim.dot(normal) < tip.dot(normal) { rim } else { tip }
    }

    /// The highest of 13,000 samples of a triangle given from the programmed point's foot, gathered
    /// about their peak: by golden section along fans from a corner, and along the best of those.
    /// `None` if all lie outside the shadow.
    pub(crate) fn highest(&self, triangle: &[Vector3; 3], outwards: f64) -> Option<f64> {
        let [a, b, c] = triangle;
        let level = |s: f64, t: f64| {
            let p = a + ((b - a) * (1.0 - t) + (c - a) * t) * s;
            let (inside, height) = self.level(p.x, p.z, outwards);
            (inside, if inside { p.y + height } else { height })
        };
        let mut best = peak(|s| peak(|t| level(s, t)));
        for i in 0..=N_GRID {
            for j in 0..=N_GRID {
                let share = |k: usize| k as f64 / N_GRID as f64;
                best = higher(best, level(share(i), share(j)));
            }
        }
        best.0.then_some(best.1)
    }
}

/// A ball of an end mill: its centre's distance from the axis and height above the tip.
#[derive(Debug, Clone, Copy)]
struct Ball {
    center: f64,
    above: f64,
    radius: f64,
}

/// What a tool's size is.
pub(crate) trait Reach {
    /// From the axis to the rim [mm].
    fn reach(&self) -> f64;

    /// Half the width of the shadow along x [mm].
    fn half_width(&self) -> f64;
}

impl Reach for Profile {
    fn reach(&self) -> f64 {
        match *self {
            Self::Wheel { major_radius, minor_radius } => major_radius + minor_radius,
            Self::Ball { radius }
            | Self::Flat { radius }
            | Self::Bull { radius, .. }
            | Self::Cone { radius, .. }
            | Self::BallCone { radius, .. } => radius,
        }
    }

    fn half_width(&self) -> f64 {
        match *self {
            Self::Wheel { minor_radius, .. } => minor_radius,
            _ => self.reach(),
        }
    }
}

fn higher(a: Level, b: Level) -> Level {
    if a < b { b } else { a }
}

/// The peak of a function of one peak on `[0, 1]`, by golden section.
pub(crate) fn peak(f: impl Fn(f64) -> Level) -> Level {
    let [mut low, mut high] = [0.0, 1.0];
    let [mut left, mut right] = [1.0 - GOLDEN, GOLDEN];
    let [mut at_left, mut at_right] = [f(left), f(right)];
    let mut best = higher(higher(f(low), f(high)), higher(at_left, at_right));
    for _ in 0..N_STEPS {
        if at_left < at_right {
            low = left;
            (left, at_left) = (right, at_right);
            right = low + GOLDEN * (high - low);
            at_right = f(right);
            best = higher(best, at_right);
        } else {
            high = right;
            (right, at_right) = (left, at_left);
            left = high - GOLDEN * (high - low);
            at_left = f(left);
            best = higher(best, at_left);
        }
    }
    best
}

/// One tool of every kind.
pub(crate) fn tools() -> [Profile; 6] {
    [
        Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 },
        Profile::Ball { radius: 6.0 },
        Profile::Flat { radius: 5.0 },
        Profile::Bull { radius: 8.0, corner_radius: 2.5 },
        Profile::Cone { radius: 7.0, half_angle: 0.5 },
        Profile::BallCone { radius: 9.0, tip_radius: 2.0, half_angle: 0.35 },
    ]
}
