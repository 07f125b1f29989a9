//! The ground: flat round the podium, hills beyond, closed below.

use glam::{Vec2, Vec3};

use super::{Cuts, Palette};
use crate::builtin::builder::{Builder, SceneBuilder};

/// Half width of the land, its level about the podium, and its underside.
pub(super) const HALF: f32 = 28.0;
pub(super) const LEVEL: f32 = -1.8;
const BOTTOM: f32 = -4.0;
/// Half size of the flat land about the middle, and over how many metres the hills begin.
const FLAT: Vec2 = Vec2::new(14.0, 12.5);
const SHOULDER: f32 = 11.0;

/// Height of the ground.
pub(super) fn height(x: f32, z: f32) -> f32 {
    let outside = (Vec2::new(x, z + 1.0).abs() - FLAT).max(Vec2::ZERO).length();
    let t = (outside / SHOULDER).clamp(0.0, 1.0);
    let rise = t * t * (3.0 - 2.0 * t);
    // Low towards the viewer (+z), high behind; long waves only, so that coarse ground keeps their shape.
    let behind = 0.5 - 0.5 * (z / HALF).clamp(-1.0, 1.0);
    let waves = 0.6 + 0.25 * (0.21 * x + 0.6).sin() + 0.25 * (0.17 * z - 0.13 * x).cos();
    LEVEL + rise * waves * (0.9 + 6.0 * behind)
}

fn point(x: f32, z: f32) -> Vec3 {
    Vec3::new(x, height(x, z), z)
}

/// Greener in the hollows, dry on the heights, with broad patches.
fn tint(p: Vec3) -> Vec3 {
    let patch = (0.33 * p.x + 0.9 * (0.21 * p.z).sin()).sin() * (0.29 * p.z - 0.11 * p.x).cos();
    let dry = ((p.y - LEVEL) / 5.0).clamp(0.0, 1.0);
    let green = Vec3::new(0.62, 0.80, 0.66);
    green.lerp(Vec3::new(1.0, 0.93, 0.86), (0.45 + 0.35 * patch + 0.4 * dry).clamp(0.0, 1.0))
}

pub(super) fn add(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    let n = cuts.land;
    let at = |i: u32| HALF * (2.0 * i as f32 / n as f32 - 1.0);
    let mut b = Builder::default();
    let e = 0.05;
    for j in 0..=n {
        for i in 0..=n {
            let (x, z) = (at(i), at(j));
            let normal = (point(x, z + e) - point(x, z - e)).cross(point(x + e, z) - point(x - e, z));
            let p = point(x, z);
            b.vertex(p, normal, Vec2::new(i as f32, j as f32) / n as f32, tint(p));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            b.triangle([a, a + 1, a + n + 2]);
            b.triangle([a, a + n + 2, a + n + 1]);
        }
    }
    // Skirts down to the bottom, and the bottom as a fan about its middle.
    let soil = Vec3::new(0.62, 0.55, 0.5);
    let rim = |k: u32| match (k / n % 4, k % n) {
        (0, i) => (at(i), -HALF),
        (1, i) => (HALF, at(i)),
        (2, i) => (-at(i), HALF),
        (_, i) => (-HALF, -at(i)),
    };
    for k in 0..4 * n {
        let ((x0, z0), (x1, z1)) = (rim(k), rim(k + 1));
        let low = |x, z| Vec3::new(x, BOTTOM, z);
        let outwards = [Vec3::NEG_Z, Vec3::X, Vec3::Z, Vec3::NEG_X][(k / n) as usize];
        let skirt = [point(x0, z0), point(x1, z1), low(x1, z1), low(x0, z0)];
        let [a, c, d, f] = skirt.map(|p| b.vertex(p, outwards, Vec2::ZERO, soil));
        b.triangle([a, c, d]);
        b.triangle([a, d, f]);
        let fan = [low(x0, z0), low(x1, z1), low(0.0, 0.0)];
        let fan = fan.map(|p| b.vertex(p, Vec3::NEG_Y, Vec2::ZERO, soil));
        b.triangle(fan);
    }
    scene.add("land", b, palette.grass);
}
