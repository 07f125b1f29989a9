//! The volumes into the stencil, and the stencil into a mask.
//!
//! Core WebGPU has no format with a stencil and 32 bits of depth that a host's depth could be copied into without loss, so the
//! stencil stands alone and fragments compare themselves with the surface that the depth image shows: those behind it count
//! (*z-fail*), those before it are discarded.

use super::settings::VolumeUniform;
use super::{PIXEL, VOLUME};
use crate::gpu::{
    Bindings, Buffer, FullscreenPass, Gpu, GpuError, Program, Shader, Texture, Uniform, read_buffer,
    shader_module,
};
use crate::visibility::FACTOR_FORMAT;
use crate::wgsl::FULLSCREEN;

const UNCOUNTED: &str = "fn filled(counts: bool) {}";

pub(super) const DRAW: Shader =
    Shader { name: "volumes/draw", parts: &[VOLUME, UNCOUNTED, include_str!("draw.wgsl")] };
pub(super) const COUNTED_DRAW: Shader = Shader {
    name: "volumes/draw counted",
    parts: &[VOLUME, include_str!("fill.wgsl"), include_str!("draw.wgsl")],
};
pub(super) const RECEIVERS: Shader =
    Shader { name: "volumes/receivers", parts: &[VOLUME, PIXEL, FULLSCREEN, include_str!("receivers.wgsl")] };
pub(super) const MASK: Shader =
    Shader { name: "volumes/mask", parts: &[FULLSCREEN, include_str!("mask.wgsl")] };

const STENCIL: wgpu::TextureFormat = wgpu::TextureFormat::Stencil8;

/// Everything that is drawn over the picture.
#[derive(Debug)]
pub(super) struct Draw {
    receivers_pass: FullscreenPass,
    draw: (wgpu::RenderPipeline, Program),
    /// Made when fragments are first counted.
    counted: Option<((wgpu::RenderPipeline, Program), Buffer)>,
    mask_pipeline: wgpu::RenderPipeline,
    pub(super) receivers: Texture,
    pub(super) stencil: Texture,
}

/// What is drawn of the lists: all over the picture the first, and each of the others within its run of layers.
pub(super) struct Drawn<'a> {
    pub(super) uniform: &'a Uniform<VolumeUniform>,
    pub(super) vertices: &'a Buffer,
    pub(super) primitives: &'a Buffer,
    pub(super) draws: &'a Buffer,
    /// Corners and sizes of these runs in pixels.
    pub(super) layers: &'a [[u32; 4]],
}

impl Draw {
    pub(super) fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, GpuError> {
        Ok(Self {
            receivers_pass: FullscreenPass::new(gpu, &RECEIVERS, wgpu::TextureFormat::R32Float, false),
            draw: volume_pipeline(gpu, &DRAW),
            counted: None,
            mask_pipeline: mask_pipeline(gpu),
            receivers: Texture::target(gpu, "volumes/receivers", size, wgpu::TextureFormat::R32Float)?,
            stencil: Texture::target(gpu, "volumes/stencil", size, STENCIL)?,
        })
    }

    /// Begins or ends to count fragments.
    pub(super) fn set_counting(&mut self, gpu: &Gpu, counts: bool) -> Result<(), GpuError> {
        let make = || Ok((volume_pipeline(gpu, &COUNTED_DRAW), Buffer::storage(gpu, "volumes/fill", 8)?));
        self.counted = counts.then(make).transpose()?;
        Ok(())
    }

    /// Fragments, and those among them that changed the stencil, since the last recording. Waits.
    pub(super) fn read_fill(&self, gpu: &Gpu) -> Result<[u32; 2], GpuError> {
        let Some((_, fill)) = &self.counted else { return Ok([0; 2]) };
        let words: Vec<u32> = read_buffer(gpu, fill)?;
        Ok([0, 1].map(|n| words.get(n).copied().unwrap_or_default()))
    }

    pub(super) fn record_receivers(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        uniform: &Uniform<VolumeUniform>,
        depth: &Texture,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new().read("volume", uniform).read("depth", depth);
        self.receivers_pass.record(gpu, encoder, &bindings, &mut self.receivers, false)
    }

    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        drawn: &Drawn<'_>,
        mask: &mut Texture,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("volume", drawn.uniform)
            .read("vertices", drawn.vertices)
            .read("primitives", drawn.primitives)
            .read("receivers", &self.receivers);
        let (pipeline, group) = match &mut self.counted {
            Some(((pipeline, program), fill)) => {
                encoder.clear_buffer(&fill.raw, 0, None);
                (&*pipeline, program.bind(gpu, 0, &bindings.write("fill", fill))?)
            }
            None => (&self.draw.0, self.draw.1.bind(gpu, 0, &bindings)?),
        };
        let stencil_ops = wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Store };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(DRAW.name),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.stencil.view,
                depth_ops: None,
                stencil_ops: Some(stencil_ops),
            }),
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw_indirect(&drawn.draws.raw, 16);
        let lists = (2..).zip(drawn.layers).filter(|(_, [_, _, width, height])| width * height > 0);
        for (list, &[x, y, width, height]) in lists {
            pass.set_scissor_rect(x, y, width, height);
            pass.draw_indirect(&drawn.draws.raw, 16 * list);
        }
        drop(pass);
        self.record_mask(encoder, mask);
        Ok(())
    }

    fn record_mask(&self, encoder: &mut wgpu::CommandEncoder, mask: &mut Texture) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(MASK.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &mask.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.stencil.view,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.mask_pipeline);
        pass.set_stencil_reference(0);
        pass.draw(0..3, 0..1);
    }
}

/// Counts what is left by back faces up and by front faces down; 256 of them are none again.
fn volume_pipeline(gpu: &Gpu, shader: &Shader) -> (wgpu::RenderPipeline, Program) {
    let module = shader_module(gpu, shader);
    let face = |pass_op| wgpu::StencilFaceState {
        compare: wgpu::CompareFunction::Always,
        pass_op,
        ..Default::default()
    };
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(shader.name),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex_main"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: STENCIL,
            depth_write_enabled: None,
            depth_compare: None,
            stencil: wgpu::StencilState {
                front: face(wgpu::StencilOperation::DecrementWrap),
                back: face(wgpu::StencilOperation::IncrementWrap),
                read_mask: 0xff,
                write_mask: 0xff,
            },
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment_main"),
            compilation_options: Default::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let program = Program::new(shader, |group| pipeline.get_bind_group_layout(group));
    (pipeline, program)
}

fn mask_pipeline(gpu: &Gpu) -> wgpu::RenderPipeline {
    let module = shader_module(gpu, &MASK);
    let shadowed = wgpu::StencilFaceState { compare: wgpu::CompareFunction::NotEqual, ..Default::default() };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(MASK.name),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("fullscreen"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: STENCIL,
            depth_write_enabled: None,
            depth_compare: None,
            stencil: wgpu::StencilState { front: shadowed, back: shadowed, read_mask: 0xff, write_mask: 0 },
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(FACTOR_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
