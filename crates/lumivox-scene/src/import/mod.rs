//! The front door: one way in for every file, whatever its format.
//!
//! A file passes, in this order: its extension, the size cap, the importer's own checks of counts and ranges, the
//! third-party parser inside [`guard::fenced`], and the common cleaning in [`crate::mesh`].

mod gltf;
mod guard;
mod mtl;
mod obj;
mod off;
mod ply;
mod scene_file;
mod source;
mod stl;
mod texture;
mod units;

use std::path::Path;

use glam::{Mat4, Vec3};

use crate::mesh::{RawMesh, Shading};
use crate::{Instance, Limits, Material, Scene, SceneError, builtin};
pub use scene_file::SCHEMA;
use source::Source;

/// What [`load`] reads, by the end of the file's name.
pub const EXTENSIONS: &[&str] = &[".glb", ".gltf", ".obj", ".ply", ".stl", ".off", ".scene.json"];

/// Albedo of a mesh whose file says nothing about its surface.
const DEFAULT_ALBEDO: f32 = 0.8;
/// Name of the material of files that name none.
const DEFAULT_MATERIAL: &str = "default";

/// Loads `"builtin:NAME"`, `"builtin:NAME:DETAIL"` (0 to 4) or a file, within the default [`Limits`].
///
/// ```
/// let scene = lumivox_scene::load("builtin:cornell:0")?;
/// assert!(scene.triangle_count() > 20);
/// let error = lumivox_scene::load("builtin:palace").unwrap_err();
/// assert!(error.to_string().contains("atrium"));
/// # Ok::<(), lumivox_scene::SceneError>(())
/// ```
///
/// # Errors
/// If there is no such built-in scene or file, or the file is no scene.
pub fn load(source: &str) -> Result<Scene, SceneError> {
    load_with(source, &Limits::default())
}

/// [`load`] with limits of one's own.
///
/// # Errors
/// As [`load`].
pub fn load_with(source: &str, limits: &Limits) -> Result<Scene, SceneError> {
    if let Some(name) = source.strip_prefix("builtin:") {
        return builtin::by_name(name);
    }
    check_extension(source)?;
    let source = Source::of_path(Path::new(source));
    let bytes = source.read_self(limits)?;
    import(&source, &bytes, limits)
}

/// Reads a scene from memory. The end of `name` says the format; files that the scene refers to are not found, unless
/// they are embedded.
///
/// # Errors
/// If the bytes are no scene of that format or ask for more than `limits`.
pub fn load_bytes(name: &str, bytes: &[u8], limits: &Limits) -> Result<Scene, SceneError> {
    check_extension(name)?;
    crate::mesh::check_limit(name, "the size in bytes", bytes.len() as u64, limits.file_bytes)?;
    import(&Source::of_memory(name), bytes, limits)
}

/// `.scene.json`, `.glb` and so on, in lower case; empty if there is none.
fn extension(name: &str) -> String {
    let lower = name.to_ascii_lowercase();
    let file = lower.rsplit(['/', '\\']).next().unwrap_or_default();
    match file.rsplit_once('.') {
        Some((stem, "json")) if stem.ends_with(".scene") => ".scene.json".to_owned(),
        Some((_, end)) => format!(".{end}"),
        None => String::new(),
    }
}

/// The name of a file without folders and its end.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or_default();
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

fn check_extension(name: &str) -> Result<(), SceneError> {
    let extension = extension(name);
    if EXTENSIONS.contains(&extension.as_str()) {
        return Ok(());
    }
    let extension = extension.trim_start_matches('.').to_owned();
    Err(SceneError::UnknownExtension { file: name.to_owned(), extension })
}

/// Reads any format. Normals are the file's for glTF; else the faces', or with `smooth` the file's or averages.
fn import(source: &Source, bytes: &[u8], limits: &Limits) -> Result<Scene, SceneError> {
    match extension(source.name()).as_str() {
        ".scene.json" => scene_file::import(source, bytes, limits),
        _ => import_meshes(source, bytes, limits, false),
    }
}

/// Reads a format that is not made of other files' scenes.
fn import_meshes(source: &Source, bytes: &[u8], limits: &Limits, smooth: bool) -> Result<Scene, SceneError> {
    let shading = if smooth { Shading::Smooth } else { Shading::Flat };
    let mut scene = match extension(source.name()).as_str() {
        ".glb" | ".gltf" => {
            let shading = if smooth { Shading::Smooth } else { Shading::FileOrFlat };
            let mut scene = gltf::import(source, bytes, limits, shading)?;
            units::note(".gltf", bytes, &mut scene);
            return Ok(scene);
        }
        ".obj" => obj::import(source, bytes, limits, shading)?,
        ".ply" => {
            let mut scene = Scene::default();
            let raw = ply::import(source, bytes, limits, &mut scene.report)?;
            single(source, raw, scene, limits, shading)?
        }
        ".stl" => single(source, stl::import(source, bytes, limits)?, Scene::default(), limits, shading)?,
        ".off" => single(source, off::import(source, bytes, limits)?, Scene::default(), limits, shading)?,
        _ => return Err(source.unsupported("this kind of file inside of a scene")),
    };
    let world_from_local = Mat4::IDENTITY;
    scene.instances = (0..scene.meshes.len()).map(|mesh| Instance { mesh, world_from_local }).collect();
    units::note(&extension(source.name()), bytes, &mut scene);
    Ok(scene)
}

/// A scene of one mesh with the default material; of none if it has no triangles.
fn single(
    source: &Source,
    raw: RawMesh,
    mut scene: Scene,
    limits: &Limits,
    shading: Shading,
) -> Result<Scene, SceneError> {
    // Such files name no mesh.
    let raw = RawMesh { name: stem(source.name()).to_owned(), ..raw };
    raw.check(source.name(), limits)?;
    if raw.indices.is_empty() {
        scene.report.warn("the file has no triangles");
        scene.report.skipped_primitives += 1;
        return Ok(scene);
    }
    scene.materials.push(default_material(!raw.colors.is_empty()));
    scene.meshes.push(raw.into_mesh(shading, &mut scene.report));
    Ok(scene)
}

/// The surface of a file that names none; where vertices have colours, these alone count.
fn default_material(has_colors: bool) -> Material {
    Material::matte(DEFAULT_MATERIAL, Vec3::splat(if has_colors { 1.0 } else { DEFAULT_ALBEDO }))
}

/// Cuts a polygon into triangles around its first corner; fewer than three corners make none.
fn fan(mut corners: impl Iterator<Item = u32>, triangles: &mut Vec<[u32; 3]>) {
    let (Some(first), Some(mut last)) = (corners.next(), corners.next()) else { return };
    for next in corners {
        triangles.push([first, last, next]);
        last = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_are_found_whatever_their_case() {
        for (name, end) in [
            ("a.GLB", ".glb"),
            ("b/x.Scene.JSON", ".scene.json"),
            ("x.json", ".json"),
            ("a.b/c", ""),
            (r"d\e.ply", ".ply"),
            (".scene.json", ".scene.json"),
        ] {
            assert_eq!(extension(name), end, "{name}");
        }
        let text = load("walls.blend").unwrap_err().to_string();
        assert!(
            text.starts_with("walls.blend: unknown file type 'blend'; supported are .glb .gltf .obj"),
            "{text}"
        );
        let text = load("no-such.glb").unwrap_err().to_string();
        assert!(text.starts_with("no-such.glb: cannot be read"), "{text}");
    }

    #[test]
    fn the_size_cap_comes_first() {
        let limits = Limits { file_bytes: 3, ..Limits::default() };
        let text = load_bytes("a.ply", b"plyx", &limits).unwrap_err().to_string();
        assert_eq!(text, "a.ply: the size in bytes is 4, more than the limit of 3");
    }
}
