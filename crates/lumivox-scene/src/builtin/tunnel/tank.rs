//! The tank: hull, tracks, wheels, turret and gun. It looks towards +z; its origin lies on the ground under its middle.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Mat4, Quat, Vec2, Vec3};

use crate::builtin::bodies;
use crate::builtin::builder::{Builder, SceneBuilder, pick};
use crate::{Material, NodeId, Transform};

/// Where the turret turns, and where the gun tilts in the turret's axes.
const TURRET: Vec3 = Vec3::new(0.0, 1.42, -0.25);
const GUN: Vec3 = Vec3::new(0.0, 0.40, 0.95);
/// How far the gun points up at rest, radians about x.
pub(super) const GUN_TILT: f32 = -0.03;
/// Middles of the tracks are at plus and minus this in x; their width.
const TRACK: f32 = 1.32;
const TRACK_WIDTH: f32 = 0.56;
/// Radius of a wheel, and middles of the wheels of one side in z.
pub(super) const WHEEL: f32 = 0.36;
const WHEELS: [f32; 6] = [-2.0, -1.2, -0.4, 0.4, 1.2, 2.0];

/// From outlines drawn with x to the front and y up, extruded from the tank's left (+x) to its right.
fn sideways(left: f32) -> Mat4 {
    let columns = [Vec3::Z, Vec3::Y, Vec3::NEG_X].map(|v| v.extend(0.0));
    Mat4::from_cols(columns[0], columns[1], columns[2], Vec3::new(left, 0.0, 0.0).extend(1.0))
}

/// What moves of the tank.
pub(super) struct Rig {
    pub(super) tank: NodeId,
    pub(super) turret: NodeId,
    pub(super) gun: NodeId,
    pub(super) wheels: Vec<NodeId>,
}

/// The tank with its origin at `place`.
pub(super) fn add(scene: &mut SceneBuilder, place: Vec3, detail: u32) -> Rig {
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let [green, dark, rubber, light] = [
        matte("tank green", 0.30, 0.36, 0.16),
        matte("gun metal", 0.20, 0.22, 0.16),
        matte("tracks", 0.12, 0.11, 0.10),
        matte("head lamps", 0.85, 0.83, 0.75),
    ];
    let steps = pick(detail, [1, 2, 4, 8, 12]);
    let sides = pick(detail, [8, 12, 18, 28, 44]);
    let tank = scene.node(None, Transform::at(place));
    let turret_node = scene.node(Some(tank), Transform::at(TURRET));
    let gun_node = scene.node(Some(turret_node), Transform::turned(Quat::from_rotation_x(GUN_TILT), GUN));
    let wheels: Vec<NodeId> = [-1.0, 1.0]
        .into_iter()
        .flat_map(|side| WHEELS.map(|z| Vec3::new(side * TRACK, WHEEL + 0.1, z)))
        .map(|axle| scene.node(Some(tank), Transform::at(axle)))
        .collect();

    let mut b = Builder::default();
    hull(&mut b, steps);
    scene.hang("tank hull", b, green, tank);
    let mut b = Builder::default();
    tracks(&mut b, sides / 2, steps);
    scene.hang("tank tracks", b, rubber, tank);
    let mut b = Builder::default();
    wheel(&mut b, sides);
    scene.hang_all("tank wheel", b, dark, &wheels);
    let mut b = Builder::default();
    turret(&mut b, sides);
    scene.hang("tank turret", b, green, turret_node);
    let mut b = Builder::default();
    gun(&mut b, sides);
    scene.hang("tank gun", b, dark, gun_node);
    let mut b = Builder::default();
    for side in [-1.0, 1.0] {
        let place =
            Mat4::from_translation(Vec3::new(side * 1.05, 1.27, 2.1)) * Mat4::from_rotation_x(FRAC_PI_2);
        b.turned(place, &[[0.0, 0.0], [0.11, 0.0], [0.14, 0.26], [0.0, 0.30]], sides, Vec3::ONE);
    }
    scene.hang("tank head lamps", b, light, tank);
    Rig { tank, turret: turret_node, gun: gun_node, wheels }
}

/// The body between the tracks, the deck over them with mudguards, and boxes on it.
fn hull(b: &mut Builder, steps: u32) {
    let body = [[-2.9, 0.5], [2.5, 0.42], [3.0, 0.9], [2.1, 1.36], [-2.75, 1.36], [-3.05, 1.0]];
    b.prism(sideways(1.0), &body, 2.0, steps, Vec3::ONE);
    let deck = [[-2.85, 1.12], [2.6, 1.12], [2.0, 1.45], [-2.8, 1.45]];
    b.prism(sideways(1.66), &deck, 3.32, steps, Vec3::ONE);
    for side in [-1.0, 1.0] {
        let left = side * TRACK + 0.33;
        b.prism(sideways(left), &[[2.5, 1.08], [3.25, 0.98], [3.25, 1.03], [2.5, 1.16]], 0.66, 1, Vec3::ONE);
        let min = Vec3::new(side * 1.36 - 0.2, 1.40, -2.3);
        b.brick(Mat4::IDENTITY, min, min + Vec3::new(0.4, 0.26, 1.3), 1, Vec3::splat(0.85));
    }
    // Grille over the engine, and the driver's hatch.
    for i in 0..5 {
        let min = Vec3::new(-0.7, 1.42, -2.6 + 0.2 * i as f32);
        b.brick(Mat4::IDENTITY, min, min + Vec3::new(1.4, 0.07, 0.11), 1, Vec3::splat(0.7));
    }
    b.brick(Mat4::IDENTITY, Vec3::new(-0.3, 1.42, 1.35), Vec3::new(0.3, 1.52, 1.85), 1, Vec3::splat(0.9));
}

/// A closed ring on each side with cleats on the ground and over the top.
fn tracks(b: &mut Builder, pieces: u32, steps: u32) {
    let line = |inset: f32| {
        let mut points = Vec::new();
        // Counter-clockwise: along the ground to the front, up, back over the top and down.
        for (middle, radius, from, to) in [
            (Vec2::new(-2.05, 0.46), 0.46, -0.72 * PI, -0.5 * PI),
            (Vec2::new(2.05, 0.46), 0.46, -0.5 * PI, -0.28 * PI),
            (Vec2::new(2.62, 0.72), 0.36, -0.28 * PI, 0.5 * PI),
            (Vec2::new(-2.62, 0.72), 0.36, 0.5 * PI, 1.28 * PI),
        ] {
            points.extend(bodies::arc(middle, radius - inset, [from, to], pieces.max(2)));
        }
        points
    };
    let [inner, outer] = [line(0.1), line(0.0)];
    for side in [-1.0, 1.0] {
        let place = sideways(side * TRACK + 0.5 * TRACK_WIDTH);
        b.band(place, [&inner, &outer], true, [TRACK_WIDTH, steps as f32], Vec3::ONE);
        for (middle, radius) in [(Vec3::new(0.0, 0.72, 2.62), 0.27), (Vec3::new(0.0, 0.72, -2.62), 0.27)] {
            // Sprocket and idler.
            let place = Mat4::from_translation(middle + (side * TRACK + 0.2) * Vec3::X)
                * Mat4::from_rotation_z(FRAC_PI_2);
            b.bar(place, radius, 0.4, 4 * pieces.max(2), Vec3::splat(0.9));
        }
        // Cleats hang half sunk in the upper front and rear runs.
        for i in 0..13 {
            let z = -2.4 + 0.4 * i as f32;
            let min = Vec3::new(side * TRACK - 0.5 * TRACK_WIDTH - 0.01, 0.98, z);
            let max = Vec3::new(side * TRACK + 0.5 * TRACK_WIDTH + 0.01, 1.105, z + 0.1);
            b.brick(Mat4::IDENTITY, min, max, 1, Vec3::splat(0.8));
        }
    }
}

/// A road wheel about the tank's x axis, with a hub and bars that show how it turns.
fn wheel(b: &mut Builder, sides: u32) {
    let half = 0.2;
    let place = Mat4::from_translation(half * Vec3::X) * Mat4::from_rotation_z(FRAC_PI_2);
    let rim = [[0.0, -0.03], [0.1, -0.03], [0.12, 0.03], [0.28, 0.03], [0.28, 0.0], [WHEEL, 0.0]];
    let profile: Vec<[f32; 2]> =
        rim.iter().copied().chain(rim.iter().rev().map(|[r, y]| [*r, 2.0 * half - y])).collect();
    b.turned(place, &profile, sides, Vec3::ONE);
    for i in 0..3 {
        let turn = Mat4::from_rotation_x(PI * i as f32 / 3.0);
        // Each bar a little wider than the last: where they cross, no faces lie in one plane.
        let reach = half + 0.004 * i as f32;
        b.brick(turn, Vec3::new(-reach, -0.03, -0.29), Vec3::new(reach, 0.03, 0.29), 1, Vec3::splat(0.8));
    }
}

/// A rounded turret, longer than wide, with a commander's hatch.
fn turret(b: &mut Builder, sides: u32) {
    let dome = [
        [0.0, -0.02],
        [1.0, -0.02],
        [1.16, 0.16],
        [1.16, 0.34],
        [1.02, 0.56],
        [0.78, 0.72],
        [0.5, 0.78],
        [0.0, 0.80],
    ];
    b.turned(Mat4::from_scale(Vec3::new(1.0, 1.0, 1.14)), &dome, 2 * sides, Vec3::ONE);
    let hatch = Mat4::from_translation(Vec3::new(0.38, 0.7, -0.35));
    b.turned(
        hatch,
        &[[0.0, 0.0], [0.3, 0.0], [0.3, 0.2], [0.24, 0.26], [0.0, 0.27]],
        sides,
        Vec3::splat(0.9),
    );
    // The box at the back.
    b.brick(Mat4::IDENTITY, Vec3::new(-0.7, 0.12, -1.62), Vec3::new(0.7, 0.52, -1.0), 1, Vec3::splat(0.9));
}

/// Mantlet, barrel, fume extractor and muzzle brake along +z.
fn gun(b: &mut Builder, sides: u32) {
    let along = Mat4::from_rotation_x(FRAC_PI_2);
    let mantlet = Mat4::from_scale(Vec3::new(0.42, 0.30, 0.34));
    b.ball(mantlet, sides, Vec3::ONE);
    let profile = [
        [0.0, 0.1],
        [0.13, 0.1],
        [0.12, 0.9],
        [0.09, 0.95],
        [0.085, 1.5],
        [0.125, 1.55],
        [0.125, 1.95],
        [0.085, 2.0],
        [0.075, 2.75],
        [0.12, 2.78],
        [0.12, 3.1],
        [0.055, 3.1],
        [0.055, 2.7],
        [0.0, 2.7],
    ];
    b.turned(along, &profile, sides, Vec3::ONE);
}
