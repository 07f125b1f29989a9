//! Scenes for Lumivox: meshes, materials, lights and cameras, the importers that read them from files, and the
//! procedural scenes that need no file. No GPU in here.
//!
//! - [`load`] is the front door: `"builtin:NAME"`, `"builtin:NAME:DETAIL"` or a path.
//! - [`load_bytes`] reads untrusted bytes within stated [`Limits`].
//! - Every problem of a file is a [`SceneError`] that names the file and the reason; what was merely left out is
//!   counted in [`Scene::report`].
//! - [`Scene::clips`] and [`Scene::pose`] say what moves and where everything stands at one moment.
//!
//! Units and axes are those of [`lumivox_core`]: right-handed, Y up, metres, linear Rec. 709. Lights are radiometric:
//! W/sr for point and spot, W/m2 for directional, W/(m2 sr) for emission, rectangles and the sky.

pub mod animation;
pub mod builtin;
mod error;
mod import;
mod limits;
mod mesh;
mod report;
mod scene;
mod sky;

pub use animation::{Animation, Clip, DeformedMesh, Interpolation, NodeId, Pose, Track, Transform};
pub use error::SceneError;
pub use import::{EXTENSIONS, SCHEMA, load, load_bytes, load_with};
pub use limits::Limits;
pub use mesh::Mesh;
pub use report::ImportReport;
pub use scene::{AlphaMode, Camera, Glass, Instance, Light, Material, Scene, SpotFalloff, Texture, Wrap};
pub use sky::SkyMap;
