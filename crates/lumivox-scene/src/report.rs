//! What an importer left out or mended.

use serde::Serialize;

/// Everything that was dropped, repaired or not understood while a scene was read; all zero and empty for a clean
/// file and for the built-in scenes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ImportReport {
    /// Vertices with a coordinate that is NaN or infinite.
    pub dropped_vertices: u64,
    /// Triangles that used such a vertex.
    pub dropped_triangles: u64,
    /// Normals that were no direction (zero or not finite) and were replaced by the face's.
    pub repaired_normals: u64,
    /// Primitives without triangles (points and lines).
    pub skipped_primitives: u64,
    /// Images larger than the limit, halved until they fit.
    pub shrunk_textures: u64,
    /// Images that are named but could not be found or read; the material goes without.
    pub missing_textures: Vec<String>,
    /// glTF extensions that the file uses and this importer ignores.
    pub ignored_extensions: Vec<String>,
    /// What went wrong otherwise, one sentence each.
    pub warnings: Vec<String>,
    /// What the file says, or does not say, about its unit and its up axis. Nothing is ever scaled or turned for it.
    pub notes: Vec<String>,
}

/// Warnings, and notes, that are kept of one file.
const MOST: usize = 64;

impl ImportReport {
    /// Adds a warning once; a broken file tends to repeat itself.
    pub(crate) fn warn(&mut self, text: impl Into<String>) {
        add_once(&mut self.warnings, text.into());
    }

    /// Adds a note once.
    pub(crate) fn note(&mut self, text: impl Into<String>) {
        add_once(&mut self.notes, text.into());
    }

    /// Takes over what another report says, for a scene made of several files.
    pub(crate) fn merge(&mut self, other: Self) {
        self.dropped_vertices += other.dropped_vertices;
        self.dropped_triangles += other.dropped_triangles;
        self.repaired_normals += other.repaired_normals;
        self.skipped_primitives += other.skipped_primitives;
        self.shrunk_textures += other.shrunk_textures;
        self.missing_textures.extend(other.missing_textures);
        for e in other.ignored_extensions {
            if !self.ignored_extensions.contains(&e) {
                self.ignored_extensions.push(e);
            }
        }
        other.warnings.into_iter().for_each(|w| self.warn(w));
        other.notes.into_iter().for_each(|n| self.note(n));
    }
}

fn add_once(list: &mut Vec<String>, text: String) {
    if list.len() < MOST && !list.contains(&text) {
        list.push(text);
    }
}
