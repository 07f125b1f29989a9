//! What a voxelization did.

use glam::Vec3;

/// What was done and what was left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VoxelizeReport {
    /// Triangles of the model.
    pub triangles: u64,
    /// Triangles that were skipped because a corner is not finite, or names no vertex.
    pub skipped_triangles: u64,
    /// What a solid fill found, if one was asked for.
    pub solid: Option<SolidReport>,
}

/// What a solid fill found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidReport {
    /// Cells that the outside does not reach, beside the surface's own.
    pub filled_cells: u64,
    /// Edges that only one triangle has, among corners at equal places.
    pub boundary_edges: u64,
    /// The longest hole of the surface. It leaks if it is wider than the cells, and surely if nothing was filled.
    pub hole: Option<Hole>,
}

impl SolidReport {
    /// Whether the outside runs in through a hole, as far as can be told: there is one, and nothing was filled.
    pub fn leaks(&self) -> bool {
        self.hole.is_some() && self.filled_cells == 0
    }
}

/// Boundary edges that hang together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// Middle of its edges in the world, weighted by their lengths.
    pub center: Vec3,
    /// A point on it: the middle of its first edge.
    pub edge: Vec3,
    /// Sum of the lengths of its edges in metres.
    pub length: f64,
    /// Number of its edges.
    pub edges: u64,
}
