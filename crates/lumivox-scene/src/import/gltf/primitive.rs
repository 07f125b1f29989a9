//! The geometry of one primitive, with what may deform it.

use gltf::json::mesh::{Mode, MorphTarget as JsonTarget, Primitive, Semantic};
use gltf::json::validation::Checked::Valid;

use super::accessor::Reader;
use super::texture_transform::UvSource;
use crate::animation::deform::MorphTarget;
use crate::mesh::{RawMesh, check_limit};
use crate::{ImportReport, Limits, SceneError};

/// Sets of four joints and weights that a vertex may have.
const JOINT_SETS: u32 = 4;

/// What has been read so far, over all meshes: primitives may share accessors, so the file's size bounds nothing.
pub(super) struct Budget<'a> {
    file: &'a str,
    limits: &'a Limits,
    vertices: u64,
    triangles: u64,
    /// Offsets of morph targets and sets of joints, each of the size of a vertex.
    extras: u64,
}

impl<'a> Budget<'a> {
    pub(super) fn new(file: &'a str, limits: &'a Limits) -> Self {
        Self { file, limits, vertices: 0, triangles: 0, extras: 0 }
    }

    pub(super) fn add(&mut self, vertices: u64, triangles: u64) -> Result<(), SceneError> {
        self.vertices = self.vertices.saturating_add(vertices);
        check_limit(self.file, "the number of vertices", self.vertices, self.limits.vertices)?;
        self.triangles = self.triangles.saturating_add(triangles);
        check_limit(self.file, "the number of triangles", self.triangles, self.limits.triangles)
    }

    pub(super) fn add_extra(&mut self, count: u64) -> Result<(), SceneError> {
        self.extras = self.extras.saturating_add(count);
        let what = "the number of joint weights and morph offsets";
        check_limit(self.file, what, self.extras, self.limits.vertices)
    }

    /// Refuses more meshes or instances than are allowed.
    pub(super) fn check_counts(&self, meshes: usize, instances: usize) -> Result<(), SceneError> {
        check_limit(self.file, "the number of meshes", meshes as u64, self.limits.meshes)?;
        check_limit(self.file, "the number of instances", instances as u64, self.limits.nodes)
    }
}

/// Four joints and four weights per vertex.
type JointSet = (Vec<[f32; 4]>, Vec<[f32; 4]>);

/// A primitive as the file states it.
pub(super) struct RawPrimitive {
    pub(super) raw: RawMesh,
    pub(super) targets: Vec<MorphTarget>,
    /// Empty for a mesh without joints.
    pub(super) influences: Influences,
}

/// Joints and their weights, which sum to one for each vertex.
#[derive(Clone, Debug, Default)]
pub(super) struct Influences {
    /// Per vertex the end of its influences; they start where those of the vertex before end.
    ends: Vec<u32>,
    list: Vec<(u32, f32)>,
}

impl Influences {
    pub(super) fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    pub(super) fn of(&self, vertex: u32) -> &[(u32, f32)] {
        let v = vertex as usize;
        let start = v.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.list[start as usize..self.ends[v] as usize]
    }
}

/// Reads one primitive, or `None` for points, lines and primitives without positions.
pub(super) fn read(
    reader: &Reader,
    primitive: &Primitive,
    uv_source: UvSource,
    budget: &mut Budget,
    report: &mut ImportReport,
) -> Result<Option<RawPrimitive>, SceneError> {
    let attribute = |semantic| primitive.attributes.get(&Valid(semantic)).map(|a| a.value());
    let (Some(positions), Valid(mode)) = (attribute(Semantic::Positions), primitive.mode) else {
        return Ok(None);
    };
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(None);
    }
    let count = reader.count(positions)?;
    let corners = match primitive.indices {
        Some(indices) => reader.count(indices.value())?,
        None => count,
    };
    let triangles = if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) };
    budget.add(count, triangles)?;

    // Only what has the positions' count is decoded, so that the limit above holds for all of it.
    let same_count = |index: usize| -> Result<usize, SceneError> {
        match reader.count(index)? {
            c if c == count => Ok(index),
            c => Err(reader
                .source
                .malformed(format!("has accessor {index} of {c} elements beside {count} positions"))),
        }
    };
    let mut raw = RawMesh { positions: reader.vectors(positions, 3..=3, 0.0)?, ..RawMesh::default() };
    if let Some(normals) = attribute(Semantic::Normals) {
        raw.normals = reader.vectors(same_count(normals)?, 3..=3, 0.0)?;
    }
    if let Some(uvs) = attribute(Semantic::TexCoords(uv_source.set)) {
        raw.uvs = reader.vectors(same_count(uvs)?, 2..=2, 0.0)?;
        raw.uvs.iter_mut().for_each(|uv| *uv = uv_source.apply(*uv));
    }
    if let Some(colors) = attribute(Semantic::Colors(0)) {
        raw.colors = reader.vectors(same_count(colors)?, 3..=4, 1.0)?;
    }
    let corners = match primitive.indices {
        Some(indices) => reader.integers(indices.value())?,
        None => (0..count as u32).collect(),
    };
    raw.indices = triangles_of(&corners, mode);

    let mut targets = Vec::new();
    for target in primitive.targets.iter().flatten() {
        let JsonTarget { positions, normals, .. } = target;
        let mut offsets = |index: &Option<gltf::json::Index<gltf::json::Accessor>>| match index {
            Some(index) => {
                budget.add_extra(count)?;
                reader.vectors(same_count(index.value())?, 3..=3, 0.0)
            }
            None => Ok(Vec::new()),
        };
        targets.push(MorphTarget { positions: offsets(positions)?, normals: offsets(normals)? });
    }
    let strange = targets.iter_mut().flat_map(|t| [&mut t.positions, &mut t.normals]).flatten().flatten();
    let strange = strange.filter(|v| !v.is_finite()).map(|v| *v = 0.0).count();
    if strange > 0 {
        report.warn(format!("{strange} numbers of morph targets are not finite and count as zero"));
    }

    let mut sets = Vec::new();
    for set in 0..JOINT_SETS {
        let (Some(joints), Some(weights)) =
            (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)))
        else {
            break;
        };
        budget.add_extra(count)?;
        let joints: Vec<[f32; 4]> = reader.vectors(same_count(joints)?, 4..=4, 0.0)?;
        let weights: Vec<[f32; 4]> = reader.vectors(same_count(weights)?, 4..=4, 0.0)?;
        sets.push((joints, weights));
    }
    let influences = influences_of(&sets, report);
    if !targets.is_empty() || !influences.is_empty() {
        raw.origins = (0..count as u32).collect();
    }
    Ok(Some(RawPrimitive { raw, targets, influences }))
}

/// Gathers the sets of each vertex, without those of no weight, and scales the rest to a sum of one.
fn influences_of(sets: &[JointSet], report: &mut ImportReport) -> Influences {
    // Four weights of a byte each are rounded by no more.
    const ROUNDING: f32 = 0.01;
    let mut all = Influences::default();
    let Some((first, _)) = sets.first() else { return all };
    let mut odd = 0;
    for v in 0..first.len() {
        let start = all.list.len();
        let pairs = sets.iter().flat_map(|(joints, weights)| joints[v].into_iter().zip(weights[v]));
        all.list.extend(pairs.filter(|(_, w)| *w > 0.0 && w.is_finite()).map(|(j, w)| (j as u32, w)));
        let sum: f32 = all.list[start..].iter().map(|(_, w)| w).sum();
        let fits = (sum - 1.0).abs() <= ROUNDING;
        odd += u64::from(!fits);
        if all.list.len() == start || !sum.is_finite() {
            all.list.truncate(start);
            all.list.push((first[v][0] as u32, 1.0));
        } else {
            all.list[start..].iter_mut().for_each(|(_, w)| *w /= sum);
        }
        all.ends.push(all.list.len() as u32);
    }
    if odd > 0 {
        let text =
            format!("joint weights of {odd} vertices do not sum to one; they are scaled so that they do");
        report.warn(text);
    }
    all
}

/// Corner numbers to triangles; strips keep their winding. A rest of one or two corners is left out.
fn triangles_of(corners: &[u32], mode: Mode) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        Mode::TriangleFan => match corners.split_first() {
            Some((&hub, rim)) => rim.windows(2).map(|w| [w[0], w[1], hub]).collect(),
            None => Vec::new(),
        },
        _ => corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(triangles_of(&[0, 1, 2, 3, 4], Mode::TriangleStrip), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles_of(&[0, 1, 2, 3], Mode::TriangleFan), [[1, 2, 0], [2, 3, 0]]);
        assert_eq!(triangles_of(&[0, 1, 2, 3, 4], Mode::Triangles), [[0, 1, 2]]);
        assert!(triangles_of(&[], Mode::TriangleFan).is_empty());
    }

    #[test]
    fn weights_are_scaled_to_one_whatever_they_are() {
        let mut report = ImportReport::default();
        let joints = vec![[0.0, 1.0, 2.0, 3.0], [5.0, 6.0, 0.0, 0.0], [7.0, 0.0, 0.0, 0.0]];
        let weights = vec![[0.5, 0.5, 0.0, 0.0], [3.0, 1.0, f32::NAN, -1.0], [0.0; 4]];
        let all = influences_of(&[(joints, weights)], &mut report);
        assert_eq!(all.of(0), [(0, 0.5), (1, 0.5)]);
        assert_eq!(all.of(1), [(5, 0.75), (6, 0.25)]);
        assert_eq!(all.of(2), [(7, 1.0)]);
        assert!(report.warnings[0].contains("of 2 vertices"), "{:?}", report.warnings);
        assert!(influences_of(&[], &mut report).is_empty());
    }
}
