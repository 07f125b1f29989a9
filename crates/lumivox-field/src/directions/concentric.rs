//! The concentric map of Shirley and Chiu from the square `[-1, 1]^2` to the disk, lifted to the hemisphere by Malley:
//! squares become circles, areas keep their ratio, and neighbours stay neighbours (Figure 32c).

use std::f32::consts::FRAC_PI_4;

use glam::{Vec2, Vec3};

use super::{flattened, lifted};

/// The direction of a point of the unit square.
pub(super) fn direction(unit: Vec2) -> Vec3 {
    let square = 2.0 * unit - 1.0;
    let (radius, other, turned) = if square.x.abs() >= square.y.abs() {
        (square.x, square.y, false)
    } else {
        (square.y, square.x, true)
    };
    if radius == 0.0 {
        return Vec3::Z;
    }
    let (sin, cos) = (FRAC_PI_4 * (other / radius)).sin_cos();
    let disk = radius * Vec2::new(cos, sin);
    lifted(if turned { Vec2::new(disk.y, disk.x) } else { disk })
}

/// The point of the unit square of a direction.
#[inline(always)]
pub(super) fn inverse(local: Vec3) -> Vec2 {
    let disk = flattened(local);
    let (x, y) = (disk.x.abs(), disk.y.abs());
    let (major, minor) = (x.max(y), x.min(y));
    let radius = (major * major + minor * minor).sqrt();
    let along = radius * octants(minor / major.max(f32::MIN_POSITIVE));
    // Which is larger is as good as random, so this must not become a branch.
    let pick = (radius.to_bits() ^ along.to_bits()) & u32::from(x < y).wrapping_neg();
    let square = Vec2::new(f32::from_bits(radius.to_bits() ^ pick), f32::from_bits(along.to_bits() ^ pick));
    0.5 * Vec2::new(square.x.copysign(disk.x), square.y.copysign(disk.y)) + 0.5
}

/// The arc tangent of a number from 0 to 1 in eighths of a turn, to 1e-04: 1/75 of the finest texel.
#[inline(always)]
fn octants(x: f32) -> f32 {
    // Of the odd powers, from a least-maximum fit.
    const C: [f32; 4] = [1.272239, -0.408933, 0.186230, -0.049639];
    let q = x * x;
    // Two halves at once, for shorter chains of dependent operations.
    x * ((C[0] + C[1] * q) + q * q * (C[2] + C[3] * q))
}
