//! *Direct*: one pass over the triangles, whatever their size.
//!
//! - `small`: a thread per triangle. A triangle that reaches a box of up to 64 cells is done right there: first all tests, into a mask
//!   of 64 bits, then surfaces for the marked cells alone, so that threads which run in step do not wait for each other's tests.
//!   All others go into a list, with the number of tiles that they take: squares of columns along the axis they face most.
//! - `plan`: sums up the tiles of the list, and how many workgroups that makes.
//! - `tiles`: a workgroup per tile, found by bisection in the sums, a thread per four columns. A column crosses the plane in a few cells.
//!
//! No invocation takes more than some 2,000 steps, whatever the triangle: software drivers end one silently after 65,535.

use super::mesh::BATCH_TRIANGLES;
use super::method::{Job, Options, Stages};
use super::text::{Layout, Phase, method_text};
use crate::gpu::{Bindings, Buffer, GeneratedPass, GeneratedText, Gpu, GpuError};
use crate::wgsl::linear_groups;
use lumivox_core::Grid;

/// Words before the list: its length, and the number of tiles.
const HEAD: u32 = 4;

#[derive(Debug)]
pub(crate) struct Direct {
    /// `small` and `tiles`, for plain meshes and for all others.
    variants: [[GeneratedPass; 2]; 2],
    plan: GeneratedPass,
    /// Group 3 of `small`, group 0 of `plan`, and group 3 of `tiles`.
    groups: [wgpu::BindGroup; 3],
    arguments: Buffer,
}

impl Direct {
    pub(super) fn new(
        gpu: &Gpu,
        grid: &Grid,
        layout: &Layout,
        options: &Options,
        phase: Phase,
    ) -> Result<Self, GpuError> {
        let variant = |is_plain: bool| -> Result<_, GpuError> {
            let [small, plan, tiles] = texts(layout, options, phase, (tile_side(grid), is_plain));
            Ok(([GeneratedPass::new(gpu, &small)?, GeneratedPass::new(gpu, &tiles)?], plan))
        };
        let ((plain, plan), (full, _)) = (variant(true)?, variant(false)?);
        let plan = GeneratedPass::new(gpu, &plan)?;
        let bytes = 4 * u64::from(HEAD + 2 * BATCH_TRIANGLES);
        let mut work = Buffer::storage(gpu, "voxelize/direct/work", bytes)?;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
        let mut arguments = Buffer::with_usage(gpu, "voxelize/direct/arguments", 12, usage);
        let [small, tiles] = &full;
        let groups = [
            small.bind(gpu, 3, &Bindings::new().write("work", &mut work))?,
            plan.bind(gpu, 0, &Bindings::new().write("work", &mut work).write("arguments", &mut arguments))?,
            tiles.bind(gpu, 3, &Bindings::new().read("work", &work))?,
        ];
        Ok(Self { variants: [plain, full], plan, groups, arguments })
    }
}

impl Stages for Direct {
    fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, job: &Job<'_>) -> Result<(), GpuError> {
        gpu.check()?;
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("voxelize/direct"),
            timestamp_writes: None,
        });
        let accumulators = &job.groups[job.axis.unwrap_or(3)];
        let [small_work, plan_work, tiles_work] = &self.groups;
        for mesh in job.meshes {
            let [small, tiles] = &self.variants[usize::from(!mesh.is_plain())];
            for (batch, count) in mesh.batches() {
                pass.set_pipeline(&small.pipeline);
                pass.set_bind_group(0, accumulators, &[]);
                pass.set_bind_group(1, batch, &[]);
                if let Some(functions) = job.functions {
                    pass.set_bind_group(2, functions, &[]);
                }
                pass.set_bind_group(3, small_work, &[]);
                let [x, y, z] = linear_groups(count);
                pass.dispatch_workgroups(x, y, z);
                pass.set_pipeline(&self.plan.pipeline);
                pass.set_bind_group(0, plan_work, &[]);
                pass.dispatch_workgroups(1, 1, 1);
                pass.set_pipeline(&tiles.pipeline);
                pass.set_bind_group(0, accumulators, &[]);
                pass.set_bind_group(3, tiles_work, &[]);
                pass.dispatch_workgroups_indirect(&self.arguments.raw, 0);
            }
        }
        Ok(())
    }
}

/// Columns along a tile's side: four for each thread, so that looking the triangle up is shared among some, and no triangle has
/// more than 64 x 64 tiles, so that the tiles of a whole batch fit 32 bits.
fn tile_side(grid: &Grid) -> u32 {
    grid.dims.max_element().div_ceil(64).max(16)
}

/// The texts of the three stages, with tiles of a side, for plain meshes or for all.
pub(super) fn texts(
    layout: &Layout,
    options: &Options,
    phase: Phase,
    (tile, is_plain): (u32, bool),
) -> [GeneratedText; 3] {
    let common = method_text(layout, options, phase, is_plain);
    let numbers = format!(
        "const LV_TILE: u32 = {tile}u;\nconst LV_WORK_HEAD: u32 = {HEAD}u;\nconst LV_BATCH: u32 = {BATCH_TRIANGLES}u;\n"
    );
    let text = |name, parts: &[&str]| GeneratedText { name, source: parts.join("\n") };
    [
        text("voxelize/direct/small", &[&numbers, &common, include_str!("small.wgsl")]),
        text("voxelize/direct/plan", &[&numbers, include_str!("plan.wgsl")]),
        text("voxelize/direct/tiles", &[&numbers, &common, include_str!("tiles.wgsl")]),
    ]
}
