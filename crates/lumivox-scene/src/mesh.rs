//! Triangle meshes: the finished [`Mesh`] and the [`RawMesh`] that importers fill and one place cleans.

use glam::{DVec3, Vec3};
use lumivox_core::TriangleView;

use crate::{ImportReport, Limits, SceneError};

/// Triangles of one material. All attributes have one entry per vertex; normals are unit, positions finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Name in the file; may be empty.
    pub name: String,
    /// Metres, in the mesh's own space.
    pub positions: Vec<[f32; 3]>,
    /// Unit vectors.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, v downwards from the top row; zero if the file has none.
    pub uvs: Vec<[f32; 2]>,
    /// Linear colour that multiplies the material's; one if the file has none.
    pub colors: Vec<[f32; 4]>,
    /// Vertex numbers of each triangle, all in range.
    pub indices: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`](crate::Scene::materials).
    pub material: usize,
}

impl Mesh {
    /// A mesh with face normals from plain geometry that is known to be sound.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn flat(name: &str, positions: Vec<[f32; 3]>, indices: Vec<[u32; 3]>, material: usize) -> Self {
        let mut report = ImportReport::default();
        let raw = RawMesh { name: name.to_owned(), positions, indices, material, ..RawMesh::default() };
        raw.into_mesh(Shading::Flat, &mut report)
    }

    /// Puts lids on its holes, and says how many edges are open after that. Lids have normals of their own, and the colours and texture
    /// coordinates of their edges; vertices are only added, behind those that there are.
    pub fn close_holes(&mut self) -> usize {
        let view = TriangleView { positions: &self.positions, indices: &self.indices };
        if lumivox_core::open_edges(&view) == 0 {
            return 0;
        }
        let lids = lumivox_core::lids(&view);
        let old = self.positions.len();
        for triangle in &lids.indices {
            let corner = |i: u32| -> [f32; 3] {
                let i = i as usize;
                let own = self.positions[..old].get(i);
                own.or_else(|| lids.positions.get(i.wrapping_sub(old))).copied().unwrap_or_default()
            };
            let corners = triangle.map(corner);
            let normal = face_normal(&corners, &[0, 1, 2]);
            let first = self.positions.len() as u32;
            for (i, position) in triangle.iter().zip(corners) {
                // The middle of a lid takes what its first edge has.
                let like = if (*i as usize) < old { *i as usize } else { triangle[0] as usize };
                self.push_vertex(position, normal, like);
            }
            self.indices.push([first, first + 1, first + 2]);
        }
        lumivox_core::open_edges(&TriangleView { positions: &self.positions, indices: &self.indices })
    }

    /// Gives it the normals of a smooth surface: averages, by area, of the faces around each position. For scans that were read with those of
    /// their faces, and are to be seen through.
    pub fn smooth(&mut self) {
        self.normals = smooth_normals(&self.positions, &self.indices);
    }

    fn push_vertex(&mut self, position: [f32; 3], normal: Vec3, like: usize) {
        self.positions.push(position);
        self.normals.push(normal.to_array());
        self.uvs.push(self.uvs.get(like).copied().unwrap_or_default());
        self.colors.push(self.colors.get(like).copied().unwrap_or([1.0; 4]));
    }
}

/// Where a mesh's normals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shading {
    /// The face's; vertices are no longer shared.
    Flat,
    /// The file's, or the face's if it has none.
    FileOrFlat,
    /// The file's, or averages of the faces around a position.
    Smooth,
}

/// Geometry as a file states it: attributes may be absent, values may be anything.
#[derive(Clone, Debug, Default)]
pub(crate) struct RawMesh {
    pub(crate) name: String,
    pub(crate) positions: Vec<[f32; 3]>,
    /// Empty or one per position, like all attributes.
    pub(crate) normals: Vec<[f32; 3]>,
    pub(crate) uvs: Vec<[f32; 2]>,
    pub(crate) colors: Vec<[f32; 4]>,
    /// Numbers of the vertices in the file, for what is stated per vertex but kept elsewhere.
    pub(crate) origins: Vec<u32>,
    pub(crate) indices: Vec<[u32; 3]>,
    pub(crate) material: usize,
}

impl RawMesh {
    /// Refuses indices and attribute counts that do not fit the positions, and more than the limits allow.
    pub(crate) fn check(&self, file: &str, limits: &Limits) -> Result<(), SceneError> {
        let count = self.positions.len();
        let malformed = |reason| SceneError::Malformed { file: file.to_owned(), reason };
        check_limit(file, "the number of vertices", count as u64, limits.vertices)?;
        check_limit(file, "the number of triangles", self.indices.len() as u64, limits.triangles)?;
        for (what, len) in [
            ("normals", self.normals.len()),
            ("texture coordinates", self.uvs.len()),
            ("colours", self.colors.len()),
            ("numbers", self.origins.len()),
        ] {
            if len != 0 && len != count {
                return Err(malformed(format!(
                    "mesh '{}' has {count} positions but {len} {what}",
                    self.name
                )));
            }
        }
        match self.indices.iter().flatten().find(|&&i| i as usize >= count) {
            Some(i) => {
                Err(malformed(format!("mesh '{}' uses vertex {i} but has {count} vertices", self.name)))
            }
            None => Ok(()),
        }
    }

    /// Drops what is not finite, fills what is absent and makes the normals unit.
    pub(crate) fn into_mesh(self, shading: Shading, report: &mut ImportReport) -> Mesh {
        self.into_mesh_and_origins(shading, report).0
    }

    /// [`RawMesh::into_mesh`], and where its vertices come from.
    pub(crate) fn into_mesh_and_origins(
        mut self,
        shading: Shading,
        report: &mut ImportReport,
    ) -> (Mesh, Vec<u32>) {
        self.drop_non_finite(report);
        let keeps_normals = shading != Shading::Flat && !self.normals.is_empty();
        if !keeps_normals {
            self.normals.clear();
            match shading {
                Shading::Smooth => self.normals = smooth_normals(&self.positions, &self.indices),
                Shading::Flat | Shading::FileOrFlat => self.unshare(),
            }
        }
        self.mend_normals(report);
        let count = self.positions.len();
        self.uvs.resize(count, [0.0; 2]);
        self.colors.resize(count, [1.0; 4]);
        self.uvs.iter_mut().flatten().filter(|v| !v.is_finite()).for_each(|v| *v = 0.0);
        self.colors.iter_mut().flatten().filter(|v| !v.is_finite()).for_each(|v| *v = 1.0);
        let Self { name, positions, normals, uvs, colors, origins, indices, material } = self;
        (Mesh { name, positions, normals, uvs, colors, indices, material }, origins)
    }

    fn drop_non_finite(&mut self, report: &mut ImportReport) {
        let good: Vec<bool> = self.positions.iter().map(|p| p.iter().all(|v| v.is_finite())).collect();
        let kept = good.iter().filter(|g| **g).count();
        if kept == good.len() {
            return;
        }
        let triangles = self.indices.len();
        self.indices.retain(|t| t.iter().all(|&i| good[i as usize]));
        report.dropped_vertices += (good.len() - kept) as u64;
        report.dropped_triangles += (triangles - self.indices.len()) as u64;
        let mut next = 0;
        let new_index: Vec<u32> = good
            .iter()
            .map(|&g| {
                next += u32::from(g);
                next.saturating_sub(1)
            })
            .collect();
        self.indices.iter_mut().flatten().for_each(|i| *i = new_index[*i as usize]);
        fn keep<T>(list: &mut Vec<T>, good: &[bool]) {
            let mut flags = good.iter();
            list.retain(|_| flags.next().copied().unwrap_or(true));
        }
        keep(&mut self.positions, &good);
        keep(&mut self.normals, &good);
        keep(&mut self.uvs, &good);
        keep(&mut self.colors, &good);
        keep(&mut self.origins, &good);
    }

    /// Gives each triangle its own three vertices and its face normal.
    fn unshare(&mut self) {
        fn spread<T: Copy>(list: &[T], indices: &[[u32; 3]]) -> Vec<T> {
            if list.is_empty() {
                Vec::new()
            } else {
                indices.iter().flatten().map(|&i| list[i as usize]).collect()
            }
        }
        self.normals =
            self.indices.iter().flat_map(|t| [face_normal(&self.positions, t).to_array(); 3]).collect();
        self.positions = spread(&self.positions, &self.indices);
        self.uvs = spread(&self.uvs, &self.indices);
        self.colors = spread(&self.colors, &self.indices);
        self.origins = spread(&self.origins, &self.indices);
        self.indices = (0..self.indices.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    }

    /// Makes normals unit; one that is no direction becomes that of a face at its vertex.
    fn mend_normals(&mut self, report: &mut ImportReport) {
        let mut bad = Vec::new();
        for (i, n) in self.normals.iter_mut().enumerate() {
            let v = DVec3::from_array(n.map(f64::from));
            let unit = v.try_normalize().map_or(Vec3::ZERO, |u| u.as_vec3());
            if !unit.is_normalized() {
                bad.push(i);
            }
            *n = unit.to_array();
        }
        if bad.is_empty() {
            return;
        }
        report.repaired_normals += bad.len() as u64;
        bad.iter().for_each(|&i| self.normals[i] = Vec3::Y.to_array());
        for t in &self.indices {
            for &i in t {
                if bad.binary_search(&(i as usize)).is_ok() {
                    self.normals[i as usize] = face_normal(&self.positions, t).to_array();
                }
            }
        }
    }
}

/// Refuses a count beyond its limit.
pub(crate) fn check_limit(file: &str, what: &'static str, found: u64, limit: u64) -> Result<(), SceneError> {
    if found > limit {
        return Err(SceneError::TooLarge { file: file.to_owned(), what, found, limit });
    }
    Ok(())
}

/// Twice the area times the normal, in f64: edges of 1e30 and 1e-30 metres must neither overflow nor vanish.
fn face_vector(positions: &[[f32; 3]], t: &[u32; 3]) -> DVec3 {
    let [a, b, c] = t.map(|i| DVec3::from_array(positions[i as usize].map(f64::from)));
    (b - a).cross(c - a)
}

/// Unit normal of a triangle; up for one without area.
pub(crate) fn face_normal(positions: &[[f32; 3]], t: &[u32; 3]) -> Vec3 {
    let v = face_vector(positions, t);
    // A plain `try_normalize` squares the length, which underflows for the smallest triangles.
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() {
        (v / largest).normalize_or(DVec3::Y).as_vec3()
    } else {
        Vec3::Y
    }
}

/// Area-weighted averages of the faces around each position, whether or not they share the vertex.
fn smooth_normals(positions: &[[f32; 3]], indices: &[[u32; 3]]) -> Vec<[f32; 3]> {
    use std::collections::HashMap;
    // Adding zero turns -0 into 0, so that both count as one place.
    let key = |p: &[f32; 3]| p.map(|v| (v + 0.0).to_bits());
    let mut places: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    let place: Vec<u32> = positions
        .iter()
        .map(|p| {
            let next = places.len() as u32;
            *places.entry(key(p)).or_insert(next)
        })
        .collect();
    let mut sums = vec![DVec3::ZERO; places.len()];
    for t in indices {
        let v = face_vector(positions, t);
        if v.is_finite() {
            t.iter().for_each(|&i| sums[place[i as usize] as usize] += v);
        }
    }
    place
        .iter()
        .map(|&p| {
            let v = sums[p as usize];
            let largest = v.abs().max_element();
            let unit = if largest > 0.0 { (v / largest).normalize_or(DVec3::Y) } else { DVec3::Y };
            unit.as_vec3().to_array()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad() -> RawMesh {
        RawMesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            indices: vec![[0, 1, 2], [0, 2, 3]],
            ..RawMesh::default()
        }
    }

    #[test]
    fn faces_become_smooth() {
        let corners = (0..8u32).map(|n| [n & 1, n >> 1 & 1, n >> 2 & 1].map(|c| c as f32 - 0.5)).collect();
        let corner = vec![[0, 2, 1], [0, 4, 2], [0, 1, 4]];
        let mut mesh = Mesh::flat("corner", corners, corner, 0);
        let middle: Vec<usize> = (0..9).filter(|n| mesh.positions[*n] == [-0.5; 3]).collect();
        assert_eq!(middle.len(), 3);
        mesh.smooth();
        let expected = -Vec3::splat(3f32.sqrt().recip());
        assert!(middle.iter().all(|n| Vec3::from(mesh.normals[*n]).distance(expected) < 1e-6));
        assert_eq!(mesh.normals.len(), mesh.positions.len());
    }

    #[test]
    fn holes_of_a_mesh_are_closed_and_attributes_stay_in_step() {
        let corners = |n: u32| [n & 1, n >> 1 & 1, n >> 2 & 1].map(|c| c as f32);
        let cube = [
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
        ];
        let mut open = Mesh::flat("open", (0..8).map(corners).collect(), cube.to_vec(), 0);
        let before = open.clone();
        assert_eq!(open.close_holes(), 0);
        assert_eq!(open.indices.len(), cube.len() + 4);
        let count = open.positions.len();
        assert_eq!([open.normals.len(), open.uvs.len(), open.colors.len()], [count; 3]);
        assert!(open.normals[before.positions.len()..].iter().all(|n| (n[0] - 1.0).abs() < 1e-6));
        assert_eq!(open.close_holes(), 0);
        assert_eq!(open.positions.len(), count);
        let mut empty = Mesh::default();
        assert_eq!(empty.close_holes(), 0);
    }

    #[test]
    fn a_vertex_that_is_not_finite_goes_with_its_triangles() {
        let mut raw = quad();
        raw.positions[1][2] = f32::NAN;
        raw.uvs = vec![[0.0, 0.1], [1.0, 0.1], [2.0, 0.1], [3.0, f32::INFINITY]];
        let mut report = ImportReport::default();
        let mesh = raw.into_mesh(Shading::Smooth, &mut report);
        assert_eq!((report.dropped_vertices, report.dropped_triangles), (1, 1));
        assert_eq!(mesh.positions.len(), 3);
        assert_eq!(mesh.indices, [[0, 1, 2]]);
        assert_eq!(mesh.uvs, [[0.0, 0.1], [2.0, 0.1], [3.0, 0.0]]);
    }

    #[test]
    fn flat_normals_unshare_vertices_and_point_by_winding() {
        let mesh = quad().into_mesh(Shading::FileOrFlat, &mut ImportReport::default());
        assert_eq!(mesh.positions.len(), 6);
        assert!(mesh.normals.iter().all(|n| *n == [0.0, 0.0, 1.0]));
        assert_eq!((mesh.uvs.len(), mesh.colors[5]), (6, [1.0; 4]));
    }

    #[test]
    fn normals_that_are_no_direction_are_mended() {
        let mut raw = quad();
        raw.normals = vec![[0.0; 3], [f32::NAN, 0.0, 0.0], [0.0, 7.0, 0.0], [0.0, 1e-30, 0.0]];
        let mut report = ImportReport::default();
        let mesh = raw.into_mesh(Shading::FileOrFlat, &mut report);
        assert_eq!(report.repaired_normals, 2);
        assert_eq!(mesh.normals, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn normals_survive_extreme_scales() {
        for scale in [1e-30f32, 1e30] {
            let mut raw = quad();
            raw.positions.iter_mut().flatten().for_each(|v| *v *= scale);
            for shading in [Shading::Flat, Shading::Smooth] {
                let mesh = raw.clone().into_mesh(shading, &mut ImportReport::default());
                assert!(mesh.normals.iter().all(|n| *n == [0.0, 0.0, 1.0]), "{scale} {shading:?}");
            }
        }
    }

    #[test]
    fn counts_that_disagree_are_refused_with_numbers() {
        let mut raw = quad();
        raw.indices.push([0, 1, 4]);
        let text = raw.check("a.ply", &Limits::default()).unwrap_err().to_string();
        assert_eq!(text, "a.ply: mesh '' uses vertex 4 but has 4 vertices");
        raw.colors.push([1.0; 4]);
        assert!(raw.check("a.ply", &Limits::default()).is_err());
        let text =
            quad().check("a.ply", &Limits { triangles: 1, ..Limits::default() }).unwrap_err().to_string();
        assert_eq!(text, "a.ply: the number of triangles is 2, more than the limit of 1");
    }
}
