//! OBJ with its MTL libraries. `tobj` reads the geometry; materials are read by [`mtl`], since it has no patience with
//! short lines. Polygons become fans, points and lines are left out, texture rows count from the top.

use std::cell::Cell;
use std::collections::HashMap;

use super::guard::fenced;
use super::source::Source;
use super::{default_material, mtl};
use crate::mesh::{RawMesh, Shading, check_limit};
use crate::{Limits, Scene, SceneError};

/// Reads a file into one mesh per object and material.
pub(super) fn import(
    source: &Source,
    bytes: &[u8],
    limits: &Limits,
    shading: Shading,
) -> Result<Scene, SceneError> {
    fenced(source.name(), "OBJ", || read(source, &String::from_utf8_lossy(bytes), limits, shading))
}

fn read(source: &Source, text: &str, limits: &Limits, shading: Shading) -> Result<Scene, SceneError> {
    check_counts(source, text, limits)?;
    let mut scene = Scene::default();
    let materials = libraries(source, text, limits, &mut scene)?;
    let models = match geometry(text, &materials) {
        // Colours on some vertices only, or with an alpha, are more than the reader takes.
        Err(tobj::LoadError::FaceColorOutOfBounds | tobj::LoadError::ColorParseError) => {
            scene.report.warn("vertex colours are left out: not every vertex has three numbers");
            geometry(&without_colors(text), &materials)
        }
        other => other,
    };
    let models = models.map_err(|e| source.malformed(format!("is no valid OBJ: {e}")))?;
    let fallback = scene.materials.len();
    for model in models {
        let mesh = model.mesh;
        let raw = RawMesh {
            name: model.name,
            positions: rows(&mesh.positions),
            normals: rows(&mesh.normals),
            uvs: rows::<2>(&mesh.texcoords).into_iter().map(|[u, v]| [u, 1.0 - v]).collect(),
            colors: rows::<3>(&mesh.vertex_color).into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect(),
            indices: mesh.indices.as_chunks().0.to_vec(),
            material: mesh.material_id.filter(|m| *m < materials.len()).unwrap_or(fallback),
        };
        if raw.indices.is_empty() {
            continue;
        }
        raw.check(source.name(), limits)?;
        scene.meshes.push(raw.into_mesh(shading, &mut scene.report));
    }
    if scene.meshes.iter().any(|m| m.material == fallback) {
        scene.materials.push(default_material());
    }
    Ok(scene)
}

fn rows<const N: usize>(numbers: &[f32]) -> Vec<[f32; N]> {
    numbers.as_chunks().0.to_vec()
}

fn check_counts(source: &Source, text: &str, limits: &Limits) -> Result<(), SceneError> {
    let (mut vertices, mut triangles) = (0u64, 0u64);
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v" | "vt" | "vn") => vertices += 1,
            Some("f") => triangles += (words.count() as u64).saturating_sub(2),
            _ => {}
        }
    }
    // Positions, texture coordinates and normals together: at worst, three lists of full length.
    check_limit(source.name(), "the number of vertices", vertices, limits.vertices.saturating_mul(3))?;
    check_limit(source.name(), "the number of triangles", triangles, limits.triangles)
}

/// The materials of all libraries that the file names. A library that is missing is a warning.
fn libraries(
    source: &Source,
    text: &str,
    limits: &Limits,
    scene: &mut Scene,
) -> Result<Vec<mtl::MtlMaterial>, SceneError> {
    let mut all = Vec::new();
    let mut seen = Vec::new();
    for line in text.lines() {
        let Some(("mtllib", rest)) = line.trim().split_once(char::is_whitespace) else { continue };
        let whole = rest.trim();
        if whole.is_empty() || seen.contains(&whole) || seen.len() >= 256 {
            continue;
        }
        seen.push(whole);
        // One name with blanks, or several names.
        let several: Vec<&str> = whole.split_whitespace().collect();
        let found = |name: &str| source.beside(name).and_then(|s| Ok((s.read_self(limits)?, s)));
        let names = if several.len() > 1 && found(whole).is_err() { several } else { vec![whole] };
        for name in names {
            match found(name) {
                Ok((bytes, library)) => {
                    let materials = mtl::parse(&String::from_utf8_lossy(&bytes));
                    let count = (all.len() + materials.len()) as u64;
                    check_limit(source.name(), "the number of materials", count, limits.meshes)?;
                    mtl::add(&library, &materials, limits, scene)?;
                    all.extend(materials);
                }
                Err(error) => scene.report.warn(format!("material library '{name}' is left out: {error}")),
            }
        }
    }
    Ok(all)
}

fn geometry(text: &str, materials: &[mtl::MtlMaterial]) -> Result<Vec<tobj::Model>, tobj::LoadError> {
    let options =
        tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let given = Cell::new(false);
    // All libraries at the first mention: the numbers of the materials are then those of `materials`.
    let library = |_: &std::path::Path| {
        if given.replace(true) {
            return Ok((Vec::new(), HashMap::new()));
        }
        let named = materials.iter().map(|m| tobj::Material { name: m.name.clone(), ..Default::default() });
        let numbers = materials.iter().enumerate().rev().map(|(i, m)| (m.name.clone(), i));
        Ok((named.collect(), numbers.collect()))
    };
    tobj::load_obj_buf(&mut text.as_bytes(), &options, library).map(|(models, _)| models)
}

/// The same text with three numbers to a vertex.
fn without_colors(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        if words.next() == Some("v") {
            out.push('v');
            for word in words.take(3) {
                out.push(' ');
                out.push_str(word);
            }
        } else {
            out.push_str(line);
        }
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Scene, SceneError> {
        import(&Source::of_memory("a.obj"), text.as_bytes(), &Limits::default(), Shading::Flat)
    }

    #[test]
    fn polygons_relative_indices_and_partial_colours_are_read() {
        let scene =
            parse("v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nf -4/1 -3/1 -2/1 -1/1\n").unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!((mesh.indices.len(), mesh.uvs[0], mesh.normals[0]), (2, [0.0, 0.75], [0.0, 0.0, 1.0]));
        assert_eq!(scene.report.warnings.len(), 1);
        assert_eq!(scene.materials, [default_material()]);
    }

    #[test]
    fn a_missing_library_is_a_warning_and_a_bad_index_an_error() {
        let scene = parse("mtllib no.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").unwrap();
        assert!(scene.report.warnings[0].contains("no.mtl"));
        assert!(parse("v 0 0 0\nf 1 2 3").unwrap_err().to_string().starts_with("a.obj: is no valid OBJ"));
    }
}
