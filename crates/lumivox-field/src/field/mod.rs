//! A baked field in memory.

pub(crate) mod maps;
mod packed;
mod texture;

use std::sync::Arc;

pub use maps::{BYTE_MISS, Distances};
pub use texture::{FieldTexture, MAX_TEXTURE_SIDE, Texels, TextureLayout};

use crate::bake::Sphere;
use crate::directions::Directions;
use crate::points::SpherePoints;
use crate::{FieldError, Settings};
use maps::Maps;

/// The visibility field of one rigid object (dissertation 4.4): for each sample point on its bounding sphere a map of
/// the distance to the object in each inward direction.
///
/// It is in the object's own space and holds for every place, turn and scale of the object, and for all its levels of
/// detail: it knows nothing of triangles.
#[derive(Clone)]
pub struct Field {
    pub(crate) settings: Settings,
    pub(crate) sphere: Sphere,
    pub(crate) mesh_key: u128,
    pub(crate) points: Arc<SpherePoints>,
    pub(crate) directions: Directions,
    pub(crate) maps: Maps,
}

impl Field {
    pub(crate) fn new(
        settings: Settings,
        sphere: Sphere,
        mesh_key: u128,
        maps: Maps,
    ) -> Result<Self, FieldError> {
        let points = Arc::new(SpherePoints::new(settings.points)?);
        let directions = Directions::new(settings.mapping, settings.directions)?;
        Ok(Self { settings, sphere, mesh_key, points, directions, maps })
    }

    /// What the field is made of.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The bounding sphere, in the object's space, in metres.
    pub fn sphere(&self) -> Sphere {
        self.sphere
    }

    /// How far ahead a hit should lie of rays that start within the sphere, for [`Field::ahead`], in metres:
    /// [`lumivox_core::hit_bias`].
    pub fn hit_bias(&self) -> f32 {
        lumivox_core::hit_bias(self.points.divisions()) * self.sphere.radius
    }

    /// A hash of the mesh that was baked.
    pub fn mesh_key(&self) -> u128 {
        self.mesh_key
    }

    /// The sample points, on a unit sphere in place of [`Field::sphere`].
    pub fn points(&self) -> &SpherePoints {
        &self.points
    }

    /// The directions of each map.
    pub fn directions(&self) -> Directions {
        self.directions
    }

    /// All distances, map after map in the order of the points.
    pub fn distances(&self) -> &Distances {
        &self.maps.distances
    }

    /// Octahedral normals in signed steps of 1/127, one per direction, map after map; empty without normals.
    pub fn octahedral_normals(&self) -> &[[i8; 2]] {
        &self.maps.normals
    }

    /// Bytes of all maps.
    pub fn bytes(&self) -> u64 {
        self.settings.bytes()
    }
}

impl std::fmt::Debug for Field {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Field")
            .field("settings", &self.settings)
            .field("sphere", &self.sphere)
            .field("mesh_key", &format_args!("{:032x}", self.mesh_key))
            .finish_non_exhaustive()
    }
}

impl PartialEq for Field {
    /// Same settings, sphere, mesh and numbers.
    fn eq(&self, other: &Self) -> bool {
        (self.settings, self.sphere, self.mesh_key) == (other.settings, other.sphere, other.mesh_key)
            && self.maps == other.maps
    }
}
