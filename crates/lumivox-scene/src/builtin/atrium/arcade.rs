//! The colonnade: columns with bases and capitals, round arches with coloured voussoirs, and the balustrade. Each is
//! made once, in the axes of a [`Bay`], and stands in many places.

use std::f32::consts::PI;

use glam::{Mat4, Vec2, Vec3};

use super::{
    ARCH, BAY, CEILING, COURT, Detail, GALLERY, Palette, SPRING, UPPER_CEILING, UPPER_SPRING, WALL, shade,
    sides,
};
use crate::builtin::builder::{Builder, SceneBuilder};

/// Half the thickness of the arcade wall.
const HALF: f32 = 0.24;
/// Wedge stones around an arch; odd, so that there is a keystone.
const VOUSSOIRS: u32 = 11;

pub(super) fn add(scene: &mut SceneBuilder, palette: &Palette, detail: &Detail) {
    let sides = sides();
    let bays: Vec<_> = sides.iter().flatten().collect();
    let places: Vec<Mat4> = bays.iter().map(|b| b.world_from_bay).collect();

    for (name, spring, top) in [("arch", SPRING, CEILING), ("gallery arch", UPPER_SPRING, UPPER_CEILING)] {
        let (mut wall, mut stones) = (Builder::default(), Builder::default());
        arch_wall(&mut wall, spring, top, HALF, detail);
        if detail.level == 0 {
            soffit(&mut wall, spring, HALF, detail);
        } else {
            voussoirs(&mut stones, spring, HALF + 0.035, detail);
            scene.add_at(&format!("{name} voussoirs"), stones, palette.trim, &places);
        }
        scene.add_at(name, wall, palette.wall, &places);
    }
    // Across the arcade, from each column of the long sides to the outer wall.
    let mut cross = Builder::default();
    arch_wall(&mut cross, SPRING, CEILING, 0.16, detail);
    soffit(&mut cross, SPRING, 0.16, detail);
    scene.add_at("transverse arch", cross, palette.plaster, &transverse());

    let columns: Vec<Mat4> = column_feet().map(Mat4::from_translation).collect();
    let raised: Vec<Mat4> = columns.iter().map(|m| Mat4::from_translation(GALLERY * Vec3::Y) * *m).collect();
    for (name, height, radius, places) in
        [("column", SPRING, 0.21, columns), ("gallery column", UPPER_SPRING - GALLERY, 0.17, raised)]
    {
        let mut b = Builder::default();
        column(&mut b, height, radius, detail);
        scene.add_at(name, b, palette.stone, &places);
    }
    let mut piers = Builder::default();
    for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let foot = Vec3::new(x * COURT[0], 0.0, z * COURT[1]);
        pier(&mut piers, foot, 0.0, SPRING);
        pier(&mut piers, foot, SPRING, CEILING);
        pier(&mut piers, foot, GALLERY, UPPER_SPRING);
        pier(&mut piers, foot, UPPER_SPRING, UPPER_CEILING);
    }
    pilasters(&mut piers);
    scene.add("piers and pilasters", piers, palette.stone);

    let mut b = Builder::default();
    balustrade(&mut b, detail);
    let places: Vec<Mat4> = bays.iter().map(|b| b.raised(GALLERY)).collect();
    scene.add_at("balustrade", b, palette.trim, &places);
}

/// Feet of the round columns: all axes on the court's edge but the corners.
fn column_feet() -> impl Iterator<Item = Vec3> {
    sides()
        .into_iter()
        .flat_map(|side| side.into_iter().skip(1).map(|bay| bay.world_from_bay.transform_point3(Vec3::ZERO)))
}

/// Places of the transverse arches: x from the column to the outer wall.
fn transverse() -> Vec<Mat4> {
    let along_wall = |foot: Vec3| {
        let outwards =
            if foot.z.abs() > COURT[1] - 0.1 { Vec3::Z * foot.z.signum() } else { Vec3::X * foot.x.signum() };
        let columns = [outwards, Vec3::Y, outwards.cross(Vec3::Y)].map(|v| v.extend(0.0));
        Mat4::from_cols(columns[0], columns[1], columns[2], foot.extend(1.0))
    };
    column_feet().map(along_wall).collect()
}

/// A point of the arch at `angle` from its left foot.
fn on_arch(radius: f32, spring: f32, angle: f32) -> Vec2 {
    Vec2::new(0.5 * BAY - radius * angle.cos(), spring + radius * angle.sin())
}

/// The wall of one bay above the springing, with a round opening: two faces and the two soles.
fn arch_wall(b: &mut Builder, spring: f32, top: f32, half: f32, detail: &Detail) {
    let segments = segments(detail);
    let rise = top - spring;
    let middle = Vec2::new(0.5 * BAY, spring);
    let corner = (rise / (0.5 * BAY)).atan();
    let mut angles: Vec<f32> = (0..=segments).map(|i| PI * i as f32 / segments as f32).collect();
    angles.extend([corner, PI - corner]);
    angles.sort_by(f32::total_cmp);
    angles.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
    // Where the ray at an angle from the arch's middle meets the bay's outline.
    let outline = |angle: f32| {
        let d = Vec2::new(-angle.cos(), angle.sin());
        let reach = (0.5 * BAY / d.x.abs().max(1e-6)).min(rise / d.y.max(1e-6));
        middle + reach * d
    };
    let rings = detail.pick([1, 1, 1, 1, 2]);
    for pair in angles.windows(2) {
        let [p, q] = [pair[0], pair[1]].map(|a| (on_arch(ARCH, spring, a), outline(a)));
        let color = shade((p.1.x * 40.0 + p.1.y * 90.0) as u32, 0.12);
        for side in [1.0, -1.0] {
            let at = |v: Vec2| v.extend(side * half);
            let corners = [at(p.0), at(p.1), at(q.1), at(q.0)];
            let corners = if side > 0.0 { corners } else { [corners[0], corners[3], corners[2], corners[1]] };
            let steps = if side > 0.0 { [rings, 1] } else { [1, rings] };
            b.quad(corners, steps, color);
        }
    }
    for x in [0.0, 0.5 * BAY + ARCH] {
        let width = 0.5 * BAY - ARCH;
        b.grid(Vec3::new(x, spring, -half), width * Vec3::X, 2.0 * half * Vec3::Z, [1, 1], Vec3::splat(0.9));
    }
}

/// Cuts of one arch.
fn segments(detail: &Detail) -> u32 {
    detail.pick([3, 6, 10, 16, 22])
}

/// The underside of an arch without voussoirs.
fn soffit(b: &mut Builder, spring: f32, half: f32, detail: &Detail) {
    let depth = detail.pick([1, 1, 1, 1, 2]);
    b.sheet([segments(detail), depth], Vec3::splat(0.95), |s, t| {
        let p = on_arch(ARCH, spring, PI * s);
        let inwards = (Vec2::new(0.5 * BAY, spring) - p).extend(0.0);
        (p.extend(half * (1.0 - 2.0 * t)), inwards)
    });
}

/// A ring of wedge stones in two colours that stands a little proud of both faces of the wall.
fn voussoirs(b: &mut Builder, spring: f32, half: f32, detail: &Detail) {
    let per_stone = detail.pick([1, 1, 1, 1, 2]);
    let stones = detail.pick([7, 7, VOUSSOIRS, VOUSSOIRS, VOUSSOIRS]);
    let (inner, outer) = (ARCH - 0.02, ARCH + 0.2);
    for stone in 0..stones {
        let color = if stone % 2 == 0 { shade(stone, 0.1) } else { Vec3::new(0.84, 0.56, 0.42) };
        let angle = |s: f32| PI * (stone as f32 + s) / stones as f32;
        for side in [1.0, -1.0] {
            b.sheet([per_stone, 1], color, |s, t| {
                // Against the turn on the front, with it on the back, so that both are wound outwards.
                let s = if side > 0.0 { 1.0 - s } else { s };
                let radius = inner + t * (outer - inner);
                (on_arch(radius, spring, angle(s)).extend(side * half), side * Vec3::Z)
            });
            b.sheet([per_stone, 1], color, |s, t| {
                let p = on_arch(outer, spring, angle(s));
                let away = (p - Vec2::new(0.5 * BAY, spring)).extend(0.0);
                (p.extend(side * (half - 0.035 * t)), away)
            });
        }
        b.sheet([per_stone, 1], color, |s, t| {
            let p = on_arch(inner, spring, angle(s));
            (p.extend(half * (1.0 - 2.0 * t)), (Vec2::new(0.5 * BAY, spring) - p).extend(0.0))
        });
    }
}

/// Plinth, moulded base, swelling shaft, bell capital and abacus.
fn column(b: &mut Builder, height: f32, radius: f32, detail: &Detail) {
    let r = radius;
    let plinth = 0.12;
    let abacus = 0.12;
    let wide = 2.7 * r;
    b.block(Vec3::new(0.0, 0.5 * plinth, 0.0), Vec3::new(wide, plinth, wide), 0.0, 1, Vec3::splat(0.95));
    let top = height - abacus;
    b.block(
        Vec3::new(0.0, height - 0.5 * abacus, 0.0),
        Vec3::new(2.5 * r, abacus, 2.2 * HALF),
        0.0,
        1,
        Vec3::ONE,
    );
    let sides = detail.pick([4, 6, 9, 14, 20]);
    let y = |t: f32| plinth + t * (top - plinth);
    let shaft = detail.pick([1, 1, 1, 2, 4]);
    let curve = detail.pick([1, 1, 2, 3, 5]);
    let mut profile = Vec::new();
    // The base: a bulge that draws in towards the shaft.
    for i in 0..=curve {
        let a = 0.5 * PI * i as f32 / curve as f32;
        profile.push(Vec2::new(r * (1.06 + 0.24 * a.cos()), plinth + 0.16 * a.sin()));
    }
    let (low, high) = (plinth + 0.16, y(0.86));
    for i in 0..=shaft {
        let t = i as f32 / shaft as f32;
        profile.push(Vec2::new(r * (1.0 - 0.16 * t * t), low + t * (high - low)));
    }
    // The neck ring and the bell.
    profile.push(Vec2::new(0.95 * r, high));
    for i in 0..=curve {
        let a = 0.5 * PI * i as f32 / curve as f32;
        profile.push(Vec2::new(r * (1.28 - 0.36 * a.cos()), high + 0.03 + (top - high - 0.03) * a.sin()));
    }
    b.lathe(Vec3::ZERO, &profile, sides, Vec3::ONE);
}

/// A square corner post from `low` to `high` with a foot and a head.
fn pier(b: &mut Builder, foot: Vec3, low: f32, high: f32) {
    let part = |b: &mut Builder, y: [f32; 2], width: f32| {
        let half = Vec3::new(0.5 * width, 0.0, 0.5 * width);
        b.slab(foot + y[0] * Vec3::Y - half, foot + y[1] * Vec3::Y + half, shade((y[0] * 10.0) as u32, 0.08));
    };
    if high - low < 2.0 {
        return part(b, [low, high], 0.52);
    }
    part(b, [low, low + 0.25], 0.62);
    part(b, [low + 0.25, high - 0.15], 0.5);
    part(b, [high - 0.15, high], 0.62);
}

/// Flat piers on the outer walls, where the transverse arches end.
fn pilasters(b: &mut Builder) {
    for foot in column_feet() {
        let on_long = foot.z.abs() > COURT[1] - 0.1;
        let (center, half) = if on_long {
            (Vec3::new(foot.x, 0.0, foot.z.signum() * (WALL[1] - 0.1)), Vec3::new(0.2, 0.0, 0.1))
        } else {
            (Vec3::new(foot.x.signum() * (WALL[0] - 0.1), 0.0, foot.z), Vec3::new(0.1, 0.0, 0.2))
        };
        b.slab(center - half, center + half + SPRING * Vec3::Y, Vec3::splat(0.95));
    }
}

/// Handrail, foot rail and turned balusters of one bay.
fn balustrade(b: &mut Builder, detail: &Detail) {
    let (from, to) = (0.18, BAY - 0.18);
    let rail = |b: &mut Builder, low: f32, high: f32, half: f32| {
        let steps = detail.pick([1, 1, 1, 2, 4]);
        let size = Vec3::new(to - from, high - low, 2.0 * half);
        b.block(Vec3::new(0.5 * BAY, 0.5 * (low + high), 0.0), size, 0.0, steps, Vec3::ONE);
    };
    rail(b, 0.0, 0.12, 0.11);
    rail(b, 0.86, 0.98, 0.13);
    let count = detail.pick([3, 4, 6, 8, 8]);
    let sides = detail.pick([3, 4, 4, 6, 10]);
    let full = [
        Vec2::new(0.07, 0.12),
        Vec2::new(0.05, 0.2),
        Vec2::new(0.085, 0.34),
        Vec2::new(0.075, 0.44),
        Vec2::new(0.035, 0.66),
        Vec2::new(0.06, 0.8),
        Vec2::new(0.06, 0.86),
    ];
    let profile = match detail.level {
        0 => vec![full[2] - Vec2::new(0.0, 0.22), full[6]],
        1 | 2 => vec![full[0], full[2], full[4], full[6]],
        _ => full.to_vec(),
    };
    for i in 0..count {
        let x = from + (to - from) * (i as f32 + 0.5) / count as f32;
        b.lathe(Vec3::new(x, 0.0, 0.0), &profile, sides, Vec3::ONE);
    }
}
