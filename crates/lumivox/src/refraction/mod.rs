//! Refraction and frosted glass: closed things that are seen through, by how much of them an eye ray crosses.
//!
//! Source: Eisemann and Decoret, *Fast Scene Voxelization and Applications* (2006), section 3.3.
//!
//! What an eye ray crosses is counted in a local [`Slicemap`] of the camera whose front and back faces have bits of their own: from a front to a back
//! it is inside. That holds for concave things too, where the nearest and the farthest surface alone would fill all hollows.
//!
//! ```text
//! meshes --slicemap--> fronts and backs --thickness--> metres of each kind of glass at each pixel
//!        --surface---> first normal, kind, depth --+        |
//! picture of what is opaque --pyramid--> ----------+-> shading --> picture with glass
//! environment --------------pyramid--> ------------+
//! ```
//!
//! | stage | does |
//! | --- | --- |
//! | `surface` | the nearest glass: its normal and kind |
//! | [`Slicemap`] | fronts and backs of all kinds, in one pass |
//! | [`Thickness`] | inner cells of each column, as metres along the eye ray |
//! | [`Pyramid`] | a picture, or an environment, ever more blurred |
//! | `shading` | where the bent ray looks, how blurred, and what the way through glass takes of it |
//!
//! **Model.** The bent ray is taken to cross as much glass as the straight one. The way that it looks is the eye ray's, moved towards
//! the ray refracted at the first surface by a share that grows with thickness ([`Glass::bend`]); light is left by a power of
//! thickness ([`Glass::through`]); and the picture that it looks at is the more blurred the thicker the glass
//! ([`Glass::frost`]). All of it may change from frame to frame.
//!
//! Where a surface is so bumpy that the ways of neighboring pixels look far apart, it is blurred by as much, as a look-up in a texture with levels
//! is: else scans are speckled.
//!
//! **Beyond the paper.** It looks into an environment alone. Here the picture of what is opaque behind comes first: the bent ray
//! looks for what it meets there, step by step in the depth of the picture. The environment comes where it leaves the picture; [`RefractionSettings::uses_picture`] turns that off. What glass mirrors by Fresnel's law is added.
//!
//! **Limits.** Things have to be closed, and their faces have to look outward: [`open_edges`](lumivox_core::open_edges) and the sign of the
//! volume tell. An open one should be [`Glass::is_thin`], which is seen through without thickness, from both sides. Glass inside of glass of the same kind counts once. A second glass behind the first takes light and
//! blurs, but does not bend. What stands inside of glass cuts its thickness. The eye should be outside.
//! The picture holds no more than the camera sees: what would be seen around a corner is taken from the environment, or from before it.

mod pyramid;
mod settings;
mod shading;
mod surface;
mod thickness;

pub use pyramid::{Edge, Pyramid, PyramidUniform};
pub use settings::{Glass, GlassUniform, RefractionSettings, RefractionUniform};
pub use thickness::{Evaluation, Thickness, ThicknessUniform, evaluation_table};

use lumivox_core::View;

use crate::gpu::{GeneratedText, Gpu, GpuError, Shader, Texture, Uniform};
use crate::slicemap::{MAX_KINDS, Slicemap, SlicemapSettings, Slicing};
use crate::voxelize::Mesh;
use crate::wgsl::ViewUniform;
use shading::Shading;
use surface::Surface;

/// Format of the pictures that come in and go out: linear radiance.
pub const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What stands behind glass: the host's picture of all that is opaque.
#[derive(Clone, Copy, Debug)]
pub struct Backdrop<'a> {
    /// Where the view stands.
    pub uniform: &'a Uniform<ViewUniform>,
    /// Its depth, standard or reversed; a depth format or `R32Float`.
    pub depth: &'a Texture,
    /// Its linear radiance; any filterable colour format.
    pub picture: &'a Texture,
}

/// Glass of a scene in one view: all that it keeps, and its passes.
#[derive(Debug)]
pub struct Refraction {
    settings: RefractionSettings,
    slicemap: Slicemap,
    surface: Surface,
    thickness: Thickness,
    background: Pyramid,
    shading: Shading,
}

impl Refraction {
    /// For pictures of `settings.size` pixels.
    ///
    /// # Errors
    /// More columns, slices or kinds than a slicemap has, and the device's.
    pub fn new(gpu: &Gpu, settings: RefractionSettings) -> Result<Self, GpuError> {
        let columns = SlicemapSettings {
            size: settings.columns,
            slices: settings.slices,
            kinds: settings.kinds,
            slicing: Slicing::Local,
            splits_faces: true,
            ..SlicemapSettings::default()
        };
        let slicemap = Slicemap::new(gpu, columns)?;
        Ok(Self {
            surface: Surface::new(gpu, &settings, &slicemap)?,
            thickness: Thickness::new(gpu, settings.columns, settings.evaluation)?,
            background: Pyramid::new(gpu, settings.size, Edge::Ends)?,
            shading: Shading::new(gpu, &settings),
            slicemap,
            settings,
        })
    }

    /// Where the camera stands, from the next submission on: the view of the backdrop. `range` are the least and the largest distance
    /// along it at which there may be glass, metres.
    pub fn set_view(&mut self, gpu: &Gpu, view: &View, range: [f32; 2]) {
        self.slicemap.set_view(gpu, view, range);
        self.shading.set_view(gpu, view);
    }

    /// What the kinds of glass are like, from the next submission on; kinds without one are clear.
    pub fn set_glass(&mut self, gpu: &Gpu, glass: &[Glass]) {
        let mut kinds = [Glass::default(); MAX_KINDS as usize];
        kinds.iter_mut().zip(glass).for_each(|(kind, glass)| *kind = *glass);
        self.shading.set_glass(gpu, &kinds);
    }

    /// Draws glass over the backdrop into `target`, a picture like it of [`PICTURE_FORMAT`]. Each mesh comes with the number
    /// of its kind; `environment` is all that lies around, in the form of [`Pyramid::environment`].
    ///
    /// # Errors
    /// A kind that the settings do not have, and the device's.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[(&Mesh, u32)],
        backdrop: &Backdrop<'_>,
        environment: &Pyramid,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        // What is thin has no cells, and must not stretch the columns of what has.
        let thick: Vec<(&Mesh, u32)> =
            meshes.iter().copied().filter(|(_, kind)| !self.shading.is_thin(*kind)).collect();
        self.slicemap.record(gpu, encoder, &thick)?;
        self.surface.record(encoder, meshes);
        self.thickness.record(gpu, encoder, &self.slicemap, Some(backdrop))?;
        if self.settings.uses_picture {
            self.background.record(gpu, encoder, backdrop.picture)?;
        }
        let Self { surface, thickness, background, shading, .. } = self;
        let around = [&*background, environment];
        shading.record(gpu, encoder, (surface, thickness.texture()), backdrop, around, target)
    }

    /// Fronts and backs, for reading.
    pub fn slicemap(&self) -> &Slicemap {
        &self.slicemap
    }

    /// The metres of each kind that each column's ray crosses.
    pub fn thickness(&self) -> &Thickness {
        &self.thickness
    }

    /// Its settings.
    pub fn settings(&self) -> &RefractionSettings {
        &self.settings
    }
}

pub(crate) fn shaders() -> Vec<Shader> {
    vec![thickness::SHADER, pyramid::SHADER, shading::SHADER]
}

pub(crate) fn texts() -> Vec<GeneratedText> {
    vec![surface::text()]
}
