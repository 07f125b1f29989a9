//! The nodes and what hangs on them.

use glam::Mat4;

use super::deform::{Body, Skin};
use super::{Clip, Transform};
use crate::{Camera, Light, Scene};

/// A node of an [`Animation`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeId(pub(crate) usize);

/// The nodes, clips and skins of a scene, and which of its parts they move. Empty for a scene that stands still.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// Parents come before their children.
    pub(super) nodes: Vec<Node>,
    pub(crate) clips: Vec<Clip>,
    pub(crate) instances: Vec<HungInstance>,
    pub(crate) lights: Vec<HungLight>,
    pub(crate) cameras: Vec<HungCamera>,
    pub(crate) skins: Vec<Skin>,
    pub(crate) bodies: Vec<Body>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    /// Smaller than the node's own number.
    pub(super) parent: Option<usize>,
    /// Where it rests, as the start for tracks that move a part of it.
    pub(super) rest: Transform,
    /// Where it rests, exactly.
    pub(super) parent_from_local: Mat4,
    /// Where it rests; finite.
    pub(super) world_from_local: Mat4,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HungInstance {
    pub(crate) instance: usize,
    /// The node that moves the whole of the file that the instance is from.
    pub(crate) outer: Option<usize>,
    /// The node within that file.
    pub(crate) node: Option<usize>,
    pub(crate) node_from_local: Mat4,
    /// Where it stood when it was hung.
    pub(crate) rest: Mat4,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HungLight {
    pub(crate) light: usize,
    pub(crate) node: usize,
    /// The light in the node's space.
    pub(crate) local: Light,
    pub(crate) rest: Light,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HungCamera {
    pub(crate) camera: usize,
    /// What the eye and up hang on.
    pub(crate) eye: usize,
    /// What the target hangs on.
    pub(crate) target: usize,
    /// The camera in its nodes' spaces.
    pub(crate) local: Camera,
    pub(crate) rest: Camera,
}

impl Animation {
    /// Adds a node below `parent`, or at the root if that is `None` or no node of this animation. A transform that is
    /// not finite counts as none.
    pub fn add_node(&mut self, parent: Option<NodeId>, local: Transform) -> NodeId {
        self.add_node_matrix(parent, local.matrix(), local)
    }

    /// Adds a node that rests at `matrix`; tracks that move a part of it start from `rest`.
    pub(crate) fn add_node_matrix(
        &mut self,
        parent: Option<NodeId>,
        matrix: Mat4,
        rest: Transform,
    ) -> NodeId {
        let parent = parent.map(|p| p.0).filter(|p| *p < self.nodes.len());
        let (rest, matrix) =
            if matrix.is_finite() { (rest, matrix) } else { (Transform::default(), Mat4::IDENTITY) };
        let above = parent.map_or(Mat4::IDENTITY, |p| self.nodes[p].world_from_local);
        let world = above * matrix;
        let world_from_local = if world.is_finite() { world } else { above };
        self.nodes.push(Node { parent, rest, parent_from_local: matrix, world_from_local });
        NodeId(self.nodes.len() - 1)
    }

    pub(crate) fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Takes over the nodes of another animation, behind those that are there.
    pub(crate) fn append_nodes(&mut self, other: &Self) {
        let first = self.nodes.len();
        let shifted = |n: &Node| Node { parent: n.parent.map(|p| p + first), ..n.clone() };
        self.nodes.extend(other.nodes.iter().map(shifted));
    }

    /// Adds a clip; its index is that for [`Scene::pose`].
    pub fn add_clip(&mut self, clip: Clip) -> usize {
        self.clips.push(clip);
        self.clips.len() - 1
    }

    /// Whether there is no clip to play.
    pub fn is_empty(&self) -> bool {
        self.clips.is_empty()
    }

    /// Where a node rests in the world; identity for one of another animation.
    pub fn world_from_node(&self, node: NodeId) -> Mat4 {
        self.nodes.get(node.0).map_or(Mat4::IDENTITY, |n| n.world_from_local)
    }

    /// `node_from_world` of the rest; `None` for a foreign node, identity for one without volume.
    fn node_from_world(&self, node: NodeId) -> Option<Mat4> {
        let inverse = self.nodes.get(node.0)?.world_from_local.inverse();
        Some(if inverse.is_finite() { inverse } else { Mat4::IDENTITY })
    }
}

impl Scene {
    /// Lets an instance move with a node from now on; at rest it stays where it stands. A node whose rest has no volume
    /// takes it as if its place were stated in the node's space. Indices out of range are ignored, here and below.
    pub fn hang_instance(&mut self, instance: usize, node: NodeId) {
        let Some(rest) = self.instances.get(instance).map(|i| i.world_from_local) else { return };
        let Some(node_from_world) = self.animation.node_from_world(node) else { return };
        let node_from_local = node_from_world * rest;
        let (outer, node) = (None, Some(node.0));
        self.animation.instances.push(HungInstance { instance, outer, node, node_from_local, rest });
    }

    /// The instances that move as a whole and whose meshes keep their shape, in order; [`Scene::instances`] by number.
    pub fn rigid_instances(&self) -> Vec<usize> {
        let bends = |mesh: usize| self.animation.bodies.iter().any(|b| b.mesh == mesh);
        let hung = self.animation.instances.iter().map(|h| h.instance);
        let mut rigid: Vec<usize> =
            hung.filter(|&i| self.instances.get(i).is_some_and(|instance| !bends(instance.mesh))).collect();
        rigid.sort_unstable();
        rigid.dedup();
        rigid
    }

    /// Lets a light move with a node from now on; at rest it stays where it is. Nodes move and turn lights; of scale
    /// only rectangles take notice.
    pub fn hang_light(&mut self, light: usize, node: NodeId) {
        let Some(&rest) = self.lights.get(light) else { return };
        let Some(node_from_world) = self.animation.node_from_world(node) else { return };
        let local = rest.transformed(&node_from_world).unwrap_or(rest);
        self.animation.lights.push(HungLight { light, node: node.0, local, rest });
    }

    /// Lets a camera move with a node from now on; at rest it stays where it is.
    pub fn hang_camera(&mut self, camera: usize, node: NodeId) {
        self.hang_camera_between(camera, node, node);
    }

    /// Lets a camera's eye and up move with one node and its target with another.
    pub fn hang_camera_between(&mut self, camera: usize, eye: NodeId, target: NodeId) {
        let Some(rest) = self.cameras.get(camera).cloned() else { return };
        let (Some(from_eye), Some(from_target)) =
            (self.animation.node_from_world(eye), self.animation.node_from_world(target))
        else {
            return;
        };
        let local = Camera {
            eye: from_eye.transform_point3(rest.eye),
            target: from_target.transform_point3(rest.target),
            up: from_eye.transform_vector3(rest.up).normalize_or(rest.up),
            ..rest.clone()
        };
        self.animation.cameras.push(HungCamera { camera, eye: eye.0, target: target.0, local, rest });
    }
}

impl Light {
    /// The light moved by a matrix; `None` if it would lose its direction or its finiteness.
    pub(super) fn transformed(&self, target_from_source: &Mat4) -> Option<Self> {
        let point = |p| Some(target_from_source.transform_point3(p)).filter(|p| p.is_finite());
        let vector = |v| target_from_source.transform_vector3(v);
        let unit = |v| vector(v).try_normalize();
        let mut light = *self;
        match &mut light {
            Self::Directional { direction, .. } => *direction = unit(*direction)?,
            Self::Point { position, .. } => *position = point(*position)?,
            Self::Spot { position, direction, .. } => {
                *position = point(*position)?;
                *direction = unit(*direction)?;
            }
            Self::Rect { origin, u, v, .. } => {
                *origin = point(*origin)?;
                (*u, *v) = (vector(*u), vector(*v));
                let area = u.cross(*v);
                if !u.is_finite() || !v.is_finite() || !area.is_finite() || area == glam::Vec3::ZERO {
                    return None;
                }
            }
        }
        Some(light)
    }

    /// The light with its strength multiplied.
    pub(super) fn dimmed(&self, factor: f32) -> Self {
        let mut light = *self;
        let strength = match &mut light {
            Self::Directional { irradiance, .. } => irradiance,
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Rect { radiance, .. } => radiance,
        };
        let dimmed = *strength * factor.max(0.0);
        if dimmed.is_finite() {
            *strength = dimmed;
        }
        light
    }
}
