//! The practical algorithm: an occlusion query for each caster and layer, whose answers stay on the device.

use super::super::VOLUME;
use super::super::casters::Casters;
use super::super::settings::CullSettings;
use super::stages::{CORNERS, MAP, Raster, begin};
use super::{MapUniform, Seen};
use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Texture, Uniform};
use crate::voxelize::UNWRITTEN;

const QUERY: Shader =
    Shader { name: "volumes/query", parts: &[VOLUME, MAP, CORNERS, include_str!("query.wgsl")] };
const COLLECT: Shader = Shader { name: "volumes/collect", parts: &[VOLUME, include_str!("collect.wgsl")] };

pub(super) const SHADERS: &[Shader] = &[QUERY, COLLECT];

/// Queries of a set at most, by WebGPU.
const SET_QUERIES: u32 = 4096;

crate::gpu_struct! {
    /// The casters of a set of queries.
    pub struct QueriedUniform {
        /// The first.
        pub first: u32,
        /// How many.
        pub count: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
    }
}

/// The queries of as many casters as one set holds, one set after the other.
#[derive(Debug)]
pub(super) struct Queries {
    pass: Raster,
    collect: ComputePass,
    set: wgpu::QuerySet,
    answers: Buffer,
    target: Texture,
    parts: Vec<Uniform<QueriedUniform>>,
    /// Queries of a caster: of its layers, and whether the light sees it.
    of_caster: u32,
}

impl Queries {
    pub(super) fn new(gpu: &Gpu, casters: &Casters, settings: &CullSettings) -> Result<Self, GpuError> {
        let of_caster = settings.layers + 1;
        let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("volumes/queries"),
            ty: wgpu::QueryType::Occlusion,
            count: SET_QUERIES,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::STORAGE;
        let (all, share) = (casters.count() as u32, SET_QUERIES / of_caster);
        let part = |n: u32| {
            let first = n * share;
            let part = QueriedUniform { first, count: share.min(all - first), reserved_0: 0, reserved_1: 0 };
            Uniform::new(gpu, "volumes/queried", &part)
        };
        Ok(Self {
            pass: Raster::new(gpu, &QUERY),
            collect: ComputePass::new(gpu, &COLLECT, &[]),
            set,
            answers: Buffer::with_usage(gpu, "volumes/answers", 8 * u64::from(SET_QUERIES), usage),
            target: Texture::target(gpu, "volumes/nothing", [settings.map_size; 2], UNWRITTEN)?,
            parts: (0..all.div_ceil(share)).map(part).collect(),
            of_caster,
        })
    }

    /// Asks for all casters in one view of the light.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        &Seen { uniform, casters, volumes, .. }: &Seen<'_>,
        map: &Uniform<MapUniform>,
        (covered, slices, kept): (&Buffer, &Buffer, &mut Buffer),
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("volume", uniform)
            .read("map", map)
            .read("vertices", &casters.vertices)
            .read("triangles", &casters.triangles)
            .read("facing", &volumes.facing)
            .read("covered", covered)
            .read("slices", slices);
        let group = self.pass.program.bind(gpu, 0, &bindings)?;
        let share = (SET_QUERIES / self.of_caster) as usize;
        for (part, ranges) in self.parts.iter().zip(casters.ranges().chunks(share)) {
            let mut pass = begin(encoder, QUERY.name, &self.target, Some(&self.set));
            pass.set_pipeline(&self.pass.pipeline);
            pass.set_bind_group(0, &group, &[]);
            let mut query = 0;
            for triangles in ranges {
                for layer in 0..self.of_caster {
                    pass.begin_occlusion_query(query);
                    pass.draw(6 * triangles.start..6 * triangles.end, layer..layer + 1);
                    pass.end_occlusion_query();
                    query += 1;
                }
            }
            drop(pass);
            encoder.resolve_query_set(&self.set, 0..query, &self.answers.raw, 0);
            let bindings = Bindings::new()
                .read("volume", uniform)
                .read("queried", part)
                .read("answers", &self.answers)
                .write("kept", &mut *kept);
            self.collect.record(gpu, encoder, &bindings, [(ranges.len() as u32).div_ceil(64), 1, 1])?;
        }
        Ok(())
    }
}
