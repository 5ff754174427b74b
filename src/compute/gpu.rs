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
