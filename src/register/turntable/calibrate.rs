//! A turntable found from what a camera saw of a part on it.

use super::fit::{fit, median, off};
use super::judge::Evidence;
use super::pairs::view_pairs;
use super::refine::Refinement;
use super::{Turntable, TurntableDoubt, TurntableError, TurntableOptions};
use crate::geom::{Point3, PointCloud, Pose};
use crate::progress::{Progress, Silent};
use crate::register::icp::{
    IcpError, IcpOptions, Kernel, Metric, Role, Settled, Verdict, View, ViewOptions, align_views,
};
use rayon::prelude::*;

/// Fewer pairs of neighbours fix no axis to be believed.
const LEAST: usize = 3;
/// A part that turns by less is said to stand still: 0.1 degrees.
const STILL: f64 = 0.00175;
/// Voxels along the diagonal of the first view.
const FINENESS: f64 = 150.0;
/// Neighbours' points farther apart than this are no pair at the start [voxels].
const FAR: f64 = 20.0;
/// Motions of neighbours that differ by more voxels from the turn they have in common are looked for
/// again from there.
const AGAIN: f64 = 1.0;
/// Pairs of the joint refinement, from round to round [voxels]. Ends of a turn join from the second on.
const WITHIN: [f64; 3] = [4.0, 4.0, 2.0];

/// A turntable found, and what is to be known about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The turntable.
    pub turntable: Turntable,
    /// Whether it may be believed.
    pub verdict: Verdict,
    /// Why it may not, or not quite.
    pub doubts: Vec<TurntableDoubt>,
    /// Views that show enough to be laid over others.
    pub n_views: usize,
    /// Pairs of views laid over each other.
    pub n_pairs: usize,
    /// Median distance of their surfaces [mm].
    pub apart: f64,
    /// The same between views a whole turn apart [mm].
    pub apart_after_a_turn: Option<f64>,
}

impl Calibration {
    /// A turntable that was given, and is believed.
    pub fn given(turntable: Turntable) -> Self {
        Self {
            turntable,
            verdict: Verdict::Ok,
            doubts: Vec::new(),
            n_views: 0,
            n_pairs: 0,
            apart: 0.0,
            apart_after_a_turn: None,
        }
    }
}

/// Finds the turntable on which a part turned while `clouds` were seen, one step after the other, each
/// in the frame of the camera and with normals.
pub fn calibrate(
    clouds: &[PointCloud],
    options: &TurntableOptions,
    progress: &dyn Progress,
) -> Result<Calibration, TurntableError> {
    options.check()?;
    let neighbours = Neighbours::new(clouds, options, progress)?;
    let views = &neighbours.views;
    let mut motions = neighbours.motions(None, &[], progress)?;
    let n_pairs = motions.len();
    if n_pairs < LEAST {
        return Err(TurntableError::TooFewViews { n_pairs, least: LEAST });
    }
    let (middle, lever) = neighbours.middle();
    let fitted = |motions: &[(usize, Pose)]| -> Result<Turntable, TurntableError> {
        let motions: Vec<Pose> = motions.iter().map(|(_, motion)| *motion).collect();
        let found = fit(&motions, &middle, lever);
        let step = found.map_or(0.0, |turntable| turntable.step);
        found.filter(|_| step >= STILL).ok_or(TurntableError::Still { step_deg: step.to_degrees() })
    };
    let rough = fitted(&motions)?;
    motions = neighbours.motions(Some((&rough, &middle, lever)), &motions, progress)?;
    let fitted = fitted(&motions)?;
    let given = options.turntable_step.map(f64::to_radians);
    let mut turntable = Turntable { step: given.unwrap_or(fitted.step), ..fitted };
    progress.start("refine the turntable", WITHIN.len() as u64);
    let mut looked_at = (Vec::new(), None);
    for (round, within) in WITHIN.iter().enumerate() {
        let mut pairs = view_pairs(views.len(), turntable.step);
        pairs.retain(|pair| round > 0 || !pair.is_closing);
        let refinement = Refinement { views, pairs: &pairs, has_free_step: given.is_none() };
        let (better, sums) = refinement.run(&turntable, within * neighbours.voxel);
        turntable = better.near(&middle);
        looked_at = (pairs, Some(sums));
        progress.advance(1)?;
    }
    let (pairs, Some(sums)) = looked_at else {
        return Err(TurntableError::TooFewViews { n_pairs, least: LEAST });
    };
    let evidence = Evidence {
        views,
        pairs: &pairs,
        motions: &motions,
        sums: &sums,
        given,
        found: fitted.step,
        voxel: neighbours.voxel,
    };
    let doubts = evidence.doubts(&turntable);
    Ok(Calibration {
        turntable,
        verdict: doubts.iter().map(TurntableDoubt::verdict).max().unwrap_or(Verdict::Ok),
        n_views: views.iter().flatten().count(),
        n_pairs: pairs.len(),
        apart: sums.open,
        apart_after_a_turn: sums.closing,
        doubts,
    })
}

/// Views, and how each is laid over the next.
struct Neighbours {
    /// None of a view that shows too little.
    views: Vec<Option<View>>,
    voxel: f64,
    settled: Settled,
    options: IcpOptions,
}

impl Neighbours {
    fn new(
        clouds: &[PointCloud],
        options: &TurntableOptions,
        progress: &dyn Progress,
    ) -> Result<Self, TurntableError> {
        let diagonal = |cloud: &PointCloud| cloud.aabb().size().norm();
        let first = clouds.iter().find(|cloud| !cloud.points.is_empty()).map_or(0.0, diagonal);
        let detail = if first > 0.0 && first.is_finite() { first / FINENESS } else { 1.0 };
        let voxel = options.turntable_voxel.unwrap_or(detail);
        let options = IcpOptions {
            fine: Some(Metric::PointToPlane),
            kernel: Kernel::Tukey,
            voxel: Some(voxel),
            max_distance: Some(FAR * voxel),
            ..IcpOptions::default()
        };
        let nothing = PointCloud::default();
        let settled = Settled::new(&nothing, &nothing, &options)?;
        let view_options = ViewOptions {
            voxel,
            neighbours: options.neighbours,
            with_colours: false,
            with_borders: false,
            camera: None,
        };
        progress.start("views", clouds.len() as u64);
        let view = |cloud: &PointCloud| {
            progress.advance(1)?;
            match View::new(cloud, Role::Source, view_options, &Silent) {
                Ok(view) => Ok(Some(view)),
                Err(error @ IcpError::Voxel(_)) => Err(error.into()),
                // The part may be out of the picture for a while.
                Err(_) => Ok(None),
            }
        };
        let views: Result<_, TurntableError> = clouds.par_iter().map(view).collect();
        Ok(Self { views: views?, voxel, settled, options })
    }

    /// The motion of each neighbour over the next, with the number of the view it leads to. What is
    /// known already stays if it agrees with `rough`, and is looked for again from there if not.
    fn motions(
        &self,
        rough: Option<(&Turntable, &Point3, f64)>,
        known: &[(usize, Pose)],
        progress: &dyn Progress,
    ) -> Result<Vec<(usize, Pose)>, TurntableError> {
        progress.start("neighbouring views", self.views.len() as u64);
        let found: Result<Vec<Option<(usize, Pose)>>, TurntableError> = (2..=self.views.len())
            .into_par_iter()
            .map(|number| {
                progress.advance(1)?;
                let before = known.iter().find(|(other, _)| *other == number);
                if let (Some((turntable, middle, lever)), Some((_, motion))) = (rough, before)
                    && off(motion, turntable, middle, lever) < AGAIN * self.voxel
                {
                    return Ok(Some((number, *motion)));
                }
                let (Some(source), Some(target)) =
                    (&self.views[number - 2], &self.views[number - 1])
                else {
                    return Ok(None);
                };
                let guess =
                    rough.map_or_else(Pose::identity, |(turntable, ..)| turntable.turned(1.0));
                let views = [source, target];
                let laid = align_views(views, &guess, &self.settled, &self.options, &Silent)?;
                Ok(Some((number, laid.target_from_source)))
            })
            .collect();
        Ok(found?.into_iter().flatten().collect())
    }

    /// The middle of the views, and how far from there points are.
    fn middle(&self) -> (Point3, f64) {
        let views: Vec<&View> = self.views.iter().flatten().collect();
        let middle =
            [0, 1, 2].map(|k| median(&views.iter().map(|view| view.center[k]).collect::<Vec<_>>()));
        let radii: Vec<f64> = views.iter().map(|view| view.radius).collect();
        (Point3::from(middle), median(&radii).max(f64::MIN_POSITIVE))
    }
}
