//! A closed torus knot over a floor: concave, smooth, and meant to be seen through.

use std::f32::consts::{PI, TAU};

use glam::{Mat4, Vec2, Vec3};

use super::builder::{Builder, SceneBuilder, pick};
use crate::{Camera, Glass, Light, Material, Scene};

/// Times the knot goes around the upright axis, and around the ring.
const TURNS: [f32; 2] = [2.0, 3.0];
/// Radius of the ring, of the way around it, and of the tube.
const RING: f32 = 1.0;
const WAY: f32 = 0.42;
const TUBE: f32 = 0.21;
/// Height of the knot's middle over the floor.
pub(super) const MIDDLE: f32 = 1.05;

/// A (2, 3) torus knot of 0.42 m thick tube over a checkered floor, with a coloured wall behind and balls around, so that
/// there is something to be bent. The knot is one closed smooth surface, slightly green where it is thick: it is meant for
/// refraction; renderers without show a white knot.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 1 440 | 3 192 | 12 752 | 42 768 | 139 520 |
pub fn knot_glass(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let clear =
        Glass { color: Vec3::new(0.78, 0.95, 0.90), distance: 0.5, bend: Some(4.0), ..Glass::default() };
    let glass = Material { glass: Some(clear), ..Material::matte("glass", Vec3::ONE) };
    let glass = scene.material(glass);
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let [light, dark, wall] = [
        matte("light tiles", 0.72, 0.70, 0.66),
        matte("dark tiles", 0.16, 0.17, 0.20),
        matte("wall", 0.30, 0.48, 0.62),
    ];
    let balls =
        [matte("red", 0.66, 0.09, 0.06), matte("gold", 0.76, 0.52, 0.12), matte("green", 0.12, 0.46, 0.14)];
    let around = pick(detail, [48, 96, 192, 384, 768]);
    let sides = pick(detail, [8, 12, 24, 40, 64]);
    let steps = pick(detail, [1, 1, 2, 4, 8]);

    let mut knot = Builder::default();
    tube(&mut knot, around, sides);
    scene.add("knot", knot, glass);

    let (mut lights, mut darks) = (Builder::default(), Builder::default());
    for i in 0..10 {
        for j in 0..10 {
            let corner = Vec3::new(0.6 * (i as f32 - 5.0), 0.0, 0.6 * (j as f32 - 5.0));
            let tile = if (i + j) % 2 == 0 { &mut lights } else { &mut darks };
            tile.grid(corner, 0.6 * Vec3::Z, 0.6 * Vec3::X, [steps; 2], Vec3::ONE);
        }
    }
    // The slab's other sides, up to the tiles.
    let (low, size) = (Vec3::new(-3.0, -0.2, -3.0), 6.0);
    darks.grid(low, size * Vec3::X, size * Vec3::Z, [10 * steps; 2], Vec3::ONE);
    for side in 0..4 {
        let turn = Mat4::from_rotation_y(0.5 * PI * side as f32);
        let along = turn.transform_vector3(Vec3::X);
        let from = turn.transform_point3(Vec3::new(-3.0, -0.2, 3.0));
        darks.grid(from, size * along, 0.2 * Vec3::Y, [10 * steps, 1], Vec3::ONE);
    }
    scene.add("light tiles", lights, light);
    scene.add("dark tiles and slab", darks, dark);
    let mut b = Builder::default();
    b.brick(Mat4::IDENTITY, Vec3::new(-2.98, -0.1, -2.9), Vec3::new(2.98, 2.6, -2.65), 2 * steps, Vec3::ONE);
    scene.add("wall", b, wall);
    for ((material, name), (x, z, radius)) in balls
        .into_iter()
        .zip(["red ball", "gold ball", "green ball"])
        .zip([(-1.75, -0.9, 0.42f32), (1.7, -1.2, 0.5), (1.35, 1.25, 0.28)])
    {
        let mut b = Builder::default();
        let place =
            Mat4::from_translation(Vec3::new(x, radius - 0.005, z)) * Mat4::from_scale(Vec3::splat(radius));
        b.ball(place, sides, Vec3::ONE);
        scene.add(name, b, material);
    }
    scene.light(Light::Directional {
        direction: Vec3::new(-0.45, -0.8, -0.4).normalize_or_zero(),
        irradiance: Vec3::new(10.0, 9.4, 8.4),
    });
    scene.sky(Vec3::new(0.55, 0.65, 0.80));
    scene.camera(Camera::look("knot", Vec3::new(0.9, 2.0, 4.6), Vec3::new(0.0, 0.95, 0.0), 40.0));
    scene.camera(Camera::look("above", Vec3::new(-2.6, 4.2, 2.8), Vec3::new(0.0, 0.9, 0.0), 40.0));
    scene.finish()
}

/// The knot's middle line, `t` in 0..1 once along all of it.
fn line(t: f32) -> Vec3 {
    let [p, q] = TURNS.map(|n| n * TAU * t);
    let radius = RING + WAY * q.cos();
    // Leaning towards the viewer, so that one sees into the loops.
    let flat = Vec3::new(radius * p.cos(), WAY * q.sin(), radius * p.sin());
    Mat4::from_rotation_x(1.05).transform_vector3(0.62 * flat) + MIDDLE * Vec3::Y
}

/// A closed tube about the line. Its cross sections are framed by the way to the ring's middle line, which comes back to
/// itself, so that the ends meet without a twist.
pub(super) fn tube(b: &mut Builder, around: u32, sides: u32) {
    let section = |i: u32| {
        let t = (i % around) as f32 / around as f32;
        let e = 1e-3;
        let ahead = (line(t + e) - line(t - e)).normalize_or_zero();
        // Of a torus knot's curvature there is always some: the curve's own bend gives a frame that closes.
        let bend = line(t + e) + line(t - e) - 2.0 * line(t);
        let across = (bend - ahead * ahead.dot(bend)).normalize_or_zero();
        (line(t), across, ahead.cross(across))
    };
    for i in 0..around {
        let (middle, across, up) = section(i);
        for j in 0..sides {
            let (sin, cos) = (TAU * j as f32 / sides as f32).sin_cos();
            let normal = cos * across + sin * up;
            let uv = Vec2::new(i as f32 / around as f32, j as f32 / sides as f32);
            b.vertex(middle + TUBE * normal, normal, uv, Vec3::ONE);
        }
    }
    for i in 0..around {
        for j in 0..sides {
            let (k, m) = ((i + 1) % around, (j + 1) % sides);
            let [p, q, r, s] = [(i, j), (k, j), (k, m), (i, m)].map(|(i, j)| i * sides + j);
            b.triangle([p, q, r]);
            b.triangle([p, r, s]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn triangles_are_as_documented_and_all_is_closed() {
        assert_eq!(
            [0, 1, 2, 3, 4].map(|d| knot_glass(d).triangle_count()),
            [1440, 3192, 12752, 42768, 139520]
        );
        for detail in [0, 2] {
            assert_eq!(checks::open_edges(&checks::world_triangles(&knot_glass(detail), |_| true)), 0);
        }
    }

    #[test]
    fn the_knot_is_one_tube_that_does_not_touch_itself_or_the_floor() {
        let triangles = checks::world_triangles(&knot_glass(2), |n| n == "knot");
        assert_eq!(checks::open_edges(&triangles), 0);
        let lowest = triangles.iter().flatten().map(|p| p.y).fold(f32::INFINITY, f32::min);
        assert!((0.02..0.2).contains(&lowest), "{lowest}");
        // The volume of a tube is its section times its length, unless it runs through itself.
        let points: Vec<Vec3> = (0..=1000).map(|i| line(i as f32 / 1000.0)).collect();
        let length: f32 = points.windows(2).map(|p| p[0].distance(p[1])).sum();
        let volume = checks::volume(&triangles);
        assert!((volume / (PI * TUBE * TUBE * length) - 1.0).abs() < 0.03, "{volume}, length {length}");
        for i in 0..200i32 {
            for j in 0..200i32 {
                let apart = (i - j).rem_euclid(200).min((j - i).rem_euclid(200));
                let near = line(i as f32 / 200.0).distance(line(j as f32 / 200.0)) < 2.05 * TUBE;
                assert!(!near || apart < 30, "{i} {j}");
            }
        }
    }
}
