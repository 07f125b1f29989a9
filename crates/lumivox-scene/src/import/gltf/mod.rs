//! glTF 2.0 and GLB.
//!
//! Read: triangles, strips and fans, indexed or not, of any component type, sparse too; node transforms; base colour,
//! emission and alpha of materials; vertex colours; perspective cameras; `KHR_lights_punctual`, whose candela and lux
//! are taken as W/sr and W/m2. Skins and morph targets stay in their rest pose. `KHR_texture_transform` and everything
//! else that a file uses is counted as ignored.
//!
//! The `gltf` crate parses the JSON and knows the defaults; vertices are read by [`accessor`], which believes nothing.

mod accessor;
mod check;
mod container;
mod material;
mod node;

use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked::Valid;

use crate::import::guard::fenced;
use crate::import::source::Source;
use crate::mesh::{RawMesh, Shading, check_limit};
use crate::{Limits, Material, Scene, SceneError};
use accessor::Reader;

/// Reads an asset.
pub(super) fn import(
    source: &Source,
    bytes: &[u8],
    limits: &Limits,
    shading: Shading,
) -> Result<Scene, SceneError> {
    fenced(source.name(), "glTF", || read(source, bytes, limits, shading))
}

fn read(source: &Source, bytes: &[u8], limits: &Limits, shading: Shading) -> Result<Scene, SceneError> {
    let chunks = container::split(source, bytes)?;
    let root = check::parse(source, chunks.json, limits)?;
    let mut scene = Scene::default();
    check::check(source, &root, limits, &mut scene.report)?;
    let buffers = container::buffers(source, &root, chunks.bin, limits)?;
    let document = gltf::Document::from_json_without_validation(root.clone());
    let reader = Reader { source, root: &root, buffers: &buffers };

    let uv_sets = material::read(&reader, &document, limits, &mut scene)?;
    let mut budget = Budget { vertices: 0, triangles: 0 };
    let mut ranges = Vec::with_capacity(root.meshes.len());
    let mut default_material = None;
    for mesh in &root.meshes {
        let first = scene.meshes.len();
        for primitive in &mesh.primitives {
            let material = match primitive.material {
                Some(m) => m.value(),
                None => *default_material.get_or_insert_with(|| {
                    scene.materials.push(Material::default());
                    scene.materials.len() - 1
                }),
            };
            let uv_set = uv_sets.get(material).copied().unwrap_or(0);
            let name = mesh.name.clone().unwrap_or_default();
            match read_primitive(&reader, primitive, uv_set, limits, &mut budget)? {
                Some(raw) => {
                    let raw = RawMesh { name, material, ..raw };
                    raw.check(source.name(), limits)?;
                    scene.meshes.push(raw.into_mesh(shading, &mut scene.report));
                }
                None => scene.report.skipped_primitives += 1,
            }
        }
        ranges.push(first..scene.meshes.len());
    }
    node::place(source, &document, &ranges, limits, &mut scene)?;
    Ok(scene)
}

/// What has been read so far, over all meshes: primitives may share accessors, so the file's size bounds nothing.
struct Budget {
    vertices: u64,
    triangles: u64,
}

/// The geometry of one primitive, or `None` for points, lines and primitives without positions.
fn read_primitive(
    reader: &Reader,
    primitive: &Primitive,
    uv_set: u32,
    limits: &Limits,
    budget: &mut Budget,
) -> Result<Option<RawMesh>, SceneError> {
    let file = reader.source.name();
    let attribute = |semantic| primitive.attributes.get(&Valid(semantic)).map(|a| a.value());
    let (Some(positions), Valid(mode)) = (attribute(Semantic::Positions), primitive.mode) else {
        return Ok(None);
    };
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(None);
    }
    let count = reader.count(positions)?;
    budget.vertices = budget.vertices.saturating_add(count);
    check_limit(file, "the number of vertices", budget.vertices, limits.vertices)?;
    let corners = match primitive.indices {
        Some(indices) => reader.count(indices.value())?,
        None => count,
    };
    let triangles = if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) };
    budget.triangles = budget.triangles.saturating_add(triangles);
    check_limit(file, "the number of triangles", budget.triangles, limits.triangles)?;

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
    if let Some(uvs) = attribute(Semantic::TexCoords(uv_set)) {
        raw.uvs = reader.vectors(same_count(uvs)?, 2..=2, 0.0)?;
    }
    if let Some(colors) = attribute(Semantic::Colors(0)) {
        raw.colors = reader.vectors(same_count(colors)?, 3..=4, 1.0)?;
    }
    let corners = match primitive.indices {
        Some(indices) => reader.integers(indices.value())?,
        None => (0..count as u32).collect(),
    };
    raw.indices = triangles_of(&corners, mode);
    Ok(Some(raw))
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
mod tests;
