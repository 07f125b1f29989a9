//! How much an untrusted file may ask for.

/// Upper bounds that are checked before anything is allocated for a file. The defaults hold the largest scenes that
/// a desktop renders comfortably and keep an importer below some gigabytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file (the scene itself, an external buffer, an image).
    pub file_bytes: u64,
    /// Bytes of all buffers of one scene together, external and embedded.
    pub buffer_bytes: u64,
    /// Vertices of one scene, each mesh counted once.
    pub vertices: u64,
    /// Triangles of one scene, each mesh counted once.
    pub triangles: u64,
    /// Meshes (glTF primitives) of one scene.
    pub meshes: u64,
    /// Nodes, and with them instances, of one scene.
    pub nodes: u64,
    /// Nodes above one another.
    pub node_depth: u64,
    /// Keyframes of one scene, times and values counted each.
    pub keyframes: u64,
    /// Pixels of one image as stored in its file.
    pub image_pixels: u64,
    /// Pixels of all textures of one scene as they are kept.
    pub texture_pixels: u64,
    /// Longest side of a texture that is kept; larger images are halved until they fit.
    pub texture_side: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 1 << 30,
            buffer_bytes: 1 << 30,
            vertices: 60_000_000,
            triangles: 20_000_000,
            meshes: 100_000,
            nodes: 200_000,
            node_depth: 128,
            keyframes: 20_000_000,
            image_pixels: 1 << 27,
            texture_pixels: 1 << 28,
            texture_side: 2048,
        }
    }
}
