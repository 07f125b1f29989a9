//! Baking (dissertation 4.4.1, Algorithm 1): from every sample point on the bounding sphere a ray in every inward
//! direction.
//!
//! The object is moved to a unit sphere first, so that its size and place in its own space do not matter. Maps are baked
//! in runs of [`MAPS_PER_CHUNK`], each on all threads of the current `rayon` pool; rays of a map follow each other texel
//! by texel and so keep to the same parts of the tree. Each map depends on its number alone: threads, runs and pauses
//! change nothing.

mod geometry;
mod mesh;
mod sphere;

use std::ops::{ControlFlow, Range};

use glam::Vec3;
use rayon::prelude::*;

pub use mesh::Mesh;
pub(crate) use mesh::RADII;
pub use sphere::Sphere;

use crate::directions::{Directions, Frame};
use crate::field::maps::{Maps, octahedral};
use crate::lookup::Ray;
use crate::points::SpherePoints;
use crate::{Field, FieldError, Settings};
use geometry::{Geometry, Hit};

/// Maps that are baked, reported and written together.
pub const MAPS_PER_CHUNK: u32 = 64;

/// How far a bake is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Maps finished, those that an earlier bake left among them.
    pub maps_done: u32,
    /// Maps of the field.
    pub maps: u32,
    /// Rays traced by this bake.
    pub rays: u64,
}

/// A mesh ready to be baked.
pub struct Baker {
    settings: Settings,
    sphere: Sphere,
    mesh_key: u128,
    geometry: Geometry,
    points: SpherePoints,
    /// Number of the texel and local direction.
    directions: Vec<(u32, Vec3)>,
    /// Per texel, 1 where unused.
    cosines: Vec<f32>,
}

impl Baker {
    /// Checks everything, finds the bounding sphere and builds the tree for the rays.
    ///
    /// # Errors
    /// [`FieldError::Unsupported`] for settings outside their choices; [`FieldError::BadMesh`] for a mesh without
    /// triangles or extent, with indices out of range, vertices that are not finite, another number of normals than
    /// vertices, or a radius outside 1e-30 to 1e30 m.
    pub fn new(mesh: Mesh<'_>, settings: Settings) -> Result<Self, FieldError> {
        let points = SpherePoints::new(settings.points)?;
        let map = Directions::new(settings.mapping, settings.directions)?;
        mesh.check()?;
        let sphere = mesh.sphere()?;
        let side = map.side();
        let texels = (0..map.count()).map(|n| (n, map.direction(n % side, n / side)));
        Ok(Self {
            settings,
            sphere,
            mesh_key: mesh.key(),
            geometry: Geometry::new(&mesh.in_unit_sphere(sphere), &mesh.corner_normals()),
            points,
            cosines: texels.clone().map(|(_, d)| d.map_or(1.0, |d| d.z)).collect(),
            directions: texels.filter_map(|(n, d)| Some((n, d?))).collect(),
        })
    }

    /// What will be baked.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The bounding sphere of the mesh.
    pub fn sphere(&self) -> Sphere {
        self.sphere
    }

    /// A hash of the mesh.
    pub fn mesh_key(&self) -> u128 {
        self.mesh_key
    }

    /// Rays of a whole bake.
    pub fn rays(&self) -> u64 {
        self.rays_per_map() * u64::from(self.settings.points)
    }

    /// The true distance to the mesh along a ray, in lengths of its direction, by the same tree that bakes. Nothing
    /// is met behind the origin.
    pub fn trace(&self, ray: &Ray) -> Option<f32> {
        self.hit(ray).map(|(hit, _, length)| hit.distance / length)
    }

    /// The same with the unit normal that is met, in the object's space, on the ray's side.
    pub fn trace_with_normal(&self, ray: &Ray) -> Option<(f32, Vec3)> {
        let (hit, direction, length) = self.hit(ray)?;
        Some((hit.distance / length, self.geometry.normal(&hit, direction)))
    }

    /// What a ray meets, its unit direction, and the length that this had where the bounding sphere is the unit sphere.
    #[inline]
    fn hit(&self, ray: &Ray) -> Option<(Hit, Vec3, f32)> {
        let unit = ray.in_unit_sphere(self.sphere);
        let length = unit.direction.length();
        let direction = unit.direction / length;
        if !(unit.origin.is_finite() && direction.is_finite()) {
            return None;
        }
        let hit = self.geometry.nearest(unit.origin, direction, f32::MAX)?;
        Some((hit, direction, length))
    }

    /// Bakes the field in memory. `observe` is called after each run of maps and may stop the bake.
    ///
    /// # Errors
    /// [`FieldError::Cancelled`] when stopped, [`FieldError::OutOfMemory`].
    pub fn bake(&self, observe: impl FnMut(Progress) -> ControlFlow<()>) -> Result<Field, FieldError> {
        let mut maps = Maps::empty(&self.settings);
        maps.reserve(&self.settings).ok_or(FieldError::OutOfMemory { bytes: self.settings.bytes() })?;
        self.bake_from(0, observe, |chunk| {
            maps.append(chunk);
            Ok(())
        })?;
        Field::new(self.settings, self.sphere, self.mesh_key, maps)
    }

    /// Bakes the maps from number `first` on, which is a multiple of [`MAPS_PER_CHUNK`], and hands over each run.
    pub(crate) fn bake_from(
        &self,
        first: u32,
        mut observe: impl FnMut(Progress) -> ControlFlow<()>,
        mut keep: impl FnMut(Maps) -> Result<(), FieldError>,
    ) -> Result<(), FieldError> {
        let maps = self.settings.points;
        for start in (first..maps).step_by(MAPS_PER_CHUNK as usize) {
            let end = maps.min(start + MAPS_PER_CHUNK);
            keep(self.chunk(start..end))?;
            let rays = u64::from(end - first) * self.rays_per_map();
            let stop = observe(Progress { maps_done: end, maps, rays }).is_break();
            if stop && end < maps {
                return Err(FieldError::Cancelled { done: end, total: maps });
            }
        }
        Ok(())
    }

    fn rays_per_map(&self) -> u64 {
        self.directions.len() as u64
    }

    fn chunk(&self, numbers: Range<u32>) -> Maps {
        let baked: Vec<_> = numbers.into_par_iter().with_max_len(1).map(|n| self.map(n)).collect();
        let mut all = Maps::empty(&self.settings);
        baked.into_iter().for_each(|map| all.append(map));
        all
    }

    /// All rays of one sample point.
    fn map(&self, number: u32) -> Maps {
        let texels = self.cosines.len();
        let mut distances = vec![1.0; texels];
        let mut normals = vec![[0; 2]; if self.settings.normals { texels } else { 0 }];
        let origin = self.points.positions()[number as usize];
        let frame = Frame::at(origin);
        for &(texel, local) in &self.directions {
            let direction = frame.object_from_local(local);
            // The way to the far side of the sphere is the longest; its rounding is left to the margin of the sphere.
            let Some(hit) = self.geometry.nearest(origin, direction, 2.0) else { continue };
            distances[texel as usize] = (0.5 * hit.distance).min(1f32.next_down());
            if let Some(normal) = normals.get_mut(texel as usize) {
                *normal = octahedral(self.geometry.normal(&hit, direction));
            }
        }
        Maps::of_one(self.settings.storage, &distances, &self.cosines, normals)
    }
}

#[cfg(test)]
mod tests;
