//! A pass that runs its fragment shader in listed tiles alone.

use super::tiles::Tiles;
use crate::gpu::{Bindings, Gpu, GpuError, Program, Shader, Texture, shader_module};

/// A pipeline of `tile_corner` and `fragment`, for one target format.
#[derive(Debug)]
pub(super) struct TiledPass {
    name: &'static str,
    pipeline: wgpu::RenderPipeline,
    program: Program,
}

impl TiledPass {
    /// Compiles the pass. `constants` are the fragment stage's `override` declarations.
    pub(super) fn new(
        gpu: &Gpu,
        shader: &Shader,
        format: wgpu::TextureFormat,
        constants: &[(&str, f64)],
    ) -> Self {
        let module = shader_module(gpu, shader);
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(shader.name),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("tile_corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let program = Program::new(shader, |group| pipeline.get_bind_group_layout(group));
        Self { name: shader.name, pipeline, program }
    }

    /// Clears the target to what pixels of other tiles keep, and draws the tiles that have objects.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bindings: &Bindings<'_>,
        tiles: &Tiles,
        (target, rest): (&mut Texture, wgpu::Color),
    ) -> Result<(), GpuError> {
        gpu.check()?;
        let bind_group = self.program.bind(gpu, 0, bindings)?;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(rest), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.draw_indirect(&tiles.draw.raw, 0);
        Ok(())
    }
}
