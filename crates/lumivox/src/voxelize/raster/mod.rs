//! What the rasterizing methods share: a pipeline whose fragments write cells, and the geometry stage that core WebGPU lacks.
//!
//! The papers render into the layers of a 3D texture that a geometry shader picks, and blend the three sweeps with MAX. Core WebGPU has
//! neither geometry shaders nor layers that a vertex stage picks. Two stand-ins are possible: an atlas with all slices side by side, or
//! fragments that write to buffers themselves. We take the second:
//!
//! - an atlas holds the three sweeps apart and fuses them afterwards: at 256 cells a side clearing and fusing take several times as long
//!   as drawing, and a target more costs as much again. Fragments touch occupied cells alone, and all sweeps share the sums.
//! - blending knows MAX, and sums that saturate in half floats. Integer sums have all [rules](super::Rule), MAX among them.
//! - a slice is a number that a fragment is compared with, so that the grid may be larger than an atlas.
//!
//! A pass without a target is not allowed, so there is one of a byte per pixel that nothing is written to.
//!
//! **The same cells everywhere.** A rasterizer moves corners to a grid of 1/256 of a pixel, or as coarse as it likes down to 1/16. So outlines are
//! drawn 1/16 of a pixel wider, and each fragment asks in single precision whether the column's centre lies in the triangle, and in which slice.
//!
//! **Cost.** On a software driver with two threads a primitive of a few pixels takes about a microsecond: the 69,451 triangles of the Stanford bunny
//! at 128 cells take 130 ms by clipping or slicing and 55 ms for a slicemap of one direction, where [`direct`](super::direct) takes 8. Of 48 triangles as large
//! as the grid all three take 6.5 ms for occupancy; with a channel of albedo slicing takes 24, clipping 30 and direct 40.

mod expansion;

use super::method::{Job, Options};
use super::text::{Layout, Phase, method_text};
use super::{Coverage, Mesh};
use crate::gpu::{GeneratedText, Gpu, GpuError, Texture, bind_group_layouts, validated};
use lumivox_core::Grid;

pub(super) use expansion::{Expansion, Geometry, texts};

const PRIMITIVE: &str = include_str!("primitive.wgsl");
const FRAGMENT: &str = include_str!("fragment.wgsl");

/// A byte for each pixel, which nothing is written to.
pub(crate) const UNWRITTEN: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Which triangles a sweep draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Faces {
    /// Those that face its axis most.
    Dominant,
    /// All.
    Every,
}

/// The text of a draw, for plain meshes or for all: everything but the vertex stage, which `vertex` holds.
pub(super) fn draw_text(
    name: &'static str,
    (layout, options, phase): (&Layout, &Options, Phase),
    is_plain: bool,
    faces: Faces,
    vertex: &[&str],
) -> GeneratedText {
    let common = method_text(layout, &sampled(options), phase, is_plain);
    let head = format!("const LV_EVERY_FACE: bool = {};", faces == Faces::Every);
    let vertex = vertex.join("\n");
    GeneratedText { name, source: [&common, &head, PRIMITIVE, FRAGMENT, &vertex].join("\n") }
}

/// The only coverage of rasterizers.
fn sampled(options: &Options) -> Options {
    Options { coverage: Coverage::Sampled, ..*options }
}

/// Pipelines that draw slices, and their target.
#[derive(Debug)]
pub(super) struct Raster {
    name: &'static str,
    /// For plain meshes, and for all others.
    pipelines: [wgpu::RenderPipeline; 2],
    target: Texture,
    grid: Grid,
}

impl Raster {
    /// `text` makes the text for plain meshes or for all.
    pub(super) fn new(
        gpu: &Gpu,
        grid: &Grid,
        text: impl Fn(bool) -> GeneratedText,
    ) -> Result<Self, GpuError> {
        let (plain, full) = (text(true), text(false));
        let side = grid.dims.max_element();
        let target = Texture::target(gpu, full.name, [side, side], UNWRITTEN)?;
        let pipelines = [pipeline(gpu, &plain)?, pipeline(gpu, &full)?];
        Ok(Self { name: full.name, pipelines, target, grid: *grid })
    }

    /// The pipeline for a mesh.
    pub(super) fn pipeline(&self, mesh: &Mesh) -> &wgpu::RenderPipeline {
        &self.pipelines[usize::from(!mesh.is_plain())]
    }

    /// Begins a pass in which a pixel is a column along `axis`.
    pub(super) fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        job: &Job<'_>,
        axis: usize,
        faces: Faces,
    ) -> wgpu::RenderPass<'e> {
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
        let dims = self.grid.dims.to_array();
        let [width, height] = [dims[(axis + 1) % 3], dims[(axis + 2) % 3]];
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, width, height);
        pass.set_bind_group(0, &job.groups[if faces == Faces::Every { 3 } else { axis }], &[]);
        if let Some(functions) = job.functions {
            pass.set_bind_group(2, functions, &[]);
        }
        pass
    }
}

fn pipeline(gpu: &Gpu, text: &GeneratedText) -> Result<wgpu::RenderPipeline, GpuError> {
    let layouts = bind_group_layouts(gpu, text)?;
    writing_pipeline(gpu, text, &layouts.iter().map(Option::as_ref).collect::<Vec<_>>())
}

/// A pipeline whose fragments write to buffers, and to no target.
pub(crate) fn writing_pipeline(
    gpu: &Gpu,
    text: &GeneratedText,
    groups: &[Option<&wgpu::BindGroupLayout>],
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
        let nothing =
            wgpu::ColorTargetState { format: UNWRITTEN, blend: None, write_mask: wgpu::ColorWrites::empty() };
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
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment_main"),
                compilation_options: Default::default(),
                targets: &[Some(nothing)],
            }),
            multiview_mask: None,
            cache: None,
        })
    })
}

/// The sweeps that a recording takes.
pub(super) fn axes(job: &Job<'_>) -> impl Iterator<Item = usize> + use<> {
    let only = job.axis;
    (0..3).filter(move |&axis| only.is_none_or(|a| a == axis))
}

/// The batches of all meshes: the mesh, the bind group, and the number of triangles.
pub(super) fn batches<'a>(
    job: &Job<'a>,
) -> impl Iterator<Item = (&'a Mesh, &'a wgpu::BindGroup, u32)> + use<'a> {
    let meshes: &'a [&'a Mesh] = job.meshes;
    meshes.iter().flat_map(|&mesh| mesh.batches().map(move |(batch, count)| (mesh, batch, count)))
}
