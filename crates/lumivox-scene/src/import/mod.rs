//! The front door: one way in for every file, whatever its format.
//!
//! A file passes, in this order: its extension, the size cap, the importer's own checks of counts and ranges, the
//! third-party parser inside [`guard::fenced`], and the common cleaning in [`crate::mesh`].

mod gltf;
mod guard;
mod source;
mod texture;

use std::path::Path;

use crate::{Limits, Scene, SceneError, builtin};
use source::Source;

/// What [`load`] reads, by the end of the file's name.
pub const EXTENSIONS: &[&str] = &[".glb", ".gltf"];

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

fn check_extension(name: &str) -> Result<(), SceneError> {
    let extension = extension(name);
    if EXTENSIONS.contains(&extension.as_str()) {
        return Ok(());
    }
    let extension = extension.trim_start_matches('.').to_owned();
    Err(SceneError::UnknownExtension { file: name.to_owned(), extension })
}

fn import(source: &Source, bytes: &[u8], limits: &Limits) -> Result<Scene, SceneError> {
    match extension(source.name()).as_str() {
        ".glb" | ".gltf" => gltf::import(source, bytes, limits),
        _ => check_extension(source.name()).map(|()| Scene::default()),
    }
}
