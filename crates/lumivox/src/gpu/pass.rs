//! Compute and full-screen passes. A pass is made once, holds its pipeline, and is recorded any number of times.

use super::{Bindings, Buffer, GeneratedText, Gpu, GpuError, Program, Shader, Texture};

/// A compute pass: one entry point, `main`.
#[derive(Debug)]
pub struct ComputePass {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
    program: Program,
}

impl ComputePass {
    /// Compiles the pass. `constants` are the shader's `override` declarations: numbers that Rust defines once.
    pub fn new(gpu: &Gpu, shader: &Shader, constants: &[(&str, f64)]) -> Self {
        Self::of_text(gpu, &GeneratedText { name: shader.name, source: shader.source() }, constants)
    }

    /// The same of a text that was put together at run time.
    pub(crate) fn of_text(gpu: &Gpu, text: &GeneratedText, constants: &[(&str, f64)]) -> Self {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(text.name),
            source: wgpu::ShaderSource::Wgsl(text.source.as_str().into()),
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(text.name),
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        let program = Program::of_text(text, |group| pipeline.get_bind_group_layout(group));
        Self { name: text.name, pipeline, program }
    }

    /// The shader's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Records one dispatch of `groups` workgroups.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bindings: &Bindings<'_>,
        groups: [u32; 3],
    ) -> Result<(), GpuError> {
        self.begin(gpu, encoder, bindings)?.dispatch_workgroups(groups[0], groups[1], groups[2]);
        Ok(())
    }

    /// Records one dispatch whose numbers of workgroups lie in a buffer when it runs, from byte `offset` on.
    pub fn record_indirect(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bindings: &Bindings<'_>,
        groups: &Buffer,
        offset: u64,
    ) -> Result<(), GpuError> {
        self.begin(gpu, encoder, bindings)?.dispatch_workgroups_indirect(&groups.raw, offset);
        Ok(())
    }

    fn begin<'e>(
        &self,
        gpu: &Gpu,
        encoder: &'e mut wgpu::CommandEncoder,
        bindings: &Bindings<'_>,
    ) -> Result<wgpu::ComputePass<'e>, GpuError> {
        gpu.check()?;
        let bind_group = self.program.bind(gpu, 0, bindings)?;
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(self.name),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        Ok(pass)
    }
}

/// A pass that runs its fragment shader (`fragment`) once per pixel of a target. The vertex stage is `fullscreen`, from the
/// shared module of that name.
#[derive(Debug)]
pub struct FullscreenPass {
    name: &'static str,
    pipeline: wgpu::RenderPipeline,
    program: Program,
}

impl FullscreenPass {
    /// Compiles the pass for one target format. With `additive` the result is added to what the target holds.
    pub fn new(gpu: &Gpu, shader: &Shader, format: wgpu::TextureFormat, additive: bool) -> Self {
        Self::with_constants(gpu, shader, format, additive, &[])
    }

    /// As [`Self::new`]; `constants` are the fragment stage's `override` declarations.
    pub fn with_constants(
        gpu: &Gpu,
        shader: &Shader,
        format: wgpu::TextureFormat,
        additive: bool,
        constants: &[(&str, f64)],
    ) -> Self {
        let module = shader_module(gpu, shader);
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let target = wgpu::ColorTargetState {
            format,
            blend: additive.then_some(wgpu::BlendState { color: add, alpha: add }),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(shader.name),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("fullscreen"),
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
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        });
        let program = Program::new(shader, |group| pipeline.get_bind_group_layout(group));
        Self { name: shader.name, pipeline, program }
    }

    /// Records the pass. The target is kept when `keep` is set (an additive pass), else cleared to black first.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bindings: &Bindings<'_>,
        target: &mut Texture,
        keep: bool,
    ) -> Result<(), GpuError> {
        gpu.check()?;
        let bind_group = self.program.bind(gpu, 0, bindings)?;
        let load = if keep { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.draw(0..3, 0..1);
        Ok(())
    }
}

/// Compiles a shader.
pub(crate) fn shader_module(gpu: &Gpu, shader: &Shader) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(shader.name),
        source: wgpu::ShaderSource::Wgsl(shader.source().into()),
    })
}
