//! Where a mesh of a scene file stands.

use glam::{Mat4, Vec3, Vec4};

use super::format::{MeshEntry, Scale};
use super::motion::rotation;
use super::vector;
use crate::Transform;

/// A mesh's place; its parts are what keyframes replace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    pub(super) matrix: Mat4,
    /// `None` if a matrix says the place.
    pub(super) parts: Option<Transform>,
}

pub(super) fn scale_of(scale: Scale, name: &str) -> Result<Vec3, String> {
    match scale {
        Scale::Uniform(s) => vector([s; 3], name),
        Scale::PerAxis(s) => vector(s, name),
    }
}

pub(super) fn placement(entry: &MeshEntry) -> Result<Placement, String> {
    if let Some(rows) = entry.matrix {
        if entry.scale.is_some() || entry.rotate_deg.is_some() || entry.translate.is_some() {
            return Err("with both a matrix and scale, rotate_deg or translate".to_owned());
        }
        let [x, y, z, w] = rows.map(Vec4::from);
        if w != Vec4::W {
            return Err("whose matrix does not end in the row 0 0 0 1".to_owned());
        }
        let matrix = Mat4::from_cols(x, y, z, w).transpose();
        let finite = matrix.is_finite().then_some(Placement { matrix, parts: None });
        return finite.ok_or_else(|| "whose matrix is not finite".to_owned());
    }
    let scale = entry.scale.map_or(Ok(Vec3::ONE), |s| scale_of(s, "scale"))?;
    let rotation = rotation(vector(entry.rotate_deg.unwrap_or_default(), "rotate_deg")?);
    let translation = vector(entry.translate.unwrap_or_default(), "translate")?;
    let matrix = Mat4::from_scale_rotation_translation(scale, rotation, translation);
    Ok(Placement { matrix, parts: Some(Transform { translation, rotation, scale }) })
}
