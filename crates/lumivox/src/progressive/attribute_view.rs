//! What a view brings to a volume of any channels.

use glam::UVec2;
use lumivox_core::View;

use crate::gpu::{Gpu, Texture, Uniform};
use crate::progressive::{InjectionPattern, InjectionScale, ViewInput};
use crate::wgsl::ViewUniform;

/// A rendered view with pictures of any channels, all of one size; or with its depth alone, such as a plain shadow map, which
/// cleans and injects nothing.
#[derive(Debug)]
pub struct AttributeView {
    pub(super) depth: Texture,
    /// None for views that only clean.
    pub(super) surfaces: Option<Surfaces>,
    pub(super) uniform: Uniform<ViewUniform>,
    points: UVec2,
    pattern: InjectionPattern,
    split: u32,
}

/// The pictures that points are injected from.
#[derive(Debug)]
pub(super) struct Surfaces {
    pub(super) normal: Texture,
    pub(super) pictures: Vec<Texture>,
}

impl AttributeView {
    /// A view that cleans and injects `points` of its texels. `depth` is a depth format or `R32Float`; `normal` holds unit world
    /// normals that face the view, zero where nothing is; `pictures` are those of the channels that take one, in their order, of
    /// any format that shaders load as floats.
    pub fn new(
        gpu: &Gpu,
        label: &str,
        depth: Texture,
        normal: Texture,
        pictures: Vec<Texture>,
        points: UVec2,
    ) -> Self {
        let surfaces = Some(Surfaces { normal, pictures });
        let points = points.min(UVec2::from(depth.size()));
        Self { surfaces, points, ..Self::cleaning(gpu, label, depth) }
    }

    /// A view that only cleans.
    pub fn cleaning(gpu: &Gpu, label: &str, depth: Texture) -> Self {
        let nothing: ViewUniform = bytemuck::Zeroable::zeroed();
        Self {
            depth,
            surfaces: None,
            uniform: Uniform::new(gpu, label, &nothing),
            points: UVec2::ZERO,
            pattern: InjectionPattern::default(),
            split: 1,
        }
    }

    /// A G-buffer or reflective shadow map with pictures of albedo and emission.
    pub fn of(gpu: &Gpu, label: &str, view: &ViewInput) -> Self {
        let textures = &view.textures;
        let pictures = vec![textures.albedo.clone(), textures.emission.clone()];
        Self::new(gpu, label, textures.depth.clone(), textures.normal.clone(), pictures, view.points)
    }

    /// As [`ViewInput::with_pattern`].
    #[must_use]
    pub fn with_pattern(mut self, pattern: InjectionPattern, split: u32) -> Self {
        (self.pattern, self.split) = (pattern, split.clamp(1, self.point_count().max(1)));
        self
    }

    /// Changes over how many frames the points are split, from the next [`Self::update`] on.
    pub fn set_split(&mut self, split: u32) {
        self.split = split.clamp(1, self.point_count().max(1));
    }

    /// Number of points it injects, in all frames that they are split over together.
    pub fn point_count(&self) -> u32 {
        self.points.x * self.points.y
    }

    /// Where the view stands in the frame of this number. Once per frame, before it is recorded; `attribute_points` are the points
    /// of all views of the frame, and the same for all of them.
    pub fn update(&self, gpu: &Gpu, view: &View, attribute_points: u32, frame: u32) {
        let scale = InjectionScale { attribute_points, light_points: 1, radiance_max: 1.0 };
        let whole = ViewUniform::new(view, UVec2::from(self.depth.size()), self.points, scale);
        let (pattern, split) = (self.pattern as u32, self.split);
        self.uniform.write(gpu, &ViewUniform { pattern, split, phase: frame % split, ..whole });
    }

    pub(super) fn invocations(&self) -> u32 {
        self.pattern.invocations(self.points, self.split)
    }
}
