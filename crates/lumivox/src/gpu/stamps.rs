//! The device's own clock, before and after a piece of a frame's commands.

use super::Gpu;

/// Two timestamps, 8 bytes each.
pub(crate) const STAMP_BYTES: u64 = 16;

/// Writes the device's clock before and after what lies between.
#[derive(Debug)]
pub(crate) struct Stamps {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// Milliseconds of a tick.
    tick: f64,
}

impl Stamps {
    /// None where the device has no timestamps.
    pub(crate) fn new(gpu: &Gpu, label: &str) -> Option<Self> {
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        gpu.count_created();
        let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some(label),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        gpu.count_created();
        let resolved = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: STAMP_BYTES,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Some(Self { set, resolved, tick: 1e-6 * f64::from(gpu.queue.get_timestamp_period()) })
    }

    /// Begins. Passes without work carry the stamps: core WebGPU has them at passes alone.
    pub(crate) fn begin(&self, encoder: &mut wgpu::CommandEncoder) {
        self.write(encoder, [Some(0), None]);
    }

    /// Ends, and copies both to a place in a buffer.
    pub(crate) fn end(&self, encoder: &mut wgpu::CommandEncoder, to: &wgpu::Buffer, offset: u64) {
        self.write(encoder, [None, Some(1)]);
        encoder.resolve_query_set(&self.set, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, to, offset, STAMP_BYTES);
    }

    fn write(&self, encoder: &mut wgpu::CommandEncoder, [begin, end]: [Option<u32>; 2]) {
        drop(encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("timestamp"),
            timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                query_set: &self.set,
                beginning_of_pass_write_index: begin,
                end_of_pass_write_index: end,
            }),
        }));
    }

    /// Milliseconds between two stamps; none if they ran backwards.
    pub(crate) fn milliseconds(&self, stamps: &[u8]) -> Option<f64> {
        let at = |n: usize| stamps.get(8 * n..8 * n + 8)?.try_into().ok().map(u64::from_le_bytes);
        at(1)?.checked_sub(at(0)?).map(|ticks| ticks as f64 * self.tick)
    }
}
