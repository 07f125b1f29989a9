//! Two closed rooms beside each other, one lit and one dark: light in the dark one has leaked.

use glam::{Mat4, Vec3};

use super::builder::{Builder, SceneBuilder, pick};
use super::masonry::{Masonry, plain};
use crate::{Camera, Light, Material, Scene};

/// Width (x), height and depth (z) of the inside of each room.
const ROOM: Vec3 = Vec3::new(4.0, 2.8, 4.0);
/// Thickness of floor, ceiling and all walls but the shared one.
const OUTER: f32 = 0.3;
/// Least and greatest thickness of the shared wall.
const THICKNESS: [f32; 2] = [0.002, 4.0];
/// The wall's thickness in the scene that goes by name.
const BY_NAME: f32 = 0.2;

/// Two rooms of 4 x 2.8 x 4 m inside, closed all round, that share a wall of `wall_thickness` metres about x = 0 (0.002
/// to 4; what is outside of that, or no number, is brought inside). A point lamp of 30 W/sr lights the room at -x. No
/// light reaches the room at +x: whatever a renderer shows there has leaked. `builtin:two_rooms` has a wall of 0.2 m.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 588 | 1 392 | 3 440 | 9 936 | 31 176 |
pub fn two_rooms(detail: u32, wall_thickness: f32) -> Scene {
    let mut scene = SceneBuilder::default();
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let [outside, white, floor, shared] = [
        matte("outer wall", 0.50, 0.48, 0.45),
        matte("white plaster", 0.75, 0.74, 0.72),
        matte("floor boards", 0.45, 0.30, 0.18),
        matte("shared wall", 0.76, 0.72, 0.64),
    ];
    let [orange, blue, crate_wood, stone] = [
        matte("orange plaster", 0.72, 0.30, 0.08),
        matte("blue plaster", 0.12, 0.25, 0.60),
        matte("crate wood", 0.52, 0.36, 0.20),
        matte("pale stone", 0.70, 0.68, 0.64),
    ];
    let [least, most] = THICKNESS;
    let half = 0.5 * if wall_thickness.is_nan() { BY_NAME } else { wall_thickness.clamp(least, most) };
    let longest = pick(detail, [f32::INFINITY, 1.5, 0.7, 0.35, 0.18]);
    let steps = pick(detail, [1, 2, 3, 5, 8]);
    let sides = pick(detail, [8, 12, 20, 32, 48]);

    let (far, top, deep) = (half + ROOM.x, ROOM.y, 0.5 * ROOM.z);
    let mut m = Masonry::default();
    m.fill([-far - OUTER, -OUTER, -deep - OUTER], [far + OUTER, top + OUTER, deep + OUTER], outside);
    m.fill([-far - 0.1, -0.1, -deep - 0.1], [far + 0.1, top + 0.1, deep + 0.1], white);
    m.fill([-far, 0.0, -deep - 0.1], [0.0, top, -deep], orange);
    m.fill([0.0, 0.0, -deep - 0.1], [far, top, -deep], blue);
    m.fill([-far, -0.1, -deep], [far, 0.0, deep], floor);
    m.cut([-far, 0.0, -deep], [far, top, deep]);
    // Into the other walls by their plaster, so that it is one piece with them.
    m.fill([-half, -0.1, -deep - 0.1], [half, top + 0.1, deep + 0.1], shared);
    m.finish(&mut scene, "rooms", longest, plain);

    for (side, name) in [(-1.0, "lit"), (1.0, "dark")] {
        let at = |x: f32, y: f32, z: f32| Mat4::from_translation(Vec3::new(side * (half + x), y, z));
        let mut b = Builder::default();
        let size = Vec3::splat(0.45);
        b.brick(at(1.0, 0.44, -1.1) * Mat4::from_rotation_y(0.35), -size, size, steps, Vec3::ONE);
        let size = Vec3::splat(0.28);
        b.brick(at(1.05, 1.16, -1.1) * Mat4::from_rotation_y(-0.3), -size, size, steps, Vec3::ONE);
        scene.add(&format!("crates, {name} room"), b, crate_wood);
        let mut b = Builder::default();
        b.ball(at(2.5, 0.44, -0.6) * Mat4::from_scale(Vec3::splat(0.45)), sides, Vec3::ONE);
        scene.add(&format!("ball, {name} room"), b, stone);
    }
    scene.light(Light::Point {
        position: Vec3::new(-half - 0.5 * ROOM.x, 2.2, 0.3),
        intensity: Vec3::new(30.0, 27.0, 22.0),
    });
    let view = |name: &str, side: f32| {
        let eye = Vec3::new(side * (far - 0.3), 1.6, deep - 0.3);
        Camera::look(name, eye, Vec3::new(side * (half + 1.2), 1.05, -0.9), 65.0)
    };
    scene.camera(view("lit room", -1.0));
    scene.camera(view("dark room", 1.0));
    scene.finish()
}

/// The scene that goes by name.
pub(super) fn by_name(detail: u32) -> Scene {
    two_rooms(detail, BY_NAME)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn triangles_are_as_documented_and_all_is_closed() {
        assert_eq!([0, 1, 2, 3, 4].map(|d| by_name(d).triangle_count()), [588, 1392, 3440, 9936, 31176]);
        for thickness in [0.01, 0.2, 1.0] {
            let triangles = checks::world_triangles(&two_rooms(1, thickness), |_| true);
            assert_eq!(checks::open_edges(&triangles), 0, "{thickness}");
        }
    }

    #[test]
    fn no_ray_leaves_a_room() {
        for thickness in [0.0, 0.01, 0.2, 1.0] {
            let scene = two_rooms(0, thickness);
            let triangles = checks::world_triangles(&scene, |_| true);
            let half = 0.5 * thickness.max(THICKNESS[0]);
            for side in [-1.0, 1.0] {
                let middle = side * (half + 0.5 * ROOM.x);
                for offset in [Vec3::ZERO, Vec3::new(-1.7, -0.9, 1.8), Vec3::new(1.9, 1.2, -1.9)] {
                    let from = Vec3::new(middle, 1.4, 0.0) + offset;
                    for way in checks::directions(3000) {
                        let end = from + checks::hit(&triangles, from, way).unwrap() * way;
                        let (x, rest) = ((end.x - middle).abs(), (end - Vec3::new(0.0, 1.4, 0.0)).abs());
                        assert!(x < 2.001 && rest.y < 1.401 && rest.z < 2.001, "{thickness}: {end}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_shared_wall_is_as_thick_as_asked_and_nonsense_is_brought_inside() {
        for (given, expected) in
            [(0.2, 0.2), (1.5, 1.5), (-1.0, 0.002), (f32::INFINITY, 4.0), (f32::NAN, 0.2)]
        {
            let triangles = checks::world_triangles(&two_rooms(0, given), |n| n == "rooms, shared wall");
            let widest = triangles.iter().flatten().map(|p| p.x.abs()).fold(0.0, f32::max);
            assert!((2.0 * widest - expected).abs() < 1e-5, "{given}: {widest}");
        }
    }

    #[test]
    fn the_lamp_is_in_the_lit_room_alone() {
        let scene = two_rooms(2, 0.2);
        assert!(matches!(scene.lights[..], [Light::Point { position, .. }] if position.x < -0.1));
        assert_eq!(scene.sky, Vec3::ZERO);
        assert!(scene.materials.iter().all(|m| m.emission == Vec3::ZERO));
    }
}
