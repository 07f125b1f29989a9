//! Two rooms with a door between: it opens and shuts, and a figure walks behind it.
//!
//! ```text
//!   z = -3.6  +--------- red ---------+
//!             |       lamp            |      x -2.6..2.6, 2.7 m high
//!             |  <- figure walks ->   |      the wall between is 0.2 m thick, z -0.2..0
//!             +--------[door]---------+      the door opens towards +z
//!             |                       |
//!             |   camera, dim lamp    |      white room
//!   z =  4.2  +-----------------------+
//! ```

mod figure;
mod walk;

use glam::{Mat4, Quat, Vec2, Vec3};

use super::builder::{Builder, SceneBuilder, pick};
use super::masonry::{Masonry, plain};
use crate::{Camera, Clip, Light, Material, NodeId, Scene, Track, Transform};

/// Half width and height of the opening, and of the leaf, which covers the opening from the front.
const OPENING: [f32; 2] = [0.68, 2.15];
const LEAF: [f32; 2] = [0.73, 2.2];
/// Axis of the hinges, and half the thickness of the leaf.
const HINGE: Vec3 = Vec3::new(-LEAF[0], 0.0, 0.032);
const HALF_LEAF: f32 = 0.025;
/// Angle of the open door in radians.
const OPEN: f32 = 1.85;
/// Half width and height of both rooms, and their ends in z.
const HALF: f32 = 2.6;
const HEIGHT: f32 = 2.7;
const BACK: [f32; 2] = [-3.6, -0.2];
const FRONT: [f32; 2] = [0.0, 4.2];

/// A door that opens and shuts before a red room with a lamp, in which a jointed figure walks to and fro, after figure
/// 72 of Gaitatzes' dissertation (2012) and figure 6.7 of Gaitatzes and Papaioannou, *Progressive Screen-Space
/// Multichannel Surface Voxelization* (2013): what is behind the door and behind the figure is seen only at times.
/// The white room in front has a dim lamp of its own; when the door is open, light from the red room colours it.
///
/// One clip, `door`, of 9.8 s; it loops without a jump. The figure's feet stand still while they carry it.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 2 536 | 4 532 | 9 344 | 20 912 | 48 924 |
pub fn door(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let steps = pick(detail, [1, 1, 2, 4, 6]);
    let sides = pick(detail, [8, 12, 18, 28, 44]);
    rooms(&mut scene, detail);
    furniture(&mut scene, steps, sides);
    let leaf = leaf(&mut scene, steps, sides);

    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let clothes = figure::Clothes {
        skin: matte("skin", 0.60, 0.40, 0.29),
        shirt: matte("shirt", 0.16, 0.38, 0.62),
        trousers: matte("trousers", 0.20, 0.19, 0.22),
        shoes: matte("shoes", 0.12, 0.08, 0.06),
        hair: matte("hair", 0.13, 0.08, 0.055),
    };
    let figure = figure::add(&mut scene, &clothes, Vec3::new(0.0, 1.0, walk::LINE), sides);
    let mut clip = Clip::new("door");
    walk::add(&mut clip, &figure);
    clip.push(leaf, swing());
    scene.clip(clip.lasting(walk::DURATION));

    scene.light(Light::Point {
        position: Vec3::new(-0.55, 2.3, -3.0),
        intensity: Vec3::new(26.0, 22.5, 17.5),
    });
    scene.light(Light::Point { position: Vec3::new(1.7, 2.3, 3.3), intensity: Vec3::new(2.6, 2.9, 3.6) });
    scene.camera(Camera::look("front room", Vec3::new(0.75, 1.6, 3.2), Vec3::new(-0.1, 1.1, 0.0), 58.0));
    scene.camera(Camera::look("doorway", Vec3::new(0.5, 1.6, 1.5), Vec3::new(-0.1, 1.0, -2.0), 70.0));
    scene.camera(Camera::look("back room", Vec3::new(2.3, 1.7, -2.75), Vec3::new(-0.6, 1.0, -1.0), 66.0));
    scene.finish()
}

/// The door's angle over the clip: shut, opens, stands open while the figure turns, shuts, stays shut.
fn swing() -> Track {
    let (opening, shutting) = ([0.2, 1.9], [7.9, 9.6]);
    let angle = |t: f32| {
        let eased = |[from, to]: [f32; 2]| {
            let u = ((t - from) / (to - from)).clamp(0.0, 1.0);
            u * u * (3.0 - 2.0 * u)
        };
        OPEN * (eased(opening) - eased(shutting))
    };
    let count = 196u32;
    let times = (0..=count).map(|i| walk::DURATION * i as f32 / count as f32);
    // Towards +z: against the sense of a turn about y.
    Track::rotation(times.map(|t| (t, Quat::from_rotation_y(-angle(t)))))
}

fn rooms(scene: &mut SceneBuilder, detail: u32) {
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let [outside, white, red, boards, tiles, casing] = [
        matte("outer wall", 0.50, 0.48, 0.45),
        matte("white plaster", 0.76, 0.75, 0.72),
        matte("red plaster", 0.70, 0.10, 0.06),
        matte("floor boards", 0.50, 0.36, 0.23),
        matte("floor tiles", 0.60, 0.57, 0.52),
        matte("casing", 0.66, 0.62, 0.55),
    ];
    let longest = pick(detail, [f32::INFINITY, 1.2, 0.6, 0.35, 0.2]);
    let steps = pick(detail, [1, 1, 2, 4, 6]);
    let mut m = Masonry::default();
    m.fill([-HALF - 0.3, -0.3, BACK[0] - 0.3], [HALF + 0.3, HEIGHT + 0.3, FRONT[1] + 0.3], outside);
    m.fill([-HALF - 0.1, -0.1, BACK[0] - 0.1], [HALF + 0.1, HEIGHT + 0.1, FRONT[1] + 0.1], white);
    m.fill([-HALF - 0.1, 0.0, BACK[0] - 0.1], [HALF + 0.1, HEIGHT, BACK[0]], red);
    m.fill([HALF, 0.0, BACK[0]], [HALF + 0.1, HEIGHT, BACK[1]], red);
    m.fill([-HALF, -0.1, BACK[0]], [HALF, 0.0, -0.1], tiles);
    m.fill([-HALF, -0.1, -0.1], [HALF, 0.0, FRONT[1]], boards);
    m.cut([-HALF, 0.0, BACK[0]], [HALF, HEIGHT, BACK[1]]);
    m.cut([-HALF, 0.0, FRONT[0]], [HALF, HEIGHT, FRONT[1]]);
    let [half, high] = OPENING;
    m.cut([-half, 0.0, BACK[1]], [half, high, FRONT[0]]);
    m.finish(scene, "rooms", longest, plain);

    // Frames on both faces of the wall, 4 cm deep in it; in front the leaf lies inside the frame.
    let mut frames = Builder::default();
    for (inner, z, depth) in
        [([LEAF[0] + 0.02, LEAF[1] + 0.02], -0.04, 0.09), ([half + 0.02, high + 0.02], BACK[1] - 0.03, 0.07)]
    {
        let line = |wider: f32| {
            let [x, y] = inner.map(|v| v + wider);
            [(x, -0.02), (x, y), (-x, y), (-x, -0.02)].map(|(x, y)| Vec2::new(x, y))
        };
        let place = Mat4::from_translation(z * Vec3::Z);
        frames.band(place, [&line(0.0), &line(0.1)], false, [depth, steps as f32], Vec3::ONE);
    }
    scene.add("door frames", frames, casing);
}

/// The leaf with panels and knobs, on its hinge.
fn leaf(scene: &mut SceneBuilder, steps: u32, sides: u32) -> NodeId {
    let wood = scene.material(Material::matte("door wood", Vec3::new(0.44, 0.25, 0.12)));
    let brass = scene.material(Material::matte("brass", Vec3::new(0.72, 0.52, 0.20)));
    let node = scene.node(None, Transform::at(HINGE));
    let (width, low) = (2.0 * LEAF[0], 0.012);
    let mut b = Builder::default();
    b.brick(
        Mat4::IDENTITY,
        Vec3::new(0.0, low, -HALF_LEAF),
        Vec3::new(width, LEAF[1], HALF_LEAF),
        2 * steps,
        Vec3::ONE,
    );
    // Raised panels, only in front: behind, the leaf lies against the wall.
    for (y0, y1) in [(0.16, 0.95), (1.15, 2.04)] {
        for (x0, x1) in [(0.14, 0.67), (0.79, 1.32)] {
            let (min, max) = (Vec3::new(x0, y0, 0.0), Vec3::new(x1, y1, HALF_LEAF + 0.014));
            b.brick(Mat4::IDENTITY, min, max, steps, Vec3::splat(0.88));
        }
    }
    scene.hang("door leaf", b, wood, node);
    let mut b = Builder::default();
    let along = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
    // Through the leaf; the knob behind stays within the opening.
    let knob = Mat4::from_translation(Vec3::new(width - 0.13, 1.03, -0.07)) * along;
    b.bar(knob, 0.012, 0.14, sides, Vec3::ONE);
    for z in [-0.08, 0.08] {
        let place = Mat4::from_translation(Vec3::new(width - 0.13, 1.03, z));
        b.ball(place * Mat4::from_scale(Vec3::new(0.032, 0.032, 0.024)), sides, Vec3::ONE);
    }
    scene.hang("door knobs", b, brass, node);
    node
}

/// A carpet, a table with a vase, a stool, and a shelf with boxes in the back room.
fn furniture(scene: &mut SceneBuilder, steps: u32, sides: u32) {
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let [wood, carpet, clay, box_blue, box_gold] = [
        matte("dark wood", 0.24, 0.14, 0.08),
        matte("grey carpet", 0.55, 0.53, 0.50),
        matte("clay", 0.66, 0.62, 0.56),
        matte("blue box", 0.10, 0.22, 0.55),
        matte("gold box", 0.72, 0.50, 0.12),
    ];
    let mut b = Builder::default();
    b.brick(Mat4::IDENTITY, Vec3::new(-1.3, -0.02, 1.5), Vec3::new(1.1, 0.012, 3.2), steps, Vec3::ONE);
    scene.add("carpet", b, carpet);

    let mut b = Builder::default();
    let table = Mat4::from_translation(Vec3::new(1.75, 0.0, 0.75)) * Mat4::from_rotation_y(-0.08);
    b.brick(table, Vec3::new(-0.5, 0.72, -0.38), Vec3::new(0.5, 0.77, 0.38), steps, Vec3::ONE);
    for (x, z) in [(-0.44, -0.32), (-0.44, 0.32), (0.44, -0.32), (0.44, 0.32)] {
        let foot = Vec3::new(x, -0.02, z);
        b.brick(table, foot - Vec3::new(0.03, 0.0, 0.03), foot + Vec3::new(0.03, 0.76, 0.03), 1, Vec3::ONE);
    }
    let shelf = Mat4::from_translation(Vec3::new(1.2, 0.0, -3.42));
    for y in [-0.02, 0.5, 1.0] {
        b.brick(shelf, Vec3::new(-0.8, y, -0.2), Vec3::new(0.8, y + 0.06, 0.16), steps, Vec3::ONE);
    }
    for x in [-0.8, 0.76] {
        b.brick(shelf, Vec3::new(x - 0.01, -0.03, -0.19), Vec3::new(x + 0.05, 1.12, 0.17), steps, Vec3::ONE);
    }
    scene.add("table and shelf", b, wood);

    let mut b = Builder::default();
    let vase = [
        [0.0, 0.0],
        [0.06, 0.0],
        [0.12, 0.1],
        [0.13, 0.18],
        [0.07, 0.3],
        [0.06, 0.36],
        [0.09, 0.42],
        [0.075, 0.42],
        [0.0, 0.3],
    ];
    let at = |x, y, z| Mat4::from_translation(Vec3::new(x, y, z));
    b.turned(at(1.8, 0.765, 0.75), &vase, sides, Vec3::ONE);
    b.turned(at(1.6, 1.055, -3.42), &vase, sides, Vec3::ONE);
    let stool = [[0.0, 0.40], [0.2, 0.40], [0.21, 0.43], [0.2, 0.46], [0.0, 0.46]];
    b.turned(at(-1.7, 0.0, 2.4), &stool, sides, Vec3::ONE);
    for i in 0..3 {
        let (sin, cos) = (2.1 * i as f32).sin_cos();
        b.bar(at(-1.7 + 0.13 * cos, -0.02, 2.4 + 0.13 * sin), 0.022, 0.44, sides, Vec3::splat(0.7));
    }
    scene.add("vases and stool", b, clay);
    for (name, material, x, y, half) in
        [("blue box", box_blue, 0.75, 0.706, 0.15f32), ("gold box", box_gold, 1.0, 1.176, 0.12)]
    {
        let mut b = Builder::default();
        let place = at(x, y, -3.42) * Mat4::from_rotation_y(0.2);
        b.brick(place, Vec3::splat(-half), Vec3::splat(half), steps, Vec3::ONE);
        scene.add(name, b, material);
    }
}

#[cfg(test)]
mod tests;
