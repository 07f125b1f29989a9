//! The thin set of Schwarz and Seidel: a cell counts only as far as the six middles of its faces.
//!
//! The plane has to pass within `max|n| / 2` of the centre, and each projection of the triangle within
//! `max|edge normal| / 2` of it: the exact test, with a cube replaced by the octahedron between the middles of its
//! faces. A path from face to face crosses the octahedra of the cells that it passes, which is why the set still
//! separates.

use super::overlap::Reach;

/// How far the octahedron reaches.
pub(crate) struct Thin;

impl Reach for Thin {
    const TOUCHES: bool = false;

    #[inline]
    fn reach(a: f64, b: f64, c: f64) -> f64 {
        0.5 * a.abs().max(b.abs()).max(c.abs())
    }
}
