//! A tank in a tunnel, lit by a lamp that travels ahead of it.
//!
//! ```text
//!        .-------.         inside 7.2 m wide and 5.6 m high, z -16..12, open at both ends
//!      /     lamp  \       left wall (-x) with an orange stripe, right wall (+x) with a blue one
//!     |  *          |      the tank comes from -z; the camera waits near +z
//!     |    [tank]   |
//!     +--         --+      kerbs on both sides
//! ```

mod drive;
mod tank;

use std::f32::consts::PI;

use glam::{Mat4, Vec2, Vec3};

use super::bodies;
use super::builder::{Builder, SceneBuilder, pick};
use crate::{Camera, Material, Scene};

/// Radius of the vault, the height where it springs, the thickness of the lining, and the ends in z.
const RADIUS: f32 = 3.6;
const SPRING: f32 = 2.0;
const LINING: f32 = 0.5;
const ENDS: [f32; 2] = [-16.0, 12.0];
/// Where the tank starts.
const START: f32 = -8.0;
/// The lamp, seen from the middle of the tank: ahead and to the left, as high as the turret's top, so that the shadow falls on the right.
const LAMP: Vec3 = Vec3::new(-2.8, 2.6, 5.0);

/// A vaulted tunnel of 28 m, in which a tank drives towards the camera. A spot light hangs ahead of the tank and moves
/// with it, so that the tank's shadow travels along the right wall, after figures 77 and 78 of Gaitatzes' dissertation
/// (2012). Its one clip, `drive`, takes the tank forth and back in 12 s and loops without a jump. Small lamps in the crown and a dusk sky at the ends keep the rest from being black.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 4 776 | 7 112 | 13 040 | 26 692 | 53 708 |
pub fn tunnel(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    lining(&mut scene, detail);
    let rig = tank::add(&mut scene, START * Vec3::Z, detail);
    drive::add(&mut scene, &rig);
    scene.sky(Vec3::new(0.10, 0.15, 0.26));
    scene.camera(Camera::look("ahead", Vec3::new(-1.4, 1.8, 10.6), Vec3::new(0.5, 1.6, -4.0), 52.0));
    scene.camera(Camera::look("beside", Vec3::new(-3.1, 2.6, 3.5), Vec3::new(1.2, 1.2, -6.5), 60.0));
    scene.finish()
}

/// Walls of `reach` beyond the tunnel's inside: up the right leg, over the vault and down the left.
fn horseshoe(reach: f32, foot: f32, pieces: u32) -> Vec<Vec2> {
    let mut line = vec![Vec2::new(RADIUS + reach, foot)];
    line.extend(bodies::arc(Vec2::new(0.0, SPRING), RADIUS + reach, [0.0, PI], pieces));
    line.push(Vec2::new(-RADIUS - reach, foot));
    line
}

fn lining(scene: &mut SceneBuilder, detail: u32) {
    let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
    let [concrete, rib, road, kerb] = [
        matte("concrete", 0.56, 0.54, 0.50),
        matte("ribs", 0.66, 0.63, 0.58),
        matte("road", 0.24, 0.235, 0.23),
        matte("kerb", 0.60, 0.59, 0.56),
    ];
    let [orange, blue, white] = [
        matte("orange paint", 0.76, 0.27, 0.05),
        matte("blue paint", 0.07, 0.20, 0.60),
        matte("white paint", 0.80, 0.80, 0.78),
    ];
    let lamp =
        Material { emission: Vec3::new(11.0, 9.0, 6.0), ..Material::matte("crown lamps", Vec3::splat(0.8)) };
    let lamp = scene.material(lamp);

    let pieces = pick(detail, [8, 12, 20, 32, 48]);
    let along = pick(detail, [1, 4, 14, 28, 56]);
    let steps = pick(detail, [1, 1, 2, 4, 6]);
    let [from, to] = ENDS;
    let mut vault = Builder::default();
    let lines = [horseshoe(0.0, -0.2, pieces), horseshoe(LINING, -0.2, pieces)];
    let place = Mat4::from_translation(from * Vec3::Z);
    vault.band(place, [&lines[0], &lines[1]], false, [to - from, along as f32], Vec3::ONE);
    scene.add("vault", vault, concrete);

    let mut ribs = Builder::default();
    let lines = [horseshoe(-0.16, -0.1, pieces), horseshoe(0.2, -0.1, pieces)];
    for i in 0..7 {
        let place = Mat4::from_translation((from + 1.8 + 4.0 * i as f32) * Vec3::Z);
        ribs.band(place, [&lines[0], &lines[1]], false, [0.4, steps as f32], Vec3::ONE);
    }
    scene.add("ribs", ribs, rib);

    let mut floor = Builder::default();
    sheet_box(&mut floor, [-RADIUS - 0.7, -0.5, from - 0.3], [RADIUS + 0.7, 0.0, to + 0.3], along);
    scene.add("road", floor, road);
    let (mut kerbs, mut marks) = (Builder::default(), Builder::default());
    for side in [-1.0, 1.0] {
        let (a, b) = (side * (RADIUS + 0.1), side * (RADIUS - 0.75));
        sheet_box(&mut kerbs, [a.min(b), -0.05, from + 0.1], [a.max(b), 0.2, to - 0.1], along);
        let (a, b) = (side * (RADIUS - 0.9), side * (RADIUS - 1.05));
        sheet_box(&mut marks, [a.min(b), -0.02, from + 0.2], [a.max(b), 0.012, to - 0.2], 1);
    }
    scene.add("kerbs", kerbs, kerb);
    scene.add("road marks", marks, white);
    for (side, material, name) in [(-1.0, orange, "orange stripe"), (1.0, blue, "blue stripe")] {
        let mut stripe = Builder::default();
        let (a, b) = (side * (RADIUS + 0.1), side * (RADIUS - 0.04));
        sheet_box(&mut stripe, [a.min(b), 0.55, from + 0.1], [a.max(b), 1.75, to - 0.1], along);
        scene.add(name, stripe, material);
    }
    let mut lamps = Builder::default();
    // In the middle between two ribs.
    for i in 0..6 {
        let z = from + 4.0 + 4.0 * i as f32;
        let top = SPRING + RADIUS;
        let (min, max) = (Vec3::new(-0.2, top - 0.14, z - 0.7), Vec3::new(0.2, top + 0.05, z + 0.7));
        lamps.brick(Mat4::IDENTITY, min, max, steps, Vec3::ONE);
    }
    scene.add("crown lamps", lamps, lamp);
}

/// A box cut along z into `along` cells.
fn sheet_box(b: &mut Builder, min: [f32; 3], max: [f32; 3], along: u32) {
    let [x0, y0, z0] = min;
    let [x1, y1, z1] = max;
    let place = Mat4::from_translation(z0 * Vec3::Z);
    b.prism(place, &[[x0, y0], [x1, y0], [x1, y1], [x0, y1]], z1 - z0, along, Vec3::ONE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn triangles_are_as_documented_and_all_is_closed() {
        assert_eq!([0, 1, 2, 3, 4].map(|d| tunnel(d).triangle_count()), [4776, 7112, 13040, 26692, 53708]);
        for detail in [0, 2] {
            assert_eq!(checks::open_edges(&checks::world_triangles(&tunnel(detail), |_| true)), 0);
        }
    }

    #[test]
    fn the_lamp_throws_the_tanks_shadow_on_the_right_wall() {
        let scene = tunnel(0);
        let tank = checks::world_triangles(&scene, |n| n.starts_with("tank"));
        let lining = checks::world_triangles(&scene, |n| n == "vault" || n.ends_with("stripe"));
        let lamp = LAMP + START * Vec3::Z;
        let shadowed = checks::directions(4000)
            .filter(|&way| checks::hit(&tank, lamp, way).is_some())
            .filter_map(|way| checks::hit(&lining, lamp, way).map(|d| lamp + d * way))
            .filter(|p| p.x > RADIUS - 0.1 && p.y > 0.2 && p.y < 2.0)
            .count();
        assert!(shadowed > 20, "{shadowed}");
    }
}
