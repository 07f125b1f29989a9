//! From triangles to lists of the volumes' faces.

use super::VOLUME;
use super::casters::Casters;
use super::settings::{MAX_LAYERS, VolumeUniform};
use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform, read_buffer};
use crate::wgsl::linear_groups;

const LISTS: &str = include_str!("lists.wgsl");

pub(super) const AROUND: Shader =
    Shader { name: "volumes/around", parts: &[VOLUME, include_str!("around.wgsl")] };
pub(super) const FACING: Shader =
    Shader { name: "volumes/facing", parts: &[VOLUME, include_str!("facing.wgsl")] };
pub(super) const NETS: Shader = Shader { name: "volumes/nets", parts: &[VOLUME, include_str!("nets.wgsl")] };
pub(super) const CAPS: Shader =
    Shader { name: "volumes/caps", parts: &[VOLUME, LISTS, include_str!("caps.wgsl")] };
pub(super) const SIDES: Shader =
    Shader { name: "volumes/sides", parts: &[VOLUME, LISTS, include_str!("sides.wgsl")] };
pub(super) const PLAN: Shader = Shader { name: "volumes/plan", parts: &[VOLUME, include_str!("plan.wgsl")] };

/// Words of the buffer `lists`.
const LIST_WORDS: usize = 2 * LISTS_AT_MOST + 5;
/// Runs of layers in a binary tree, and one that is none.
const LISTS_AT_MOST: usize = 2 * MAX_LAYERS as usize;

/// How much of the volumes is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VolumeCounts {
    /// Meshes that may cast.
    pub casters: u32,
    /// Those of which anything is drawn.
    pub kept_casters: u32,
    /// Sides that are drawn, once for each run of layers that they are drawn in.
    pub sides: u32,
    /// Sides of which anything is drawn, each once.
    pub kept_sides: u32,
    /// Sides of all volumes.
    pub all_sides: u32,
    /// Triangles of sides and caps that are drawn.
    pub triangles: u32,
    /// Triangles of all volumes.
    pub all_triangles: u32,
    /// Whether there was no room for lists of layers, so that nothing was left out.
    pub is_too_long: bool,
    /// Fragments of them, where these are counted.
    pub fragments: u32,
    /// Fragments that changed the stencil.
    pub updates: u32,
}

/// The passes, and what lies between them.
#[derive(Debug)]
pub(super) struct Volumes {
    around_pass: ComputePass,
    facing_pass: ComputePass,
    nets_pass: ComputePass,
    /// Counting, emitting.
    caps_passes: [ComputePass; 2],
    sides_passes: [ComputePass; 2],
    plan_pass: ComputePass,
    around: Buffer,
    pub(super) facing: Buffer,
    pub(super) nets: Buffer,
    lists: Buffer,
    pub(super) primitives: Buffer,
    /// Of each list what an indirect draw takes.
    pub(super) draws: Buffer,
    /// Triangles in the lists.
    pub(super) capacity: u32,
}

impl Volumes {
    pub(super) fn new(gpu: &Gpu, casters: &Casters) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_storage_buffer_binding_size / 12;
        let hint = "leave out casters, or give those with many triangles a simpler stand-in";
        gpu.check_binding_size("shadow volumes", 12 * casters.most, hint)?;
        // As much again for faces that are drawn in several layers.
        let capacity = (2 * casters.most).clamp(64, limit);
        let draws = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
        let storage = |label: &str, words: u64| Buffer::storage(gpu, label, 4 * words.max(4));
        let both =
            |shader: &Shader| [0.0, 1.0].map(|emits| ComputePass::new(gpu, shader, &[("EMITS", emits)]));
        Ok(Self {
            around_pass: ComputePass::new(gpu, &AROUND, &[]),
            facing_pass: ComputePass::new(gpu, &FACING, &[]),
            nets_pass: ComputePass::new(gpu, &NETS, &[]),
            caps_passes: both(&CAPS),
            sides_passes: both(&SIDES),
            plan_pass: ComputePass::new(gpu, &PLAN, &[]),
            around: storage("volumes/around", casters.count() as u64)?,
            facing: storage("volumes/facing", casters.triangle_count.into())?,
            nets: storage("volumes/nets", casters.edge_count.into())?,
            lists: storage("volumes/lists", LIST_WORDS as u64)?,
            primitives: storage("volumes/primitives", 3 * capacity)?,
            draws: Buffer::with_usage(gpu, "volumes/draws", 16 * LISTS_AT_MOST as u64, draws),
            capacity: capacity as u32,
        })
    }

    /// Which triangles cast, and which edges have sides.
    pub(super) fn record_silhouettes(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        uniform: &Uniform<VolumeUniform>,
        casters: &Casters,
    ) -> Result<(), GpuError> {
        encoder.clear_buffer(&self.around.raw, 0, None);
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("vertices", &casters.vertices)
            .read("triangles", &casters.triangles)
            .write("around", &mut self.around);
        self.around_pass.record(gpu, encoder, &bindings, linear_groups(casters.triangle_count))?;
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("vertices", &casters.vertices)
            .read("triangles", &casters.triangles)
            .read("around", &self.around)
            .write("facing", &mut self.facing);
        self.facing_pass.record(gpu, encoder, &bindings, linear_groups(casters.triangle_count))?;
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("edges", &casters.edges)
            .read("incidences", &casters.incidences)
            .read("facing", &self.facing)
            .write("nets", &mut self.nets);
        self.nets_pass.record(gpu, encoder, &bindings, linear_groups(casters.edge_count))
    }

    /// The lists; of what `kept` says of each caster, if anything is culled.
    pub(super) fn record_lists(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        uniform: &Uniform<VolumeUniform>,
        (casters, kept): (&Casters, &Buffer),
    ) -> Result<(), GpuError> {
        encoder.clear_buffer(&self.lists.raw, 0, None);
        for phase in 0..2 {
            let bindings = Bindings::new()
                .read("volume", uniform)
                .read("vertices", &casters.vertices)
                .read("triangles", &casters.triangles)
                .read("facing", &self.facing)
                .read("kept", kept)
                .write("lists", &mut self.lists)
                .write("primitives", &mut self.primitives);
            let groups = linear_groups(casters.triangle_count);
            self.caps_passes[phase].record(gpu, encoder, &bindings, groups)?;
            let bindings = Bindings::new()
                .read("volume", uniform)
                .read("vertices", &casters.vertices)
                .read("edges", &casters.edges)
                .read("edge_casters", &casters.edge_casters)
                .read("nets", &self.nets)
                .read("kept", kept)
                .write("lists", &mut self.lists)
                .write("primitives", &mut self.primitives);
            self.sides_passes[phase].record(gpu, encoder, &bindings, linear_groups(casters.edge_count))?;
            if phase == 0 {
                let bindings = Bindings::new()
                    .read("volume", uniform)
                    .write("lists", &mut self.lists)
                    .write("draws", &mut self.draws);
                self.plan_pass.record(gpu, encoder, &bindings, [1, 1, 1])?;
            }
        }
        Ok(())
    }

    /// How long the lists of the last recording are. Waits.
    pub(super) fn read_counts(&self, gpu: &Gpu) -> Result<VolumeCounts, GpuError> {
        let words: Vec<u32> = read_buffer(gpu, &self.lists)?;
        let word = |n: usize| words.get(n).copied().unwrap_or_default();
        let lists = LISTS_AT_MOST;
        Ok(VolumeCounts {
            triangles: words.iter().take(lists).sum(),
            all_triangles: word(2 * lists),
            sides: word(2 * lists + 1),
            all_sides: word(2 * lists + 2),
            is_too_long: word(2 * lists + 3) != 0,
            kept_sides: word(2 * lists + 4),
            ..VolumeCounts::default()
        })
    }
}

pub(super) fn dispatch(pass: &mut wgpu::ComputePass<'_>, groups: [u32; 3]) {
    pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
}
