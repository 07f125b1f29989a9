//! The leaves: cards about the twigs, and the texture that gives them their shape.

use glam::{Vec2, Vec3};

use super::Chance;
use super::wood::Branch;
use crate::builtin::builder::Builder;
use crate::{Texture, Wrap};

/// Pixels along each side of the texture.
const SIDE: u32 = 64;
/// Length of a leaf when there are 160 000 of them, in metres.
const LENGTH: f32 = 0.125;
const ALL: u32 = 160_000;

/// One pointed leaf with a lighter rib; its stalk at the lower edge. Outside of it opacity is zero, colour goes on so
/// that filtering brings nothing foreign in.
pub(super) fn texture() -> Texture {
    let pixel = |x: u32, y: u32| {
        let u = (x as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
        // From the stalk to the tip.
        let v = 1.0 - (y as f32 + 0.5) / SIDE as f32;
        let along = ((v - 0.08) / 0.9).clamp(0.0, 1.0);
        let half = 0.95 * (along * (1.0 - along)).sqrt() * (1.35 - 0.7 * along);
        let toothed = half * (1.0 - 0.06 * (42.0 * v).sin());
        let blade = u.abs() < toothed;
        let stalk = u.abs() < 0.05 && v < 0.15;
        let rib = u.abs() < 0.05 || (7.0 * (v - 0.55 * u.abs())).fract() < 0.13;
        let [r, g, b] = if rib { [140, 160, 82] } else { [106, 140, 52] };
        [r, g, b, if blade || stalk { 255 } else { 0 }]
    };
    let pixels = (0..SIDE).flat_map(|y| (0..SIDE).flat_map(move |x| pixel(x, y))).collect();
    let name = "leaf".to_owned();
    Texture { name, width: SIDE, height: SIDE, srgb: true, pixels, wrap: [Wrap::Clamp; 2] }
}

/// `count` leaves spread over the twigs. Fewer leaves are larger, so that the crown stays as dense.
pub(super) fn mesh(b: &mut Builder, branches: &[Branch], count: u32) {
    let twigs: Vec<&Branch> = branches.iter().filter(|b| b.is_twig()).collect();
    if twigs.is_empty() {
        return;
    }
    let mut chance = Chance(77);
    let length = LENGTH * (ALL as f32 / count as f32).sqrt();
    for i in 0..count {
        let twig = twigs[i as usize % twigs.len()];
        let t = 0.15 + 0.85 * chance.unit();
        // Leaves stand about the twig, mostly level, and hang outwards a little.
        let out = (chance.direction() * Vec3::new(1.0, 0.6, 1.0)).normalize_or(Vec3::X);
        let stalk = twig.at(t) + 0.16 * chance.unit() * out;
        let way = (out - 0.25 * Vec3::Y + 0.3 * chance.direction()).normalize_or(Vec3::X);
        let up = (Vec3::Y + 0.7 * chance.direction()).normalize_or(Vec3::Y);
        let across = way.cross(up).normalize_or(way.any_orthonormal_vector());
        let normal = across.cross(way);
        let size = length * (0.8 + 0.4 * chance.unit());
        let value = 0.72 + 0.28 * chance.unit();
        let color = Vec3::new(value * (0.85 + 0.15 * chance.unit()), value, 0.9 * value);
        let half = 0.5 * size * across;
        let corners = [(-half, 0.0, 1.0), (half, 1.0, 1.0), (half, 1.0, 0.0), (-half, 0.0, 0.0)];
        let [p, q, r, s] = corners.map(|(side, u, v)| {
            b.vertex(stalk + side + (1.0 - v) * size * way, normal, Vec2::new(u, v), color)
        });
        b.triangle([p, q, r]);
        b.triangle([p, r, s]);
    }
}
