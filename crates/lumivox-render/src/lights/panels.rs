//! Rect lights as geometry: black, in the way of light, and not seen by the camera.

use glam::{Mat4, Vec3};
use lumivox_scene::{Instance, Light, Material, Mesh, Scene};

/// One black parallelogram per rect light, in the order of the lights.
pub fn panels(lights: &[Light]) -> Scene {
    let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut scene = Scene::default();
    scene.materials.push(Material::matte("back of a rect light", Vec3::ZERO));
    scene.meshes.push(Mesh::flat("rect light", square, vec![[0, 1, 2], [0, 2, 3]], 0));
    for light in lights {
        if let Light::Rect { origin, u, v, .. } = *light {
            let axes = (u.extend(0.0), v.extend(0.0), u.cross(v).extend(0.0), origin.extend(1.0));
            let world_from_local = Mat4::from_cols(axes.0, axes.1, axes.2, axes.3);
            scene.instances.push(Instance { mesh: 0, world_from_local });
        }
    }
    scene
}
