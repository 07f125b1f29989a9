//! Visibility fields (Gaitatzes, dissertation, chapter 4): for sample points on the bounding sphere of a rigid object,
//! maps of the distance to the object in every inward direction. Baked once, they tell in constant time how far any ray
//! is from the object, wherever the object stands and however many triangles it has. No GPU in here.
//!
//! ```no_run
//! # use lumivox_core::TriangleView;
//! # use lumivox_field::{Baker, Field, Mesh, Ray, Settings};
//! # fn example(triangles: TriangleView<'_>, ray: &Ray) -> Result<(), lumivox_field::FieldError> {
//! let baker = Baker::new(Mesh::new(triangles), Settings::default())?;
//! baker.bake_to_file("object.lvf", |_| std::ops::ControlFlow::Continue(()))?;
//! let field = Field::load("object.lvf")?;
//! let distance = field.nearest(ray);
//! # Ok(())
//! # }
//! ```
//!
//! - [`points`]: sample points on the sphere, and which is nearest (4.4.3).
//! - [`directions`]: the maps' directions, and in which texel a direction falls (4.4.4).
//! - [`bake`]: the rays (Algorithm 1).
//! - [`field`]: how distances are kept (4.6.1), and all maps as one 3D texture (Figure 28).
//! - [`lookup`]: rays against a field (Algorithm 2).
//! - [`mod@file`]: the format `.lvf`; a bake that stopped goes on where it was.
//! - [`parts()`]: several spheres for elongated objects (4.8).
//! - [`Cache`]: fields by mesh and settings.

pub mod bake;
mod cache;
pub mod directions;
mod error;
pub mod field;
pub mod file;
pub mod lookup;
mod parts;
pub mod points;
mod settings;
#[cfg(test)]
mod shapes;

pub use bake::{Baker, MAPS_PER_CHUNK, Mesh, Progress, Sphere};
pub use cache::{Cache, Cached};
pub use directions::{Directions, Mapping};
pub use error::FieldError;
pub use field::{BYTE_MISS, Distances, Field, FieldTexture, Texels, TextureLayout};
pub use lookup::{Blend, Interpolation, Ray};
pub use parts::{Part, parts};
pub use points::SpherePoints;
pub use settings::{Settings, Storage};
