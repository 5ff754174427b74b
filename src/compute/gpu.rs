//! An opened device, and kernels run on it.

use super::adapter::present;
use super::{Buffer, GpuError, Kernel, Precision};
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// An opened device with the kernels compiled for it so far.
pub struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    name: String,
    limits: wgpu::Limits,
    pipelines: Mutex<HashMap<Kernel, wgpu::ComputePipeline>>,
    /// Why the device was lost, once it is.
    lost: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the adapter whose name has `name` in it, in any case; or the one of the fastest kind.
    pub fn open(name: Option<&str>) -> Result<Self, GpuError> {
        let present = present();
        let named = |adapter: &wgpu::Adapter| adapter.get_info().name;
        let names: Vec<String> = present.iter().map(named).collect();
        let wanted = name.unwrap_or_default().to_lowercase();
        let mut matching =
            present.into_iter().filter(|adapter| named(adapter).to_lowercase().contains(&wanted));
        match (matching.next(), name) {
            (Some(adapter), _) => Self::of(&adapter),
            (None, Some(name)) if !names.is_empty() => {
                Err(GpuError::NoSuchAdapter { name: name.to_owned(), present: names })
            }
            (None, _) => Err(GpuError::NoAdapter),
        }
    }

    fn of(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let name = adapter.get_info().name;
        let limits = adapter.limits();
        let asked = wgpu::DeviceDescriptor {
            label: Some("horma"),
            required_features: adapter.features() & wgpu::Features::SHADER_F64,
            required_limits: limits.clone(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&asked))
            .map_err(|error| GpuError::Refused { adapter: name.clone(), why: error.to_string() })?;
        let lost = Arc::new(Mutex::new(None));
        let told = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, why| {
            let why = if why.is_empty() { format!("{reason:?}") } else { why };
            *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(why);
        });
        Ok(Self { device, queue, name, limits, pipelines: Mutex::default(), lost })
    }

    /// What the device is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Does it compute in `precision`?
    pub fn has(&self, precision: Precision) -> bool {
        precision == Precision::Single
            || self.device.features().contains(wgpu::Features::SHADER_F64)
    }

    /// The most bytes of a buffer that a kernel can see.
    pub fn largest_binding(&self) -> u64 {
        self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size)
    }

    /// The most workgroups of one run.
    pub fn most_workgroups(&self) -> u32 {
        self.limits.max_compute_workgroups_per_dimension
    }

    /// Runs `kernel` in `n_workgroups` workgroups with `buffers` as bindings 0, 1, ... of group 0,
    /// and waits until it is done.
    pub fn run(
        &self,
        kernel: &Kernel,
        buffers: &[&Buffer],
        n_workgroups: u32,
    ) -> Result<(), GpuError> {
        let pipeline = self.pipeline(kernel)?;
        self.checked(kernel.name, 0, || {
            let entries: Vec<_> = (0..)
                .zip(buffers)
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.inner.as_entire_binding(),
                })
                .collect();
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(kernel.name),
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            let mut encoder =
                self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(n_workgroups, 1, 1);
            }
            self.queue.submit([encoder.finish()]);
        })?;
        self.wait(kernel.name)
    }

    /// The kernel as the device has it, compiled once.
    fn pipeline(&self, kernel: &Kernel) -> Result<wgpu::ComputePipeline, GpuError> {
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = pipelines.get(kernel) {
            return Ok(pipeline.clone());
        }
        if !self.has(kernel.precision) {
            return Err(GpuError::Lacks { adapter: self.name.clone(), what: "f64 in kernels" });
        }
        let pipeline = self.checked(kernel.name, 0, || {
            let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(kernel.name),
                source: wgpu::ShaderSource::Wgsl(kernel.source().into()),
            });
            self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(kernel.name),
                layout: None,
                module: &module,
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        })?;
        pipelines.insert(kernel.clone(), pipeline.clone());
        Ok(pipeline)
    }

    /// Does `work` that may need `n_bytes` on the device; what the device says against it is the
    /// error.
    pub(super) fn checked<T>(
        &self,
        what: &str,
        n_bytes: u64,
        work: impl FnOnce() -> T,
    ) -> Result<T, GpuError> {
        let room = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let valid = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let done = work();
        let invalid = pollster::block_on(valid.pop());
        let internal = pollster::block_on(internal.pop());
        let no_room = pollster::block_on(room.pop());
        if invalid.is_some() || internal.is_some() {
            // A lost device is told of when it is next asked; whether it answers does not matter.
            let _ = self.device.poll(wgpu::PollType::Poll);
        }
        self.still_there()?;
        if no_room.is_some() {
            return Err(GpuError::OutOfMemory { adapter: self.name.clone(), n_bytes });
        }
        match invalid.or(internal) {
            Some(error) => Err(self.refuses(what, &error)),
            None => Ok(done),
        }
    }

    /// Waits until all that was submitted is done.
    pub(super) fn wait(&self, what: &str) -> Result<(), GpuError> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.still_there()?;
        polled.map(|_| ()).map_err(|error| self.refuses(what, &error))
    }

    pub(super) fn refuses(&self, what: &str, why: &impl fmt::Display) -> GpuError {
        let (adapter, what) = (self.name.clone(), what.to_owned());
        GpuError::Refuses { adapter, what, why: why.to_string() }
    }

    fn still_there(&self) -> Result<(), GpuError> {
        match &*self.lost.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(why) => Err(GpuError::Lost { adapter: self.name.clone(), why: why.clone() }),
            None => Ok(()),
        }
    }
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_tuple("Gpu").field(&self.name).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::device;

    /// Doubles what is bound.
    const DOUBLE: &str = "
        @group(0) @binding(0) var<storage, read_write> numbers: array<real>;
        @compute @workgroup_size(WORKGROUP)
        fn main(@builtin(global_invocation_id) id: vec3<u32>) {
            numbers[id.x] = numbers[id.x] * real(2);
        }";

    fn kernel(text: &'static str) -> Kernel {
        Kernel { name: "double", parts: vec![text], precision: Precision::Single, workgroup: 4 }
    }

    #[test]
    fn numbers_go_to_the_device_and_come_back_changed_by_a_kernel_compiled_once() {
        let Some(gpu) = device() else { return };
        let numbers =
            gpu.upload("numbers", &[1.0_f32, 2.5, -3.0, 0.0, 7.0, 8.0, 9.0, 1e30]).unwrap();
        for _ in 0..2 {
            gpu.run(&kernel(DOUBLE), &[&numbers], 2).unwrap();
        }
        let doubled: Vec<f32> = gpu.download("numbers", &numbers).unwrap();
        assert_eq!(doubled, [4.0, 10.0, -12.0, 0.0, 28.0, 32.0, 36.0, 4e30]);
        assert_eq!(gpu.pipelines.lock().unwrap().len(), 1);
    }

    #[test]
    fn a_kernel_that_makes_no_sense_is_an_error_that_names_it() {
        let Some(gpu) = device() else { return };
        let error = gpu.run(&kernel("fn main() -> nonsense {}"), &[], 1).unwrap_err();
        let GpuError::Refuses { what, why, .. } = &error else { panic!("{error}") };
        assert!(what == "double" && why.contains("nonsense"), "{error}");
    }

    #[test]
    fn a_lost_device_is_an_error_that_says_what_to_do() {
        let Some(gpu) = device() else { return };
        let numbers = gpu.upload("numbers", &[1.0_f32; 4]).unwrap();
        gpu.device.destroy();
        let error = gpu.run(&kernel(DOUBLE), &[&numbers], 1).unwrap_err();
        assert!(matches!(error, GpuError::Lost { .. }), "{error}");
        assert!(error.to_string().contains("--compute cpu"), "{error}");
    }
}
