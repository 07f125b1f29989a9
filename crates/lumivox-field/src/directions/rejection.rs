//! Points of the square `[-1, 1]^2` that lie in the disk, lifted to the hemisphere (Figure 32b). The other texels of
//! the map stay unused.

use std::f32::consts::SQRT_2;

use glam::{Vec2, Vec3};

use super::{flattened, lifted};

/// The direction of a point of the unit square, if the disk covers it.
pub(super) fn direction(unit: Vec2) -> Option<Vec3> {
    let disk = 2.0 * unit - 1.0;
    is_used(disk).then(|| lifted(disk))
}

/// The point of the unit square of a direction, in a texel in use of a map with `side` texels a side.
#[inline]
pub(super) fn inverse(local: Vec3, side: u32) -> Vec2 {
    let disk = flattened(local);
    // What is no direction would end in a corner.
    let disk = if disk.is_finite() { disk } else { Vec2::ZERO };
    let texel = 2.0 / side as f32;
    let centre = ((disk + 1.0) / texel).floor() * texel + 0.5 * texel - 1.0;
    // A texel whose centre the disk leaves out gives way to one inwards: half a texel's diagonal from the rim, every
    // point belongs to a centre within the disk. A 1/1000 is left to rounding.
    let inwards = disk / disk.length().max(0.5) * (1.0 - 0.5005 * SQRT_2 * texel);
    0.5 * (if is_used(centre) { disk } else { inwards }) + 0.5
}

#[inline]
fn is_used(disk: Vec2) -> bool {
    disk.length_squared() < 1.0
}
