//! Shadow maps: the depth that a light's view sees, for [`crate::direct`]. Opaque surfaces are drawn without a
//! fragment stage, masked ones with one that cuts their holes.
//!
//! They are apart from the reflective shadow maps, which are coarser: injection needs a few samples a cell, a shadow's
//! edge as many texels as it can get. All lights use one atlas, batch after batch
//! ([`crate::renderer::ShadowedLights`]).
//!
//! Depth is reversed. With 0 near and 1 far all that is a few hundred near planes away lies within some thousand steps of the
//! last bit below 1, which is more than the test in [`crate::direct`] has room for: walls 2 m from a lamp were speckled.

use lumivox::gpu::{Bindings, Gpu, GpuError, Program, Shader, Texture};
use lumivox::{wgpu, wgsl};

use crate::gpu_scene::{Draw, GpuScene, VERTEX_BUFFERS};
use crate::material_textures::MaterialTextures;
use crate::renderer::{Shade, ShadowBatch};
use crate::surface::{DEPTH_FORMAT, SURFACE, material_options};

/// The shader of opaque surfaces.
pub const OPAQUE_SHADER: Shader =
    Shader { name: "render/shadow", parts: &[wgsl::VIEW, include_str!("shadow.wgsl")] };
/// The shader of masked surfaces.
pub const MASKED_SHADER: Shader = Shader {
    name: "render/shadow masked",
    parts: &[wgsl::VIEW, SURFACE, include_str!("shadow_masked.wgsl")],
};

/// The pass.
#[derive(Debug)]
pub struct ShadowPass {
    opaque: (wgpu::RenderPipeline, Program),
    masked: (wgpu::RenderPipeline, Program),
    materials: Vec<wgpu::BindGroup>,
}

impl ShadowPass {
    /// Compiles it for a scene's materials.
    pub fn new(gpu: &Gpu, scene: &GpuScene, shared: &MaterialTextures) -> Result<Self, GpuError> {
        let opaque = pipeline(gpu, &OPAQUE_SHADER, None);
        let masked = pipeline(gpu, &MASKED_SHADER, Some(shared));
        let materials = scene.bind_materials(gpu, shared, &masked.1)?;
        Ok(Self { opaque, masked, materials })
    }

    /// Draws the depth of everything that the views of a batch see, 1 near to 0 far, each into its tile of the atlas. Objects with
    /// visibility fields are left out where these stand for them.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        batch: &ShadowBatch,
        atlas: &Texture,
    ) -> Result<(), GpuError> {
        gpu.check()?;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(OPAQUE_SHADER.name),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &atlas.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_vertex_buffer(0, scene.shapes.raw.slice(..));
        pass.set_vertex_buffer(1, scene.paints.raw.slice(..));
        pass.set_index_buffer(scene.indices.raw.slice(..), wgpu::IndexFormat::Uint32);
        for (is_masked, (pipeline, program)) in [(false, &self.opaque), (true, &self.masked)] {
            let with_casters = matches!(batch.shade, Shade::Maps | Shade::Leaves(_) | Shade::Volumes(_));
            let left_out = match batch.shade {
                Shade::Leaves(_) => Some(true),
                Shade::Volumes(_) => Some(false),
                _ => None,
            };
            let draws = || {
                let all = scene.draws.iter().filter(|d| d.is_masked == is_masked);
                let is_in = |d: &&Draw| left_out != Some(d.is_masked) || !d.in_camera;
                all.filter(is_in).filter(|d| with_casters || !d.is_caster)
            };
            if draws().next().is_none() {
                continue;
            }
            pass.set_pipeline(pipeline);
            for tile in &batch.tiles {
                let bindings = Bindings::new().read("view", &tile.view).read("instances", &scene.instances);
                pass.set_bind_group(0, &program.bind(gpu, 0, &bindings)?, &[]);
                let (corner, size) = (tile.corner.as_vec2(), tile.size as f32);
                pass.set_viewport(corner.x, corner.y, size, size, 0.0, 1.0);
                pass.set_scissor_rect(tile.corner.x, tile.corner.y, tile.size, tile.size);
                for draw in draws() {
                    if is_masked {
                        pass.set_bind_group(1, &self.materials[draw.material], &[]);
                    }
                    let instances = draw.instance..draw.instance + 1;
                    pass.draw_indexed(draw.indices.0..draw.indices.1, draw.base_vertex, instances);
                }
            }
        }
        Ok(())
    }
}

/// With a fragment stage if it is given materials to look up.
fn pipeline(
    gpu: &Gpu,
    shader: &Shader,
    materials: Option<&MaterialTextures>,
) -> (wgpu::RenderPipeline, Program) {
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(shader.name),
        source: wgpu::ShaderSource::Wgsl(shader.source().into()),
    });
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(shader.name),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: if materials.is_some() { &VERTEX_BUFFERS } else { &VERTEX_BUFFERS[..1] },
        },
        primitive: wgpu::PrimitiveState { cull_mode: None, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: materials.map(|shared| wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: material_options(shared),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let program = Program::new(shader, |group| pipeline.get_bind_group_layout(group));
    (pipeline, program)
}
