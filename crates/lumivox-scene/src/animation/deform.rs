//! Meshes whose vertices follow joints or morph targets: glTF 2.0, sections 3.7.2.2 and 3.7.3.

use glam::{Mat3, Mat4, Vec3};

use super::pose::Moment;
use super::{Animation, DeformedMesh};
use crate::mesh::face_normal;

/// Joints and where they see the mesh that they move.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Skin {
    /// Nodes.
    pub(crate) joints: Vec<usize>,
    /// One per joint; finite.
    pub(crate) joint_from_mesh: Vec<Mat4>,
}

/// A mesh before anything moves it, and what does.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Body {
    /// Index into the scene's meshes; each is that of one body at most.
    pub(crate) mesh: usize,
    /// The node whose tracks move the morph targets.
    pub(crate) node: usize,
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) normals: Vec<[f32; 3]>,
    /// Whether each three vertices in a row are a triangle whose normal is the face's.
    pub(crate) flat: bool,
    pub(crate) targets: Vec<MorphTarget>,
    /// Factor of each target at rest; absent ones are zero.
    pub(crate) weights: Vec<f32>,
    pub(crate) binding: Option<Binding>,
}

/// What is added to a mesh; an empty list adds nothing, else there is one entry per vertex, finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MorphTarget {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) normals: Vec<[f32; 3]>,
}

/// How much of which joint moves each vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Binding {
    /// Index into the animation's skins.
    pub(crate) skin: usize,
    /// Per vertex the end of its influences; they start where those of the vertex before end.
    pub(crate) ends: Vec<u32>,
    /// Index into the skin's joints, in range, and weight; those of a vertex sum to one.
    pub(crate) influences: Vec<(u32, f32)>,
}

impl Body {
    /// The mesh at one moment. Vertices that leave the range of numbers stay where they were before any motion.
    pub(super) fn posed(&self, animation: &Animation, moment: &Moment) -> DeformedMesh {
        let (mut positions, mut normals) = (self.positions.clone(), self.normals.clone());
        self.morph(moment, &mut positions, &mut normals);
        if let Some((binding, skin)) =
            self.binding.as_ref().and_then(|b| Some((b, animation.skins.get(b.skin)?)))
        {
            binding.apply(skin, moment, &mut positions, &mut normals);
        }
        for (p, before) in positions.iter_mut().zip(&self.positions) {
            if !p.iter().all(|v| v.is_finite()) {
                *p = *before;
            }
        }
        if self.flat {
            for (t, normals) in normals.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                let first = 3 * t as u32;
                *normals = [face_normal(&positions, &[first, first + 1, first + 2]).to_array(); 3];
            }
        } else {
            for (n, before) in normals.iter_mut().zip(&self.normals) {
                *n = Vec3::from(*n).try_normalize().map_or(*before, |n| n.to_array());
            }
        }
        DeformedMesh { mesh: self.mesh, positions, normals }
    }

    fn morph(&self, moment: &Moment, positions: &mut [[f32; 3]], normals: &mut [[f32; 3]]) {
        let weights = moment.weights.get(&self.node).unwrap_or(&self.weights);
        for (target, weight) in self.targets.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            add(positions, &target.positions, *weight);
            add(normals, &target.normals, *weight);
        }
    }
}

fn add(to: &mut [[f32; 3]], what: &[[f32; 3]], weight: f32) {
    for (to, what) in to.iter_mut().zip(what) {
        *to = (Vec3::from(*to) + weight * Vec3::from(*what)).to_array();
    }
}

impl Binding {
    fn apply(&self, skin: &Skin, moment: &Moment, positions: &mut [[f32; 3]], normals: &mut [[f32; 3]]) {
        // The place of the mesh's own node is no part of this: the joints say where it is in the world.
        let world_from_mesh: Vec<Mat4> = skin
            .joints
            .iter()
            .zip(&skin.joint_from_mesh)
            .map(|(&joint, bind)| moment.world_from_node[joint] * *bind)
            .collect();
        let mut start = 0;
        for ((p, n), &end) in positions.iter_mut().zip(normals).zip(&self.ends) {
            let influences = &self.influences[start..end as usize];
            start = end as usize;
            let blended = influences
                .iter()
                .fold(Mat4::ZERO, |sum, &(joint, weight)| sum + weight * world_from_mesh[joint as usize]);
            *p = blended.transform_point3((*p).into()).to_array();
            *n = (cofactor(&blended) * Vec3::from(*n)).to_array();
        }
    }
}

/// What turns normals as a matrix turns surfaces, short of a positive factor; unlike the inverse transpose it is there
/// for matrices without volume, too.
fn cofactor(m: &Mat4) -> Mat3 {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.truncate());
    let all = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    // Small models make cofactors that vanish when they are squared.
    let largest = all.to_cols_array().into_iter().fold(0.0f32, |m, v| m.max(v.abs()));
    if largest > 0.0 && largest.is_finite() { all * largest.recip() } else { all }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cofactor_keeps_normals_upright_under_any_scale() {
        let tilt = Mat4::from_scale(Vec3::new(1.0, 4.0, 1e-12));
        let (a, b) = (Vec3::new(1.0, 1.0, 0.0), Vec3::Z);
        let turned = (cofactor(&tilt) * a.cross(b)).normalize_or_zero();
        let surface = [tilt.transform_vector3(a), tilt.transform_vector3(b)].map(|v| v.normalize_or_zero());
        assert!(turned.dot(surface[0]).abs() < 1e-6 && turned.dot(surface[1]).abs() < 1e-6);
        assert!(turned.dot(surface[0].cross(surface[1])) > 0.0);
        let flat = cofactor(&Mat4::from_scale(Vec3::new(1.0, 1.0, 0.0)));
        assert_eq!((flat * Vec3::Z).normalize_or_zero(), Vec3::Z);
    }
}
