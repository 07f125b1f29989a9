//! Passes over triangles, texels and pixels.

use super::super::settings::CullSettings;
use super::super::{PIXEL, VOLUME};
use super::{MapUniform, Seen};
use crate::gpu::{
    Bindings, Buffer, ComputePass, Gpu, GpuError, Program, Shader, Texture, Uniform, shader_module,
};
use crate::voxelize::UNWRITTEN;

pub(super) const MAP: &str = include_str!("map.wgsl");
pub(super) const CORNERS: &str = include_str!("corners.wgsl");
const RECT: &str = include_str!("rect.wgsl");

const RECTS: Shader =
    Shader { name: "volumes/rects", parts: &[VOLUME, MAP, CORNERS, include_str!("rects.wgsl")] };
const PLACES: Shader = Shader { name: "volumes/places", parts: &[VOLUME, MAP, include_str!("places.wgsl")] };
const FOOTPRINT: Shader = Shader {
    name: "volumes/footprint",
    parts: &[VOLUME, MAP, CORNERS, RECT, include_str!("footprint.wgsl")],
};
const OUTLINE: Shader =
    Shader { name: "volumes/outline", parts: &[VOLUME, MAP, RECT, include_str!("outline.wgsl")] };
const COVER: Shader =
    Shader { name: "volumes/cover", parts: &[VOLUME, MAP, RECT, include_str!("cover.wgsl")] };
const REDUCE: Shader =
    Shader { name: "volumes/reduce", parts: &[VOLUME, MAP, RECT, include_str!("reduce.wgsl")] };
const PIXELS: Shader =
    Shader { name: "volumes/pixels", parts: &[VOLUME, PIXEL, MAP, include_str!("pixels.wgsl")] };
const VISIBLE: Shader =
    Shader { name: "volumes/visible", parts: &[VOLUME, MAP, CORNERS, include_str!("visible.wgsl")] };
const SLICES: Shader =
    Shader { name: "volumes/slices", parts: &[VOLUME, MAP, CORNERS, include_str!("slices.wgsl")] };

pub(super) const SHADERS: &[Shader] =
    &[RECTS, PLACES, FOOTPRINT, OUTLINE, COVER, REDUCE, PIXELS, VISIBLE, SLICES];

/// A pipeline over triangles, and a target that nothing is written to.
#[derive(Debug)]
pub(super) struct Raster {
    name: &'static str,
    pub(super) pipeline: wgpu::RenderPipeline,
    pub(super) program: Program,
}

impl Raster {
    pub(super) fn new(gpu: &Gpu, shader: &Shader) -> Self {
        let module = shader_module(gpu, shader);
        let nothing =
            wgpu::ColorTargetState { format: UNWRITTEN, blend: None, write_mask: wgpu::ColorWrites::empty() };
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
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment_main"),
                compilation_options: Default::default(),
                targets: &[Some(nothing)],
            }),
            multiview_mask: None,
            cache: None,
        });
        let program = Program::new(shader, |group| pipeline.get_bind_group_layout(group));
        Self { name: shader.name, pipeline, program }
    }

    /// Two triangles for each of `count` triangles or edges.
    fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (target, bindings): (&Texture, &Bindings<'_>),
        count: u32,
    ) -> Result<(), GpuError> {
        let group = self.program.bind(gpu, 0, bindings)?;
        let mut pass = begin(encoder, self.name, target, None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..6 * count, 0..1);
        Ok(())
    }
}

/// A render pass over a target that nothing is written to.
pub(super) fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    name: &'static str,
    target: &Texture,
    queries: Option<&wgpu::QuerySet>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Discard,
            },
        })],
        occlusion_query_set: queries,
        ..Default::default()
    })
}

/// The passes.
#[derive(Debug)]
pub(super) struct Stages {
    pub(super) rects: ComputePass,
    pub(super) places: ComputePass,
    pub(super) cover: ComputePass,
    pub(super) reduce: ComputePass,
    pixels: ComputePass,
    footprint: Raster,
    outline: Raster,
    /// Where receivers are whole meshes.
    receivers: Option<(Raster, Raster, Texture)>,
    map_target: Texture,
}

impl Stages {
    pub(super) fn new(gpu: &Gpu, settings: &CullSettings, picture: [u32; 2]) -> Result<Self, GpuError> {
        let pass = |shader: &Shader| ComputePass::new(gpu, shader, &[]);
        let target = |size| Texture::target(gpu, "volumes/nothing", size, UNWRITTEN);
        let receivers = || Ok((Raster::new(gpu, &VISIBLE), Raster::new(gpu, &SLICES), target(picture)?));
        Ok(Self {
            rects: pass(&RECTS),
            places: pass(&PLACES),
            cover: pass(&COVER),
            reduce: pass(&REDUCE),
            pixels: pass(&PIXELS),
            footprint: Raster::new(gpu, &FOOTPRINT),
            outline: Raster::new(gpu, &OUTLINE),
            receivers: (!settings.by_pixel).then(receivers).transpose()?,
            map_target: target([settings.map_size; 2])?,
        })
    }

    /// What of casters lies in which texel.
    pub(super) fn record_footprints(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        &Seen { uniform, casters, volumes, .. }: &Seen<'_>,
        map: &Uniform<MapUniform>,
        (rects, footprints): (&Buffer, &mut Buffer),
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("map", map)
            .read("vertices", &casters.vertices)
            .read("triangles", &casters.triangles)
            .read("facing", &volumes.facing)
            .read("rects", rects)
            .write("footprints", footprints);
        self.footprint.record(gpu, encoder, (&self.map_target, &bindings), casters.triangle_count)?;
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("map", map)
            .read("vertices", &casters.vertices)
            .read("edges", &casters.edges)
            .read("edge_casters", &casters.edge_casters)
            .read("nets", &volumes.nets)
            .read("rects", rects)
            .write("footprints", footprints);
        self.outline.record(gpu, encoder, (&self.map_target, &bindings), casters.edge_count)
    }

    /// Bits of the layers of all pixels.
    pub(super) fn record_pixels(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        &Seen { uniform, depth, receivers, .. }: &Seen<'_>,
        map: &Uniform<MapUniform>,
        slices: &mut Buffer,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("map", map)
            .read("depth", depth)
            .read("receivers", receivers)
            .write("slices", slices);
        let [width, height] = receivers.size();
        self.pixels.record(gpu, encoder, &bindings, [width.div_ceil(8), height.div_ceil(8), 1])
    }

    /// Which meshes show in the picture.
    pub(super) fn record_visible(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        &Seen { uniform, casters, receivers, .. }: &Seen<'_>,
        visible: &mut Buffer,
    ) -> Result<(), GpuError> {
        let Some((pass, _, target)) = &self.receivers else { return Ok(()) };
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("vertices", &casters.vertices)
            .read("triangles", &casters.triangles)
            .read("receivers", receivers)
            .write("visible", visible);
        pass.record(gpu, encoder, (target, &bindings), casters.triangle_count)
    }

    /// Bits of the layers of all triangles of such meshes.
    pub(super) fn record_slices(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        &Seen { uniform, casters, .. }: &Seen<'_>,
        map: &Uniform<MapUniform>,
        (visible, slices): (&Buffer, &mut Buffer),
    ) -> Result<(), GpuError> {
        let Some((_, pass, _)) = &self.receivers else { return Ok(()) };
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("map", map)
            .read("vertices", &casters.vertices)
            .read("triangles", &casters.triangles)
            .read("visible", visible)
            .write("slices", slices);
        pass.record(gpu, encoder, (&self.map_target, &bindings), casters.triangle_count)
    }
}
