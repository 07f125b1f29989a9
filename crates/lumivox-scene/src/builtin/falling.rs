//! Bodies that fall past each other and bounce on a floor, each rigid: what visibility fields are for.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Mat4, Quat, Vec2, Vec3};

use super::builder::{Builder, SceneBuilder, pick};
use super::{bodies, knot_glass};
use crate::{Camera, Clip, Light, Material, NodeId, Scene, SpotFalloff, Track, Transform};

/// Seconds of the clip, which loops without a jump.
const DURATION: f32 = 6.0;
/// Keys per second.
const RATE: f32 = 20.0;
/// How high a body rises over the height at which it touches the floor.
const HEIGHT: f32 = 3.4;

/// A body by its number, where it falls, its axis, whole turns and bounces in the clip, and the part of the clip that it is ahead by.
struct Fall {
    body: usize,
    place: Vec2,
    axis: Vec3,
    turns: f32,
    bounces: f32,
    ahead: f32,
}

const fn fall(body: usize, place: [f32; 2], axis: [f32; 3], turns: f32, bounces: f32, ahead: f32) -> Fall {
    let [x, z] = place;
    Fall { body, place: Vec2::new(x, z), axis: Vec3::from_array(axis), turns, bounces, ahead }
}

const FALLS: [Fall; 10] = [
    fall(0, [-1.9, 0.6], [0.3, 1.0, 0.2], 1.0, 2.0, 0.10),
    fall(1, [0.2, -1.1], [1.0, 0.4, 0.1], 2.0, 3.0, 0.40),
    fall(2, [1.8, 0.9], [0.5, 0.3, 1.0], 1.0, 2.0, 0.75),
    fall(3, [-0.3, 1.5], [1.0, 0.1, 0.6], -1.0, 2.0, 0.55),
    fall(4, [2.4, -1.5], [0.2, 1.0, 0.7], -2.0, 3.0, 0.15),
    fall(1, [-2.6, -1.6], [0.4, 0.2, 1.0], -1.0, 2.0, 0.85),
    fall(2, [-0.9, -2.7], [1.0, 0.7, 0.0], 2.0, 3.0, 0.20),
    fall(4, [0.9, 2.6], [0.1, 0.5, 1.0], 1.0, 2.0, 0.95),
    fall(3, [3.4, 0.9], [0.7, 1.0, 0.2], 1.0, 3.0, 0.65),
    fall(0, [1.0, -3.2], [1.0, 0.2, 0.3], -1.0, 2.0, 0.35),
];

/// Ten bodies of five shapes that bounce on a floor under an overcast sky, a lamp and a panel of light: a knot, a jack, a stool, a
/// goblet and an arch, two of each. They turn, pass each other, and never touch. Its one clip, `fall`, takes 6 s and loops without
/// a jump.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 3 544 | 8 864 | 31 216 | 95 056 | 284 704 |
pub fn falling(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let floor = matte("floor", 0.66, 0.64, 0.60);
    let paints = [
        matte("red", 0.62, 0.14, 0.10),
        matte("blue", 0.16, 0.30, 0.58),
        matte("ochre", 0.66, 0.46, 0.16),
        matte("white", 0.76, 0.75, 0.72),
        matte("green", 0.20, 0.44, 0.22),
    ];
    let steps = pick(detail, [2, 4, 8, 16, 32]);
    let mut ground = Builder::default();
    ground.grid(Vec3::new(-9.0, 0.0, -9.0), 18.0 * Vec3::Z, 18.0 * Vec3::X, [steps; 2], Vec3::ONE);
    scene.add("floor", ground, floor);

    let names = ["knot", "jack", "stool", "goblet", "arch"];
    let mut nodes: [Vec<NodeId>; 5] = Default::default();
    let mut clip = Clip::new("fall");
    for fall in &FALLS {
        let node = scene.node(None, Transform::at(fall.at(0.0)));
        nodes[fall.body].push(node);
        let count = (DURATION * RATE) as u32;
        let keys = || (0..=count).map(|i| DURATION * i as f32 / count as f32);
        clip.push(node, Track::translation(keys().map(|t| (t, fall.at(t)))));
        clip.push(node, Track::rotation(keys().map(|t| (t, fall.turned(t)))));
    }
    for ((nodes, name), (paint, n)) in nodes.iter().zip(names).zip(paints.into_iter().zip(0..)) {
        scene.hang_all(name, body(n, detail), paint, nodes);
    }
    scene.clip(clip);

    scene.light(Light::Spot {
        position: Vec3::new(-5.0, 8.5, 4.0),
        direction: Vec3::new(0.5, -0.85, -0.4).normalize_or_zero(),
        intensity: Vec3::new(300.0, 270.0, 220.0),
        beam: 0.5,
        cutoff: 0.8,
        falloff: SpotFalloff::LinearAngle,
    });
    scene.light(Light::Rect {
        origin: Vec3::new(4.5, 7.0, -2.0),
        u: Vec3::new(0.0, 0.0, 3.0),
        v: Vec3::new(-1.6, 1.6, 0.0),
        radiance: Vec3::new(5.0, 6.0, 8.0),
    });
    scene.sky(Vec3::new(0.9, 0.95, 1.05));
    scene.camera(Camera::look("front", Vec3::new(0.6, 4.4, 10.2), Vec3::new(0.1, 1.6, 0.0), 42.0));
    scene.camera(Camera::look("above", Vec3::new(-5.5, 9.5, 5.5), Vec3::new(0.0, 0.6, 0.0), 45.0));
    scene.finish()
}

impl Fall {
    /// Where the body's middle is: parabolas, one after another. The body's radius is 1 m at most.
    fn at(&self, seconds: f32) -> Vec3 {
        let part = (self.bounces * (seconds / DURATION + self.ahead)).rem_euclid(1.0);
        let from_top = 2.0 * part - 1.0;
        Vec3::new(self.place.x, RADIUS + HEIGHT * (1.0 - from_top * from_top), self.place.y)
    }

    fn turned(&self, seconds: f32) -> Quat {
        let axis = self.axis.normalize_or(Vec3::Y);
        Quat::from_axis_angle(axis, TAU * self.turns * (seconds / DURATION + self.ahead))
    }
}

/// The radius of every body.
const RADIUS: f32 = 0.725;

/// A body of [`RADIUS`] about the origin.
fn body(number: usize, detail: u32) -> Builder {
    let sides = pick(detail, [10, 16, 32, 56, 96]);
    let steps = pick(detail, [1, 2, 4, 8, 14]);
    let mut b = Builder::default();
    match number {
        0 => {
            let mut knot = Builder::default();
            knot_glass::tube(
                &mut knot,
                pick(detail, [48, 80, 160, 288, 512]),
                pick(detail, [8, 12, 20, 32, 56]),
            );
            let middle = Mat4::from_translation(-knot_glass::MIDDLE * Vec3::Y);
            b.append(Mat4::from_scale(Vec3::splat(0.62)) * middle, &knot);
        }
        1 => jack(&mut b, sides),
        2 => stool(&mut b, steps),
        3 => goblet(&mut b, sides),
        _ => arch(&mut b, sides, steps),
    }
    b
}

/// Three bars that cross, with a ball at every end.
fn jack(b: &mut Builder, sides: u32) {
    for turn in [Mat4::IDENTITY, Mat4::from_rotation_x(FRAC_PI_2), Mat4::from_rotation_z(FRAC_PI_2)] {
        b.bar(turn * Mat4::from_translation(-0.58 * Vec3::Y), 0.07, 1.16, sides, Vec3::ONE);
        for end in [-0.57, 0.57] {
            let place = turn * Mat4::from_translation(end * Vec3::Y) * Mat4::from_scale(Vec3::splat(0.145));
            b.ball(place, sides, Vec3::ONE);
        }
    }
}

/// A seat on four legs with rails between them.
fn stool(b: &mut Builder, steps: u32) {
    let at = Mat4::from_translation(-0.02 * Vec3::Y);
    b.brick(at, Vec3::new(-0.4, 0.36, -0.4), Vec3::new(0.4, 0.46, 0.4), 2 * steps, Vec3::ONE);
    for (x, z) in [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)] {
        let foot = Vec3::new(x, -0.48, z);
        b.brick(at, foot - Vec3::new(0.06, 0.0, 0.06), foot + Vec3::new(0.06, 0.85, 0.06), steps, Vec3::ONE);
    }
    for side in [-0.3, 0.3] {
        let (low, high) = (Vec3::new(-0.28, -0.2, side - 0.035), Vec3::new(0.28, -0.12, side + 0.035));
        b.brick(at, low, high, steps, Vec3::ONE);
    }
}

/// A cup on a stem, hollow.
fn goblet(b: &mut Builder, sides: u32) {
    let profile = [
        [0.0, -0.66],
        [0.30, -0.66],
        [0.28, -0.61],
        [0.07, -0.53],
        [0.06, -0.16],
        [0.12, -0.08],
        [0.33, 0.10],
        [0.40, 0.34],
        [0.38, 0.60],
        [0.34, 0.60],
        [0.35, 0.34],
        [0.28, 0.14],
        [0.0, 0.02],
    ];
    b.turned(Mat4::IDENTITY, &profile, sides, Vec3::ONE);
}

/// Half a ring on two feet.
fn arch(b: &mut Builder, sides: u32, steps: u32) {
    let pieces = sides / 2;
    let line = |radius: f32| {
        let mut points = vec![Vec2::new(radius, -0.39)];
        points.extend(bodies::arc(Vec2::new(0.0, -0.05), radius, [0.0, PI], pieces));
        points.push(Vec2::new(-radius, -0.39));
        points
    };
    let place = Mat4::from_translation(-0.19 * Vec3::Z);
    b.band(place, [&line(0.36), &line(0.58)], false, [0.38, steps as f32], Vec3::ONE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn triangles_are_as_documented_and_bodies_are_closed() {
        assert_eq!([0, 1, 2, 3, 4].map(|d| falling(d).triangle_count()), [3544, 8864, 31216, 95056, 284704]);
        for detail in [0, 2] {
            for n in 0..5 {
                let scene = falling(detail);
                let name = ["knot", "jack", "stool", "goblet", "arch"][n];
                let triangles = checks::world_triangles(&scene, |m| m == name);
                assert_eq!(checks::open_edges(&triangles), 0, "{name}");
                let farthest = body(n, detail).mesh.positions.into_iter().map(|p| Vec3::from(p).length());
                let farthest = farthest.fold(0.0, f32::max);
                assert!((0.6..=RADIUS).contains(&farthest), "{name}: {farthest}");
            }
        }
    }

    #[test]
    fn bodies_fall_without_touching_and_the_clip_loops() {
        let mut passed = 0;
        for (n, a) in FALLS.iter().enumerate() {
            for b in &FALLS[..n] {
                let apart = a.place.distance(b.place);
                assert!(apart > 2.0 * RADIUS, "{n}: {apart}");
                let above = |t: f32| a.at(t).y > b.at(t).y;
                let moments = (0..60).map(|i| DURATION * i as f32 / 60.0);
                passed += i32::from(moments.clone().any(above) && moments.clone().any(|t| !above(t)));
            }
            assert!(a.at(DURATION).distance(a.at(0.0)) < 1e-3);
            assert!(a.turned(DURATION).dot(a.turned(0.0)).abs() > 1.0 - 1e-4);
            let lowest = (0..600).map(|i| a.at(0.01 * i as f32).y).fold(9.0, f32::min);
            assert!((RADIUS..RADIUS + 0.1).contains(&lowest), "{lowest}");
        }
        assert!(passed > 30, "{passed} pairs pass each other");
        let scene = falling(0);
        assert_eq!((scene.clips().len(), scene.clips()[0].duration), (1, DURATION));
    }
}
