//! A geometry stage for devices that have none: each triangle becomes as many primitives as it has slices, or strips of slices.
//!
//! - `count`: a thread per triangle of a batch, how many primitives it becomes.
//! - `plan`: sums these up, and makes the arguments of an indirect draw.
//! - `vertex`: finds its triangle by bisection in the sums, and makes one corner of one primitive.
//!
//! A list of all pairs of triangle and slice has no bound but the product of both. The sums are a word for each triangle of a batch,
//! half a MiB, whatever the triangles are like; the price is 17 steps of bisection for each vertex.

use super::{Faces, Raster, axes, batches, draw_text, sampled};
use crate::gpu::{Bindings, Buffer, GeneratedPass, GeneratedText, Gpu, GpuError, Program};
use crate::voxelize::BATCH_TRIANGLES;
use crate::voxelize::method::{Job, Options, Stages};
use crate::voxelize::text::{Layout, Phase, method_text};
use crate::wgsl::linear_groups;
use lumivox_core::Grid;

/// Words before the sums: the number of triangles.
const HEAD: u32 = 4;

/// What a method makes of triangles: WGSL with `lv_primitives(t) -> u32`, how many there are, and `lv_corner(t, nth, corner) -> LvPrimitive`.
#[derive(Clone, Copy, Debug)]
pub(in crate::voxelize) struct Geometry {
    /// Names of the three stages.
    pub(in crate::voxelize) names: [&'static str; 3],
    pub(in crate::voxelize) source: &'static str,
    /// Vertices that a triangle may become.
    pub(in crate::voxelize) output_vertices: Option<u32>,
}

#[derive(Debug)]
pub(in crate::voxelize) struct Expansion {
    count: GeneratedPass,
    plan: GeneratedPass,
    raster: Raster,
    /// Group 3 of `count`, group 0 of `plan`, and group 3 of the draw.
    groups: [wgpu::BindGroup; 3],
    arguments: Buffer,
}

impl Expansion {
    pub(in crate::voxelize) fn new(
        gpu: &Gpu,
        grid: &Grid,
        layout: &Layout,
        options: &Options,
        phase: Phase,
        geometry: &Geometry,
    ) -> Result<Self, GpuError> {
        let text = |is_plain| texts(layout, options, phase, is_plain, geometry);
        let [count, plan, draw] = text(true);
        let (count, plan) = (GeneratedPass::new(gpu, &count)?, GeneratedPass::new(gpu, &plan)?);
        let raster = Raster::new(gpu, grid, |is_plain| {
            let [_, _, draw] = text(is_plain);
            draw
        })?;
        let mut work = Buffer::storage(gpu, geometry.names[0], 4 * u64::from(HEAD + BATCH_TRIANGLES))?;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT;
        let mut arguments = Buffer::with_usage(gpu, geometry.names[1], 16, usage);
        let groups = [
            count.bind(gpu, 3, &Bindings::new().write("work", &mut work))?,
            plan.bind(gpu, 0, &Bindings::new().write("work", &mut work).write("arguments", &mut arguments))?,
            Program::generated(gpu, &draw)?.bind(gpu, 3, &Bindings::new().read("work", &work))?,
        ];
        Ok(Self { count, plan, raster, groups, arguments })
    }
}

impl Stages for Expansion {
    fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, job: &Job<'_>) -> Result<(), GpuError> {
        gpu.check()?;
        let [count_work, plan_work, draw_work] = &self.groups;
        for axis in axes(job) {
            for (mesh, batch, count) in batches(job) {
                let descriptor =
                    wgpu::ComputePassDescriptor { label: Some("voxelize/expansion"), timestamp_writes: None };
                let mut pass = encoder.begin_compute_pass(&descriptor);
                pass.set_pipeline(&self.count.pipeline);
                pass.set_bind_group(0, &job.groups[axis], &[]);
                pass.set_bind_group(1, batch, &[]);
                if let Some(functions) = job.functions {
                    pass.set_bind_group(2, functions, &[]);
                }
                pass.set_bind_group(3, count_work, &[]);
                let [x, y, z] = linear_groups(count);
                pass.dispatch_workgroups(x, y, z);
                pass.set_pipeline(&self.plan.pipeline);
                pass.set_bind_group(0, plan_work, &[]);
                pass.dispatch_workgroups(1, 1, 1);
                drop(pass);
                let mut pass = self.raster.begin(encoder, job, axis, Faces::Dominant);
                pass.set_pipeline(self.raster.pipeline(mesh));
                pass.set_bind_group(1, batch, &[]);
                pass.set_bind_group(3, draw_work, &[]);
                pass.draw_indirect(&self.arguments.raw, 0);
            }
        }
        Ok(())
    }
}

/// The texts of the three stages, for plain meshes or for all.
pub(in crate::voxelize) fn texts(
    layout: &Layout,
    options: &Options,
    phase: Phase,
    is_plain: bool,
    geometry: &Geometry,
) -> [GeneratedText; 3] {
    let [count, plan, draw] = geometry.names;
    let limit = geometry.output_vertices.unwrap_or(u32::MAX);
    let numbers = format!(
        "const LV_WORK_HEAD: u32 = {HEAD}u;\nconst LV_BATCH: u32 = {BATCH_TRIANGLES}u;\n\
         const LV_OUTPUT_VERTICES: u32 = {limit}u;\n"
    );
    let common = method_text(layout, &sampled(options), phase, is_plain);
    let text = |name, parts: &[&str]| GeneratedText { name, source: parts.join("\n") };
    let vertex = [numbers.as_str(), geometry.source, include_str!("vertex.wgsl")];
    [
        text(count, &[&common, &numbers, super::PRIMITIVE, geometry.source, include_str!("count.wgsl")]),
        text(plan, &[&numbers, include_str!("plan.wgsl")]),
        draw_text(draw, (layout, options, phase), is_plain, Faces::Dominant, &vertex),
    ]
}
