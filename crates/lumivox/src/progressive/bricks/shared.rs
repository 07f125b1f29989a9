//! Buffers that several volumes of bricks lie in, one behind the other, so that a shader reads all of them by few bindings.

use std::num::NonZeroU64;

use glam::UVec3;

use crate::gpu::{Buffer, Gpu, GpuError};
use crate::progressive::AttributeChannel;

use super::VoxelizerSettings;
use super::store::{BRICK_CELLS, HEADER};

/// Where buffers may be bound from: a multiple of that fits every device.
const ALIGNMENT: u64 = 256;

/// Tables, headers and values of several volumes of one size.
#[derive(Debug)]
pub(in crate::progressive) struct SharedBuffers {
    whole: [Buffer; 3],
    /// Bytes of one volume's.
    strides: [u64; 3],
}

/// One volume's table, headers and values.
#[derive(Debug)]
pub(in crate::progressive) struct Windows(pub(super) [Buffer; 3]);

/// Bytes of the table, the headers and the values of a volume.
pub(super) fn sizes(dims: UVec3, channels: &[AttributeChannel], settings: &VoxelizerSettings) -> [u64; 3] {
    let slots = u64::from(settings.bricks);
    let table = 4 * dims.as_u64vec3().element_product();
    [table, 4 * slots * HEADER as u64, slots * BRICK_CELLS * 8 * channels.len() as u64]
}

impl SharedBuffers {
    pub(in crate::progressive) fn new(
        gpu: &Gpu,
        dims: UVec3,
        channels: &[AttributeChannel],
        settings: &VoxelizerSettings,
        count: usize,
    ) -> Result<Self, GpuError> {
        let settings = settings.clean();
        let strides = sizes(dims, channels, &settings).map(|bytes| bytes.next_multiple_of(ALIGNMENT));
        let [table, headers, values] = strides;
        let make = |name: &str, bytes: u64| Buffer::storage(gpu, name, bytes * count as u64);
        let whole = [
            make("cascade/tables", table)?,
            make("cascade/headers", headers)?,
            make("cascade/values", values)?,
        ];
        Ok(Self { whole, strides })
    }

    /// The part of a volume.
    pub(in crate::progressive) fn windows(&self, gpu: &Gpu, number: usize) -> Windows {
        let window = |n: usize| {
            let size = NonZeroU64::new(self.strides[n]).unwrap_or(NonZeroU64::MIN);
            Buffer::window(gpu, self.whole[n].raw.clone(), self.strides[n] * number as u64, size)
        };
        Windows([0, 1, 2].map(window))
    }

    pub(in crate::progressive) fn whole(&self) -> [&Buffer; 3] {
        self.whole.each_ref()
    }

    /// Words of a table and of headers, and values of 8 bytes, from one volume to the next.
    pub(in crate::progressive) fn strides(&self) -> [u32; 3] {
        let [table, headers, values] = self.strides;
        [table / 4, headers / 4, values / 8].map(|n| n as u32)
    }
}
