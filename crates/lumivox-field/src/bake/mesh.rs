//! The mesh to be baked, borrowed.

use glam::{DVec3, Vec3};
use lumivox_core::TriangleView;
use xxhash_rust::xxh3::Xxh3;

use super::Sphere;
use crate::FieldError;

/// Triangles of one rigid object, any soup, and its normals if they are not the faces'.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// The triangles, both sides of which count.
    pub triangles: TriangleView<'a>,
    /// Unit normals, one per position, interpolated over each triangle; without them those of the faces are used.
    pub normals: Option<&'a [[f32; 3]]>,
}

/// Radii outside are refused: what is divided by them would leave the range of a float.
pub(crate) const RADII: std::ops::RangeInclusive<f32> = 1e-30..=1e30;

/// Part of every key, so that a change of what a bake computes makes old caches worthless.
const BAKE_VERSION: u32 = 1;

impl<'a> Mesh<'a> {
    /// A mesh with the normals of its faces.
    pub fn new(triangles: TriangleView<'a>) -> Self {
        Self { triangles, normals: None }
    }

    pub(crate) fn check(&self) -> Result<(), FieldError> {
        let TriangleView { positions, indices } = self.triangles;
        let refuse = |reason: String| Err(FieldError::BadMesh { reason });
        if indices.is_empty() {
            return refuse("it has no triangles".to_owned());
        }
        // The tree numbers triangles and their nodes in 32 bits.
        if indices.len() > (u32::MAX / 4) as usize {
            return refuse(format!("it has {} triangles, more than 2^30", indices.len()));
        }
        let beyond = indices.iter().flatten().find(|&&i| i as usize >= positions.len());
        if let Some(index) = beyond {
            return refuse(format!("it uses vertex {index} of {}", positions.len()));
        }
        let sound = |i: &&u32| positions[**i as usize].iter().all(|v| v.is_finite());
        if let Some(index) = indices.iter().flatten().find(|i| !sound(i)) {
            return refuse(format!("vertex {index} is not finite"));
        }
        match self.normals {
            Some(normals) if normals.len() != positions.len() => {
                refuse(format!("it has {} vertices but {} normals", positions.len(), normals.len()))
            }
            _ => Ok(()),
        }
    }

    /// The bounding sphere of what the triangles use.
    pub(crate) fn sphere(&self) -> Result<Sphere, FieldError> {
        let mut used = vec![false; self.triangles.positions.len()];
        self.triangles.indices.iter().flatten().for_each(|&i| used[i as usize] = true);
        let places = self.triangles.positions.iter().zip(&used).filter(|(_, used)| **used);
        let points: Vec<_> = places.map(|(p, _)| DVec3::from_array(p.map(f64::from))).collect();
        let sphere = Sphere::around(&points);
        if sphere.center.is_finite() && RADII.contains(&sphere.radius) {
            return Ok(sphere);
        }
        let (least, most) = (RADII.start(), RADII.end());
        let reason = format!("its radius is {} m, outside {least:e} to {most:e} m", sphere.radius);
        Err(FieldError::BadMesh { reason })
    }

    /// The triangles moved and scaled to the unit sphere in place of `sphere`.
    pub(super) fn in_unit_sphere(&self, sphere: Sphere) -> Vec<[Vec3; 3]> {
        let (center, scale) = (sphere.center.as_dvec3(), 1.0 / f64::from(sphere.radius));
        let unit = |p: &[f32; 3]| ((DVec3::from_array(p.map(f64::from)) - center) * scale).as_vec3();
        let places: Vec<_> = self.triangles.positions.iter().map(unit).collect();
        self.triangles.indices.iter().map(|t| t.map(|i| places[i as usize])).collect()
    }

    /// The normals at the corners of each triangle; empty without normals. One that is not finite counts as none.
    pub(super) fn corner_normals(&self) -> Vec<[Vec3; 3]> {
        let Some(normals) = self.normals else { return Vec::new() };
        let normal = |i: u32| {
            let n = Vec3::from(normals[i as usize]);
            if n.is_finite() { n } else { Vec3::ZERO }
        };
        self.triangles.indices.iter().map(|t| t.map(normal)).collect()
    }

    /// A hash of all positions, indices and normals. The same mesh in another order has another key.
    pub fn key(&self) -> u128 {
        let mut hash = Xxh3::new();
        let TriangleView { positions, indices } = self.triangles;
        let counts = [positions.len(), indices.len(), self.normals.map_or(0, <[_]>::len)];
        hash.update(&BAKE_VERSION.to_le_bytes());
        counts.iter().for_each(|n| hash.update(&(*n as u64).to_le_bytes()));
        hash.update(bytemuck::cast_slice(positions));
        hash.update(bytemuck::cast_slice(indices));
        hash.update(bytemuck::cast_slice(self.normals.unwrap_or_default()));
        hash.digest128()
    }
}
