//! The channels of a volume: what is asked about the surface in a cell, how several answers become one, and how it is
//! stored.

mod accumulate;
mod flat;
mod lane;
mod numbers;
mod values;

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};

pub(crate) use accumulate::{Accumulator, Fragment, Parts};
pub(crate) use flat::{FlatPiece, FlatWriter, MixedCell, takes_flat, write_mixed};
pub(crate) use numbers::{fixed, to_f64, unit};
pub use values::{Format, Values};

/// One piece of surface in one cell, as channels see it.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Where attributes are taken, in metres in the world: the centroid of the part of the triangle in the cell; for
    /// `sampled` coverage the point on the line through the cell's centre.
    pub position: Vec3,
    /// Unit normal in the world: the mesh's, interpolated, or the face's if the mesh has none; zero where there is none.
    pub normal: Vec3,
    /// Texture coordinates; zero if the mesh has none.
    pub uv: Vec2,
    /// Area of the piece in texture coordinates.
    pub uv_area: f32,
    /// Colour and opacity of the surface, linear: the material's times its texture times the vertex colour.
    pub color: Vec4,
    /// Emitted radiance: the material's times its texture.
    pub emission: Vec3,
    /// Area of the triangle in the cell in square metres; for `sampled` coverage that under one sample.
    pub area: f32,
    /// Weights of the triangle's corners, sum one.
    pub barycentric: Vec3,
    /// Number of the mesh in the model.
    pub mesh: usize,
    /// Number of the triangle in its mesh.
    pub triangle: usize,
    /// Number of the material in the model.
    pub material: usize,
}

/// What becomes of several surfaces in one cell. None of them depends on the order of the triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Rule {
    /// The largest value, component by component: the papers' MAX blending.
    Maximum,
    /// The sum.
    Sum,
    /// The mean, weighted by area. A surface counts as at least 2^-22 of a cell face, so that lines and points, which
    /// have no area, still have a say where there is nothing else.
    #[default]
    Average,
    /// The value at the point that is nearest to the cell's centre; of two that are equally near, the larger value.
    Nearest,
}

/// A custom channel's function: up to four components at a surface point.
pub type ChannelFn = dyn Fn(&SurfacePoint) -> [f32; 4] + Send + Sync;

/// What a channel asks of a surface point.
#[derive(Clone)]
pub(crate) enum Source {
    Albedo,
    Normal,
    Emission,
    Area,
    Custom(Arc<ChannelFn>),
}

/// A named channel of one to four components.
///
/// Sums and averages are made of fixed-point integers, which is why neither threads nor the order of triangles matter:
/// a value counts in steps of 2^-24 and up to 2^38, beyond which it is cut off; NaN counts as zero.
#[derive(Clone)]
pub struct Channel {
    pub(crate) name: String,
    pub(crate) components: usize,
    pub(crate) format: Format,
    pub(crate) rule: Rule,
    pub(crate) range: [f32; 2],
    pub(crate) unit: bool,
    pub(crate) source: Source,
}

impl Channel {
    fn new(name: &str, components: usize, source: Source) -> Self {
        let (format, rule, range) = (Format::F16, Rule::Average, [0.0, 1.0]);
        Self { name: name.to_owned(), components, format, rule, range, unit: false, source }
    }

    /// `albedo`: linear reflectance, three components, `u8`, average.
    pub fn albedo() -> Self {
        Self::new("albedo", 3, Source::Albedo).format(Format::U8)
    }

    /// `normal`: unit normal, three components, `f16`, average brought to unit length (zero where normals cancel).
    /// In `u8`, 0 to 255 stands for -1 to 1.
    pub fn normal() -> Self {
        Self { range: [-1.0, 1.0], unit: true, ..Self::new("normal", 3, Source::Normal) }
    }

    /// `emission`: emitted radiance, three components, `f16`, average.
    pub fn emission() -> Self {
        Self::new("emission", 3, Source::Emission)
    }

    /// `area`: area of all surfaces in the cell in square metres, one component, `f32`, sum.
    pub fn area() -> Self {
        Self::new("area", 1, Source::Area).format(Format::F32).rule(Rule::Sum)
    }

    /// A channel of one's own: the first `components` (1 to 4) of what `function` answers; `f16`, average.
    pub fn custom(
        name: &str,
        components: usize,
        function: impl Fn(&SurfacePoint) -> [f32; 4] + Send + Sync + 'static,
    ) -> Self {
        Self::new(name, components.clamp(1, 4), Source::Custom(Arc::new(function)))
    }

    /// The channel under another name.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self }
    }

    /// The channel in another format.
    #[must_use]
    pub fn format(self, format: Format) -> Self {
        Self { format, ..self }
    }

    /// The channel with another rule.
    #[must_use]
    pub fn rule(self, rule: Rule) -> Self {
        Self { rule, ..self }
    }

    /// The values that 0 and 255 stand for in `u8`; values beyond are cut off. Other formats ignore it.
    #[must_use]
    pub fn range(self, low: f32, high: f32) -> Self {
        Self { range: [low, high], ..self }
    }

    /// Whether the first three components are brought to unit length in the end.
    #[must_use]
    pub fn unit(self, unit: bool) -> Self {
        Self { unit, ..self }
    }

    /// The channel's name.
    pub fn name(&self) -> &str {
        &self.name
    }
}

impl std::fmt::Debug for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Channel")
            .field("name", &self.name)
            .field("components", &self.components)
            .field("format", &self.format)
            .field("rule", &self.rule)
            .finish_non_exhaustive()
    }
}
