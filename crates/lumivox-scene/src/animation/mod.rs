//! Motion: a hierarchy of nodes, what hangs on them, and clips of keyframes that move them.
//!
//! [`Scene::pose`](crate::Scene::pose) says where everything stands at one moment of a [`Clip`], on the CPU: instances,
//! lights and cameras by the nodes they hang on, meshes with skins or morph targets vertex by vertex. The conventions
//! are those of glTF 2.0, section 3.11 and appendix C.
//!
//! A moving lamp on a turning arm, by code:
//!
//! ```
//! use glam::{Quat, Vec3};
//! use lumivox_scene::{Clip, Light, Scene, Track, Transform};
//!
//! let mut scene = Scene::default();
//! scene.lights.push(Light::Point { position: Vec3::X, intensity: Vec3::ONE });
//! let arm = scene.animation.add_node(None, Transform::default());
//! scene.hang_light(0, arm);
//! let turn = Track::spin(Vec3::Y, 4.0);
//! scene.animation.add_clip(Clip::new("turn").with(arm, turn));
//! let Light::Point { position, .. } = scene.pose(0, 1.0).lights[0] else { unreachable!() };
//! assert!(position.abs_diff_eq(Vec3::NEG_Z, 1e-6));
//! ```

mod clip;
pub(crate) mod deform;
mod motion_bounds;
mod pose;
pub(crate) mod rig;
mod track;
mod transform;

pub use clip::Clip;
pub(crate) use clip::{Channel, Target};
pub use pose::{DeformedMesh, Pose};
pub use rig::{Animation, NodeId};
pub(crate) use track::Property;
pub use track::{Interpolation, Track};
pub use transform::Transform;
