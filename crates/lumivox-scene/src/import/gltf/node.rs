//! The node tree: instances, cameras and lights in world space.

use std::ops::Range;

use glam::{Mat4, Vec3};
use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;

use crate::import::source::Source;
use crate::mesh::check_limit;
use crate::{Camera, Instance, Light, Limits, Scene, SceneError, SpotFalloff};

/// Walks the tree with a list of its own instead of recursion, so that no depth of nesting reaches the stack.
/// `ranges` says for each glTF mesh which of the scene's meshes are its primitives.
pub(super) fn place(
    source: &Source,
    document: &gltf::Document,
    ranges: &[Range<usize>],
    limits: &Limits,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let count = document.nodes().count();
    let mut open: Vec<(gltf::Node, Mat4, u64)> =
        roots(document).into_iter().map(|n| (n, Mat4::IDENTITY, 1)).collect();
    if count == 0 {
        let all = (0..scene.meshes.len()).map(|mesh| Instance { mesh, world_from_local: Mat4::IDENTITY });
        scene.instances.extend(all);
    }
    if open.is_empty() && count > 0 && document.scenes().len() == 0 {
        return Err(source.malformed("has no root among its nodes: each is another one's child"));
    }
    let mut seen = vec![false; count];
    while let Some((node, world_from_parent, depth)) = open.pop() {
        // A tree reaches each node once; this also ends cycles and keeps shared subtrees from multiplying.
        if std::mem::replace(&mut seen[node.index()], true) {
            let index = node.index();
            return Err(source.malformed(format!("reaches node {index} twice; its nodes must form a tree")));
        }
        check_limit(source.name(), "the depth of its node tree", depth, limits.node_depth)?;
        let world_from_local = world_from_parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        if !world_from_local.is_finite() {
            scene.report.warn(format!("node {} is left out: its transform is not finite", node.index()));
            continue;
        }
        if let Some(range) = node.mesh().and_then(|m| ranges.get(m.index())) {
            scene.instances.extend(range.clone().map(|mesh| Instance { mesh, world_from_local }));
            check_limit(
                source.name(),
                "the number of instances",
                scene.instances.len() as u64,
                limits.nodes,
            )?;
        }
        if node.skin().is_some() {
            scene.report.warn("skinned meshes are shown in their rest pose");
        }
        if let Some(camera) = node.camera() {
            match camera_of(&camera, node.name(), &world_from_local) {
                Some(camera) => scene.cameras.push(camera),
                None => {
                    scene.report.warn("a camera is left out: it is not in perspective or has no direction")
                }
            }
        }
        if let Some(light) = node.light() {
            match light_of(&light, &world_from_local) {
                Some(light) => scene.lights.push(light),
                None => scene.report.warn("a light is left out: its numbers make no light"),
            }
        }
        open.extend(node.children().map(|child| (child, world_from_local, depth + 1)));
    }
    // The list is last in, first out.
    scene.instances.sort_by_key(|i| i.mesh);
    Ok(())
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
