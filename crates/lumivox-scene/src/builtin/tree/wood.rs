//! How the tree branches: every branch is a bent tapered tube that splits into thinner ones.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

use super::Chance;
use crate::builtin::builder::Builder;

/// Points along one branch, without the first.
const PIECES: usize = 4;
/// Orders of branches: trunk, limbs, boughs, branches, twigs.
const ORDERS: u32 = 5;

/// A bent branch.
pub(super) struct Branch {
    /// 0 for the trunk.
    pub(super) order: u32,
    pub(super) points: [Vec3; PIECES + 1],
    pub(super) radii: [f32; PIECES + 1],
}

impl Branch {
    /// Whether it bears leaves.
    pub(super) fn is_twig(&self) -> bool {
        self.order + 1 == ORDERS
    }

    /// The point at `t` in 0..1.
    pub(super) fn at(&self, t: f32) -> Vec3 {
        let position = t.clamp(0.0, 1.0) * PIECES as f32;
        let i = (position as usize).min(PIECES - 1);
        self.points[i].lerp(self.points[i + 1], position - i as f32)
    }
}

/// All branches, parents before their children.
pub(super) fn grow() -> Vec<Branch> {
    let mut chance = Chance(20_240);
    let mut all = Vec::new();
    let trunk = Shoot { order: 0, from: Vec3::new(0.0, -0.15, 0.0), way: Vec3::Y, length: 2.9, radius: 0.34 };
    branch(&mut all, &trunk, &mut chance);
    all
}

struct Shoot {
    order: u32,
    from: Vec3,
    way: Vec3,
    length: f32,
    radius: f32,
}

fn branch(all: &mut Vec<Branch>, shoot: &Shoot, chance: &mut Chance) {
    let mut points = [shoot.from; PIECES + 1];
    let mut radii = [shoot.radius; PIECES + 1];
    let mut way = shoot.way;
    let wander = if shoot.order == 0 { 0.10 } else { 0.24 };
    for i in 1..=PIECES {
        // Limbs sag a little, twigs turn to the light.
        let lift = match shoot.order {
            0 => 0.0,
            1 => 0.04,
            _ => 0.10,
        };
        way = (way + wander * chance.direction() + lift * Vec3::Y).normalize_or(Vec3::Y);
        points[i] = points[i - 1] + shoot.length / PIECES as f32 * way;
        radii[i] = shoot.radius * (1.0 - 0.55 * i as f32 / PIECES as f32);
    }
    all.push(Branch { order: shoot.order, points, radii });
    if shoot.order + 1 >= ORDERS {
        return;
    }
    let children = [6, 6, 5, 5][shoot.order as usize];
    let start = chance.unit() * TAU;
    for c in 0..children {
        // The last child goes on from the tip, the others leave along the way, each a golden angle further round.
        let last = c + 1 == children;
        let along = if last { 1.0 } else { 0.45 + 0.5 * (c as f32 + 0.5) / children as f32 };
        let i = ((along * PIECES as f32) as usize).min(PIECES - 1);
        let position = along * PIECES as f32 - i as f32;
        let from = points[i].lerp(points[i + 1], position);
        let ahead = (points[i + 1] - points[i]).normalize_or(Vec3::Y);
        let tilt = if last { 0.15 } else { 0.78 + 0.22 * chance.signed() };
        let round = Quat::from_axis_angle(ahead, start + 2.399_963 * c as f32);
        let side = round * ahead.any_orthonormal_vector();
        let way = (ahead * f32::cos(tilt) + side * f32::sin(tilt)).normalize_or(ahead);
        let here = radii[i] + (radii[i + 1] - radii[i]) * position;
        let shrink = [0.80, 0.66, 0.60, 0.56][shoot.order as usize];
        let length = shoot.length * shrink * (1.0 + 0.15 * chance.signed());
        let radius = here * if last { 0.92 } else { 0.62 };
        branch(all, &Shoot { order: shoot.order + 1, from, way, length, radius }, chance);
    }
}

/// All branches as closed tubes with `sides` sides; children begin inside of their parents.
pub(super) fn mesh(b: &mut Builder, branches: &[Branch], sides: u32) {
    for branch in branches {
        // Thin wood needs fewer sides.
        tube(b, branch, (sides >> branch.order.saturating_sub(1)).max(3));
    }
}

fn tube(b: &mut Builder, branch: &Branch, sides: u32) {
    let ahead = |i: usize| {
        let (low, high) = (i.saturating_sub(1), (i + 1).min(PIECES));
        (branch.points[high] - branch.points[low]).normalize_or(Vec3::Y)
    };
    let mut across = ahead(0).any_orthonormal_vector();
    let mut rings = Vec::new();
    for i in 0..=PIECES {
        // The frame goes along without a twist.
        let way = ahead(i);
        across = (across - way * way.dot(across)).normalize_or(way.any_orthonormal_vector());
        let up = way.cross(across);
        let ring: Vec<u32> = (0..sides)
            .map(|j| {
                let (sin, cos) = (TAU * j as f32 / sides as f32).sin_cos();
                let normal = cos * across + sin * up;
                let uv = Vec2::new(j as f32 / sides as f32, i as f32 / PIECES as f32);
                // The foot of the trunk spreads.
                let flare = if branch.order == 0 && i == 0 { 1.45 } else { 1.0 };
                b.vertex(branch.points[i] + flare * branch.radii[i] * normal, normal, uv, Vec3::ONE)
            })
            .collect();
        rings.push(ring);
    }
    let n = sides as usize;
    for pair in rings.windows(2) {
        for j in 0..n {
            let k = (j + 1) % n;
            b.triangle([pair[0][j], pair[0][k], pair[1][k]]);
            b.triangle([pair[0][j], pair[1][k], pair[1][j]]);
        }
    }
    for (ring, i, normal) in [(&rings[0], 0, -ahead(0)), (&rings[PIECES], PIECES, ahead(PIECES))] {
        let middle = b.vertex(branch.points[i], normal, Vec2::ZERO, Vec3::ONE);
        let rim: Vec<u32> = ring
            .iter()
            .map(|&v| {
                let p = Vec3::from(b.mesh.positions[v as usize]);
                b.vertex(p, normal, Vec2::ZERO, Vec3::ONE)
            })
            .collect();
        (0..n).for_each(|j| b.triangle([middle, rim[j], rim[(j + 1) % n]]));
    }
}
