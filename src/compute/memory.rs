//! Slices of numbers on their way to a device and back.

use super::{Gpu, GpuError};
use bytemuck::Pod;

/// Memory of a device that a kernel can bind.
#[derive(Debug)]
pub struct Buffer {
    pub(super) inner: wgpu::Buffer,
}

impl Gpu {
    /// A copy of `data` on the device. What is larger than [`Gpu::largest_binding`] is refused:
    /// send it in pieces.
    pub fn upload<T: Pod>(&self, what: &str, data: &[T]) -> Result<Buffer, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let n_bytes = bytes.len() as u64;
        if self.largest_binding() < n_bytes {
            return Err(GpuError::OutOfMemory { adapter: self.name().to_owned(), n_bytes });
        }
        let inner = self.checked(what, n_bytes, || {
            let buffer = self.storage(what, n_bytes);
            self.queue.write_buffer(&buffer, 0, bytes);
            buffer
        })?;
        Ok(Buffer { inner })
    }

    /// Memory of `n_bytes` with zeros in it.
    pub fn zeroed(&self, what: &str, n_bytes: u64) -> Result<Buffer, GpuError> {
        if self.largest_binding() < n_bytes {
            return Err(GpuError::OutOfMemory { adapter: self.name().to_owned(), n_bytes });
        }
        // wgpu hands no memory out that it has not cleared.
        let inner = self.checked(what, n_bytes, || self.storage(what, n_bytes))?;
        Ok(Buffer { inner })
    }

    /// Memory of `n_bytes` that begins with what `buffer` holds and goes on with zeros.
    pub fn grown(&self, what: &str, buffer: &Buffer, n_bytes: u64) -> Result<Buffer, GpuError> {
        let grown = self.zeroed(what, n_bytes)?;
        let n_kept = buffer.inner.size().min(grown.inner.size());
        self.checked(what, n_bytes, || {
            let mut encoder =
                self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(&buffer.inner, 0, &grown.inner, 0, n_kept);
            self.queue.submit([encoder.finish()]);
        })?;
        Ok(grown)
    }

    fn storage(&self, what: &str, n_bytes: u64) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_SRC
            | wgpu::BufferUsages::COPY_DST;
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size: n_bytes.max(4),
            usage,
            mapped_at_creation: false,
        })
    }

    /// What `buffer` holds by now.
    pub fn download<T: Pod>(&self, what: &str, buffer: &Buffer) -> Result<Vec<T>, GpuError> {
        let n_bytes = buffer.inner.size();
        let landing = self.checked(what, n_bytes, || {
            let landing = self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(what),
                size: n_bytes,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let mut encoder =
                self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(&buffer.inner, 0, &landing, 0, n_bytes);
            self.queue.submit([encoder.finish()]);
            landing
        })?;
        // What the callback would tell, the mapped range tells too.
        landing.map_async(wgpu::MapMode::Read, .., |_| ());
        self.wait(what)?;
        let bytes = landing.get_mapped_range(..).map_err(|error| self.refuses(what, &error))?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}
