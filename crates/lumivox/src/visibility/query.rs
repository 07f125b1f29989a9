//! Rays from a buffer against all objects: the secondary rays of a ray tracer (dissertation 4.5.2).

use super::{FIELD, Fields, NORMAL, OBJECT, Objects, blending};
use crate::gpu::{Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::wgsl::{OCTAHEDRON, linear_groups};

pub(super) const SHADER: Shader = Shader {
    name: "visibility/query",
    parts: &[OBJECT, FIELD, OCTAHEDRON, NORMAL, include_str!("query.wgsl")],
};

/// Bytes of a ray, and of a hit.
pub const RAY_BYTES: u64 = 32;
/// Bytes of a hit.
pub const HIT_BYTES: u64 = 16;

crate::gpu_struct! {
    /// What is asked.
    pub struct QueryUniform {
        /// Number of rays.
        pub rays: u32,
        /// Number of objects.
        pub object_count: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
    }
}

/// A ray as [`RayQuery`] reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct QueryRay {
    /// Where it starts, in the world; the fourth number is not read.
    pub origin: [f32; 4],
    /// Where it goes; need not be unit. The fourth number is not read.
    pub direction: [f32; 4],
}

/// What a ray meets, as [`RayQuery`] writes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct QueryHit {
    /// In lengths of the ray's direction; 1e30 where nothing is met.
    pub distance: f32,
    /// World normal that faces the ray, octahedral ([`OCTAHEDRON`]); against the ray where a field has none.
    pub normal: [f32; 2],
    /// Number of the object in [`Objects`].
    pub object: u32,
}

impl QueryHit {
    /// Whether anything was met.
    pub fn is_hit(&self) -> bool {
        self.distance < 1e30
    }
}

/// The pass: the nearest hit over all objects of each ray of a buffer.
#[derive(Debug)]
pub struct RayQuery {
    pass: ComputePass,
    uniform: Uniform<QueryUniform>,
    capacity: u32,
}

impl RayQuery {
    /// Compiles the pass, for at most `capacity` rays at a time; `blended` says whether three maps answer for each.
    pub fn new(gpu: &Gpu, capacity: u32, blended: bool) -> Self {
        Self {
            pass: ComputePass::new(gpu, &SHADER, &blending(blended)),
            uniform: Uniform::new(gpu, "visibility/query", &bytemuck::Zeroable::zeroed()),
            capacity,
        }
    }

    /// Says how many rays the frame has, after [`Objects::update`].
    pub fn update(&self, gpu: &Gpu, objects: &Objects, rays: u32) {
        let uniform = QueryUniform {
            rays: rays.min(self.capacity),
            object_count: objects.count,
            reserved_0: 0,
            reserved_1: 0,
        };
        self.uniform.write(gpu, &uniform);
    }

    /// Records the pass: `rays` holds [`QueryRay`]s and `hits` becomes [`QueryHit`]s.
    ///
    /// # Errors
    /// Buffers that are too small for the capacity, and the device's failure.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        fields: &Fields,
        objects: &Objects,
        rays: &Buffer,
        hits: &mut Buffer,
    ) -> Result<(), GpuError> {
        let count = u64::from(self.capacity);
        if rays.size() < count * RAY_BYTES || hits.size() < count * HIT_BYTES {
            let reason = format!("visibility/query: buffers too small for {count} rays");
            return Err(GpuError::Validation(reason));
        }
        let bindings = fields
            .bind(objects)
            .read("query", &self.uniform)
            .read("field_normals", &fields.normals)
            .read("rays", rays)
            .write("hits", hits);
        self.pass.record(gpu, encoder, &bindings, linear_groups(self.capacity))
    }
}
