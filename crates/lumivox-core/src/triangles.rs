//! Triangles somebody else owns.

use glam::Vec3;

use crate::Bounds;

/// A triangle mesh in borrowed slices: nothing is copied. Any soup will do: open, non-manifold, self-intersecting.
#[derive(Clone, Copy, Debug)]
pub struct TriangleView<'a> {
    /// Vertex positions in metres.
    pub positions: &'a [[f32; 3]],
    /// Three indices into `positions` per triangle.
    pub indices: &'a [[u32; 3]],
}

impl<'a> TriangleView<'a> {
    /// A view, or `None` when an index points beyond the positions.
    pub fn new(positions: &'a [[f32; 3]], indices: &'a [[u32; 3]]) -> Option<Self> {
        let valid = indices.iter().flatten().all(|&i| (i as usize) < positions.len());
        valid.then_some(Self { positions, indices })
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// The corners of triangle `n`.
    pub fn triangle(&self, n: usize) -> [Vec3; 3] {
        self.indices[n].map(|i| Vec3::from(self.positions[i as usize]))
    }

    /// All triangles.
    pub fn iter(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        (0..self.len()).map(|n| self.triangle(n))
    }

    /// The box around all triangles.
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.iter().flatten())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_indices_out_of_range_and_bounds_only_what_is_used() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [9.0; 3]];
        assert!(TriangleView::new(&positions, &[[0, 1, 4]]).is_none());
        let view = TriangleView::new(&positions, &[[0, 1, 2]]).unwrap();
        assert_eq!(view.bounds(), Bounds::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.0)));
    }
}
