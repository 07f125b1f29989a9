//! A loaded scene in the path tracer's words, so that both see the same surfaces.

use glam::{Mat3, Mat4, Vec3, Vec4};
use lumivox_oracle::scene::{self as oracle, Camera, SpotFalloff, Triangle, Wrap};
use lumivox_scene::{AlphaMode, Light, Scene};

/// Surfaces with the normals that the renderer shades with, lights and sky.
///
/// As in the renderer, `Blend` is a mask of one half, and reflectances and vertex colours are cut to 0..=1. What is not
/// the same: the tracer has no mip levels, and keeps vertex colours in full precision.
pub(crate) fn oracle_scene(scene: &Scene) -> oracle::Scene {
    let mut lights: Vec<_> = scene.lights.iter().map(light).collect();
    if scene.sky != Vec3::ZERO {
        lights.push(oracle::Light::Constant { radiance: scene.sky });
    }
    oracle::Scene {
        triangles: scene.instances.iter().flat_map(|i| triangles(scene, i)).collect(),
        materials: scene.materials.iter().map(material).collect(),
        textures: scene.textures.iter().map(texture).collect(),
        lights,
        environment: scene.sky_map.as_ref().map(|map| oracle::Environment {
            width: map.width,
            height: map.height,
            pixels: map.pixels.clone(),
        }),
    }
}

/// The same camera.
pub(crate) fn oracle_camera(camera: &lumivox_scene::Camera) -> Camera {
    Camera { eye: camera.eye, target: camera.target, up: camera.up, fov_y: camera.fov_y }
}

fn triangles<'a>(
    scene: &'a Scene,
    instance: &lumivox_scene::Instance,
) -> impl Iterator<Item = Triangle> + use<'a> {
    let mesh = &scene.meshes[instance.mesh];
    let world_from_local = instance.world_from_local;
    let turn = normal_matrix(&world_from_local);
    mesh.indices.iter().map(move |corners| {
        let corners = corners.map(|n| n as usize);
        Triangle {
            positions: corners.map(|n| world_from_local.transform_point3(mesh.positions[n].into())),
            // Not normalised: the renderer interpolates before it does.
            normals: Some(corners.map(|n| turn * Vec3::from(mesh.normals[n]))),
            uvs: corners.map(|n| mesh.uvs[n].into()),
            colors: corners.map(|n| Vec4::from(mesh.colors[n]).clamp(Vec4::ZERO, Vec4::ONE)),
            material: mesh.material as u32,
        }
    })
}

/// What turns normals right under any scale, mirrored ones too: the cofactor matrix, here with a largest entry of one.
fn normal_matrix(world_from_local: &Mat4) -> Mat3 {
    let m = Mat3::from_mat4(*world_from_local);
    let m = m * (1.0 / largest(&m));
    let cofactor =
        Mat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    cofactor * (1.0 / largest(&cofactor))
}

/// The largest entry; one for a matrix of zeros.
fn largest(m: &Mat3) -> f32 {
    let most = m.to_cols_array().into_iter().fold(0.0, |most: f32, entry| most.max(entry.abs()));
    if most > 0.0 { most } else { 1.0 }
}

fn material(material: &lumivox_scene::Material) -> oracle::Material {
    oracle::Material {
        albedo: material.base_color.clamp(Vec4::ZERO, Vec4::ONE),
        albedo_texture: material.base_color_texture.map(|t| t as u32),
        alpha_cutoff: match material.alpha {
            AlphaMode::Opaque => None,
            AlphaMode::Mask { cutoff } => Some(cutoff),
            AlphaMode::Blend => Some(0.5),
        },
        emission: material.emission.max(Vec3::ZERO),
        emission_texture: material.emission_texture.map(|t| t as u32),
    }
}

fn texture(texture: &lumivox_scene::Texture) -> oracle::Texture {
    oracle::Texture {
        width: texture.width,
        height: texture.height,
        srgb: texture.srgb,
        pixels: texture.pixels.clone(),
        wrap: texture.wrap.map(|wrap| match wrap {
            lumivox_scene::Wrap::Repeat => Wrap::Repeat,
            lumivox_scene::Wrap::Mirror => Wrap::Mirror,
            lumivox_scene::Wrap::Clamp => Wrap::Clamp,
        }),
    }
}

fn light(light: &Light) -> oracle::Light {
    match *light {
        Light::Directional { direction, irradiance } => oracle::Light::Directional { direction, irradiance },
        Light::Point { position, intensity } => oracle::Light::Point { position, intensity },
        Light::Spot { position, direction, intensity, beam, cutoff, falloff } => oracle::Light::Spot {
            position,
            direction,
            intensity,
            falloff: match falloff {
                lumivox_scene::SpotFalloff::LinearAngle => SpotFalloff::LinearAngle { beam, cutoff },
                lumivox_scene::SpotFalloff::Gltf => SpotFalloff::Gltf { inner: beam, outer: cutoff },
            },
        },
        Light::Rect { origin, u, v, radiance } => oracle::Light::Rect { origin, u, v, radiance },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;
    use lumivox_scene::{Instance, Material, Mesh};

    /// A slanted triangle with its face's normal, placed by a matrix.
    fn placed(world_from_local: Mat4) -> Triangle {
        let positions = vec![[0.3, 0.1, 0.0], [1.0, 0.2, 0.4], [0.1, 1.0, 0.9]];
        let mut scene = Scene::default();
        scene.materials.push(Material::matte("m", Vec3::splat(0.5)));
        scene.meshes.push(Mesh::flat("m", positions, vec![[0, 1, 2]], 0));
        scene.instances.push(Instance { mesh: 0, world_from_local });
        oracle_scene(&scene).triangles[0]
    }

    #[test]
    fn normals_stay_upright_on_their_face_under_any_scale() {
        let turn = Mat4::from_quat(Quat::from_rotation_y(0.7));
        for scale in [
            Vec3::ONE,
            Vec3::new(1.0, 5.0, 0.2),
            Vec3::new(-1.0, 5.0, 0.2),
            Vec3::new(-3.0, -0.1, -2.0),
            Vec3::splat(-1e-9),
            Vec3::splat(1e12),
        ] {
            let triangle = placed(turn * Mat4::from_scale(scale));
            let [a, b, c] = triangle.positions.map(|p| p.as_dvec3());
            let face = (b - a).cross(c - a).normalize();
            for normal in triangle.normals.unwrap() {
                let normal = normal.as_dvec3().normalize();
                // A mirror turns the winding over, and the cofactor matrix turns normals with it.
                assert!((normal.dot(face) - 1.0).abs() < 1e-5, "{scale}: {normal} {face}");
            }
        }
    }

    #[test]
    fn a_flattened_instance_has_numbers_for_normals() {
        for scale in [Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.0, 0.0, 1.0)] {
            let triangle = placed(Mat4::from_scale(scale));
            assert!(triangle.normals.unwrap().iter().all(|n| n.is_finite()), "{scale}");
        }
    }

    #[test]
    fn every_built_in_scene_is_one_that_the_tracer_takes() {
        for name in lumivox_scene::builtin::NAMES {
            let scene = lumivox_scene::load(&format!("builtin:{name}:0")).unwrap();
            let converted = oracle_scene(&scene);
            assert_eq!(converted.check(), Ok(()), "{name}");
            assert_eq!(converted.triangles.len() as u64, scene.triangle_count());
        }
    }

    #[test]
    fn masks_colours_and_the_sky_are_those_of_the_renderer() {
        let mut scene = lumivox_scene::load("builtin:cornell:0").unwrap();
        scene.sky = Vec3::new(1.0, 2.0, 3.0);
        scene.materials[0].base_color = Vec4::new(1.5, 0.5, -1.0, 1.0);
        for (alpha, cutoff) in [
            (AlphaMode::Opaque, None),
            (AlphaMode::Mask { cutoff: 0.3 }, Some(0.3)),
            (AlphaMode::Blend, Some(0.5)),
        ] {
            scene.materials[0].alpha = alpha;
            let converted = oracle_scene(&scene);
            assert_eq!(converted.materials[0].alpha_cutoff, cutoff);
            assert_eq!(converted.materials[0].albedo, Vec4::new(1.0, 0.5, 0.0, 1.0));
            assert_eq!(converted.lights.last(), Some(&oracle::Light::Constant { radiance: scene.sky }));
        }
    }
}
