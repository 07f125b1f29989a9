//! The node tree: instances, cameras and lights in world space, and what they hang on.

use glam::{Mat4, Quat, Vec3, Vec4};
use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;

use super::accessor::Reader;
use super::primitive::Budget;
use super::skin::{Shapes, Wardrobe};
use crate::animation::rig::{HungCamera, HungInstance, HungLight};
use crate::import::source::Source;
use crate::mesh::check_limit;
use crate::{Camera, Instance, Light, Limits, NodeId, Scene, SceneError, SpotFalloff, Transform};

/// The nodes that are shown, by their numbers in the file.
pub(super) struct Tree {
    /// Node of the animation.
    pub(super) ids: Vec<Option<NodeId>>,
    /// Number of morph targets.
    pub(super) targets: Vec<usize>,
    /// Those that are shown, parents first.
    order: Vec<usize>,
}

/// Walks the tree with a list of its own instead of recursion, so that no depth of nesting reaches the stack, and adds
/// its nodes to the animation.
pub(super) fn read(
    source: &Source,
    document: &gltf::Document,
    limits: &Limits,
    scene: &mut Scene,
) -> Result<Tree, SceneError> {
    let count = document.nodes().count();
    let mut open: Vec<(gltf::Node, Option<NodeId>, u64)> =
        roots(document).into_iter().map(|n| (n, None, 1)).collect();
    if open.is_empty() && count > 0 && document.scenes().len() == 0 {
        return Err(source.malformed("has no root among its nodes: each is another one's child"));
    }
    let mut tree = Tree { ids: vec![None; count], targets: vec![0; count], order: Vec::new() };
    let mut seen = vec![false; count];
    while let Some((node, parent, depth)) = open.pop() {
        let index = node.index();
        // A tree reaches each node once; this also ends cycles and keeps shared subtrees from multiplying.
        if std::mem::replace(&mut seen[index], true) {
            return Err(source.malformed(format!("reaches node {index} twice; its nodes must form a tree")));
        }
        check_limit(source.name(), "the depth of its node tree", depth, limits.node_depth)?;
        let matrix = Mat4::from_cols_array_2d(&node.transform().matrix());
        let above = parent.map_or(Mat4::IDENTITY, |p| scene.animation.world_from_node(p));
        if !(above * matrix).is_finite() {
            scene.report.warn(format!("node {index} is left out: its transform is not finite"));
            continue;
        }
        let id = scene.animation.add_node_matrix(parent, matrix, rest_of(&node, &matrix));
        tree.ids[index] = Some(id);
        tree.order.push(index);
        open.extend(node.children().map(|child| (child, Some(id), depth + 1)));
    }
    Ok(tree)
}

/// The parts of a node's transform, which tracks replace one by one.
fn rest_of(node: &gltf::Node, matrix: &Mat4) -> Transform {
    match node.transform() {
        gltf::scene::Transform::Matrix { .. } => Transform::of_matrix(matrix),
        gltf::scene::Transform::Decomposed { translation, rotation, scale } => Transform {
            translation: translation.into(),
            rotation: Quat::from_vec4(Vec4::from(rotation).normalize_or(Vec4::W)),
            scale: scale.into(),
        },
    }
}

/// Puts meshes, cameras and lights where the nodes say, and hangs them there.
pub(super) fn place(
    reader: &Reader,
    document: &gltf::Document,
    tree: &mut Tree,
    shapes: &Shapes,
    skins: &[Option<usize>],
    budget: &mut Budget,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    if tree.ids.is_empty() {
        let all = (0..scene.meshes.len()).map(|mesh| Instance { mesh, world_from_local: Mat4::IDENTITY });
        scene.instances.extend(all);
    }
    let mut wardrobe = Wardrobe::new(shapes);
    let nodes: Vec<gltf::Node> = document.nodes().collect();
    let mut placed: Vec<(Instance, Option<NodeId>)> = Vec::new();
    for &index in &tree.order {
        let (node, Some(id)) = (&nodes[index], tree.ids[index]) else { continue };
        let world_from_local = scene.animation.world_from_node(id);
        if let Some((mesh, range)) =
            node.mesh().and_then(|m| Some((m.clone(), shapes.ranges.get(m.index())?)))
        {
            tree.targets[index] = shapes.target_count(mesh.index());
            let stated = reader.root.nodes[index].weights.as_deref().or(mesh.weights()).unwrap_or_default();
            let used = stated.iter().take(tree.targets[index]);
            let weights: Vec<f32> = used.map(|w| if w.is_finite() { *w } else { 0.0 }).collect();
            let skin = reader.root.nodes[index].skin.and_then(|s| skins.get(s.value()).copied().flatten());
            for mesh in range.clone() {
                let joints = skin.map_or(0, |s| scene.animation.skins[s].joints.len());
                let last = wardrobe.last_joint(mesh);
                let skin = skin.filter(|_| (last as usize) < joints);
                if joints > 0 && skin.is_none() {
                    let name = &scene.meshes[mesh].name;
                    let why = format!("it uses joint {last} of {joints}");
                    scene.report.warn(format!("the skin of mesh '{name}' is left out: {why}"));
                }
                if !wardrobe.deforms(mesh, skin) {
                    let mesh = wardrobe.plain(mesh, scene, budget)?;
                    placed.push((Instance { mesh, world_from_local }, Some(id)));
                    continue;
                }
                let (own, skinned) = wardrobe.body(mesh, skin, id.0, weights.clone(), scene, budget)?;
                // Joints say where a skinned mesh is; its own node does not.
                let (world_from_local, on) =
                    if skinned { (Mat4::IDENTITY, None) } else { (world_from_local, Some(id)) };
                placed.push((Instance { mesh: own, world_from_local }, on));
            }
            budget.check_counts(0, placed.len())?;
        }
        place_camera_and_light(node, id, &world_from_local, scene);
    }
    placed.sort_by_key(|(i, _)| i.mesh);
    for (instance, node) in placed {
        let (rest, node_from_local) = (instance.world_from_local, Mat4::IDENTITY);
        if let Some(NodeId(node)) = node {
            let instance = scene.instances.len();
            let (outer, node) = (None, Some(node));
            scene.animation.instances.push(HungInstance { instance, outer, node, node_from_local, rest });
        }
        scene.instances.push(instance);
    }
    Ok(())
}

fn place_camera_and_light(node: &gltf::Node, id: NodeId, world_from_local: &Mat4, scene: &mut Scene) {
    if let Some(camera) = node.camera() {
        let [local, rest] =
            [&Mat4::IDENTITY, world_from_local].map(|place| camera_of(&camera, node.name(), place));
        if let (Some(local), Some(rest)) = (local, rest) {
            let camera = scene.cameras.len();
            scene.cameras.push(rest.clone());
            scene.animation.cameras.push(HungCamera { camera, eye: id.0, target: id.0, local, rest });
        } else {
            scene.report.warn("a camera is left out: it is not in perspective or has no direction");
        }
    }
    if let Some(light) = node.light() {
        let [local, rest] = [&Mat4::IDENTITY, world_from_local].map(|place| light_of(&light, place));
        if let (Some(local), Some(rest)) = (local, rest) {
            let light = scene.lights.len();
            scene.lights.push(rest);
            scene.animation.lights.push(HungLight { light, node: id.0, local, rest });
        } else {
            scene.report.warn("a light is left out: its numbers make no light");
        }
    }
}

/// The nodes of the scene to show: the default one, else the first, else whatever is no one's child.
fn roots(document: &gltf::Document) -> Vec<gltf::Node<'_>> {
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        return scene.nodes().collect();
    }
    let mut is_child = vec![false; document.nodes().count()];
    for child in document.nodes().flat_map(|n| n.children()) {
        is_child[child.index()] = true;
    }
    document.nodes().filter(|n| !is_child[n.index()]).collect()
}

fn camera_of(camera: &gltf::Camera, node: Option<&str>, world_from_local: &Mat4) -> Option<Camera> {
    let Projection::Perspective(perspective) = camera.projection() else { return None };
    let eye = world_from_local.transform_point3(Vec3::ZERO);
    let forward = world_from_local.transform_vector3(Vec3::NEG_Z).try_normalize()?;
    let up = world_from_local.transform_vector3(Vec3::Y).try_normalize()?;
    let fov_y = perspective.yfov();
    let usable = forward.cross(up).length() > 1e-3 && fov_y > 1e-3 && fov_y < std::f32::consts::PI - 1e-3;
    let name = node.or(camera.name()).unwrap_or_default().to_owned();
    usable.then_some(Camera { name, eye, target: eye + forward, up, fov_y })
}

fn light_of(light: &gltf::khr_lights_punctual::Light, world_from_local: &Mat4) -> Option<Light> {
    let strength = Vec3::from(light.color()) * light.intensity();
    if !strength.is_finite() || strength.min_element() < 0.0 {
        return None;
    }
    let position = world_from_local.transform_point3(Vec3::ZERO);
    let direction = world_from_local.transform_vector3(Vec3::NEG_Z).try_normalize();
    Some(match light.kind() {
        Kind::Directional => Light::Directional { direction: direction?, irradiance: strength },
        Kind::Point => Light::Point { position, intensity: strength },
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            let cutoff = outer_cone_angle;
            if !(cutoff > 0.0 && cutoff <= std::f32::consts::PI) {
                return None;
            }
            // A beam as wide as the cutoff is a hard edge; the gap keeps the falloff's quotient defined.
            let beam = inner_cone_angle.clamp(0.0, cutoff * 0.999);
            let falloff = SpotFalloff::Gltf;
            Light::Spot { position, direction: direction?, intensity: strength, beam, cutoff, falloff }
        }
    })
}
