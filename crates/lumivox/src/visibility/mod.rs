//! What rigid objects hide, by constant-time look-ups in their baked visibility fields (Gaitatzes, dissertation, chapter 4).
//!
//! A field tells for any ray how far it is from an object, wherever the object stands and however many triangles it has. It is
//! baked by the crate `lumivox-field`, on the CPU; here it comes in as a [`PackedField`](lumivox_core::PackedField), plain
//! numbers, so that this crate needs nothing of what bakes.
//!
//! | type | what it is |
//! | --- | --- |
//! | [`Fields`] | the fields, uploaded once: all maps in one 3D texture, several per slice (Figure 28) |
//! | [`Objects`] | where the objects of a frame stand; any number share a field |
//! | [`Occlusion`] | ambient visibility at each pixel of a G-buffer |
//! | [`SoftShadows`] | the share of each light of finite size that a pixel sees |
//! | [`Reflections`] | what polished pixels mirror of the objects |
//! | [`RayQuery`] | any rays against all objects |
//!
//! **Order.** Once: [`Fields::new`], [`Objects::new`], [`Occlusion::new`]. In each frame: [`Objects::update`],
//! [`Occlusion::update`], then [`Occlusion::record`] after the G-buffer. The host multiplies its ambient light by
//! [`Occlusion::factor`], each light by its [`SoftShadows::factor`], and what its surface reflects by [`Reflections::color`].
//!
//! **Look-ups** are those of `Field::ahead` in `lumivox-field`, for rays from outside an object's sphere and from within, on the
//! object itself too (Figure 31).
//!
//! **Culling.** A pass finds for each tile of 8 x 8 pixels which objects reach what it shows. Only tiles with any are drawn,
//! and in these only such objects are asked.
//!
//! **Noise.** The 16 pixels of a 4 x 4 block have rays of their own, parts of one sequence, and denoising is a mean over as
//! many pixels of the same surface. So a flat surface has no grain, and the same picture comes out every time.

mod denoise;
mod fields;
mod hit_light;
mod objects;
mod occlusion;
mod query;
mod reflection;
mod shadow;
mod tiled_pass;
mod tiles;

use glam::UVec2;

pub use fields::{FieldUniform, Fields};
pub use hit_light::{HitLamp, HitLampUniform, HitLight, HitLightUniform, MAX_LAMPS};
pub use objects::{MAX_OBJECTS, ObjectUniform, Objects, Placement};
pub use occlusion::{Combine, Occlusion, OcclusionSettings, OcclusionUniform};
pub use query::{HIT_BYTES, QueryHit, QueryRay, QueryUniform, RAY_BYTES, RayQuery};
pub use reflection::{REFLECTION_FORMAT, ReflectionSettings, ReflectionUniform, Reflections};
pub use shadow::{ShadowLight, ShadowSettings, ShadowUniform, SoftShadows};
pub use tiles::TileUniform;

use crate::gpu::{GpuError, Shader, Texture, Uniform};
use crate::progressive::ViewInput;
use crate::wgsl::ViewUniform;

/// The struct of objects.
const OBJECT: &str = include_str!("object.wgsl");
/// Look-ups; after [`OBJECT`].
const FIELD: &str = include_str!("field.wgsl");
/// Normals of hits; after [`FIELD`] and that for octahedra.
const NORMAL: &str = include_str!("normal.wgsl");
/// Directions for pixels.
const SAMPLING: &str = include_str!("sampling.wgsl");
/// What culling has in common; a part that says what counts comes after it.
const CULL: &str = include_str!("cull.wgsl");
/// The lobe of a polished surface; after [`SAMPLING`].
const LOBE: &str = include_str!("lobe.wgsl");
/// The light of hits; after [`FIELD`].
const HIT_LIGHT: &str = include_str!("hit_light.wgsl");
/// Tiles of a picture.
const TILE: &str = include_str!("tile.wgsl");
/// Listed tiles as quads; after [`TILE`].
const TILE_QUAD: &str = include_str!("tile_quad.wgsl");

/// Whether three maps answer for a ray, as shaders with [`FIELD`] are told.
fn blending(blended: bool) -> [(&'static str, f64); 1] {
    [("BLENDED", f64::from(u8::from(blended)))]
}

/// Format of factors.
pub const FACTOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;

/// The surfaces that light falls on: a G-buffer's depth and normals, of one size.
#[derive(Clone, Copy, Debug)]
pub struct Receiver<'v> {
    /// Depth, standard or reversed as the view says; a depth format or `R32Float`.
    pub depth: &'v Texture,
    /// World normals that face the view, unit length, zero where nothing is.
    pub normal: &'v Texture,
    /// Where the view stands.
    pub uniform: &'v Uniform<ViewUniform>,
}

impl<'v> From<&'v ViewInput> for Receiver<'v> {
    fn from(view: &'v ViewInput) -> Self {
        Self { depth: &view.textures.depth, normal: &view.textures.normal, uniform: &view.uniform }
    }
}

impl Receiver<'_> {
    fn check(&self, size: UVec2) -> Result<(), GpuError> {
        let given = [self.depth.size(), self.normal.size()];
        if given == [size.to_array(); 2] {
            return Ok(());
        }
        Err(GpuError::Validation(format!(
            "visibility: a G-buffer of {given:?} texels, for passes made for {size}"
        )))
    }
}

pub(crate) fn shaders() -> Vec<Shader> {
    vec![
        tiles::SHADER,
        occlusion::SHADER,
        shadow::SHADER,
        reflection::CULL_SHADER,
        reflection::SHADER,
        denoise::SHADER,
        query::SHADER,
    ]
}
