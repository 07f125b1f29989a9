//! Whether triangles enclose a volume, and closing what is open.

use std::collections::HashMap;

use glam::Vec3;

use crate::TriangleView;

/// Numbers of places: vertices at equal positions are one, as files split them for normals and texture coordinates.
fn places(view: &TriangleView<'_>) -> Vec<u32> {
    let mut known: HashMap<[u32; 3], u32> = HashMap::with_capacity(view.positions.len());
    let number = |(n, p): (usize, &[f32; 3])| {
        // Adding zero makes both zeros one.
        *known.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(n as u32)
    };
    view.positions.iter().enumerate().map(number).collect()
}

/// For each pair of places how much more often its edge is gone from the first to the second than back.
fn balance(view: &TriangleView<'_>, places: &[u32]) -> HashMap<(u32, u32), i32> {
    let mut edges: HashMap<(u32, u32), i32> = HashMap::with_capacity(2 * view.len());
    for triangle in view.indices {
        let [Some(a), Some(b), Some(c)] = triangle.map(|i| places.get(i as usize).copied()) else { continue };
        let corners = [a, b, c];
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if a < b {
                *edges.entry((a, b)).or_default() += 1;
            } else if a > b {
                *edges.entry((b, a)).or_default() -= 1;
            }
        }
    }
    edges
}

/// Edges that have not as many triangles on one side as on the other: none for a closed surface whose triangles turn the same way all over.
/// Vertices at equal positions count as one.
pub fn open_edges(view: &TriangleView<'_>) -> usize {
    balance(view, &places(view)).values().filter(|count| **count != 0).count()
}

/// What closes a surface: triangles around the middle of each hole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lids {
    /// New vertices, to be put behind those that there are.
    pub positions: Vec<[f32; 3]>,
    /// New triangles, which count both.
    pub indices: Vec<[u32; 3]>,
    /// How many holes these close.
    pub holes: usize,
}

/// Lids for all holes of a surface whose edges form simple loops; what does not is left open. Flat holes, such as the bottom of a scan, become
/// flat; deep ones become cones.
pub fn lids(view: &TriangleView<'_>) -> Lids {
    let places = places(view);
    // Lids go along open edges the other way.
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    for ((a, b), count) in balance(view, &places) {
        let (from, to) = if count > 0 { (b, a) } else { (a, b) };
        for _ in 0..count.unsigned_abs() {
            next.entry(from).or_default().push(to);
        }
    }
    let mut starts: Vec<u32> = next.keys().copied().collect();
    starts.sort_unstable();
    next.values_mut().for_each(|ends| ends.sort_unstable());
    let mut lids = Lids::default();
    for start in starts {
        while let Some(first) = next.get_mut(&start).and_then(Vec::pop) {
            let mut ring = vec![start];
            let mut at = first;
            while at != start {
                ring.push(at);
                let Some(ahead) = next.get_mut(&at).and_then(Vec::pop) else { break };
                at = ahead;
            }
            if at == start && ring.len() >= 3 {
                lids.close(view, &ring);
            }
        }
    }
    lids
}

impl Lids {
    fn close(&mut self, view: &TriangleView<'_>, ring: &[u32]) {
        self.holes += 1;
        if let [a, b, c] = *ring {
            self.indices.push([a, b, c]);
            return;
        }
        let sum: Vec3 = ring.iter().map(|&i| Vec3::from(view.positions[i as usize])).sum();
        let middle = (view.positions.len() + self.positions.len()) as u32;
        self.positions.push((sum / ring.len() as f32).to_array());
        for (n, &a) in ring.iter().enumerate() {
            self.indices.push([a, ring[(n + 1) % ring.len()], middle]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POSITIONS: [[f32; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    const CUBE: [[u32; 3]; 12] = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];

    /// Six times the volume.
    fn volume(positions: &[[f32; 3]], indices: &[[u32; 3]]) -> f32 {
        let view = TriangleView { positions, indices };
        view.iter().map(|[a, b, c]| a.dot(b.cross(c))).sum()
    }

    #[test]
    fn a_cube_is_closed_however_its_vertices_are_shared() {
        let whole = TriangleView { positions: &POSITIONS, indices: &CUBE };
        assert_eq!(open_edges(&whole), 0);
        assert_eq!(lids(&whole), Lids::default());
        let apart: Vec<[f32; 3]> = CUBE.iter().flatten().map(|&i| POSITIONS[i as usize]).collect();
        let indices: Vec<[u32; 3]> = (0..12).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        assert_eq!(open_edges(&TriangleView { positions: &apart, indices: &indices }), 0);
        // One triangle the wrong way round.
        let mut turned = CUBE;
        turned[4].swap(0, 1);
        assert_eq!(open_edges(&TriangleView { positions: &POSITIONS, indices: &turned }), 3);
    }

    #[test]
    fn holes_get_lids_that_close_them() {
        for missing in [vec![0], vec![0, 1], vec![0, 1, 2, 3], vec![4, 5, 6, 7, 8, 9]] {
            let mut indices: Vec<[u32; 3]> =
                CUBE.iter().enumerate().filter(|(n, _)| !missing.contains(n)).map(|(_, t)| *t).collect();
            let open = TriangleView { positions: &POSITIONS, indices: &indices };
            assert!(open_edges(&open) >= 3);
            let lids = lids(&open);
            let mut positions = POSITIONS.to_vec();
            positions.extend(&lids.positions);
            indices.extend(&lids.indices);
            assert_eq!(
                open_edges(&TriangleView { positions: &positions, indices: &indices }),
                0,
                "{missing:?}"
            );
            if missing.len() <= 2 {
                assert!((volume(&positions, &indices) - 6.0).abs() < 1e-5, "{missing:?}");
            }
        }
        let flat = TriangleView { positions: &POSITIONS, indices: &CUBE[..1] };
        assert_eq!(lids(&flat).holes, 1);
    }
}
