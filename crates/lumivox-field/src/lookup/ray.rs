//! Rays, and the space of a unit sphere that fields live in.

use glam::{Affine3A, Vec3};

use crate::bake::Sphere;

/// A ray. Distances along it are in lengths of `direction`, so they stay the same when the ray is transformed, whatever
/// the transform scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes; need not be unit.
    pub direction: Vec3,
}

impl Ray {
    /// A ray from `origin` along `direction`.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction }
    }

    /// The same ray in another space. For an object placed by `world_from_object`, a ray of the world is looked up as
    /// `ray.transformed(&world_from_object.inverse())`, and the distance holds in the world.
    #[must_use]
    pub fn transformed(&self, target_from_source: &Affine3A) -> Self {
        Self {
            origin: target_from_source.transform_point3(self.origin),
            direction: target_from_source.transform_vector3(self.direction),
        }
    }

    /// The point at a distance, in lengths of the direction.
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + distance * self.direction
    }

    /// The ray in the space where `sphere` is the unit sphere.
    #[inline(always)]
    pub(crate) fn in_unit_sphere(&self, sphere: Sphere) -> Self {
        let scale = 1.0 / sphere.radius;
        Self { origin: (self.origin - sphere.center) * scale, direction: self.direction * scale }
    }
}
