//! Meshes to a volume on a GPU, by any of the library's methods.

use anyhow::{Result, bail};
use glam::Vec4;
use lumivox::gpu::Gpu;
use lumivox::voxelize::{Coverage, Directions, Mesh, Method, Options, Voxelizer};
use lumivox::wgpu::CommandEncoderDescriptor;
use lumivox_core::Grid;
use lumivox_scene::Scene;
use lumivox_voxels::SparseVolume;
use rayon::prelude::*;

use super::args::{ColorArg, CoverageArg, MethodArg, VoxelizeArgs};
use super::device::Work;
use super::report::sides;
use super::upload;
use crate::clock;

/// Refuses what a method cannot do, or no GPU.
pub(super) fn check(args: &VoxelizeArgs, method: MethodArg) -> Result<()> {
    if args.solid {
        bail!("--solid is filled on the CPU alone");
    }
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

/// The volume, and the milliseconds that the GPU worked on it.
pub(super) fn voxelize(work: &Work<'_>, gpu: &Gpu, method: MethodArg) -> Result<(SparseVolume, f64)> {
    let Work { args, scene, grid, stages, .. } = work;
    check_memory(work)?;
    let brightest = scene.materials.iter().map(|m| m.emission.max_element()).fold(0.0, f32::max);
    // A range has a width.
    let brightest = if brightest > 1e-20 { brightest } else { 1.0 };
    let channels: Vec<_> = work.channels.iter().map(|c| c.gpu_channel(args.color, brightest)).collect();
    stages.enter("compile");
    let mut voxelizer = Voxelizer::new(gpu, *grid, &channels, &options(method, args.coverage()))?;
    let mut values = voxelizer.volume(gpu)?;
    stages.enter("upload");
    let paints = !channels.is_empty();
    let meshes = upload::meshes(gpu, scene, paints, args.color == ColorArg::Nearest)?;
    gpu.queue.submit([]);
    gpu.wait()?;

    stages.enter("cells");
    let meshes: Vec<&Mesh> = meshes.iter().collect();
    let start = clock::millis();
    let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
    voxelizer.record(gpu, &mut encoder, &meshes, &mut values)?;
    gpu.queue.submit([encoder.finish()]);
    gpu.wait()?;
    let ms = clock::millis() - start;

    stages.enter("read back");
    let occupied = voxelizer.read_occupancy(gpu)?;
    let mut values = values.read_back(gpu)?;
    let normals = values.channel("normal").map(|means| means.par_iter().map(|&mean| unit(mean)).collect());
    if let Some(normals) = normals {
        values.insert("normal", normals);
    }
    let mut lists: Vec<(lumivox_voxels::Channel, &[Vec4])> = Vec::with_capacity(channels.len());
    for channel in work.channels {
        let list = values.channel(channel.name());
        lists.push((channel.channel(args.color), list.unwrap_or_default()));
    }
    Ok((SparseVolume::from_dense(*grid, &occupied, &lists)?, ms))
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

/// Bytes of a cell while it is read back: whether it is occupied, the words of one channel in three copies of up to four words,
/// and four floats for each channel.
fn cell_bytes(channels: usize) -> u64 {
    if channels == 0 { 2 } else { 2 + 48 + 16 * channels as u64 }
}

/// All cells of the grid come back, empty ones too.
fn check_memory(work: &Work<'_>) -> Result<()> {
    let Grid { dims, .. } = work.grid;
    let cells = work.grid.cell_count();
    if cells > u64::from(u32::MAX) {
        bail!("a grid of {} has {cells} cells, and on a GPU there are at most {}", sides(dims), u32::MAX);
    }
    let needed = (cells * cell_bytes(work.channels.len())).div_ceil(1 << 20);
    if needed > work.args.memory {
        bail!(
            "a grid of {} cells comes back from the GPU in {needed} MiB of memory, and --memory allows {}; the CPU's memory follows the surface",
            sides(dims),
            work.args.memory
        );
    }
    Ok(())
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
