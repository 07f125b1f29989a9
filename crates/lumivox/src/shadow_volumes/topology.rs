//! Which triangles of a mesh share which edges.

use std::collections::HashMap;

use lumivox_core::TriangleView;

/// Triangles of an edge that one record holds; edges of more are several records, whose sides add up.
const RECORD_TRIANGLES: usize = 64;

/// An edge of welded vertices, and where its triangles stand in [`Topology::incidences`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) vertices: [u32; 2],
    pub(super) first: u32,
    pub(super) count: u32,
}

/// Which triangles of a mesh share which edges: made once for a mesh, whatever moves its vertices later.
///
/// Vertices at the same place are one, so that seams of texture coordinates or normals leave no gap. Triangles that have two corners
/// at one place, or an index out of range, are left out.
///
/// A part of the mesh, joined by edges, is *closed* when as many of its triangles run along each edge in one direction as in the other.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    /// The vertex of the mesh that each welded vertex is read from.
    pub(super) sources: Vec<u32>,
    /// Corners among welded vertices.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Whether each triangle's part is closed.
    pub(super) is_closed: Vec<bool>,
    pub(super) edges: Vec<Edge>,
    /// Of each edge its triangles, twice their number, and one more where they run along it backwards.
    pub(super) incidences: Vec<u32>,
    /// Sides of a volume at most, whatever the light.
    pub(super) most_sides: u64,
}

impl Topology {
    /// Of triangles as they stand before anything moves them, with the vertices in the order in which the
    /// [`Mesh`](crate::voxelize::Mesh) has them.
    pub fn new(mesh: &TriangleView<'_>) -> Self {
        let mut topology = Self::default();
        topology.weld(mesh);
        let mut runs = topology.runs();
        runs.sort_unstable();
        topology.find_closed(&runs);
        for run in runs.chunk_by(|a, b| a.0 == b.0) {
            for part in run.chunks(RECORD_TRIANGLES) {
                topology.add_edge(part);
            }
        }
        topology
    }

    /// Whether all of it is closed.
    pub fn is_closed(&self) -> bool {
        self.is_closed.iter().all(|is| *is)
    }

    /// Triangles that can cast.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Edges between them.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    fn weld(&mut self, mesh: &TriangleView<'_>) {
        let mut welded: HashMap<[u32; 3], u32> = HashMap::new();
        for triangle in mesh.indices {
            let corners = triangle.map(|index| {
                let position = mesh.positions.get(index as usize)?;
                // Both zeros are one place.
                let place = position.map(|x| (x + 0.0).to_bits());
                let next = self.sources.len() as u32;
                Some(*welded.entry(place).or_insert_with(|| {
                    self.sources.push(index);
                    next
                }))
            });
            if let [Some(a), Some(b), Some(c)] = corners
                && a != b
                && b != c
                && c != a
            {
                self.triangles.push([a, b, c]);
            }
        }
    }

    /// Each triangle along each of its edges: the edge, and the triangle as in [`Self::incidences`].
    fn runs(&self) -> Vec<([u32; 2], u32)> {
        let triangles = (0u32..).zip(&self.triangles);
        triangles
            .flat_map(|(n, &[a, b, c])| {
                [[a, b], [b, c], [c, a]].map(|[from, to]| {
                    let is_backwards = from > to;
                    ([from.min(to), from.max(to)], 2 * n + u32::from(is_backwards))
                })
            })
            .collect()
    }

    fn find_closed(&mut self, runs: &[([u32; 2], u32)]) {
        let mut parts = Parts((0..self.triangles.len() as u32).collect());
        for pair in runs.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            parts.join(pair[0].1 / 2, pair[1].1 / 2);
        }
        let mut is_open = vec![false; self.triangles.len()];
        for run in runs.chunk_by(|a, b| a.0 == b.0) {
            let backwards = run.iter().filter(|(_, triangle)| triangle & 1 == 1).count();
            if 2 * backwards != run.len() {
                is_open[parts.root(run[0].1 / 2) as usize] = true;
            }
        }
        self.is_closed = (0..self.triangles.len() as u32).map(|n| !is_open[parts.root(n) as usize]).collect();
    }

    fn add_edge(&mut self, run: &[([u32; 2], u32)]) {
        let Some(&(vertices, _)) = run.first() else { return };
        self.edges.push(Edge { vertices, first: self.incidences.len() as u32, count: run.len() as u32 });
        self.incidences.extend(run.iter().map(|(_, triangle)| triangle));
        // Of closed parts as well: a lamp may get inside.
        self.most_sides += run.len() as u64;
    }
}

/// Sets of triangles that edges join.
struct Parts(Vec<u32>);

impl Parts {
    fn root(&mut self, mut n: u32) -> u32 {
        while self.0[n as usize] != n {
            self.0[n as usize] = self.0[self.0[n as usize] as usize];
            n = self.0[n as usize];
        }
        n
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn corners() -> Vec<[f32; 3]> {
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    }

    #[test]
    fn a_tetrahedron_of_separate_triangles_is_closed() {
        let positions: Vec<_> = TETRAHEDRON.as_flattened().iter().map(|&i| corners()[i as usize]).collect();
        let indices: Vec<_> = (0..4).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        let topology = Topology::new(&TriangleView { positions: &positions, indices: &indices });
        assert_eq!((topology.sources.len(), topology.edge_count(), topology.triangle_count()), (4, 6, 4));
        assert!(topology.is_closed() && topology.edges.iter().all(|e| e.count == 2));
        assert_eq!(topology.most_sides, 12);
    }

    #[test]
    fn what_lacks_a_side_or_has_one_turned_over_is_open_and_its_neighbour_stays_closed() {
        let far = corners().into_iter().map(|[x, y, z]| [x + 5.0, y, z]);
        let positions: Vec<_> = corners().into_iter().chain(far).collect();
        let second = TETRAHEDRON.map(|t| t.map(|i| i + 4));
        let lacking = [&TETRAHEDRON[..], &second[..3]].concat();
        let turned = [&TETRAHEDRON[..], &second[..3], &[[second[3][1], second[3][0], second[3][2]]]].concat();
        for indices in [lacking, turned] {
            let topology = Topology::new(&TriangleView { positions: &positions, indices: &indices });
            assert!(topology.is_closed[..4].iter().all(|is| *is), "{indices:?}");
            assert!(topology.is_closed[4..].iter().all(|is| !is), "{indices:?}");
        }
    }

    #[test]
    fn wrong_indices_and_slivers_without_width_are_left_out_and_crowded_edges_are_cut() {
        let mut positions = corners();
        positions.push([-0.0; 3]);
        let mut indices = vec![[0, 4, 1], [1, 1, 2], [0, 1, 9]];
        indices.extend([[0, 1, 2]; 100]);
        let topology = Topology::new(&TriangleView { positions: &positions, indices: &indices });
        assert_eq!(topology.triangle_count(), 100);
        let counts: Vec<_> = topology.edges.iter().map(|e| e.count).collect();
        assert_eq!(counts, [64, 36, 64, 36, 64, 36]);
        assert_eq!(topology.most_sides, 300);
        assert!(Topology::new(&TriangleView { positions: &[], indices: &[[0, 1, 2]] }).edges.is_empty());
    }
}
