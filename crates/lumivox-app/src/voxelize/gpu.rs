//! Meshes to a volume on a GPU, by any of the library's methods.

use std::ops::ControlFlow;

use anyhow::{Result, bail};
use glam::Vec4;
use lumivox::VolumeBuffer;
use lumivox::gpu::{Gpu, read_buffer};
use lumivox::voxelize::{Coverage, Directions, Mesh, Method, Options, Voxelizer};
use lumivox::wgpu::CommandEncoderDescriptor;
use lumivox_scene::Scene;
use lumivox_voxels::{GridSpec, SparseBuilder, SparseVolume, VoxelizeOptions};

use super::args::{ColorArg, CoverageArg, MethodArg, VoxelizeArgs};
use super::device::Work;
use super::model::Surfaces;
use super::report::sides;
use super::{slabs, upload};
use crate::clock;

/// Refuses what a method cannot do, or no GPU.
pub(super) fn check(args: &VoxelizeArgs, method: MethodArg) -> Result<()> {
    if args.snap != 0.0 {
        bail!("--snap moves corners on the CPU alone");
    }
    let coverage = args.coverage();
    if method.is_sampled() && coverage != CoverageArg::Sampled {
        let coverage = format!("{coverage:?}").to_lowercase();
        bail!("--method {} samples, and knows no {coverage} coverage", method.name());
    }
    let channel = args.channels.iter().find(|channel| channel.name() != "occupancy");
    if let (MethodArg::Slicemap, Some(channel)) = (method, channel) {
        bail!("--method slicemap holds a bit a cell, and no channels such as {}", channel.name());
    }
    Ok(())
}

/// A volume, and how it came about.
pub(super) struct Outcome {
    pub(super) volume: SparseVolume,
    /// Milliseconds that the GPU worked on it.
    pub(super) ms: f64,
    /// Parts that it was done in.
    pub(super) slabs: u32,
}

/// Slab by slab from the GPU's bindings to a volume whose memory follows the surface.
pub(super) fn voxelize(work: &Work<'_>, gpu: &Gpu, method: MethodArg) -> Result<Outcome> {
    let Work { args, scene, grid, stages, .. } = work;
    let memory = args.memory << 20;
    let surfaces = Surfaces::new(scene, false);
    let model = surfaces.model(scene);
    let progress = |progress| -> ControlFlow<()> { stages.report(progress) };
    let kept: Vec<_> = work.channels.iter().map(|channel| channel.channel(args.color)).collect();
    let on_cpu = VoxelizeOptions {
        grid: GridSpec::Grid(*grid),
        coverage: args.coverage().into(),
        channels: kept.clone(),
        solid: args.solid,
        memory_limit: memory,
        progress: Some(&progress),
        ..VoxelizeOptions::default()
    };
    lumivox_voxels::check_memory(&model, &on_cpu)?;
    let brightest = scene.materials.iter().map(|m| m.emission.max_element()).fold(0.0, f32::max);
    // A range has a width.
    let brightest = if brightest > 1e-20 { brightest } else { 1.0 };
    let channels: Vec<_> = work.channels.iter().map(|c| c.gpu_channel(args.color, brightest)).collect();
    let layers = slabs::layers(gpu, grid, &channels, memory)?;
    stages.enter("compile");
    let options = options(method, args.coverage());
    let mut voxelizer = Voxelizer::for_slabs(gpu, *grid, layers, &channels, &options)?;
    let mut values = voxelizer.volume(gpu)?;
    stages.enter("upload");
    let paints = !channels.is_empty();
    let meshes = upload::meshes(gpu, scene, paints, args.color == ColorArg::Nearest)?;
    let meshes: Vec<&Mesh> = meshes.iter().collect();
    gpu.queue.submit([]);
    gpu.wait()?;

    let mut builder = SparseBuilder::new(*grid, kept)?;
    let mut ms = 0.0;
    for first in (0..grid.dims.z).step_by(layers as usize) {
        stages.enter("cells");
        let start = clock::millis();
        voxelizer.move_to_layer(gpu, first);
        let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        voxelizer.record(gpu, &mut encoder, &meshes, &mut values)?;
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()?;
        ms += clock::millis() - start;
        stages.enter("read back");
        read_slab(gpu, &voxelizer, &values, work, &mut builder)?;
        if builder.bytes() > memory {
            bail!(
                "the voxels of a grid of {} cells do not fit into the memory that --memory allows",
                sides(grid.dims)
            );
        }
    }
    let volume = builder.finish();
    let volume = if args.solid { volume.filled(&model, &on_cpu)? } else { volume };
    Ok(Outcome { volume, ms, slabs: grid.dims.z.div_ceil(layers) })
}

/// Appends what the GPU has found in a slab.
fn read_slab(
    gpu: &Gpu,
    voxelizer: &Voxelizer,
    values: &VolumeBuffer,
    work: &Work<'_>,
    builder: &mut SparseBuilder,
) -> Result<()> {
    let occupied: Vec<u32> = read_buffer(gpu, voxelizer.occupancy())?;
    let mut channels = Vec::with_capacity(work.channels.len());
    for channel in work.channels {
        let (Some(buffer), Some(format)) = (values.channel(channel.name()), values.format(channel.name()))
        else {
            bail!("the GPU has no channel {}", channel.name());
        };
        channels.push((read_buffer::<u32>(gpu, buffer)?, format, channel.name() == "normal"));
    }
    builder.push(voxelizer.layers().len() as u32, &occupied, |n, cell| {
        let (words, format, is_normal) = &channels[n];
        let width = format.words() as usize;
        let value = format.unpack(&words[width * cell..width * (cell + 1)]);
        if *is_normal { unit(value) } else { value }
    })?;
    Ok(())
}

/// A mean normal shorter than this is what rounding leaves of normals that cancel.
const CANCELLED: f32 = 1e-4;

/// At unit length; zero where normals cancel.
fn unit(mean: Vec4) -> Vec4 {
    let normal = mean.truncate();
    let length = normal.length();
    if length > CANCELLED { (normal / length).extend(mean.w) } else { Vec4::ZERO.with_w(mean.w) }
}

fn options(method: MethodArg, coverage: CoverageArg) -> Options {
    let method = match method {
        MethodArg::Slicing => Method::Slicing { output_vertices: None },
        MethodArg::Clipping => Method::Clipping { output_vertices: None },
        MethodArg::SlicePerPass => Method::SlicePerPass,
        MethodArg::Slicemap => Method::Slicemap(Directions::Three),
        MethodArg::Direct | MethodArg::Cpu => Method::Direct,
    };
    let coverage = match coverage {
        CoverageArg::Exact => Coverage::Exact,
        CoverageArg::Thin => Coverage::Thin,
        CoverageArg::Sampled => Coverage::Sampled,
    };
    Options { method, coverage, ..Options::default() }
}

/// Triangles with a corner that is not finite where it stands.
pub(super) fn skipped_triangles(scene: &Scene) -> u64 {
    let skipped = scene.instances.iter().map(|instance| {
        let mesh = &scene.meshes[instance.mesh];
        let is_finite = |&corner: &u32| {
            let position = mesh.positions.get(corner as usize);
            position.is_some_and(|&p| instance.world_from_local.transform_point3(p.into()).is_finite())
        };
        mesh.indices.iter().filter(|triangle| !triangle.iter().all(is_finite)).count() as u64
    });
    skipped.sum()
}
