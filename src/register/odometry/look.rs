//! A frame, and what the methods make of it.

use crate::geom::{Point3, PointCloud};
use crate::progress::Silent;
use crate::register::dense::{DenseError, DenseOptions, Pyramid};
use crate::register::features::{FeatureOptions, Features};
use crate::register::icp::{IcpError, Role, View, ViewOptions};
use crate::rgbd::{Camera, Image, RgbdError, RgbdFrame, grey};
use std::sync::OnceLock;

/// Voxels from the camera to what it sees in the median.
const VOXELS_DEEP: f64 = 75.0;
/// Every second pixel of every second row is enough for voxels as large.
const STEP: usize = 2;
/// Beyond this many median depths a frame is mostly noise.
const FAR: f32 = 3.0;
/// Depths around a corner that differ by more than this share are of an edge: which side the corner is
/// on cannot be told.
const EDGE: f32 = 0.03;

/// A frame with what the methods make of it, each made when first asked for.
#[derive(Debug)]
pub struct Look {
    /// The frame.
    pub frame: RgbdFrame,
    /// The camera that took it.
    pub camera: Camera,
    /// Voxels in which its surface is looked at [mm].
    pub voxel: f64,
    /// The median of its depths [mm].
    pub median_depth: f64,
    grey: OnceLock<Option<Image<f32>>>,
    features: OnceLock<Option<Features>>,
    surface: OnceLock<Result<Surface, IcpError>>,
    pyramid: OnceLock<Result<Pyramid, DenseError>>,
}

/// What a frame shows, as points.
#[derive(Debug)]
pub(super) struct Surface {
    pub(super) cloud: PointCloud,
    pub(super) view: View,
}

impl Look {
    /// A look at `frame`; `voxel` is that of its surface, by its depth if there is none. An error if the
    /// frame is not one of `camera`, or has no depth that can be.
    pub fn new(frame: RgbdFrame, camera: Camera, voxel: Option<f64>) -> Result<Self, RgbdError> {
        camera.check()?;
        frame.check(&camera)?;
        frame.check_depth()?;
        let median_depth = f64::from(median(&frame));
        let voxel = voxel.unwrap_or(median_depth / VOXELS_DEEP);
        Ok(Self {
            frame,
            camera,
            voxel,
            median_depth,
            grey: OnceLock::new(),
            features: OnceLock::new(),
            surface: OnceLock::new(),
            pyramid: OnceLock::new(),
        })
    }

    /// The same frame with nothing but its features, to be kept for long: the rest is large, and made
    /// again where it is needed.
    pub(in crate::register) fn bare(&self) -> Self {
        let features = OnceLock::new();
        if let Some(known) = self.features.get() {
            // A cell that was just made is empty.
            let _ = features.set(known.clone());
        }
        Self {
            frame: self.frame.clone(),
            camera: self.camera,
            voxel: self.voxel,
            median_depth: self.median_depth,
            grey: OnceLock::new(),
            features,
            surface: OnceLock::new(),
            pyramid: OnceLock::new(),
        }
    }

    /// How bright it is, 0 to 1; `None` without colours.
    pub fn grey(&self) -> Option<&Image<f32>> {
        self.grey.get_or_init(|| self.frame.color.as_ref().map(grey)).as_ref()
    }

    /// Its visual features; `None` without colours.
    pub fn features(&self) -> Option<&Features> {
        let find = || Some(Features::of(self.grey()?, &FeatureOptions::default()));
        self.features.get_or_init(find).as_ref()
    }

    /// Pictures of it from fine to coarse, by the options it is first asked with.
    pub(super) fn pyramid(&self, options: &DenseOptions) -> Result<&Pyramid, &DenseError> {
        let make = || Pyramid::new(&self.frame, &self.camera, options);
        self.pyramid.get_or_init(make).as_ref()
    }

    /// The point seen at `pixel`, in the camera's frame; `None` where there is no depth, or an edge.
    pub(super) fn place(&self, pixel: [f64; 2]) -> Option<Point3> {
        let [x, y] = pixel.map(|c| c.round().max(0.0) as usize);
        let depth = &self.frame.depth;
        let own = depth.get(x, y).copied().filter(|own| *own > 0.0)?;
        let near = |c: usize| c.saturating_sub(1)..=c + 1;
        let around = || near(y).flat_map(|y| near(x).filter_map(move |x| depth.get(x, y)));
        let readings = || around().copied().filter(|other| *other > 0.0);
        if readings().any(|other| (other - own).abs() > EDGE * own) {
            return None;
        }
        let (sum, n) =
            readings().fold((0.0, 0.0), |(sum, n), other| (sum + f64::from(other), n + 1.0));
        Some(self.camera.unproject(pixel, sum / n))
    }

    /// Its surface, ready to be laid over another.
    pub(super) fn surface(&self) -> Result<&Surface, &IcpError> {
        self.surface.get_or_init(|| self.make_surface()).as_ref()
    }

    fn make_surface(&self) -> Result<Surface, IcpError> {
        let mut frame = self.frame.clone();
        let far = self.median_depth as f32 * FAR;
        frame.depth.pixels_mut().iter_mut().filter(|z| **z > far).for_each(|z| *z = 0.0);
        // Sizes were checked when the look was made; a picture that is none has no points.
        let organised = frame.cloud(&self.camera);
        let cloud = organised.map(|points| points.to_sparse_cloud(STEP)).unwrap_or_default();
        let options = ViewOptions {
            voxel: self.voxel,
            neighbours: super::by_icp::NEIGHBOURS,
            with_colours: false,
            with_borders: false,
            camera: None,
        };
        let view = View::new(&cloud, Role::Source, options, &Silent)?;
        Ok(Surface { cloud, view })
    }
}

fn median(frame: &RgbdFrame) -> f32 {
    let mut depths: Vec<f32> =
        frame.depth.pixels().iter().copied().filter(|depth| *depth > 0.0).collect();
    let middle = depths.len() / 2;
    if depths.is_empty() { 0.0 } else { *depths.select_nth_unstable_by(middle, f32::total_cmp).1 }
}
