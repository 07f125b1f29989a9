//! Numbers in fixed point, whose sums do not depend on any order.

use glam::{DVec3, Vec3};

/// Units of weight in one cell face.
pub(super) const WEIGHT_UNITS: f64 = (1u64 << 22) as f64;
/// Steps of a value in one.
pub(super) const VALUE_STEPS: f64 = (1u64 << 32) as f64;
/// Unit normals whose mean is shorter than this cancel each other.
pub(super) const CANCELLED: f64 = 1e-6;
/// The largest value that sums and averages see.
pub(super) const VALUE_LIMIT: f64 = (1u64 << 30) as f64;

/// The first components in fixed point.
#[inline]
pub(crate) fn fixed(values: [f32; 4], components: usize) -> [i64; 4] {
    let mut fixed = [0; 4];
    for (fixed, &value) in fixed.iter_mut().zip(&values).take(components) {
        // `as` takes NaN to zero.
        *fixed = (f64::from(value).clamp(-VALUE_LIMIT, VALUE_LIMIT) * VALUE_STEPS) as i64;
    }
    fixed
}

/// The nearest integer of what is less than 2^51 from zero, in one addition and without a check for more.
#[inline]
pub(super) fn integer(v: f64) -> i64 {
    const MAGIC: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
    ((v + MAGIC).to_bits() as i64).wrapping_sub(MAGIC.to_bits() as i64)
}

/// Most sums fit into 64 bits, whose conversion is an instruction and not a call.
#[inline]
pub(crate) fn to_f64(sum: i128) -> f64 {
    // Not inlined, or the compiler finds the two to be one.
    #[cold]
    #[inline(never)]
    fn large(sum: i128) -> f64 {
        sum as f64
    }
    let low = sum as i64;
    if i128::from(low) == sum { low as f64 } else { large(sum) }
}

/// Unit length in f32; zero for what has no direction. Largest component first: squares of tiny triangles underflow.
pub(crate) fn unit(v: DVec3) -> Vec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() {
        (v / largest).normalize_or_zero().as_vec3()
    } else {
        Vec3::ZERO
    }
}
