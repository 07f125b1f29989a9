//! The path tracer under test: against closed forms, and what it promises besides.

mod behaviour;
mod closed_forms;
mod convergence;

use glam::Vec3;

use crate::scene::{Light, Material, Scene, Triangle};
use crate::shapes;

fn scene(parts: impl IntoIterator<Item = (Vec<[Vec3; 3]>, Material)>, lights: Vec<Light>) -> Scene {
    let mut scene = Scene { lights, ..Scene::default() };
    for (n, (triangles, material)) in parts.into_iter().enumerate() {
        scene.materials.push(material);
        scene.triangles.extend(triangles.into_iter().map(|t| Triangle::flat(t, n as u32)));
    }
    scene
}

fn gray(albedo: f32) -> Material {
    Material::matte(Vec3::splat(albedo))
}

fn glowing(albedo: f32, emission: f32) -> Material {
    Material { emission: Vec3::splat(emission), ..gray(albedo) }
}

fn floor(half: f32, y: f32) -> Vec<[Vec3; 3]> {
    let at = |x: f32, z: f32| Vec3::new(half * x, y, half * z);
    shapes::quad([at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)]).to_vec()
}
