//! Buffers with an identity, so that passes can keep bind groups for them.

use std::marker::PhantomData;
use std::num::NonZeroU64;

use super::{Gpu, GpuError, GpuStruct};

/// A storage buffer. Its identity never repeats on a device.
#[derive(Debug)]
pub struct Buffer {
    pub(super) id: u64,
    /// The wgpu buffer, for a host's own use.
    pub raw: wgpu::Buffer,
    /// What of it is bound: offset and size in bytes. All, without.
    pub(super) window: Option<(u64, NonZeroU64)>,
}

impl Buffer {
    /// A zeroed storage buffer of `bytes` (rounded up to 4) that can be copied from and to.
    pub fn storage(gpu: &Gpu, label: &str, bytes: u64) -> Result<Self, GpuError> {
        gpu.check_binding_size(label, bytes, "")?;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        Ok(Self::with_usage(gpu, label, bytes, usage))
    }

    /// A buffer of any usage.
    pub fn with_usage(gpu: &Gpu, label: &str, bytes: u64, usage: wgpu::BufferUsages) -> Self {
        let size = bytes.next_multiple_of(4).max(4);
        let raw = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        });
        Self { id: gpu.count_created(), raw, window: None }
    }

    /// Takes in `size` bytes from `offset` of a buffer that the host already has; wgpu wants offsets that are multiples of
    /// the device's alignment.
    pub(crate) fn window(gpu: &Gpu, raw: wgpu::Buffer, offset: u64, size: NonZeroU64) -> Self {
        Self { id: gpu.count_created(), raw, window: Some((offset, size)) }
    }

    /// A storage buffer filled with `data`.
    pub fn storage_with<T: bytemuck::NoUninit>(gpu: &Gpu, label: &str, data: &[T]) -> Result<Self, GpuError> {
        let buffer = Self::storage(gpu, label, std::mem::size_of_val(data) as u64)?;
        gpu.queue.write_buffer(&buffer.raw, 0, bytemuck::cast_slice(data));
        Ok(buffer)
    }

    /// What a bind group holds of it.
    pub(crate) fn binding(&self) -> wgpu::BindingResource<'_> {
        match self.window {
            Some((offset, size)) => wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &self.raw,
                offset,
                size: Some(size),
            }),
            None => self.raw.as_entire_binding(),
        }
    }

    /// Size in bytes.
    pub fn size(&self) -> u64 {
        self.window.map_or(self.raw.size(), |(_, size)| size.get())
    }
}

/// A uniform buffer that holds one `T`. Writing it takes effect before everything submitted afterwards, so one frame
/// writes each uniform once.
#[derive(Debug)]
pub struct Uniform<T> {
    pub(crate) buffer: Buffer,
    marker: PhantomData<T>,
}

impl<T: GpuStruct> Uniform<T> {
    /// A uniform with a first value.
    pub fn new(gpu: &Gpu, label: &str, value: &T) -> Self {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let buffer = Buffer::with_usage(gpu, label, size_of::<T>() as u64, usage);
        let uniform = Self { buffer, marker: PhantomData };
        uniform.write(gpu, value);
        uniform
    }

    pub(crate) fn binding(&self) -> wgpu::BindingResource<'_> {
        self.buffer.binding()
    }

    /// Replaces the value.
    pub fn write(&self, gpu: &Gpu, value: &T) {
        gpu.queue.write_buffer(&self.buffer.raw, 0, bytemuck::bytes_of(value));
    }
}
