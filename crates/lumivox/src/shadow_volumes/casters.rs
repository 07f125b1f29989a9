//! The geometry of all casters in one place: welded vertices in the world, triangles, edges.

use std::ops::Range;

use super::Topology;
use super::volumes::dispatch;
use crate::gpu::{Bindings, Buffer, GeneratedPass, GeneratedText, Gpu, GpuError, Uniform};
use crate::voxelize::{Mesh, mesh_text};
use crate::wgsl::linear_groups;

crate::gpu_struct! {
    /// Which welded vertices are a mesh's.
    pub struct PartUniform {
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

#[derive(Debug)]
struct Part {
    uniform: Uniform<PartUniform>,
    vertices: u32,
}

/// All casters.
#[derive(Debug)]
pub(super) struct Casters {
    pass: GeneratedPass,
    parts: Vec<Part>,
    sources: Buffer,
    pub(super) vertices: Buffer,
    pub(super) triangles: Buffer,
    pub(super) edges: Buffer,
    pub(super) edge_casters: Buffer,
    pub(super) incidences: Buffer,
    pub(super) triangle_count: u32,
    pub(super) edge_count: u32,
    ranges: Vec<Range<u32>>,
    /// Triangles of all volumes at most, whatever the light.
    pub(super) most: u64,
}

impl Casters {
    pub(super) fn new(gpu: &Gpu, topologies: &[&Topology]) -> Result<Self, GpuError> {
        let mut all = All::default();
        let (mut parts, mut ranges) = (Vec::new(), Vec::new());
        for topology in topologies {
            let first = all.sources.len() as u32;
            let triangle = all.triangles.len() as u32;
            all.add(topology, parts.len() as u32)?;
            ranges.push(triangle..all.triangles.len() as u32);
            let count = topology.sources.len() as u32;
            let part = PartUniform { first, count, reserved_0: 0, reserved_1: 0 };
            let uniform = Uniform::new(gpu, "volumes/part", &part);
            parts.push(Part { uniform, vertices: count });
        }
        Ok(Self {
            pass: GeneratedPass::new(gpu, &text())?,
            parts,
            ranges,
            sources: filled(gpu, "volumes/sources", &all.sources)?,
            vertices: Buffer::storage(gpu, "volumes/vertices", 16 * all.sources.len().max(1) as u64)?,
            triangles: filled(gpu, "volumes/triangles", &all.triangles)?,
            edges: filled(gpu, "volumes/edges", &all.edges)?,
            edge_casters: filled(gpu, "volumes/edge casters", &all.edge_casters)?,
            incidences: filled(gpu, "volumes/incidences", &all.incidences)?,
            triangle_count: all.triangles.len() as u32,
            edge_count: all.edges.len() as u32,
            // Sides of two triangles each, and two caps for each triangle.
            most: 2 * all.most_sides + 2 * all.triangles.len() as u64,
        })
    }

    pub(super) fn count(&self) -> usize {
        self.parts.len()
    }

    /// The triangles of each.
    pub(super) fn ranges(&self) -> &[Range<u32>] {
        &self.ranges
    }

    /// Vertices to where they stand when this runs.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[&Mesh],
    ) -> Result<(), GpuError> {
        let mut groups = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let bindings = Bindings::new()
                .read("part", &part.uniform)
                .read("sources", &self.sources)
                .write("vertices", &mut self.vertices);
            groups.push(self.pass.bind(gpu, 0, &bindings)?);
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("volumes/world"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pass.pipeline);
        for ((part, group), mesh) in self.parts.iter().zip(&groups).zip(meshes) {
            let Some((batch, _)) = mesh.batches().next() else { continue };
            pass.set_bind_group(0, group, &[]);
            pass.set_bind_group(1, batch, &[]);
            dispatch(&mut pass, linear_groups(part.vertices));
        }
        Ok(())
    }
}

/// What goes into the buffers.
#[derive(Default)]
struct All {
    sources: Vec<u32>,
    triangles: Vec<[u32; 4]>,
    edges: Vec<[u32; 4]>,
    edge_casters: Vec<u32>,
    incidences: Vec<u32>,
    most_sides: u64,
}

impl All {
    fn add(&mut self, topology: &Topology, caster: u32) -> Result<(), GpuError> {
        let (vertex, triangle) = (self.sources.len() as u32, self.triangles.len() as u32);
        let most = self.triangles.len() + topology.triangles.len();
        // Corners, incidences and casters share their words with a bit.
        if most.max(self.sources.len() + topology.sources.len()) >= 1 << 30 {
            return Err(GpuError::Validation(format!(
                "shadow volumes of {most} triangles; 2^30 are possible"
            )));
        }
        self.sources.extend(&topology.sources);
        for (corners, is_closed) in topology.triangles.iter().zip(&topology.is_closed) {
            let [a, b, c] = corners.map(|corner| vertex + corner);
            self.triangles.push([a, b, c, caster | u32::from(*is_closed) << 31]);
        }
        let first = self.incidences.len() as u32;
        self.incidences.extend(topology.incidences.iter().map(|incidence| incidence + 2 * triangle));
        for edge in &topology.edges {
            let [a, b] = edge.vertices;
            self.edges.push([vertex + a, vertex + b, first + edge.first, edge.count]);
            self.edge_casters.push(caster);
        }
        self.most_sides += topology.most_sides;
        Ok(())
    }
}

fn filled<T: bytemuck::NoUninit>(gpu: &Gpu, label: &str, data: &[T]) -> Result<Buffer, GpuError> {
    match data {
        [] => Buffer::storage(gpu, label, 16),
        data => Buffer::storage_with(gpu, label, data),
    }
}

pub(super) fn text() -> GeneratedText {
    GeneratedText { name: "volumes/world", source: [&mesh_text(), include_str!("world.wgsl")].join("\n") }
}
