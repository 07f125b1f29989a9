//! 3.1: what it gains to fill the depth buffer first, where each fragment is shaded as it is drawn.

use anyhow::{Context, Result};
use glam::{Mat4, UVec2, Vec3, Vec4};
use lumivox::core::View;
use lumivox::gpu::{Buffer, Texture};
use lumivox::slicemap::{
    Slicemap, SlicemapSettings, Transmittance, TransmittanceSettings, transmittance_wgsl,
};
use lumivox::voxelize::{IndexView, Mesh, MeshDescriptor, VertexView};
use lumivox::wgpu::{self, BufferUsages, IndexFormat, VertexFormat};
use lumivox_scene::Scene;

use super::rays::along;
use super::row;
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];

/// Positions and normals in turns, and the triangles of all of a scene's meshes.
fn geometry(scene: &Scene) -> (Vec<[[f32; 3]; 2]>, Vec<[u32; 3]>) {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for instance in &scene.instances {
        let (mesh, first) = (&scene.meshes[instance.mesh], vertices.len() as u32);
        let place = instance.world_from_local;
        vertices.extend(mesh.positions.iter().zip(&mesh.normals).map(|(&p, &n)| {
            [place.transform_point3(p.into()).to_array(), place.transform_vector3(n.into()).to_array()]
        }));
        triangles.extend(mesh.indices.iter().map(|t| t.map(|i| i + first)));
    }
    (vertices, triangles)
}

/// How a drawing compares depth, writes it, and shades.
struct Way {
    compare: wgpu::CompareFunction,
    writes_depth: bool,
    shades: bool,
}

fn pipeline(
    timer: &Timer<'_>,
    module: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
    way: &Way,
) -> wgpu::RenderPipeline {
    let target = Some(wgpu::ColorTargetState::from(COLOR));
    timer.gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("bench/forward"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 24,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &ATTRIBUTES,
            })],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(way.writes_depth),
            depth_compare: Some(way.compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: way.shades.then_some(wgpu::FragmentState {
            module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: std::slice::from_ref(&target),
        }),
        multiview_mask: None,
        cache: None,
    })
}

pub(super) fn prepass(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Depth first");
    let gpu = timer.gpu;
    let scene = lumivox_scene::builtin::tree(if quick { 0 } else { 2 });
    let size = UVec2::splat(512);
    let (vertices, triangles) = geometry(&scene);
    let upload = |bytes: &[u8], usage| {
        let usage = usage | BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let buffer = Buffer::with_usage(gpu, "bench/forward", bytes.len() as u64, usage);
        gpu.queue.write_buffer(&buffer.raw, 0, bytes);
        buffer
    };
    let points = upload(lumivox::bytemuck::cast_slice(&vertices), BufferUsages::VERTEX);
    let corners = upload(lumivox::bytemuck::cast_slice(&triangles), BufferUsages::INDEX);
    let indices = 3 * triangles.len() as u32;
    let view = VertexView { buffer: &points.raw, offset: 0, stride: 24, format: VertexFormat::Float32x3 };
    let descriptor = MeshDescriptor {
        indices: Some(IndexView {
            buffer: &corners.raw,
            offset: 0,
            format: IndexFormat::Uint32,
            count: indices,
        }),
        ..MeshDescriptor::new(view, vertices.len() as u32)
    };
    let mesh = Mesh::new(gpu, &descriptor)?;
    let sun = Vec3::new(0.5, -0.74, -0.45).normalize_or_zero();
    let mut map = Slicemap::new(gpu, SlicemapSettings { size, ..Default::default() })?;
    map.set_view(gpu, &along(&scene, sun), [0.0, 2.0 * scene.bounds().size().length()]);
    let pass = Transmittance::new(gpu, false)?;
    pass.update(gpu, &TransmittanceSettings { bias: 0.02, ..Default::default() });
    timer.submit(|e| map.record(gpu, e, &[(&mesh, 0)]))?;

    let camera = scene.cameras.first().context("the tree has a camera")?;
    let seen = View::perspective(camera.eye, camera.target, camera.up, camera.fov_y, 1.0, 0.05, 60.0);
    let words: (Mat4, Vec4) = (seen.clip_from_world, sun.extend(0.0));
    let numbers: Vec<f32> = words.0.to_cols_array().into_iter().chain(words.1.to_array()).collect();
    let uniform = Buffer::with_usage(gpu, "bench/camera", 80, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
    gpu.queue.write_buffer(&uniform.raw, 0, lumivox::bytemuck::cast_slice(&numbers));
    let text = transmittance_wgsl(0, 1) + include_str!("prepass.wgsl");
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("bench/forward"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let [slices, bits, extents] = map.buffers();
    let bound = [&uniform, slices, bits, extents, pass.buffer()];
    let kinds = [true, true, false, false, true].map(|is_uniform| match is_uniform {
        true => wgpu::BufferBindingType::Uniform,
        false => wgpu::BufferBindingType::Storage { read_only: true },
    });
    let entries: Vec<_> = (0..)
        .zip(kinds)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        })
        .collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some("bench/forward"), entries: &entries };
    let group_layout = gpu.device.create_bind_group_layout(&descriptor);
    let entries: Vec<_> = (0..)
        .zip(bound)
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.raw.as_entire_binding() })
        .collect();
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("bench/forward"),
        layout: &group_layout,
        entries: &entries,
    });
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("bench/forward"),
        bind_group_layouts: &[Some(&group_layout)],
        immediate_size: 0,
    });
    let make = |compare, writes_depth, shades| {
        pipeline(timer, &module, &layout, &Way { compare, writes_depth, shades })
    };
    let at_once = make(wgpu::CompareFunction::Less, true, true);
    let depth_alone = make(wgpu::CompareFunction::Less, true, false);
    let equal = make(wgpu::CompareFunction::Equal, false, true);
    let color = Texture::target(gpu, "bench/color", size.to_array(), COLOR)?;
    let depth = Texture::target(gpu, "bench/depth", size.to_array(), DEPTH)?;
    let draw =
        |encoder: &mut wgpu::CommandEncoder, pipeline: &wgpu::RenderPipeline, shades: bool, keeps: bool| {
            let attachment = [Some(wgpu::RenderPassColorAttachment {
                view: &color.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })];
            let load = if keeps { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(1.0) };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("bench/forward"),
                color_attachments: if shades { &attachment } else { &[] },
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth.view,
                    depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_vertex_buffer(0, points.raw.slice(..));
            pass.set_index_buffer(corners.raw.slice(..), IndexFormat::Uint32);
            pass.draw_indexed(0..indices, 0, 0..1);
        };
    let once = timer.median(|| {
        timer.submit(|e| {
            draw(e, &at_once, true, false);
            Ok(())
        })
    })?;
    let first = timer.median(|| {
        timer.submit(|e| {
            draw(e, &depth_alone, false, false);
            draw(e, &equal, true, true);
            Ok(())
        })
    })?;
    let gain = 100.0 * (once.ms / first.ms - 1.0);
    report.say(&format!(
        "The tree ({} triangles, leaves as whole cards) drawn into {} x {} pixels, each fragment asking a local slicemap of 96 slices what is left of the sun: {} ms at \
         once, and {} ms where the depth buffer is filled first, {gain:+.0} % frames per second. The paper: 20 %. Our renderer shades each pixel once from its G-buffer and \
         needs neither.",
        triangles.len(),
        size.x,
        size.y,
        ms(once.ms),
        ms(first.ms)
    ));
    report.push(row("depth first", "at once", "time", once.ms, "ms", None));
    report.push(row("depth first", "depth first", "time", first.ms, "ms", None));
    report.push(row("depth first", "depth first", "gain", gain, "%", Some(20.0)));
    Ok(())
}
