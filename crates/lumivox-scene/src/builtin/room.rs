//! A tall room in the sun: windows in a row, a staircase, and a hall behind that only light of two bounces reaches.
//!
//! ```text
//!   z = 3.2  +--[==]--[==]--[==]--+-------+     sun from +z, through the four windows, onto the floor
//!            |                 st |       |
//!            |   sun on the    ai |  hall |     x -5..2.6 room, 2.9..5.3 hall in two storeys
//!            |   floor         rs |       |     the stairs climb towards -z to a landing at 2.8 m
//!            |                 ===|       |
//!   z = -3.2 +-----------------=== -------+     doors below and above the landing
//! ```

use glam::{Mat4, Vec2, Vec3};

use super::builder::{Builder, SceneBuilder, pick};
use super::masonry::{Masonry, plain};
use crate::{Camera, Light, Material, Scene};

/// Half depth of the room, its height, and the thickness of the outer walls.
const HALF: f32 = 3.2;
const HEIGHT: f32 = 5.0;
const THICK: f32 = 0.4;
/// Height of the landing; the flight has as many steps as fit.
const LANDING: f32 = 2.8;
const STEPS: u32 = 16;
/// Where the flight starts and ends in z, and its width in x.
const FLIGHT: [f32; 2] = [2.4, -1.6];
const ACROSS: [f32; 2] = [1.4, 2.62];
/// Left and right sides of the windows, their sill and head.
const WINDOWS: [[f32; 2]; 4] = [[-4.6, -3.3], [-2.9, -1.6], [-1.2, 0.1], [0.5, 1.8]];
const SILL: f32 = 0.95;
const HEAD: f32 = 3.7;
/// Way of the sunlight.
const SUN: Vec3 = Vec3::new(-0.42, -0.82, -0.72);

/// A room lit by the sun through a row of windows, with a staircase, after the room of Gaitatzes' dissertation (2012),
/// section 5.6: the sun falls on a little of the floor, one bounce lights the walls and the ceiling, and the far wall of
/// the hall behind the door under the landing needs two. The flight is open below, so its underside lies in shadow.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 3 568 | 4 604 | 11 850 | 27 998 | 73 198 |
pub fn room(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let [plaster, ceiling, floor, outside] = [
        matte("plaster", 0.74, 0.70, 0.62),
        matte("ceiling", 0.80, 0.79, 0.76),
        matte("oak floor", 0.46, 0.29, 0.16),
        matte("outer wall", 0.55, 0.50, 0.44),
    ];
    let [teal, hall, wood, stone] = [
        matte("teal plaster", 0.16, 0.40, 0.40),
        matte("hall plaster", 0.72, 0.62, 0.44),
        matte("dark wood", 0.20, 0.11, 0.06),
        matte("stair stone", 0.66, 0.64, 0.60),
    ];
    let [red, frame, clay] = [
        matte("red carpet", 0.62, 0.07, 0.05),
        matte("window frames", 0.78, 0.77, 0.74),
        matte("clay", 0.60, 0.30, 0.16),
    ];
    let longest = pick(detail, [f32::INFINITY, 1.5, 0.6, 0.35, 0.22]);
    let steps = pick(detail, [1, 1, 2, 4, 8]);
    let sides = pick(detail, [8, 12, 20, 32, 48]);

    let mut m = Masonry::default();
    m.fill([-5.0 - THICK, -0.3, -HALF - THICK], [5.3 + THICK, HEIGHT + 0.3, HALF + THICK], outside);
    // What one sees from inside: a skin as thick as the plaster on it.
    m.fill([-5.06, -0.1, -HALF - 0.06], [2.7, HEIGHT + 0.06, HALF + 0.06], plaster);
    m.fill([-5.06, -0.1, -HALF - 0.06], [2.7, HEIGHT, -HALF], teal);
    m.fill([2.7, -0.1, -HALF - 0.06], [5.36, HEIGHT + 0.06, HALF + 0.06], hall);
    m.fill([-5.06, -0.1, -HALF], [5.36, 0.0, HALF], floor);
    m.fill([2.9, LANDING - 0.1, -HALF], [5.3, LANDING, HALF], floor);
    m.fill([-5.0, HEIGHT, -HALF], [2.6, HEIGHT + 0.06, HALF], ceiling);
    m.cut([-5.0, 0.0, -HALF], [2.6, HEIGHT, HALF]);
    m.cut([2.9, 0.0, -HALF], [5.3, LANDING - 0.3, HALF]);
    m.cut([2.9, LANDING, -HALF], [5.3, HEIGHT, HALF]);
    m.cut([2.6, 0.0, -2.9], [2.9, 2.2, -1.8]);
    m.cut([2.6, LANDING, -2.9], [2.9, HEIGHT - 0.2, -1.8]);
    for [left, right] in WINDOWS {
        m.cut([left, SILL, HALF], [right, HEAD, HALF + THICK]);
    }
    m.finish(&mut scene, "walls", longest, plain);

    let mut frames = Builder::default();
    WINDOWS.iter().for_each(|&[left, right]| window(&mut frames, left, right, steps));
    scene.add("window frames", frames, frame);

    let (mut stairs, mut rails) = (Builder::default(), Builder::default());
    flight(&mut stairs, steps);
    stairs.brick(
        Mat4::IDENTITY,
        Vec3::new(ACROSS[0] - 0.01, LANDING - 0.24, -HALF - 0.02),
        Vec3::new(ACROSS[1], LANDING, FLIGHT[1] + 0.02),
        steps,
        Vec3::ONE,
    );
    balustrade(&mut rails, steps);
    scene.add("staircase", stairs, stone);
    scene.add("balustrade", rails, wood);

    let mut carpet = Builder::default();
    carpet.slab(Vec3::new(-3.9, -0.02, -1.3), Vec3::new(-0.5, 0.015, 1.7), Vec3::ONE);
    scene.add("carpet", carpet, red);
    furniture(&mut scene, wood, clay, steps, sides);

    scene.light(Light::Directional {
        direction: SUN.normalize_or_zero(),
        irradiance: Vec3::new(20.0, 18.0, 15.0),
    });
    scene.sky(Vec3::new(0.45, 0.60, 0.85));
    scene.camera(Camera::look("room", Vec3::new(-4.65, 1.9, -1.9), Vec3::new(1.2, 1.75, 0.35), 64.0));
    scene.camera(Camera::look(
        "under the stairs",
        Vec3::new(-0.6, 1.5, -2.6),
        Vec3::new(2.6, 1.1, 0.2),
        60.0,
    ));
    scene.camera(Camera::look("hall", Vec3::new(5.0, 1.6, -2.7), Vec3::new(4.0, 1.2, 3.0), 62.0));
    scene.finish()
}

/// A cross of bars in a window, let into the wall by 3 cm.
fn window(b: &mut Builder, left: f32, right: f32, steps: u32) {
    let (low, high) = (HALF + 0.16, HALF + 0.22);
    let middle = 0.5 * (left + right);
    let upright = Vec3::new(middle - 0.035, SILL - 0.03, low);
    b.brick(Mat4::IDENTITY, upright, Vec3::new(middle + 0.035, HEAD + 0.03, high), steps, Vec3::ONE);
    for y in [2.1, 2.95] {
        let bar = Vec3::new(left - 0.03, y, low + 0.01);
        b.brick(Mat4::IDENTITY, bar, Vec3::new(right + 0.03, y + 0.06, high - 0.01), steps, Vec3::ONE);
    }
}

/// Height of the flight's sloping underside at `z`.
fn underside(z: f32) -> f32 {
    let slope = LANDING / (FLIGHT[0] - FLIGHT[1]);
    (FLIGHT[0] - z) * slope - 0.22
}

/// The steps, with a sloping underside that starts in the floor: one closed solid that reaches 2 cm into the wall.
fn flight(b: &mut Builder, steps: u32) {
    let run = (FLIGHT[0] - FLIGHT[1]) / STEPS as f32;
    let rise = LANDING / STEPS as f32;
    let [left, right] = ACROSS;
    let width = (right - left) * Vec3::X;
    let at = |y: f32, z: f32| Vec3::new(left, y, z);
    let mut body = Builder::default();
    // Top of step `i` from z(i) to z(i + 1); z falls as the flight climbs. The last one lies under the landing.
    let z = |i: u32| FLIGHT[0] - run * i as f32;
    for i in 0..STEPS {
        let (low, top) = (rise * i as f32, rise * (i + 1) as f32);
        let top = if i + 1 == STEPS { top - 0.01 } else { top };
        let low = if i == 0 { underside(z(0)) } else { low };
        let (near, far) = (z(i), z(i + 1));
        body.grid(at(low, near), width, (top - low) * Vec3::Y, [steps, 1], Vec3::ONE);
        body.grid(at(top, near), width, at(top, far) - at(top, near), [steps, 1], Vec3::ONE);
        let (from, to) = (at(underside(far), far), at(underside(near), near));
        body.grid(from, width, to - from, [steps, 1], Vec3::ONE);
        // Both sides; the corner at `low` belongs to the step before.
        let mut outline = vec![at(top, far), at(top, near), at(low, near), at(underside(near), near)];
        outline.push(at(underside(far), far));
        outline.dedup();
        for (shift, normal) in [(Vec3::ZERO, Vec3::NEG_X), (width, Vec3::X)] {
            let corners: Vec<u32> =
                outline.iter().map(|&p| body.vertex(p + shift, normal, Vec2::ZERO, Vec3::ONE)).collect();
            corners[1..].windows(2).for_each(|pair| body.triangle([corners[0], pair[0], pair[1]]));
        }
    }
    let (far, top) = (z(STEPS), LANDING - 0.01);
    let back = at(underside(far), far);
    body.grid(at(top, far), width, back - at(top, far), [steps, 1], Vec3::ONE);
    b.append(Mat4::IDENTITY, &body);
}

/// Posts on the steps and along the landing, under a handrail.
fn balustrade(b: &mut Builder, steps: u32) {
    let run = (FLIGHT[0] - FLIGHT[1]) / STEPS as f32;
    let rise = LANDING / STEPS as f32;
    let x = ACROSS[0] + 0.07;
    let mut post = |y: f32, z: f32, half: f32, height: f32| {
        let min = Vec3::new(x - half, y - 0.02, z - half);
        b.brick(Mat4::IDENTITY, min, Vec3::new(x + half, y + height, z + half), steps, Vec3::ONE);
    };
    for i in 0..STEPS {
        let z = FLIGHT[0] - run * (i as f32 + 0.5);
        let first = i == 0;
        post(rise * (i + 1) as f32, z, if first { 0.05 } else { 0.018 }, if first { 1.0 } else { 0.9 });
    }
    post(LANDING, FLIGHT[1] - 0.12, 0.05, 1.0);
    for i in 1..8 {
        post(LANDING, FLIGHT[1] - 0.12 - 0.2 * i as f32, 0.018, 0.9);
    }
    // Along the flight the rail is a brick turned into its slope, along the landing a level one into the wall.
    let slope = rise.atan2(run);
    let length = (FLIGHT[0] - FLIGHT[1] - run).hypot(LANDING - rise);
    let start = Vec3::new(x, rise + 0.9, FLIGHT[0] - 0.5 * run);
    let place = Mat4::from_translation(start) * Mat4::from_rotation_x(slope);
    let half = Vec3::new(0.035, 0.03, 0.0);
    b.brick(place, -half - (length + 0.08) * Vec3::Z, half, steps, Vec3::ONE);
    let level = Vec3::new(x, LANDING + 0.9, 0.0);
    b.brick(
        Mat4::from_translation(level),
        Vec3::new(-0.033, -0.028, -HALF - 0.02),
        Vec3::new(0.033, 0.028, FLIGHT[1] - 0.1),
        steps,
        Vec3::ONE,
    );
}

/// A table with a ball on it, a bench under the windows and two vases.
fn furniture(scene: &mut SceneBuilder, wood: usize, clay: usize, steps: u32, sides: u32) {
    let mut b = Builder::default();
    let place = Mat4::from_translation(Vec3::new(-2.6, 0.0, -2.2)) * Mat4::from_rotation_y(0.12);
    b.brick(place, Vec3::new(-0.9, 0.74, -0.45), Vec3::new(0.9, 0.80, 0.45), steps, Vec3::ONE);
    for (x, z) in [(-0.8, -0.36), (-0.8, 0.36), (0.8, -0.36), (0.8, 0.36)] {
        let foot = Vec3::new(x, -0.02, z);
        b.brick(place, foot - Vec3::new(0.04, 0.0, 0.04), foot + Vec3::new(0.04, 0.78, 0.04), 1, Vec3::ONE);
    }
    let bench = Mat4::from_translation(Vec3::new(-2.2, 0.0, 2.85));
    b.brick(bench, Vec3::new(-1.6, 0.40, -0.22), Vec3::new(1.6, 0.46, 0.22), steps, Vec3::ONE);
    for x in [-1.3, 0.0, 1.3] {
        b.brick(bench, Vec3::new(x - 0.05, -0.02, -0.18), Vec3::new(x + 0.05, 0.42, 0.18), 1, Vec3::ONE);
    }
    scene.add("table and bench", b, wood);

    let mut b = Builder::default();
    vase(&mut b, Vec3::new(-4.4, -0.01, -2.6), 1.15, sides);
    vase(&mut b, Vec3::new(0.9, -0.01, 2.7), 0.8, sides);
    vase(&mut b, Vec3::new(-2.2, 0.79, -2.25), 0.4, sides);
    scene.add("vases", b, clay);
}

/// A vase 0.9 m high at size 1, closed inside.
fn vase(b: &mut Builder, foot: Vec3, size: f32, sides: u32) {
    let profile = [
        [0.0, 0.0],
        [0.15, 0.0],
        [0.25, 0.2],
        [0.29, 0.38],
        [0.27, 0.54],
        [0.18, 0.7],
        [0.13, 0.78],
        [0.14, 0.84],
        [0.19, 0.9],
        [0.16, 0.9],
        [0.10, 0.8],
        [0.0, 0.72],
    ];
    b.turned(Mat4::from_translation(foot) * Mat4::from_scale(Vec3::splat(size)), &profile, sides, Vec3::ONE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn triangles_are_as_documented_and_all_is_closed() {
        assert_eq!([0, 1, 2, 3, 4].map(|d| room(d).triangle_count()), [3568, 4604, 11850, 27998, 73198]);
        for detail in [0, 2] {
            assert_eq!(checks::open_edges(&checks::world_triangles(&room(detail), |_| true)), 0);
        }
    }

    /// Where the sun meets the inside, from rays through the windows.
    fn sunlit(triangles: &[checks::Corners]) -> Vec<Vec3> {
        let sun = SUN.normalize_or_zero();
        let mut spots = Vec::new();
        for [left, right] in WINDOWS {
            for i in 0..12 {
                for j in 0..16 {
                    let x = left + (right - left) * (i as f32 + 0.5) / 12.0;
                    let y = SILL + (HEAD - SILL) * (j as f32 + 0.5) / 16.0;
                    let from = Vec3::new(x, y, HALF + 0.5 * THICK) - 3.0 * sun;
                    let spot = from + checks::hit(triangles, from, sun).unwrap() * sun;
                    spots.extend((spot.z < HALF - 0.01).then_some(spot - 1e-3 * sun));
                }
            }
        }
        spots
    }

    #[test]
    fn the_sun_reaches_the_floor_and_the_far_wall_sees_no_sunlit_spot() {
        let scene = room(0);
        let triangles = checks::world_triangles(&scene, |n| n != "window frames" && n != "balustrade");
        let spots = sunlit(&triangles);
        let floor = spots.iter().filter(|p| p.y < 0.05).count();
        assert!(spots.len() > 200 && floor > spots.len() / 2, "{floor} of {} on the floor", spots.len());
        for y in [0.4, 1.2, 2.0] {
            for z in [-1.8, -0.5, 1.0, 2.5] {
                let wall = Vec3::new(5.29, y, z);
                for spot in &spots {
                    let way = *spot - wall;
                    let free = checks::hit(&triangles, wall, way.normalize_or_zero());
                    assert!(free.is_some_and(|d| d < way.length() - 0.01), "{wall} sees {spot}");
                }
            }
        }
    }

    #[test]
    fn the_underside_of_the_stairs_is_in_shadow() {
        let scene = room(0);
        let triangles = checks::world_triangles(&scene, |_| true);
        for i in 2..STEPS {
            let z = FLIGHT[0] + (FLIGHT[1] - FLIGHT[0]) * i as f32 / STEPS as f32;
            let below = Vec3::new(2.0, underside(z) - 0.03, z);
            assert!(checks::hit(&triangles, below, -SUN.normalize_or_zero()).is_some(), "{below}");
        }
    }
}
