//! Rasterizes surfaces: the camera's G-buffer and the lights' reflective shadow maps.
//!
//! | target | format | G-buffer | reflective shadow map |
//! | --- | --- | --- | --- |
//! | normal | `Rgba16Float` | facing the camera | facing the light |
//! | albedo | `Rgba16Float` | yes | yes |
//! | emission | `Rgba16Float` | yes | yes |
//! | radiance | `Rgba32Float`, `Rgba16Float` | by [`crate::direct`] | what the surface reflects of this light |
//! | depth | `Depth32Float` | yes | yes; also the shadow map |
//!
//! The camera's alpha of normal and emission together are the triangle's own normal, octahedral, which the shadow test
//! needs ([`crate::direct`]).
//!
//! The camera's depth is reversed (1 near, 0 far), which keeps a tenth of a millimetre over any distance; shadow maps have the
//! standard one. Four colour targets of 8 bytes are just what core WebGPU allows. Masked surfaces have holes in all of them.

use glam::UVec2;
use lumivox::core::View;
use lumivox::gpu::{Bindings, Gpu, GpuError, Program, Shader, Texture, Uniform};
use lumivox::progressive::{InjectionScale, ViewInput, ViewTextures};
use lumivox::wgpu::{self, TextureFormat};
use lumivox::wgsl;

use crate::gpu_scene::{GpuScene, VERTEX_BUFFERS};
use crate::lights::{LIGHTS, LightUniform};
use crate::material_textures::MaterialTextures;

pub(crate) const SURFACE: &str = include_str!("surface.wgsl");

/// The G-buffer's shader.
pub const GBUFFER_SHADER: Shader = Shader {
    name: "render/gbuffer",
    parts: &[wgsl::VIEW, wgsl::OCTAHEDRON, SURFACE, include_str!("gbuffer.wgsl")],
};
/// The reflective shadow maps' shader.
pub const RSM_SHADER: Shader =
    Shader { name: "render/rsm", parts: &[wgsl::VIEW, LIGHTS, SURFACE, include_str!("rsm.wgsl")] };

/// Format of depth targets.
pub const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;
/// Format of normals, emission and radiance.
pub const HDR_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Format of the camera's radiance, a sum over hundreds of samples of area lights.
pub const RADIANCE_FORMAT: TextureFormat = TextureFormat::Rgba32Float;
/// Format of albedo. Eight bits of sRGB would be as large a target on core WebGPU, and off by some percent in dark colours.
pub const ALBEDO_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// Targets of `size` texels; `radiance` is the format of the light they hold.
pub fn targets(
    gpu: &Gpu,
    label: &str,
    size: UVec2,
    radiance: TextureFormat,
) -> Result<ViewTextures, GpuError> {
    let target =
        |name: &str, format| Texture::target(gpu, &format!("{label}/{name}"), size.to_array(), format);
    Ok(ViewTextures {
        depth: target("depth", DEPTH_FORMAT)?,
        normal: target("normal", HDR_FORMAT)?,
        albedo: target("albedo", ALBEDO_FORMAT)?,
        emission: target("emission", HDR_FORMAT)?,
        radiance: target("radiance", radiance)?,
    })
}

/// A view with its targets.
#[derive(Debug)]
pub struct SurfaceView {
    /// What Lumivox is given.
    pub input: ViewInput,
    /// Where it stands.
    pub view: View,
}

impl SurfaceView {
    /// A view into targets that it may share with others, injected at `points` points.
    pub fn new(gpu: &Gpu, label: &str, textures: ViewTextures, points: UVec2, view: View) -> Self {
        Self { input: ViewInput::new(gpu, label, textures, points), view }
    }

    /// Writes where the view stands. Once per frame, before recording.
    pub fn update(&self, gpu: &Gpu, scale: InjectionScale) {
        self.input.update(gpu, &self.view, scale);
    }

    /// Records the start of direct light: none yet.
    pub fn record_clear_radiance(&mut self, encoder: &mut wgpu::CommandEncoder) {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("render/clear radiance"),
            color_attachments: &[color(&self.input.textures.radiance)],
            ..Default::default()
        });
    }
}

/// A pipeline that draws the scene, and its materials' bind groups.
#[derive(Debug)]
pub struct SurfacePass {
    name: &'static str,
    pipeline: wgpu::RenderPipeline,
    program: Program,
    materials: Vec<wgpu::BindGroup>,
    is_rsm: bool,
}

impl SurfacePass {
    /// The pass that makes G-buffers.
    pub fn gbuffer(gpu: &Gpu, scene: &GpuScene, shared: &MaterialTextures) -> Result<Self, GpuError> {
        Self::new(gpu, &GBUFFER_SHADER, false, scene, shared)
    }

    /// The pass that makes reflective shadow maps.
    pub fn rsm(gpu: &Gpu, scene: &GpuScene, shared: &MaterialTextures) -> Result<Self, GpuError> {
        Self::new(gpu, &RSM_SHADER, true, scene, shared)
    }

    fn new(
        gpu: &Gpu,
        shader: &Shader,
        is_rsm: bool,
        scene: &GpuScene,
        shared: &MaterialTextures,
    ) -> Result<Self, GpuError> {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(shader.name),
            source: wgpu::ShaderSource::Wgsl(shader.source().into()),
        });
        let mut targets = vec![Some(HDR_FORMAT.into()), Some(ALBEDO_FORMAT.into()), Some(HDR_FORMAT.into())];
        if is_rsm {
            targets.push(Some(HDR_FORMAT.into()));
        }
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(shader.name),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &VERTEX_BUFFERS,
            },
            // Both sides are drawn: surfaces reflect on both.
            primitive: wgpu::PrimitiveState { cull_mode: None, ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(if is_rsm {
                    wgpu::CompareFunction::Less
                } else {
                    wgpu::CompareFunction::Greater
                }),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: material_options(shared),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        });
        let program = Program::new(shader, |group| pipeline.get_bind_group_layout(group));
        let materials = scene.bind_materials(gpu, shared, &program)?;
        Ok(Self { name: shader.name, pipeline, program, materials, is_rsm })
    }

    /// Draws the scene into a view. A reflective shadow map is given its light.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        light: Option<&Uniform<LightUniform>>,
        target: &mut SurfaceView,
    ) -> Result<(), GpuError> {
        gpu.check()?;
        let mut bindings =
            Bindings::new().read("view", &target.input.uniform).read("instances", &scene.instances);
        if let Some(light) = light {
            bindings = bindings.read("light", light);
        }
        let view_group = self.program.bind(gpu, 0, &bindings)?;
        let textures = &target.input.textures;
        let mut colors = vec![color(&textures.normal), color(&textures.albedo), color(&textures.emission)];
        if self.is_rsm {
            colors.push(color(&textures.radiance));
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.name),
            color_attachments: &colors,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &textures.depth.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(if self.is_rsm { 1.0 } else { 0.0 }),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &view_group, &[]);
        pass.set_vertex_buffer(0, scene.shapes.raw.slice(..));
        pass.set_vertex_buffer(1, scene.paints.raw.slice(..));
        pass.set_index_buffer(scene.indices.raw.slice(..), wgpu::IndexFormat::Uint32);
        let mut material = usize::MAX;
        for draw in scene.draws.iter().filter(|d| d.in_camera || self.is_rsm) {
            if draw.material != material {
                material = draw.material;
                pass.set_bind_group(1, &self.materials[material], &[]);
            }
            let instances = draw.instance..draw.instance + 1;
            pass.draw_indexed(draw.indices.0..draw.indices.1, draw.base_vertex, instances);
        }
        Ok(())
    }
}

/// How fragment stages look materials up.
pub(crate) fn material_options(shared: &MaterialTextures) -> wgpu::PipelineCompilationOptions<'static> {
    wgpu::PipelineCompilationOptions { constants: shared.constants(), ..Default::default() }
}

fn color(target: &Texture) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view: &target.view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            store: wgpu::StoreOp::Store,
        },
    })
}
