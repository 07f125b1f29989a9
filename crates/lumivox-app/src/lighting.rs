//! Light for scenes that bring none.

use glam::Vec3;
use lumivox_scene::{Camera, Light, Scene};

use crate::args::ShotArgs;
use crate::framing;

/// A camera that sees the sky in less than this share of all directions is in a closed room.
const CLOSED: f32 = 0.03;

/// The lights of the command line, else the scene's, else a lamp in a closed room, else a sun and a grey sky.
pub(crate) fn light_scene(scene: &mut Scene, shot: &ShotArgs, camera: &Camera) {
    if let Some(sun) = shot.sun {
        scene.lights = vec![Light::Directional { direction: sun.direction, irradiance: sun.irradiance }];
        scene.sky = Vec3::ZERO;
        scene.sky_map = None;
        return;
    }
    let emits = scene.materials.iter().any(|m| m.emission.max_element() > 0.0);
    if !scene.lights.is_empty() || emits || scene.has_sky() {
        return;
    }
    let forward = (camera.target - camera.eye).normalize_or_zero();
    let right = forward.cross(Vec3::Y).try_normalize().unwrap_or(Vec3::X);
    let around = framing::surroundings(scene, &scene.bounds(), camera.eye);
    if let Some(around) = around.filter(|a| a.openness < CLOSED) {
        eprintln!("lumivox: the scene has no light: a lamp is added where the camera is (--sun sets a sun)");
        let position = camera.eye + 0.1 * around.distance * (Vec3::Y - right);
        let intensity = around.distance * around.distance * Vec3::new(5.0, 4.7, 4.2);
        scene.lights = vec![Light::Point { position, intensity }];
    } else {
        eprintln!("lumivox: the scene has no light: a sun and a grey sky are added (--sun sets another)");
        // Over the camera's left shoulder, high.
        let level = forward.with_y(0.0).normalize_or_zero();
        let direction = (0.55 * level + 0.6 * right + Vec3::NEG_Y).normalize_or_zero();
        scene.lights = vec![Light::Directional { direction, irradiance: Vec3::new(9.0, 8.4, 7.4) }];
        scene.sky = Vec3::splat(0.4);
    }
}
