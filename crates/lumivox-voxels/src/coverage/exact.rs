//! Every cell that a triangle touches.

use super::overlap::Reach;

/// How far a cube reaches: a direction meets it as far out as its corners.
pub(crate) struct Exact;

impl Reach for Exact {
    const TOUCHES: bool = true;

    #[inline]
    fn reach(a: f64, b: f64, c: f64) -> f64 {
        0.5 * (a.abs() + b.abs() + c.abs())
    }
}
