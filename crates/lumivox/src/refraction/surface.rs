//! The nearest glass of each pixel: its normal and its kind.

use super::RefractionSettings;
use crate::gpu::{
    GeneratedText, Gpu, GpuError, Texture, Uniform, bind_group_layouts, made_bind_group, validated,
};
use crate::slicemap::{SLICEMAP, Slicemap, SlicemapUniform};
use crate::voxelize::{Mesh, mesh_layout, mesh_text};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The pass and its targets.
#[derive(Debug)]
pub(super) struct Surface {
    pipeline: wgpu::RenderPipeline,
    /// One for each kind.
    groups: Vec<wgpu::BindGroup>,
    /// World normal, and one and the kind; zero where there is no glass.
    pub(super) normal: Texture,
    pub(super) depth: Texture,
    far_depth: f32,
}

impl Surface {
    pub(super) fn new(
        gpu: &Gpu,
        settings: &RefractionSettings,
        slicemap: &Slicemap,
    ) -> Result<Self, GpuError> {
        let text = text();
        let missing = || GpuError::Binding { pass: text.name, reason: "has no group 0".to_owned() };
        let own = bind_group_layouts(gpu, &text)?.into_iter().next().flatten().ok_or_else(missing)?;
        let mesh = mesh_layout(gpu)?;
        let compare = if settings.reversed_depth {
            wgpu::CompareFunction::Greater
        } else {
            wgpu::CompareFunction::Less
        };
        let pipeline = pipeline(gpu, &text, &[Some(&own), Some(&mesh)], compare)?;
        let group = |uniform: &Uniform<SlicemapUniform>| {
            let entry = wgpu::BindGroupEntry { binding: 0, resource: uniform.binding() };
            made_bind_group(gpu, text.name, &own, &[entry])
        };
        let target = |name, format| Texture::target(gpu, name, settings.size.to_array(), format);
        Ok(Self {
            groups: slicemap.uniforms().iter().map(group).collect::<Result<_, _>>()?,
            normal: target("refraction/normal", FORMAT)?,
            depth: target("refraction/depth", DEPTH_FORMAT)?,
            far_depth: if settings.reversed_depth { 0.0 } else { 1.0 },
            pipeline,
        })
    }

    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, meshes: &[(&Mesh, u32)]) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("refraction/surface"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.normal.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(self.far_depth),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        for (mesh, kind) in meshes {
            let Some(group) = self.groups.get(*kind as usize) else { continue };
            pass.set_bind_group(0, group, &[]);
            for (batch, count) in mesh.batches() {
                pass.set_bind_group(1, batch, &[]);
                pass.draw(0..3 * count, 0..1);
            }
        }
    }
}

fn pipeline(
    gpu: &Gpu,
    text: &GeneratedText,
    groups: &[Option<&wgpu::BindGroupLayout>],
    compare: wgpu::CompareFunction,
) -> Result<wgpu::RenderPipeline, GpuError> {
    validated(gpu, || {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(text.name),
            source: wgpu::ShaderSource::Wgsl(text.source.as_str().into()),
        });
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(text.name),
            bind_group_layouts: groups,
            immediate_size: 0,
        });
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(text.name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex_main"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment_main"),
                compilation_options: Default::default(),
                targets: &[Some(FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    })
}

/// The pass's text.
pub(super) fn text() -> GeneratedText {
    let source = [&mesh_text(), SLICEMAP, include_str!("surface.wgsl")].join("\n");
    GeneratedText { name: "refraction/surface", source }
}
