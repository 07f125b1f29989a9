//! The rigid objects of a frame: which field each has, and where it stands.

use glam::{Affine3A, Mat4, Vec3};

use super::Fields;
use super::fields::FieldSphere;
use crate::gpu::{Buffer, Gpu, GpuError};

/// The most objects, each part of one counted by itself. A tile of 8 x 8 pixels keeps a bit for each, so that a picture of 1920 x
/// 1080 with room for all takes 68 MB; rays go over those that have any.
pub const MAX_OBJECTS: u32 = 16_384;

/// An object, or a part of one, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Number of its field in [`Fields`].
    pub field: usize,
    /// Where it stands. It may be scaled, sheared and mirrored, but must have volume.
    pub world_from_object: Mat4,
    /// Which object it is a part of. Parts of one object follow each other.
    pub caster: u32,
    /// Mean albedo, for reflections.
    pub albedo: Vec3,
}

impl Placement {
    /// An object of one part, white.
    pub fn new(field: usize, world_from_object: Mat4, caster: u32) -> Self {
        Self { field, world_from_object, caster, albedo: Vec3::ONE }
    }
}

crate::gpu_struct! {
    /// A [`Placement`] as shaders see it.
    pub struct ObjectUniform {
        /// From the world to where the field's sphere is the unit sphere.
        pub unit_from_world: Mat4,
        /// Turns normals of the object's space to the world, up to their length.
        pub world_from_normal: Mat4,
        /// Centre of a sphere around it, in the world.
        pub center: Vec3,
        /// Radius of that.
        pub radius: f32,
        /// Mean albedo.
        pub albedo: Vec3,
        /// Its field.
        pub field: u32,
        /// Which object it is a part of.
        pub caster: u32,
        /// How far a hit must lie ahead, in radii, of rays that start within the sphere.
        pub bias: f32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
    }
}

/// The objects of a frame. Room is made once; where they stand is written each frame.
#[derive(Debug)]
pub struct Objects {
    pub(super) buffer: Buffer,
    pub(super) capacity: u32,
    pub(super) count: u32,
    bias: Option<f32>,
}

impl Objects {
    /// Room for some objects. How far a hit must lie ahead of rays that start within an object's sphere goes with its field's points:
    /// [`hit_bias`](lumivox_core::hit_bias).
    ///
    /// # Errors
    /// More than [`MAX_OBJECTS`], and those of the device.
    pub fn new(gpu: &Gpu, capacity: u32) -> Result<Self, GpuError> {
        if capacity > MAX_OBJECTS {
            return Err(GpuError::Validation(format!(
                "visibility/objects: room for {capacity} of them; {MAX_OBJECTS} are possible"
            )));
        }
        let capacity = capacity.max(1);
        let bytes = u64::from(capacity) * size_of::<ObjectUniform>() as u64;
        let buffer = Buffer::storage(gpu, "visibility/objects", bytes)?;
        Ok(Self { buffer, capacity, count: 0, bias: None })
    }

    /// The same with one bias for all, in radii.
    #[must_use]
    pub fn with_bias(self, bias: f32) -> Self {
        Self { bias: Some(bias), ..self }
    }

    /// Writes where everything stands, once a frame before it is recorded. An object without volume, or whose numbers are not
    /// finite, is left out of the frame.
    ///
    /// # Errors
    /// More objects than there is room for, and a field that is not there.
    pub fn update(&mut self, gpu: &Gpu, fields: &Fields, placements: &[Placement]) -> Result<(), GpuError> {
        if placements.len() > self.capacity as usize {
            return Err(GpuError::Validation(format!(
                "visibility/objects: {} of them, with room for {}",
                placements.len(),
                self.capacity
            )));
        }
        let mut uniforms = Vec::with_capacity(placements.len());
        for placement in placements {
            let Some(sphere) = fields.spheres.get(placement.field) else {
                return Err(GpuError::Validation(format!(
                    "visibility/objects: field {} of {}",
                    placement.field,
                    fields.len()
                )));
            };
            uniforms.extend(self.uniform(placement, sphere));
        }
        self.count = uniforms.len() as u32;
        gpu.queue.write_buffer(&self.buffer.raw, 0, bytemuck::cast_slice(&uniforms));
        Ok(())
    }

    /// Number of objects in this frame.
    pub fn count(&self) -> u32 {
        self.count
    }

    fn uniform(&self, placement: &Placement, sphere: &FieldSphere) -> Option<ObjectUniform> {
        let FieldSphere { center, radius, bias } = *sphere;
        let world_from_object = Affine3A::from_mat4(placement.world_from_object);
        let object_from_world = world_from_object.inverse();
        let m = world_from_object.matrix3;
        // No direction is stretched by more than the matrix's Frobenius norm, and by no more than its longest column where the
        // columns are at right angles.
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(Vec3::from);
        let square = |a: usize, b: usize| columns[a].dot(columns[b]).abs();
        let longest = columns.map(Vec3::length).into_iter().fold(0.0, f32::max);
        let is_square = square(0, 1).max(square(1, 2)).max(square(2, 0)) <= 1e-5 * longest * longest;
        let norm = columns.map(|c| c.length_squared()).iter().sum::<f32>().sqrt();
        let stretch = if is_square { longest * (1.0 + 1e-5) } else { norm };
        let unit_from_object =
            Affine3A::from_scale(Vec3::splat(1.0 / radius)) * Affine3A::from_translation(-center);
        let unit_from_world = Mat4::from(unit_from_object * object_from_world);
        let world_from_normal = Mat4::from_mat3(glam::Mat3::from(object_from_world.matrix3).transpose());
        let uniform = ObjectUniform {
            unit_from_world,
            world_from_normal,
            center: world_from_object.transform_point3(center),
            radius: stretch * radius,
            albedo: placement.albedo,
            field: placement.field as u32,
            caster: placement.caster,
            bias: self.bias.unwrap_or(bias),
            reserved_0: 0,
            reserved_1: 0,
        };
        let sound = unit_from_world.is_finite()
            && world_from_normal.is_finite()
            && uniform.center.is_finite()
            && uniform.radius.is_finite();
        sound.then_some(uniform)
    }
}
