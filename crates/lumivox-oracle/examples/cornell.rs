//! Renders a Cornell box and prints the time it takes, the mean of each layer and its noise:
//! `cargo run -p lumivox-oracle --example cornell`.

use std::time::Instant;

use glam::Vec3;
use lumivox_oracle::scene::{Camera, Light, Material, Scene, SceneError, Triangle};
use lumivox_oracle::tracer::{Settings, Tracer};

fn add_quad(scene: &mut Scene, [a, b, c, d]: [Vec3; 4], albedo: Vec3) {
    let material = scene.materials.len() as u32;
    scene.materials.push(Material::matte(albedo));
    scene.triangles.extend([[a, b, c], [a, c, d]].map(|t| Triangle::flat(t, material)));
}

/// The sides and the top of a block that stands on the floor, turned about its upright axis.
fn add_block(scene: &mut Scene, center: Vec3, size: Vec3, turn: f32) {
    let (sin, cos) = turn.sin_cos();
    let [p, q, r, s] = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)].map(|(x, z)| {
        let (x, z) = (x * size.x, z * size.z);
        center + Vec3::new(cos * x + sin * z, 0.0, cos * z - sin * x)
    });
    let up = size.y * Vec3::Y;
    let white = Vec3::splat(0.725);
    add_quad(scene, [p + up, q + up, r + up, s + up], white);
    for [a, b] in [[p, q], [q, r], [r, s], [s, p]] {
        add_quad(scene, [a, b, b + up, a + up], white);
    }
}

fn cornell() -> Scene {
    let mut scene = Scene::default();
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let (white, red, green) =
        (Vec3::splat(0.725), Vec3::new(0.63, 0.065, 0.05), Vec3::new(0.14, 0.45, 0.091));
    let [w, h] = [1.0, 2.0];
    add_quad(&mut scene, [at(-w, 0.0, w), at(w, 0.0, w), at(w, 0.0, -w), at(-w, 0.0, -w)], white);
    add_quad(&mut scene, [at(-w, h, w), at(-w, h, -w), at(w, h, -w), at(w, h, w)], white);
    add_quad(&mut scene, [at(-w, 0.0, -w), at(w, 0.0, -w), at(w, h, -w), at(-w, h, -w)], white);
    add_quad(&mut scene, [at(-w, 0.0, w), at(-w, 0.0, -w), at(-w, h, -w), at(-w, h, w)], red);
    add_quad(&mut scene, [at(w, 0.0, w), at(w, h, w), at(w, h, -w), at(w, 0.0, -w)], green);
    add_block(&mut scene, at(-0.33, 0.0, -0.29), at(0.6, 1.2, 0.6), 0.3);
    add_block(&mut scene, at(0.33, 0.0, 0.37), at(0.6, 0.6, 0.6), -0.3);
    scene.lights.push(Light::Rect {
        origin: at(-0.25, 1.98, -0.25),
        u: 0.5 * Vec3::X,
        v: 0.5 * Vec3::Z,
        radiance: Vec3::new(17.0, 12.0, 4.0),
    });
    scene
}

#[expect(clippy::print_stdout, reason = "that is what it is for")]
fn main() -> Result<(), SceneError> {
    let scene = cornell();
    let camera = Camera { eye: Vec3::new(0.0, 1.0, 3.9), target: Vec3::Y, up: Vec3::Y, fov_y: 0.686 };
    let settings = Settings::default();
    let start = Instant::now();
    let picture = Tracer::new(&scene)?.render(&camera, &settings, &|_| {})?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{} x {}, {} samples: {seconds:.2} s", settings.width, settings.height, settings.samples);
    for (name, layer) in [
        ("direct", &picture.direct),
        ("first bounce", &picture.first_bounce),
        ("indirect", &picture.indirect),
    ] {
        let error = layer.radiance_error.mean() / layer.radiance.mean();
        println!("{name}: mean {:.4}, mean error of a pixel {:.1} %", layer.radiance.mean(), 100.0 * error.y);
    }
    Ok(())
}
