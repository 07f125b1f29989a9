//! Scenes of odd shapes, sizes and places.

use glam::{Mat4, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{Renderer, VoxelSource};
use lumivox_scene::{Camera, Instance, Light, Material, Mesh, Scene};

use super::{Faults, box_camera, dark_box, point, refused, tiny};
use crate::Check;

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("odd shapes: flat in one, two or three axes, without area, beyond all numbers", odd_shapes),
    ("odd instances: mirrored, of no size, sheared, huge", odd_instances),
    ("a picture does not depend on the scene's size or place", sizes_and_places),
];

fn of_triangles(corners: &[[f32; 3]]) -> Scene {
    let indices = (0..corners.len() as u32 / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    let mut scene = Scene::default();
    scene.materials.push(Material::default());
    scene.meshes.push(Mesh::flat("odd", corners.to_vec(), indices, 0));
    scene.instances.push(Instance { mesh: 0, world_from_local: Mat4::IDENTITY });
    scene.lights = vec![
        point(Vec3::new(0.3, 0.6, 1.0), 5.0),
        Light::Directional {
            direction: Vec3::new(0.3, -1.0, -0.4).normalize_or_zero(),
            irradiance: Vec3::ONE,
        },
    ];
    scene.sky = Vec3::splat(0.3);
    scene
}

fn odd_shapes(gpu: &Gpu) -> Result<(), Failed> {
    let camera = Camera::look("", Vec3::new(0.4, 0.5, 2.0), Vec3::new(0.3, 0.3, 0.0), 60.0);
    let mut faults = Faults::default();
    let line: Vec<[f32; 3]> = (0..9).map(|n| [0.1 * n as f32, 0.0, 0.0]).collect();
    let slanted: Vec<[f32; 3]> = (0..9).map(|n| [0.1 * n as f32; 3]).collect();
    for (what, corners) in [
        ("one triangle", vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        ("one slanted triangle", vec![[0.0, 0.0, 0.0], [1.0, 0.2, 0.3], [0.1, 1.0, -0.4]]),
        ("a line of triangles without area", line),
        ("a slanted line of triangles without area", slanted),
        ("a needle", vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-20, 0.0]]),
    ] {
        faults.look_at(gpu, what, &of_triangles(&corners), &camera)?;
    }
    faults.into_result()?;
    for corners in [
        [[0.5; 3]; 6],
        [[1e30, 0.0, 0.0], [0.0, 1e30, 0.0], [0.0, 0.0, 1e30], [0.0; 3], [1.0; 3], [2.0; 3]],
        [[0.0; 3], [1e-30, 0.0, 0.0], [0.0, 1e-30, 0.0], [0.0; 3], [0.0; 3], [0.0; 3]],
        [[f32::MAX, 0.0, 0.0], [-f32::MAX, 1.0, 0.0], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]],
    ] {
        let said = refused(gpu, &of_triangles(&corners)).to_string();
        assert!(said.starts_with("a grid needs a box"), "{corners:?}: {said}");
    }
    Ok(())
}

fn odd_instances(gpu: &Gpu) -> Result<(), Failed> {
    let mut faults = Faults::default();
    let scaled = |x, y, z| Mat4::from_scale(Vec3::new(x, y, z));
    let shear = Mat4::from_cols_array(&[
        1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]);
    for (what, matrix) in [
        ("mirrored", scaled(-1.0, 1.0, 1.0)),
        ("mirrored in all axes", scaled(-1.0, -1.0, -1.0)),
        ("flat", scaled(1.0, 0.0, 1.0)),
        ("a line", scaled(0.0, 1.0, 0.0)),
        ("of no size", scaled(0.0, 0.0, 0.0)),
        ("all zeros", Mat4::ZERO),
        ("sheared", shear),
        ("of 1e-20", scaled(1e-20, 1e-20, 1e-20)),
        ("of 1e20 in one axis that it has no extent in", scaled(1.0, 1.0, 1e20)),
    ] {
        let mut scene = of_triangles(&[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]]);
        scene.instances.push(Instance { mesh: 0, world_from_local: matrix });
        faults.look_at(gpu, what, &scene, &Camera::look("", Vec3::new(0.1, 0.2, 2.0), Vec3::ZERO, 60.0))?;
    }
    // Beside a sound mesh: triangles without area, none at all, and some beyond all numbers.
    let mut scene = dark_box();
    scene.lights = vec![point(Vec3::Y, 3.0)];
    let three = |n: u32| [3 * n, 3 * n + 1, 3 * n + 2];
    for (mesh, matrix) in [
        (Mesh::flat("", vec![[0.1; 3]; 30], (0..10).map(three).collect(), 0), Mat4::IDENTITY),
        (Mesh::default(), Mat4::IDENTITY),
        (
            Mesh::flat("", vec![[0.0; 3], [0.5, 0.5, 0.0], [0.2, 0.1, 0.0]], vec![three(0)], 0),
            scaled(1.0, 1.0, 1e38),
        ),
    ] {
        scene.instances.push(Instance { mesh: scene.meshes.len(), world_from_local: matrix });
        scene.meshes.push(mesh);
    }
    faults.look_at(gpu, "degenerate meshes in a box", &scene, &box_camera())?;
    faults.into_result()
}

/// The box, `scale` times as large and with its middle at a place; its light grows with the square, so that the picture stays.
fn moved(scale: f32, place: Vec3) -> (Scene, Camera) {
    let mut scene = dark_box();
    let world = Mat4::from_translation(place) * Mat4::from_scale(Vec3::splat(scale));
    for instance in &mut scene.instances {
        instance.world_from_local = world * instance.world_from_local;
    }
    scene.lights = vec![point(world.transform_point3(Vec3::new(0.2, 1.2, 0.6)), 5.0 * scale * scale)];
    let camera = box_camera();
    let [eye, target] = [camera.eye, camera.target].map(|p| world.transform_point3(p));
    (scene, Camera { eye, target, ..camera })
}

fn sizes_and_places(gpu: &Gpu) -> Result<(), Failed> {
    let mut faults = Faults::default();
    let mut picture = |scale: f32, place: Vec3, voxels| -> Result<Vec<Vec3>, Failed> {
        let (scene, camera) = moved(scale, place);
        let mut renderer = Renderer::new(gpu, &scene, tiny(voxels))?;
        renderer.set_camera(&camera);
        faults.look(gpu, &format!("{scale:e} times as large at {place}, {voxels:?}"), &mut renderer)?;
        renderer.settle(0, None)?;
        Ok(renderer.read_picture()?)
    };
    let mut wrong = Vec::new();
    for voxels in [VoxelSource::Progressive, VoxelSource::Triangles] {
        let expected = picture(1.0, Vec3::ZERO, voxels)?;
        let mean = |pixels: &[Vec3]| pixels.iter().map(|p| p.element_sum()).sum::<f32>();
        // Within rounding: a pixel at an edge or a shadow's may fall to the other side.
        for (scale, place, tolerance) in [
            (0.6e-9, Vec3::ZERO, 0.02),
            (1e-6, Vec3::ZERO, 0.02),
            (1e-3, Vec3::ZERO, 0.02),
            (1e3, Vec3::ZERO, 0.02),
            (1e6, Vec3::ZERO, 0.02),
            (0.4e9, Vec3::ZERO, 0.02),
            (1.0, Vec3::new(0.0, 0.0, 100.0), 0.02),
            // Rounding of depth roughens shadows from a few hundred times the scene's size on.
            (1.0, Vec3::new(0.0, 0.0, 1e3), f32::INFINITY),
            // Coordinates are multiples of 1/16 m there.
            (1.0, Vec3::new(1e6, 0.0, 0.0), f32::INFINITY),
            (1.0, Vec3::splat(1e7), f32::INFINITY),
        ] {
            let seen = picture(scale, place, voxels)?;
            let error = (mean(&seen) / mean(&expected) - 1.0).abs();
            if error.is_nan() || error > tolerance {
                wrong.push(format!("{scale:e} times as large at {place}, {voxels:?}: off by {error}"));
            }
        }
    }
    faults.0.extend(wrong);
    faults.into_result()
}
