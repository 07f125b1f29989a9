//! Views of buffers that the host already has.

use std::num::NonZeroU64;

use glam::UVec4;

use super::VoxelizeError;
use crate::gpu::{Buffer, Gpu, GpuError};

/// One attribute of all vertices in a buffer of the host's.
#[derive(Clone, Copy, Debug)]
pub struct VertexView<'a> {
    /// The buffer; its usage must include `STORAGE`.
    pub buffer: &'a wgpu::Buffer,
    /// Where the first vertex's attribute begins, in bytes; a multiple of 4.
    pub offset: u64,
    /// From one vertex to the next, in bytes; a multiple of 4.
    pub stride: u64,
    /// `Float32x2`, `x3`, `x4`, or `x2` and `x4` of `Float16`, `Unorm16`, `Snorm16`, or `Unorm8x4`, `Snorm8x4`.
    pub format: wgpu::VertexFormat,
}

/// Indices in a buffer of the host's.
#[derive(Clone, Copy, Debug)]
pub struct IndexView<'a> {
    /// The buffer; its usage must include `STORAGE`.
    pub buffer: &'a wgpu::Buffer,
    /// Where the first index begins, in bytes; a multiple of the size of one.
    pub offset: u64,
    /// 16 or 32 bits.
    pub format: wgpu::IndexFormat,
    /// How many; three make a triangle, and what is left over is not looked at.
    pub count: u32,
}

/// Code of a format in `mesh.wgsl`, and its words.
fn format_code(format: wgpu::VertexFormat) -> Option<(u32, u64)> {
    use wgpu::VertexFormat as F;
    Some(match format {
        F::Float32x2 => (2, 2),
        F::Float32x3 => (3, 3),
        F::Float32x4 => (4, 4),
        F::Float16x2 => (5, 1),
        F::Float16x4 => (6, 2),
        F::Unorm16x2 => (7, 1),
        F::Unorm16x4 => (8, 2),
        F::Snorm16x2 => (9, 1),
        F::Snorm16x4 => (10, 2),
        F::Unorm8x4 => (11, 1),
        F::Snorm8x4 => (12, 1),
        _ => return None,
    })
}

/// What is bound of an attribute's buffer, and where it lies in it: first word, words from one to the next, format code, 0.
pub(super) fn vertex_window(
    gpu: &Gpu,
    what: &'static str,
    view: &VertexView<'_>,
    count: u32,
) -> Result<(Buffer, UVec4), VoxelizeError> {
    let wrong = |reason: String| VoxelizeError::Mesh { what, reason };
    let (code, words) = format_code(view.format)
        .ok_or_else(|| wrong(format!("the format {:?} cannot be read in shaders", view.format)))?;
    if !view.offset.is_multiple_of(4) || !view.stride.is_multiple_of(4) {
        let reason = format!("offset {} and stride {} must be multiples of 4", view.offset, view.stride);
        return Err(wrong(reason));
    }
    let bytes =
        u64::from(count.saturating_sub(1)).saturating_mul(view.stride) + 4 * words * u64::from(count.min(1));
    let (buffer, first) = window(gpu, what, view.buffer, view.offset, bytes)?;
    let stride = u32::try_from(view.stride / 4).map_err(|e| wrong(e.to_string()))?;
    Ok((buffer, UVec4::new((first / 4) as u32, stride, code, 0)))
}

/// The window, bits of an index, and the first index in it.
pub(super) fn index_window(gpu: &Gpu, view: &IndexView<'_>) -> Result<(Buffer, u32, u32), VoxelizeError> {
    let bytes: u64 = match view.format {
        wgpu::IndexFormat::Uint16 => 2,
        wgpu::IndexFormat::Uint32 => 4,
    };
    if !view.offset.is_multiple_of(bytes) {
        let reason = format!("the offset {} must be a multiple of {bytes}", view.offset);
        return Err(VoxelizeError::Mesh { what: "indices", reason });
    }
    let (buffer, first) =
        window(gpu, "indices", view.buffer, view.offset, u64::from(view.count).saturating_mul(bytes))?;
    Ok((buffer, 8 * bytes as u32, (first / bytes) as u32))
}

/// What is bound of a buffer so that `bytes` from `offset` are seen, and where they begin in it.
fn window(
    gpu: &Gpu,
    what: &'static str,
    buffer: &wgpu::Buffer,
    offset: u64,
    bytes: u64,
) -> Result<(Buffer, u64), VoxelizeError> {
    let wrong = |reason: String| VoxelizeError::Mesh { what, reason };
    if !buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
        return Err(wrong(format!("the buffer's usage {:?} must include STORAGE", buffer.usage())));
    }
    let size = buffer.size();
    if offset.saturating_add(bytes) > size {
        return Err(wrong(format!("{bytes} bytes from {offset} on, in a buffer of {size}")));
    }
    let limits = gpu.device.limits();
    let alignment = u64::from(limits.min_storage_buffer_offset_alignment);
    let start = (offset / alignment * alignment).min(size.saturating_sub(4) / alignment * alignment);
    // Shaders read words.
    let end = (offset + bytes).next_multiple_of(4).min(size);
    let limit = limits.max_storage_buffer_binding_size;
    let bound = (end - start).max(16).min(size - start) / 4 * 4;
    if bound > limit {
        let error = GpuError::TooLarge {
            what: format!("the {what} of a mesh"),
            needed: bound,
            limit,
            hint: String::new(),
        };
        return Err(error.into());
    }
    let bound = NonZeroU64::new(bound).ok_or_else(|| wrong(format!("a buffer of {size} bytes")))?;
    Ok((Buffer::window(gpu, buffer.clone(), start, bound), offset - start))
}
