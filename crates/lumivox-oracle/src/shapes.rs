//! Meshes that the tests of this crate share.

use glam::Vec3;
use lumivox_core::TriangleView;

pub(crate) struct Mesh {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) indices: Vec<[u32; 3]>,
}

impl Mesh {
    pub(crate) fn view(&self) -> TriangleView<'_> {
        TriangleView::new(&self.positions, &self.indices).unwrap()
    }
}

/// An octahedron whose faces are divided in four `level` times, with all corners on the sphere.
pub(crate) fn sphere(radius: f32, level: u32) -> Mesh {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z];
    let mut triangles = Vec::new();
    for (sx, sy, sz) in [(1, 1, 1), (-1, 1, -1), (1, -1, -1), (-1, -1, 1)] {
        let [x, y, z] = [x * sx as f32, y * sy as f32, z * sz as f32];
        triangles.push([x, y, z]);
        triangles.push([x, -z, y]);
    }
    for _ in 0..level {
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let mid = |p: Vec3, q: Vec3| (p + q).normalize_or_zero();
                let (ab, bc, ca) = (mid(a, b), mid(b, c), mid(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions = triangles.iter().flatten().map(|&p| (radius * p).to_array()).collect();
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { positions, indices }
}

/// Two triangles; the normal by winding is `(b - a) x (d - a)`.
pub(crate) fn quad([a, b, c, d]: [Vec3; 4]) -> [[Vec3; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// The twelve triangles of an axis-aligned box, facing outwards.
pub(crate) fn cuboid(min: Vec3, max: Vec3) -> Vec<[Vec3; 3]> {
    let corner = |n: usize| {
        let pick = |bit: usize, axis: usize| if n >> bit & 1 == 0 { min[axis] } else { max[axis] };
        Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    faces.into_iter().flat_map(|face| quad(face.map(corner))).collect()
}
