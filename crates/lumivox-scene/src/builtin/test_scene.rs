//! The smallest scene that shows what indirect light does: 48 triangles, as the dissertation's test scene has.

use glam::{Mat4, Vec2, Vec3};

use super::builder::{Builder, SceneBuilder, pick};
use crate::{Camera, Light, Material, Scene};

/// Outer half width, height and half depth; the walls are 0.2 m thick.
const OUTER: [f32; 3] = [2.0, 3.0, 2.0];
const THICK: f32 = 0.2;

/// A room 3.6 m wide and 2.6 m high with thick walls, open at the front (+z), red on the left and green on the right,
/// with a block and a wedge in it: a shell of 28 triangles, a block of 12 and a wedge of 8, after the test scene of
/// Gaitatzes' dissertation (2012), section 5.6. The sun falls in through the open side onto the red wall and the floor;
/// everything else lives on what they reflect.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 48 | 192 | 768 | 3 072 | 12 288 |
pub fn test(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let [white, red, green] =
        [matte("white", 0.74, 0.72, 0.68), matte("red", 0.66, 0.08, 0.05), matte("green", 0.12, 0.46, 0.10)];
    let [shell, blue, gold] =
        [matte("shell", 0.42, 0.40, 0.38), matte("blue", 0.14, 0.26, 0.62), matte("gold", 0.74, 0.50, 0.14)];
    let steps = pick(detail, [1, 2, 4, 8, 16]);

    // Corners by side: -1 or 1 in x and z, 0 or 1 in y. The inside reaches the open front.
    let outer = |x: f32, y: f32, z: f32| Vec3::new(x * OUTER[0], y * OUTER[1] - THICK, z * OUTER[2]);
    let inner = |x: f32, y: f32, z: f32| {
        let back = if z < 0.0 { THICK } else { 0.0 };
        Vec3::new(x * (OUTER[0] - THICK), y * (OUTER[1] - 2.0 * THICK), z * OUTER[2] + back)
    };
    // Seen from inside, counter-clockwise; seen from outside for the shell.
    let sides = |at: &dyn Fn(f32, f32, f32) -> Vec3| {
        [
            [at(-1.0, 0.0, 1.0), at(1.0, 0.0, 1.0), at(1.0, 0.0, -1.0), at(-1.0, 0.0, -1.0)],
            [at(-1.0, 1.0, -1.0), at(1.0, 1.0, -1.0), at(1.0, 1.0, 1.0), at(-1.0, 1.0, 1.0)],
            [at(-1.0, 0.0, -1.0), at(1.0, 0.0, -1.0), at(1.0, 1.0, -1.0), at(-1.0, 1.0, -1.0)],
            [at(-1.0, 0.0, 1.0), at(-1.0, 0.0, -1.0), at(-1.0, 1.0, -1.0), at(-1.0, 1.0, 1.0)],
            [at(1.0, 0.0, -1.0), at(1.0, 0.0, 1.0), at(1.0, 1.0, 1.0), at(1.0, 1.0, -1.0)],
        ]
    };
    let names = ["floor", "ceiling", "back wall", "left wall", "right wall"];
    let materials = [white, white, white, red, green];
    for ((corners, name), material) in sides(&inner).into_iter().zip(names).zip(materials) {
        let mut wall = Builder::default();
        wall.quad(corners, [steps; 2], Vec3::ONE);
        scene.add(name, wall, material);
    }
    let mut outside = Builder::default();
    for [a, b, c, d] in sides(&outer) {
        outside.quad([a, d, c, b], [steps; 2], Vec3::ONE);
    }
    let rim = [(-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, 0.0)];
    for pair in rim.windows(2) {
        let [(ax, ay), (bx, by)] = [pair[0], pair[1]];
        outside.quad(
            [outer(ax, ay, 1.0), outer(bx, by, 1.0), inner(bx, by, 1.0), inner(ax, ay, 1.0)],
            [steps; 2],
            Vec3::ONE,
        );
    }
    scene.add("shell", outside, shell);

    let mut block = Builder::default();
    block.block(Vec3::new(-0.62, 0.74, -0.75), Vec3::new(0.95, 1.5, 0.95), 0.32, steps, Vec3::ONE);
    scene.add("block", block, blue);
    let mut ramp = Builder::default();
    wedge(&mut ramp, Vec3::new(0.75, -0.01, 0.35), steps);
    scene.add("wedge", ramp, gold);

    scene.light(Light::Directional {
        direction: Vec3::new(-0.62, -0.62, -0.55).normalize_or_zero(),
        irradiance: Vec3::new(14.0, 13.0, 11.2),
    });
    scene.sky(Vec3::new(0.22, 0.28, 0.38));
    scene.camera(Camera::look("front", Vec3::new(0.35, 1.45, 6.1), Vec3::new(0.0, 1.22, 0.0), 36.0));
    scene.camera(Camera::look("aside", Vec3::new(3.3, 2.6, 5.4), Vec3::new(-0.3, 0.9, 0.0), 36.0));
    scene.finish()
}

/// A ramp 1 m wide that rises to 0.8 m, turned a little; each of its faces in `steps` cells.
fn wedge(b: &mut Builder, foot: Vec3, steps: u32) {
    let place = Mat4::from_translation(foot) * Mat4::from_rotation_y(-0.45);
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let outline = [Vec2::new(-0.6, 0.0), Vec2::new(0.6, 0.0), Vec2::new(0.6, 0.8)];
    let mut body = Builder::default();
    for (z, front) in [(0.5, true), (-0.5, false)] {
        let [a, p, q] = outline.map(|v| v.extend(z));
        let corner =
            |i: u32, j: u32| a + (p - a) * i as f32 / steps as f32 + (q - p) * j as f32 / steps as f32;
        let normal = if front { Vec3::Z } else { Vec3::NEG_Z };
        for i in 0..steps {
            for j in 0..=i {
                let mut vertex = |i, j| body.vertex(corner(i, j), normal, Vec2::ZERO, Vec3::ONE);
                let lower = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)];
                let upper = (j < i).then(|| [vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                body.triangle(lower);
                upper.into_iter().for_each(|t| body.triangle(t));
            }
        }
    }
    for pair in [[0, 1], [1, 2], [2, 0]] {
        let [p, q] = pair.map(|i: usize| outline[i]);
        let quad = [at(p.x, p.y, 0.5), at(p.x, p.y, -0.5), at(q.x, q.y, -0.5), at(q.x, q.y, 0.5)];
        body.quad(quad, [steps; 2], Vec3::ONE);
    }
    b.append(place, &body);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn it_has_48_triangles_and_four_times_as_many_a_level_up() {
        assert_eq!([0, 1, 2, 3, 4].map(|d| test(d).triangle_count()), [48, 192, 768, 3072, 12288]);
    }

    #[test]
    fn shell_block_and_wedge_are_closed_and_have_their_volumes() {
        let scene = test(1);
        let solid = |names: &[&str]| checks::world_triangles(&scene, |n| names.contains(&n));
        let shell = solid(&["floor", "ceiling", "back wall", "left wall", "right wall", "shell"]);
        for (triangles, volume) in [
            (shell, 4.0 * 3.0 * 4.0 - 3.6 * 2.6 * 3.8),
            (solid(&["block"]), 0.95 * 1.5 * 0.95),
            (solid(&["wedge"]), 0.5 * 1.2 * 0.8),
        ] {
            assert_eq!(checks::open_edges(&triangles), 0);
            assert!((checks::volume(&triangles) - volume).abs() < 1e-3, "{volume}");
        }
    }
}
