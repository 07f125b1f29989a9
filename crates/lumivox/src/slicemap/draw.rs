//! The pass over the triangles: into the range of each column, or into its bits.
//!
//! A pass without a target is not allowed, so there is one of a byte for each column that nothing is written to.

use super::SLICEMAP;
use super::settings::{SlicemapSettings, SlicemapUniform};
use crate::gpu::{
    Buffer, GeneratedText, Gpu, GpuError, Texture, Uniform, bind_group_layouts, made_bind_group,
};
use crate::voxelize::{Mesh, UNWRITTEN, mesh_layout, mesh_text, writing_pipeline};

/// What a pass writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// The nearest and the farthest surface of each column.
    Extents,
    /// The bits.
    Bits,
}

/// A pass over the triangles.
#[derive(Debug)]
pub(super) struct Draw {
    name: &'static str,
    pipeline: wgpu::RenderPipeline,
    /// One for each kind of bits.
    groups: Vec<wgpu::BindGroup>,
    target: Texture,
    /// Vertices of a triangle.
    vertices: u32,
}

impl Draw {
    pub(super) fn new(
        gpu: &Gpu,
        settings: &SlicemapSettings,
        phase: Phase,
        (uniforms, bits, extents): (&[Uniform<SlicemapUniform>], &Buffer, &Buffer),
    ) -> Result<Self, GpuError> {
        let by_table = settings.uses_table && phase == Phase::Bits && !settings.conservative;
        let text = text(phase, settings.conservative, by_table);
        let cellmask = cellmask(gpu)?;
        let missing = || GpuError::Binding { pass: text.name, reason: "has no group 0".to_owned() };
        let own = bind_group_layouts(gpu, &text)?.into_iter().next().flatten().ok_or_else(missing)?;
        let pipeline = writing_pipeline(gpu, &text, &[Some(&own), Some(&mesh_layout(gpu)?)])?;
        let groups = uniforms.iter().map(|uniform| {
            let resources = [uniform.binding(), bits.binding(), extents.binding(), cellmask.binding()];
            let entries: Vec<_> = (0..)
                .zip(resources)
                .take(if by_table { 4 } else { 3 })
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
                .collect();
            made_bind_group(gpu, text.name, &own, &entries)
        });
        Ok(Self {
            name: text.name,
            groups: groups.collect::<Result<_, _>>()?,
            target: Texture::target(gpu, text.name, settings.size.to_array(), UNWRITTEN)?,
            vertices: if settings.conservative { 6 } else { 3 },
            pipeline,
        })
    }

    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, meshes: &[(&Mesh, u32)]) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        for (mesh, kind) in meshes {
            let Some(group) = self.groups.get(*kind as usize) else { continue };
            pass.set_bind_group(0, group, &[]);
            for (batch, count) in mesh.batches() {
                pass.set_bind_group(1, batch, &[]);
                pass.draw(0..self.vertices * count, 0..1);
            }
        }
    }
}

/// The paper's cellmask: of each cell of a word its bit.
fn cellmask(gpu: &Gpu) -> Result<Buffer, GpuError> {
    let masks: Vec<u32> = (0..32).map(|n| 1 << n).collect();
    Buffer::storage_with(gpu, "slicemap/cellmask", &masks)
}

/// The pass's text.
pub(super) fn text(phase: Phase, conservative: bool, by_table: bool) -> GeneratedText {
    let name = match phase {
        Phase::Extents => "slicemap/extents",
        Phase::Bits => "slicemap/bits",
    };
    let one_bit = if by_table {
        "@group(0) @binding(3) var<storage, read> slicemap_cellmask: array<u32>;\n\
         fn one_bit(slice: u32) -> u32 { return slicemap_cellmask[slice % 32u]; }"
    } else {
        "fn one_bit(slice: u32) -> u32 { return 1u << (slice % 32u); }"
    };
    let head = format!(
        "const EXTENTS: bool = {};\nconst CONSERVATIVE: bool = {conservative};\n{one_bit}",
        phase == Phase::Extents
    );
    GeneratedText { name, source: [&mesh_text(), SLICEMAP, &head, include_str!("draw.wgsl")].join("\n") }
}
