//! What a view brings to voxelization.

use glam::UVec2;
use lumivox_core::View;

use crate::gpu::{Gpu, Texture, Uniform};
use crate::wgsl::ViewUniform;

use super::InjectionPattern;

/// The pictures of a view, all of one size; clones are the same pictures. The camera's are its G-buffer, a light's are its reflective shadow map.
#[derive(Clone, Debug)]
pub struct ViewTextures {
    /// Depth, 0 near to 1 far or reversed; a depth format or `R32Float`.
    pub depth: Texture,
    /// World normal, facing the view, unit length; `Rgba16Float`. Zero where nothing is.
    pub normal: Texture,
    /// Reflectance, linear; any filterable colour format.
    pub albedo: Texture,
    /// Emitted radiance in W/(m2 sr); `Rgba16Float`.
    pub emission: Texture,
    /// Radiance that the surface *reflects* towards every direction, W/(m2 sr): of this light alone in its reflective
    /// shadow map, of all lights in the camera's picture; `Rgba16Float` or `Rgba32Float`.
    pub radiance: Texture,
}

/// A view ready for cleanup and injection.
#[derive(Debug)]
pub struct ViewInput {
    /// Its pictures.
    pub textures: ViewTextures,
    /// The view as shaders see it: `ViewUniform` of [`crate::wgsl::VIEW`].
    pub uniform: Uniform<ViewUniform>,
    pub(crate) points: UVec2,
    pattern: InjectionPattern,
    split: u32,
}

impl ViewInput {
    /// A view that injects a regular grid of `points` samples of its pictures. More points fill cells more densely and cost
    /// more; beyond one point a texel nothing is gained, so the grid is cut to the size of the pictures.
    pub fn new(gpu: &Gpu, label: &str, textures: ViewTextures, points: UVec2) -> Self {
        let points = points.min(UVec2::from(textures.depth.size()));
        let nothing: ViewUniform = bytemuck::Zeroable::zeroed();
        let uniform = Uniform::new(gpu, label, &nothing);
        Self { textures, uniform, points, pattern: InjectionPattern::default(), split: 1 }
    }

    /// The same view with its points in another order, and split over so many frames (at least 1): each of these injects its
    /// share of them (dissertation 7.10). Light propagation volumes and sub-cells take all of a view's points only in their
    /// first order.
    #[must_use]
    pub fn with_pattern(mut self, pattern: InjectionPattern, split: u32) -> Self {
        (self.pattern, self.split) = (pattern, split.clamp(1, self.point_count().max(1)));
        self
    }

    /// Number of points it injects, in all frames that they are split over together.
    pub fn point_count(&self) -> u32 {
        self.points.x * self.points.y
    }

    /// Where the view stands this frame. Call it once before the frame is recorded, for all views of the frame with the
    /// same scale.
    pub fn update(&self, gpu: &Gpu, view: &View, scale: InjectionScale) {
        self.update_frame(gpu, view, scale, 0);
    }

    /// As [`Self::update`], for the frame of this number: it says which share of split points comes now.
    pub fn update_frame(&self, gpu: &Gpu, view: &View, scale: InjectionScale, frame: u32) {
        let size = UVec2::from(self.textures.depth.size());
        let (pattern, split) = (self.pattern as u32, self.split);
        let whole = ViewUniform::new(view, size, self.points, scale);
        self.uniform.write(gpu, &ViewUniform { pattern, split, phase: frame % split, ..whole });
    }

    /// Invocations that take this frame's points.
    pub(crate) fn invocations(&self) -> u32 {
        self.pattern.invocations(self.points, self.split)
    }
}

/// What a view brings that adds light and no attributes: three of the five pictures.
///
/// A light sampled by many views can draw them one after another into the same pictures, since each is recorded before the
/// next is drawn; only the uniforms must be as many as the views, because they are written before the frame.
#[derive(Clone, Copy, Debug)]
pub struct LightView<'v> {
    /// As [`ViewTextures::depth`].
    pub depth: &'v Texture,
    /// As [`ViewTextures::normal`].
    pub normal: &'v Texture,
    /// As [`ViewTextures::radiance`].
    pub radiance: &'v Texture,
    /// Where the view stands, written with [`ViewUniform::new`] for the size of the pictures and these points.
    pub uniform: &'v Uniform<ViewUniform>,
    /// Columns and rows of the injection grid.
    pub points: UVec2,
    /// Invocations that take these: columns times rows, if they are not split over frames.
    pub invocations: u32,
}

impl<'v> From<&'v ViewInput> for LightView<'v> {
    fn from(view: &'v ViewInput) -> Self {
        let ViewTextures { depth, normal, radiance, .. } = &view.textures;
        Self {
            depth,
            normal,
            radiance,
            uniform: &view.uniform,
            points: view.points,
            invocations: view.invocations(),
        }
    }
}

/// The ranges of a frame's fixed-point sums.
///
/// A step of the light's sums is `light_points * radiance_max / 2^30`, one of emission's likewise with
/// `attribute_points`, and one of normals and albedo `attribute_points / 2^30`. With 200,000 points and radiances up to
/// 10 W/(m2 sr) a step is 0.002, of which a mean over many samples keeps a small part as error. More points than are
/// injected are safe and coarser; fewer may overflow.
#[derive(Clone, Copy, Debug)]
pub struct InjectionScale {
    /// Points that add attributes: of the camera and of all lights recorded with
    /// [`record_light`](super::Progressive::record_light), over the whole frame.
    pub attribute_points: u32,
    /// The most points that add light at a time: of one light with all its views, or of the camera. Sums of light begin
    /// anew with each light.
    pub light_points: u32,
    /// Largest radiance of a sample, W/(m2 sr). Brighter samples are cut to it; a higher bound gives coarser steps.
    /// At most 65504 counts, the largest half float.
    pub radiance_max: f32,
}
