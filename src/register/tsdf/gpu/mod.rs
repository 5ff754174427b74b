//! The same model on a device: what fusing and casting touch stays there.
//!
//! The host keeps which blocks there are, and says which of them a frame touches;
//! `kernels/tsdf/integrate.wgsl` and `kernels/tsdf/cast.wgsl` do what [`integrate`](super::integrate) and [`cast`](super::cast) do,
//! step by step, in `f32`. Where a lattice point falls on the border of two pixels, or a ray just passes a
//! surface by, rounding may decide otherwise than on the processor; elsewhere both agree to rounding.

mod kernels;
mod layout;
mod table;

use super::block::{Block, Key, N, SIDE};
use super::integrate::{Integrated, MOST_COLORS, MOST_WEIGHT, View};
use super::lattice::Lattice;
use super::tiles::Tiles;
use super::{ModelView, Readings, Seen, TsdfError, TsdfOptions, Volume};
use crate::compute::{Buffer, Gpu};
use crate::geom::Pose;
use crate::rgbd::{Camera, Image};
use kernels::WORKGROUP;
use std::fmt;
use std::sync::Arc;

/// Bytes of a point of the lattice in either buffer: distance and weight, or colour.
const POINT: u64 = 8;
/// Blocks there is room for at first.
const FIRST_ROOM: usize = 1024;

/// A [`Volume`] that lives on a device.
pub struct DeviceVolume {
    gpu: Arc<Gpu>,
    lattice: Lattice,
    /// Distances and weights, block by block.
    points: Buffer,
    /// As `points`.
    colors: Buffer,
    /// Blocks there is room for.
    room: usize,
    /// Where blocks are, as of when there were that many.
    table: Option<(usize, Buffer, u32)>,
}

impl DeviceVolume {
    /// A model of nothing yet on `gpu`.
    pub fn new(options: &TsdfOptions, gpu: Arc<Gpu>) -> Result<Self, TsdfError> {
        let lattice = Lattice::new(options)?;
        let points = gpu.zeroed("model", bytes(FIRST_ROOM))?;
        let colors = gpu.zeroed("colours of the model", bytes(FIRST_ROOM))?;
        Ok(Self { gpu, lattice, points, colors, room: FIRST_ROOM, table: None })
    }

    /// How it is made.
    pub fn options(&self) -> &TsdfOptions {
        &self.lattice.options
    }

    /// Blocks that exist.
    pub fn n_blocks(&self) -> usize {
        self.lattice.n_blocks()
    }

    /// What it takes [bytes].
    pub fn memory(&self) -> usize {
        self.lattice.memory()
    }

    /// The same as [`Volume::integrate`].
    pub fn integrate(
        &mut self,
        readings: &Readings,
        world_from_camera: &Pose,
    ) -> Result<Integrated, TsdfError> {
        let keys = self.lattice.touched(readings, world_from_camera)?;
        self.make_room(keys.iter().filter(|key| self.lattice.find(key).is_none()).count())?;
        let n_new = self.lattice.make(&keys)?;
        let view = View::new(readings, world_from_camera, self.options());
        let touched: Vec<layout::Touched> =
            keys.iter().filter_map(|key| self.touched(&view, key)).collect();
        let most = self.gpu.most_workgroups() as usize;
        let readings = self.gpu.upload("readings", readings.pixels.pixels())?;
        let blocks = self.gpu.upload("touched blocks", &touched)?;
        for begin in (0..touched.len()).step_by(most) {
            let end = (begin + most).min(touched.len());
            let job = self.gpu.upload("view", &[job(&view, begin, end)])?;
            let buffers = [&job, &blocks, &readings, &self.points, &self.colors];
            self.gpu.run(&kernels::integrate(), &buffers, (end - begin) as u32)?;
        }
        Ok(Integrated { n_touched: keys.len(), n_new })
    }

    /// The same as [`Volume::cast`].
    pub fn cast(
        &mut self,
        camera: &Camera,
        world_from_camera: &Pose,
    ) -> Result<ModelView, TsdfError> {
        let camera = camera.without_distortion();
        let (n_blocks, n_pixels) = (self.n_blocks(), camera.width * camera.height);
        let is_old = self.table.as_ref().is_none_or(|(of, ..)| *of != n_blocks);
        if is_old {
            let table = table::table(&self.lattice.keys);
            let mask = table.len() as u32 - 1;
            self.table = Some((n_blocks, self.gpu.upload("table of blocks", &table)?, mask));
        }
        let tiles = Tiles::new(&self.lattice, &camera, world_from_camera);
        let ranges: Vec<[f32; 2]> =
            tiles.ranges.iter().map(|range| [range.start as f32, range.end as f32]).collect();
        let ranges = self.gpu.upload("tiles", &ranges)?;
        let seen = self.gpu.zeroed("what is seen", (n_pixels * size_of::<Seen>()) as u64)?;
        if let Some((_, table, mask)) = &self.table {
            let job = self.ray_job(&camera, world_from_camera, tiles.n_columns as u32, *mask);
            let job = self.gpu.upload("rays", &[job])?;
            let buffers = [&job, &ranges, table, &self.points, &seen];
            let n_groups = n_pixels.div_ceil(WORKGROUP as usize) as u32;
            self.gpu.run(&kernels::cast(), &buffers, n_groups)?;
        }
        let seen: Vec<Seen> = self.gpu.download("what is seen", &seen)?;
        if seen.iter().any(|seen| seen.point[2] < 0.0) {
            return Err(TsdfError::LongRays { voxel: self.options().voxel });
        }
        let pixels = Image::new(camera.width, camera.height, seen)?;
        Ok(ModelView { camera, world_from_camera: *world_from_camera, pixels })
    }

    /// The model as the processor has it.
    pub fn download(&self) -> Result<Volume, TsdfError> {
        let points: Vec<[f32; 2]> = self.gpu.download("model", &self.points)?;
        let colors: Vec<[u16; 4]> = self.gpu.download("colours of the model", &self.colors)?;
        let block = |(points, colors): (&[[f32; 2]], &[[u16; 4]])| {
            let mut block = Block::unknown();
            for (i, [distance, weight]) in points.iter().enumerate() {
                (block.distance[i], block.weight[i]) = (*distance, *weight);
            }
            block.color.copy_from_slice(colors);
            block
        };
        let blocks = points.chunks_exact(N).zip(colors.chunks_exact(N)).take(self.n_blocks());
        Ok(Volume { lattice: self.lattice.clone(), blocks: blocks.map(block).collect() })
    }

    /// Room for `n_more` blocks, for which the lattice allows.
    fn make_room(&mut self, n_more: usize) -> Result<(), TsdfError> {
        let needed = self.n_blocks() + n_more;
        if needed <= self.room {
            return Ok(());
        }
        self.lattice.allows(needed)?;
        let most = (self.gpu.largest_binding() / bytes(1)) as usize;
        let room = needed.max(2 * self.room).min(most.max(needed));
        let points = self.gpu.grown("model", &self.points, bytes(room))?;
        let colors = self.gpu.grown("colours of the model", &self.colors, bytes(room))?;
        (self.points, self.colors, self.room) = (points, colors, room);
        Ok(())
    }

    fn touched(&self, view: &View, key: &Key) -> Option<layout::Touched> {
        let slot = self.lattice.find(key)? as u32;
        Some(layout::Touched { first: view.first_point(key), slot })
    }

    fn ray_job(
        &self,
        camera: &Camera,
        world_from_camera: &Pose,
        n_columns: u32,
        mask: u32,
    ) -> layout::Cast {
        let options = self.options();
        let eye = world_from_camera.translation.vector / options.voxel;
        // A corner of a block near the eye: what is left of the eye's place is small.
        let origin = eye.map(|c| (c / SIDE as f64).round() * SIDE as f64);
        let eye = eye - origin;
        let turn = world_from_camera.rotation.to_rotation_matrix();
        let column = |k: usize| {
            [0, 1, 2, 3]
                .map(|i| turn.matrix().column(k).get(i).map_or(0.0, |c| (c / options.voxel) as f32))
        };
        layout::Cast {
            eye: [eye.x as f32, eye.y as f32, eye.z as f32, 0.0],
            right: column(0),
            down: column(1),
            ahead: column(2),
            origin: [origin.x as i32, origin.y as i32, origin.z as i32, 0],
            focal: [camera.fx as f32, camera.fy as f32],
            center: [camera.cx as f32, camera.cy as f32],
            size: [camera.width as u32, camera.height as u32],
            n_columns,
            mask,
            voxel: options.voxel as f32,
            truncation: options.truncation() as f32,
            pad_a: 0,
            pad_b: 0,
        }
    }
}

impl fmt::Debug for DeviceVolume {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { gpu, lattice, .. } = self;
        f.debug_struct("DeviceVolume").field("gpu", gpu).field("lattice", lattice).finish()
    }
}

/// What `n_blocks` take in either buffer.
fn bytes(n_blocks: usize) -> u64 {
    n_blocks as u64 * N as u64 * POINT
}

fn job(view: &View, begin: usize, end: usize) -> layout::View {
    let along = |k: usize| {
        let [x, y, z] = view.steps[k];
        [x, y, z, 0.0]
    };
    layout::View {
        along_x: along(0),
        along_y: along(1),
        along_z: along(2),
        focal: view.focal,
        center: view.center,
        size: [view.pixels.width() as u32, view.pixels.height() as u32],
        truncation: view.truncation,
        sure: view.sure,
        most_weight: MOST_WEIGHT,
        most_colors: u32::from(MOST_COLORS),
        begin: begin as u32,
        end: end as u32,
    }
}
