//! From the GPU back to memory. These wait; they are never part of a frame.

use super::{Buffer, Gpu, GpuError, Texture};

/// All bytes of a buffer, as values of `T`.
pub fn read_buffer<T: bytemuck::Pod>(gpu: &Gpu, buffer: &Buffer) -> Result<Vec<T>, GpuError> {
    let staging = staging(gpu, buffer.size());
    let mut encoder = encoder(gpu);
    let offset = buffer.window.map_or(0, |(offset, _)| offset);
    encoder.copy_buffer_to_buffer(&buffer.raw, offset, &staging, 0, buffer.size());
    let bytes = submit_and_map(gpu, encoder, &staging, "a buffer")?;
    Ok(bytemuck::pod_collect_to_vec(&bytes[..bytes.len() / size_of::<T>() * size_of::<T>()]))
}

/// The rows of a texture (first mip level, top row first, of a 3D texture slice by slice) without padding, as values of `T`, one per texel.
///
/// # Errors
/// When `T` does not have the size of a texel of the texture's format.
pub fn read_texture<T: bytemuck::Pod>(gpu: &Gpu, texture: &Texture) -> Result<Vec<T>, GpuError> {
    let texel = texture.raw.format().block_copy_size(Some(wgpu::TextureAspect::All)).unwrap_or(4);
    if texel as usize != size_of::<T>() {
        return Err(GpuError::Readback {
            what: "a texture".to_owned(),
            reason: format!("its texels have {texel} bytes, not {}", size_of::<T>()),
        });
    }
    let [width, height] = texture.size();
    let row = width * texel;
    let padded_row = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let slices = match texture.raw.dimension() {
        wgpu::TextureDimension::D3 => texture.raw.depth_or_array_layers(),
        _ => 1,
    };
    let staging = staging(gpu, u64::from(padded_row) * u64::from(height) * u64::from(slices));
    let mut encoder = encoder(gpu);
    encoder.copy_texture_to_buffer(
        texture.raw.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_row),
                rows_per_image: Some(height),
            },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: slices },
    );
    let bytes = submit_and_map(gpu, encoder, &staging, "a texture")?;
    let rows = bytes.chunks_exact(padded_row as usize);
    Ok(rows.flat_map(|r| bytemuck::pod_collect_to_vec::<u8, T>(&r[..row as usize])).collect())
}

fn staging(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("readback") })
}

fn submit_and_map(
    gpu: &Gpu,
    encoder: wgpu::CommandEncoder,
    staging: &wgpu::Buffer,
    what: &str,
) -> Result<Vec<u8>, GpuError> {
    gpu.check()?;
    gpu.queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is gone only when this function has already returned with an error.
        let _ = sender.send(result);
    });
    gpu.wait()?;
    let failed = |reason: String| GpuError::Readback { what: what.to_owned(), reason };
    // Another thread that waits for the device may be the one that delivers; it does so without delay.
    receiver.recv().map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))?;
    let bytes = staging.get_mapped_range(..).map_err(|e| failed(e.to_string()))?.to_vec();
    staging.unmap();
    Ok(bytes)
}
