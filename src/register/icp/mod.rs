//! Fine registration: iterated closest points, from a start that is roughly right.
//!
//! Both clouds are thinned by voxels and put about their centroids ([`View`]). Then, with fewer points
//! and longer pairs at first: *sample* the source, *pair* it with the target, *reject* and *weigh*
//! pairs, make their cost small by a damped Gauss-Newton step, until steps are small. The stages and
//! their names are those of Rusinkiewicz and Levoy (2001); what is made small is a [`Metric`].
//!
//! At the end the pose is judged: what the pairs do not hold, how much of the clouds lies on each
//! other and how well. A [`Verdict`] that is not ok comes with its [`Reason`]s.
//!
//! Besl and McKay (1992); Segal et al. (2009); Park et al. (2017); Morell (2014), section 2.3.1.

mod cost;
mod error;
mod freedom;
mod held;
mod joint;
mod judge;
mod options;
mod pair;
mod projective;
mod reject;
mod sample;
mod settled;
mod step;
mod verdict;
mod view;
mod weigh;

pub(super) use cost::Normal;
pub use error::{IcpError, Role};
pub(super) use freedom::free_motions;
pub use freedom::{FreeMotion, MotionKind};
pub(super) use joint::{Beside, Evidence};
pub use judge::Alignment;
pub use options::{Directions, IcpOptions, Kernel, Metric, Pairing, Sampling, Weighting};
pub use settled::Settled;
pub use verdict::{Reason, Verdict};
pub use view::{View, ViewOptions};

use crate::geom::{PointCloud, Pose, Vector3};
use crate::progress::Progress;
use crate::rgbd::Camera;
use cost::{Cost, Motion};
use joint::Objective;
use judge::Course;
use pair::{Pair, Pairs};
use reject::reject;
use step::step;
pub(super) use step::{solve, taken};
use weigh::{colour_scale, robust, typical, weigh};

/// Fewer pairs fix no pose.
const LEAST_PAIRS: usize = 12;
/// The last level but one need not be finer than this share of a voxel.
const COARSE_EPS: f64 = 0.1;
/// Steps without a shorter one among them, after which those below [`RATTLE`] are rattling.
const RATTLES: u32 = 6;
/// Rattling stays within this share of a voxel.
const RATTLE: f64 = 0.03;

/// Lays `source` over `target`, beginning at `target_from_source`.
pub fn align(
    source: &PointCloud,
    target: &PointCloud,
    target_from_source: &Pose,
    options: &IcpOptions,
    progress: &dyn Progress,
) -> Result<Alignment, IcpError> {
    options.check()?;
    let settled = Settled::new(source, target, options)?;
    let [source, target] = views([source, target], &settled, options, progress)?;
    align_views([&source, &target], target_from_source, &settled, options, progress)
}

/// Source and target made ready for what was settled.
pub(super) fn views(
    [source, target]: [&PointCloud; 2],
    settled: &Settled,
    options: &IcpOptions,
    progress: &dyn Progress,
) -> Result<[View; 2], IcpError> {
    options.check()?;
    let of = |cloud, role| view(cloud, role, (settled, options), None, progress);
    let (source, target) = rayon::join(|| of(source, Role::Source), || of(target, Role::Target));
    Ok([source?, target?])
}

/// A cloud made ready for what was settled; `camera` is the one that saw it, from the origin.
pub(super) fn view(
    cloud: &PointCloud,
    role: Role,
    (settled, options): (&Settled, &IcpOptions),
    camera: Option<Camera>,
    progress: &dyn Progress,
) -> Result<View, IcpError> {
    let options = ViewOptions {
        voxel: settled.voxel,
        neighbours: options.neighbours,
        with_colours: settled.metric == Metric::Coloured,
        with_borders: options.reject_borders,
        camera,
    };
    View::new(cloud, role, options, progress)
}

/// Lays the first of two views over the second, beginning at `target_from_source`.
///
/// The views must have what `settled` and the options ask for: voxels, colours, borders.
pub fn align_views(
    views: [&View; 2],
    target_from_source: &Pose,
    settled: &Settled,
    options: &IcpOptions,
    progress: &dyn Progress,
) -> Result<Alignment, IcpError> {
    align_views_beside(views, target_from_source, (settled, options), None, progress)
}

/// The same, with what else is known of the pose.
pub(super) fn align_views_beside(
    views: [&View; 2],
    target_from_source: &Pose,
    (settled, options): (&Settled, &IcpOptions),
    beside: Option<&Beside>,
    progress: &dyn Progress,
) -> Result<Alignment, IcpError> {
    options.check()?;
    if !target_from_source.to_homogeneous().iter().all(|x| x.is_finite()) {
        return Err(IcpError::Start);
    }
    if options.pairing == Pairing::Projective {
        for (view, role) in views.iter().zip([Role::Source, Role::Target]) {
            let is_asked = role == Role::Target || options.directions == Directions::Both;
            if is_asked && view.camera.is_none() {
                return Err(IcpError::NoCamera { role });
            }
        }
    }
    let start = about_centers(target_from_source, views);
    let course = iterate(views, &start, (settled, options), beside, progress)?;
    let mut alignment = judge::judge(views, &start, &course, settled);
    alignment.target_from_source = from_centers(&course.pose, views);
    Ok(alignment)
}

/// How well the first of two views lies over the second where it is.
pub(super) fn judged(views: [&View; 2], target_from_source: &Pose, settled: &Settled) -> Alignment {
    let pose = about_centers(target_from_source, views);
    let mut alignment = judge::judge(views, &pose, &Course::at(pose), settled);
    alignment.target_from_source = *target_from_source;
    alignment
}

/// From the start to where steps become small, or to where there is nothing left to go by.
fn iterate(
    views: [&View; 2],
    start: &Pose,
    (settled, options): (&Settled, &IcpOptions),
    beside: Option<&Beside>,
    progress: &dyn Progress,
) -> Result<Course, IcpError> {
    let [source, target] = views;
    let samples = sample::sample(source, options);
    let is_both = options.directions == Directions::Both;
    let back_samples = if is_both { sample::sample(target, options) } else { Vec::new() };
    let mut from_source = Pairs::new(source, target, options.pairing);
    let mut from_target = Pairs::new(target, source, options.pairing);
    let mut course = Course::at(*start);
    progress.start("align", u64::from(options.levels));
    for level in 0..options.levels {
        let is_last = level + 1 == options.levels;
        let within = settled.distance(level, options.levels);
        let eps = settled.eps(options, is_last);
        let n_thinnings = options.levels - 1 - level;
        from_source.ask(sample::thinned(&samples, n_thinnings));
        from_target.ask(sample::thinned(&back_samples, n_thinnings));
        course.converged = false;
        let (mut shortest, mut restless, mut noise) = (f64::INFINITY, 0, 0.0);
        for i_iteration in 0..options.iterations {
            progress.advance(0)?;
            let motion = Motion::from(&course.pose);
            let mut pairs = from_source.find(&motion, within);
            course.first_pairs.get_or_insert(pairs.len());
            reject(&mut pairs, views, &motion, options);
            if is_both {
                let back = Motion::from(&course.pose.inverse());
                let mut others = from_target.find(&back, within);
                reject(&mut others, [target, source], &back, options);
                pairs.extend(others.iter().map(Pair::turned));
            }
            if pairs.len() < LEAST_PAIRS {
                course.starved = true;
                return Ok(course);
            }
            let mut cost = Cost { source, target, metric: settled.metric, colour_scale: 0.0 };
            // Set when a level has taken its first step: a balance that never rests never converges.
            if i_iteration < 2 {
                course.colour_scale = colour_scale(&pairs, &cost, &motion);
            }
            cost.colour_scale = course.colour_scale;
            if i_iteration < 2 && beside.is_some() {
                noise = typical(&pairs, &cost, &motion);
            }
            weigh(&mut pairs, &cost, &motion, (options.weighting, within));
            robust(&mut pairs, &cost, &motion, options.kernel);
            let objective = Objective::new(cost, &pairs, beside, noise);
            let Some(small) = step(&objective, &course.pose, target.radius) else {
                // No step makes the cost smaller: this is the bottom.
                course.converged = true;
                break;
            };
            course.pose = taken(&course.pose, &small);
            course.n_iterations += 1;
            course.last_step = [small.fixed_rows::<3>(0).norm(), small.fixed_rows::<3>(3).norm()];
            let way = course.last_step[0] * source.radius + course.last_step[1];
            restless = if way < shortest { 0 } else { restless + 1 };
            shortest = shortest.min(way);
            // A few pairs change partners to and fro: that moves the pose, but nowhere.
            let rattles = restless >= RATTLES && way < RATTLE * settled.voxel;
            let is_small = course.last_step[0] < eps[0] && course.last_step[1] < eps[1];
            if is_small || rattles {
                course.converged = true;
                break;
            }
        }
        progress.advance(1)?;
    }
    Ok(course)
}

/// A pose between the clouds' own coordinates as one between those about their centroids.
pub(super) fn about_centers(target_from_source: &Pose, [source, target]: [&View; 2]) -> Pose {
    let shift = target_from_source * source.center - target.center;
    Pose::from_parts(shift.into(), target_from_source.rotation)
}

/// The inverse of [`about_centers`].
pub(super) fn from_centers(pose: &Pose, [source, target]: [&View; 2]) -> Pose {
    let shift: Vector3 =
        target.center.coords + pose.translation.vector - pose.rotation * source.center.coords;
    Pose::from_parts(shift.into(), pose.rotation)
}

#[cfg(test)]
mod tests;
