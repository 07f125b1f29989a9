//! Slow, obviously right references that tests and comparisons measure against.
//!
//! Every part knows [`lumivox_core`] alone and never what it judges: meshes come in as borrowed triangles, scenes as
//! this crate's own plain [`scene::Scene`].
//!
//! - [`voxels`]: the exact, the thin and the sampled voxel set of a mesh in double precision, with the margin of each
//!   verdict, and the difference between two sets;
//! - [`tracer`]: a path tracer for Lambertian scenes that keeps direct light, the first bounce and all bounces apart;
//! - [`distance`]: distances between a point set and a mesh, both ways;
//! - [`closed_form`]: light transport with known answers;
//! - [`metrics`]: how far one picture is from another.
//!
//! ```
//! use glam::Vec3;
//! use lumivox_oracle::scene::{Light, Material, Scene, Triangle};
//! use lumivox_oracle::tracer::Tracer;
//!
//! let mut scene = Scene::default();
//! scene.materials.push(Material::matte(Vec3::splat(0.5)));
//! scene.triangles.push(Triangle::flat([Vec3::ZERO, Vec3::Z, Vec3::X], 0));
//! scene.lights.push(Light::Directional { direction: -Vec3::Y, irradiance: Vec3::splat(3.0) });
//! let tracer = Tracer::new(&scene)?;
//! let above = tracer.irradiance(Vec3::new(0.2, 0.1, 0.2), Vec3::Y, None, 16, 0);
//! assert_eq!(above.direct, Vec3::splat(3.0));
//! # Ok::<(), lumivox_oracle::scene::SceneError>(())
//! ```
//!
//! Conventions are those of [`lumivox_core`]: right-handed, Y up, metres, linear Rec. 709; light in radiometric units.

pub mod closed_form;
pub mod distance;
pub mod metrics;
pub mod picture;
pub mod scene;
#[cfg(test)]
mod shapes;
pub mod tracer;
pub mod voxels;
