//! Where everything stands at one moment.

use std::collections::HashMap;

use glam::{Mat4, Quat, Vec3};

use super::clip::{Channel, Target};
use super::deform::Body;
use super::rig::{HungCamera, Node};
use super::track::Property;
use super::{Animation, Clip, Transform};
use crate::{Camera, Light, Scene};

/// Where everything stands at one moment. Every number is finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// One per [`Scene::instances`].
    pub world_from_local: Vec<Mat4>,
    /// Meshes with skins or morph targets, each once.
    pub deformed: Vec<DeformedMesh>,
    /// As many and of the same kinds, in the same order, as [`Scene::lights`].
    pub lights: Vec<Light>,
    /// As many, in the same order, as [`Scene::cameras`].
    pub cameras: Vec<Camera>,
}

/// A mesh whose vertices moved; all else of it stays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeformedMesh {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Metres in the mesh's own space; one per vertex.
    pub positions: Vec<[f32; 3]>,
    /// Unit vectors; one per vertex.
    pub normals: Vec<[f32; 3]>,
}

impl Scene {
    /// The motions of the scene.
    pub fn clips(&self) -> &[Clip] {
        &self.animation.clips
    }

    /// Where everything stands at a moment of a clip. Seconds wrap around the clip's duration; NaN is 0. If there is no
    /// such clip: the pose in which the scene was loaded.
    ///
    /// The same input gives the same bits. What does not hang on a node stays where it is now, as does a light that was
    /// replaced by one of another kind.
    pub fn pose(&self, clip: usize, seconds: f32) -> Pose {
        let clip = self.animation.clips.get(clip);
        let moment = clip.map(|c| Moment::new(&self.animation, c, seconds));
        Pose {
            world_from_local: self.posed_instances(moment.as_ref()),
            deformed: self.deformed(moment.as_ref()),
            lights: self.posed_lights(moment.as_ref()),
            cameras: self.posed_cameras(moment.as_ref()),
        }
    }

    /// Takes up a pose: writes it into instances, meshes, lights and cameras. What is not there is passed over.
    pub fn apply(&mut self, pose: &Pose) {
        for (instance, matrix) in self.instances.iter_mut().zip(&pose.world_from_local) {
            instance.world_from_local = *matrix;
        }
        for deformed in &pose.deformed {
            let Some(mesh) = self.meshes.get_mut(deformed.mesh) else { continue };
            if mesh.positions.len() == deformed.positions.len() {
                mesh.positions.clone_from(&deformed.positions);
                mesh.normals.clone_from(&deformed.normals);
            }
        }
        self.lights.iter_mut().zip(&pose.lights).for_each(|(light, posed)| *light = *posed);
        self.cameras.iter_mut().zip(&pose.cameras).for_each(|(camera, posed)| camera.clone_from(posed));
    }

    fn posed_instances(&self, moment: Option<&Moment>) -> Vec<Mat4> {
        let mut all: Vec<Mat4> = self.instances.iter().map(|i| i.world_from_local).collect();
        for hung in &self.animation.instances {
            let Some(slot) = all.get_mut(hung.instance) else { continue };
            let moved = moment.map(|m| m.world(hung.outer) * m.world(hung.node) * hung.node_from_local);
            *slot = moved.filter(|m| m.is_finite()).unwrap_or(hung.rest);
        }
        all
    }

    fn deformed(&self, moment: Option<&Moment>) -> Vec<DeformedMesh> {
        let animation = &self.animation;
        if animation.bodies.is_empty() {
            return Vec::new();
        }
        let rest;
        let moment = match moment {
            Some(moment) => moment,
            None => {
                rest = Moment::rest(animation);
                &rest
            }
        };
        let fits =
            |b: &&Body| self.meshes.get(b.mesh).is_some_and(|m| m.positions.len() == b.positions.len());
        animation.bodies.iter().filter(fits).map(|b| b.posed(animation, moment)).collect()
    }

    fn posed_lights(&self, moment: Option<&Moment>) -> Vec<Light> {
        let mut all = self.lights.clone();
        for hung in &self.animation.lights {
            let Some(slot) = all.get_mut(hung.light) else { continue };
            if std::mem::discriminant(slot) == std::mem::discriminant(&hung.rest) {
                let moved = moment.and_then(|m| hung.local.transformed(&m.world_from_node[hung.node]));
                let factors = moment.iter().flat_map(|m| &m.brightness).filter(|(l, _)| *l == hung.light);
                *slot = factors.fold(moved.unwrap_or(hung.rest), |light, (_, factor)| light.dimmed(*factor));
            }
        }
        all
    }

    fn posed_cameras(&self, moment: Option<&Moment>) -> Vec<Camera> {
        let mut all = self.cameras.clone();
        for hung in &self.animation.cameras {
            if let Some(slot) = all.get_mut(hung.camera) {
                *slot = moment.and_then(|m| m.camera(hung)).unwrap_or_else(|| hung.rest.clone());
            }
        }
        all
    }
}

/// All nodes at one moment.
pub(super) struct Moment {
    /// One per node; finite.
    pub(super) world_from_node: Vec<Mat4>,
    /// Light and factor.
    brightness: Vec<(usize, f32)>,
    /// Factors of morph targets by node, where a track states them.
    pub(super) weights: HashMap<usize, Vec<f32>>,
}

impl Moment {
    pub(super) fn new(animation: &Animation, clip: &Clip, seconds: f32) -> Self {
        let seconds = clip.wrapped(seconds);
        let mut moved: Vec<Option<Transform>> = vec![None; animation.nodes.len()];
        let (mut brightness, mut weights) = (Vec::new(), HashMap::new());
        for Channel { target, track, period } in &clip.channels {
            let t = period.map_or(seconds, |p| seconds.rem_euclid(p));
            match (*target, track.property) {
                (Target::Light(light), Property::Brightness) => {
                    let mut factor = [1.0];
                    track.sample(t, &mut factor);
                    brightness.push((light, factor[0]));
                }
                (Target::Node(node), Property::Weights) => {
                    let factors: &mut Vec<f32> = weights.entry(node).or_default();
                    factors.resize(track.width, 0.0);
                    track.sample(t, factors);
                }
                (Target::Node(node), property) => {
                    let (Some(slot), Some(rest)) = (moved.get_mut(node), animation.nodes.get(node)) else {
                        continue;
                    };
                    let place = slot.get_or_insert(rest.rest);
                    match property {
                        Property::Translation => sample_vector(track, t, &mut place.translation),
                        Property::Scale => sample_vector(track, t, &mut place.scale),
                        Property::Rotation => {
                            let mut q = place.rotation.to_array();
                            track.sample(t, &mut q);
                            place.rotation = Quat::from_array(q);
                        }
                        Property::Weights | Property::Brightness => {}
                    }
                }
                (Target::Light(_), _) => {}
            }
        }
        Self { world_from_node: worlds(&animation.nodes, &moved), brightness, weights }
    }

    /// All nodes at rest.
    fn rest(animation: &Animation) -> Self {
        let world_from_node = animation.nodes.iter().map(|n| n.world_from_local).collect();
        Self { world_from_node, brightness: Vec::new(), weights: HashMap::new() }
    }

    fn world(&self, node: Option<usize>) -> Mat4 {
        node.map_or(Mat4::IDENTITY, |n| self.world_from_node[n])
    }

    /// The camera where its nodes are; `None` if it sees nothing in particular.
    fn camera(&self, hung: &HungCamera) -> Option<Camera> {
        let (eye_node, target_node) = (self.world_from_node[hung.eye], self.world_from_node[hung.target]);
        let eye = eye_node.transform_point3(hung.local.eye);
        let target = target_node.transform_point3(hung.local.target);
        let ahead = (target - eye).try_normalize()?;
        let up = eye_node.transform_vector3(hung.local.up).try_normalize()?;
        // Straight up or down: any other direction will do.
        let up = if ahead.cross(up).length() > 1e-3 { up } else { ahead.any_orthonormal_vector() };
        let finite = eye.is_finite() && target.is_finite();
        finite.then(|| Camera { eye, target, up, ..hung.local.clone() })
    }
}

fn sample_vector(track: &super::Track, seconds: f32, value: &mut Vec3) {
    let mut v = value.to_array();
    track.sample(seconds, &mut v);
    *value = v.into();
}

/// Down the tree, parents first. A node that leaves the range of numbers rests.
fn worlds(nodes: &[Node], moved: &[Option<Transform>]) -> Vec<Mat4> {
    let mut all: Vec<Mat4> = Vec::with_capacity(nodes.len());
    for (node, moved) in nodes.iter().zip(moved) {
        let parent_from_local = moved.map_or(node.parent_from_local, |m| m.matrix());
        let world = node.parent.map_or(Mat4::IDENTITY, |p| all[p]) * parent_from_local;
        all.push(if world.is_finite() { world } else { node.world_from_local });
    }
    all
}

#[cfg(test)]
mod tests;
