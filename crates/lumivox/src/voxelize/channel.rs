//! Channels of a voxelized volume: what is asked about a surface, how several answers become one, and how it is stored.

use std::sync::Arc;

use super::{MAX_CELL_BITS, SeeThrough, VoxelizeError};
use crate::volume::{ALBEDO, ChannelFormat, EMISSION, Format, NORMAL};

/// What becomes of several surfaces in one cell. None of them depends on the order of the triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub enum Rule {
    /// The largest value, component by component: the papers' MAX blending.
    Maximum,
    /// The sum. A value counts in steps of 2^-28 of the larger end of the channel's range.
    Sum,
    /// The mean, weighted by area. A surface counts as at least 2^-22 of a cell face, so that lines and points, which
    /// have no area, still have a say where there is nothing else. Sums count in 2^-36 of a cell face times the width of the
    /// channel's range, so that the value of the smallest surface has 14 bits, and that of 1/256 of a face has 28.
    #[default]
    Average,
    /// The value at the point that is nearest to the cell's centre; of those equally near, the largest, component by
    /// component. Takes a second pass over the triangles.
    Nearest,
}

/// A WGSL function of a surface point, for channels of a host's own.
///
/// The text defines `fn NAME(point: SurfacePoint) -> vec4f`, or `-> array<vec4f, N>` where it has several outputs that
/// are computed together. It may hold other functions and constants, and bindings of group 2, each on one line in the form
/// `@group(2) @binding(B) var<..> name: type;`: uniforms, textures and samplers. (All eight storage buffers of a core
/// stage are taken; a device with more can bind some here.) Names beginning with `lv_` are ours.
///
/// ```wgsl
/// struct SurfacePoint {
///     position: vec3f,  // metres, in the world: the middle of the piece of the triangle in the cell
///     area: f32,        // square metres of the triangle in the cell
///     normal: vec3f,    // unit, in the world
///     mesh: u32,        // MeshDescriptor::number
///     color: vec4f,     // linear: base colour times texture times vertex colour
///     emission: vec3f,  // W/(m2 sr)
///     triangle: u32,    // its number in the mesh
///     uv: vec2f,
///     cell: u32,        // linear index of the cell
/// }
/// ```
#[derive(Debug)]
pub struct SurfaceFunction {
    /// Name of the function.
    pub name: String,
    /// WGSL.
    pub text: String,
    /// How many `vec4f` it returns: 1 for a bare `vec4f`, else the length of the array.
    pub outputs: u32,
}

/// What a channel asks of a surface point.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    Albedo,
    Normal,
    Emission,
    Area,
    Function { function: Arc<SurfaceFunction>, output: u32 },
}

/// A named channel of one to four components.
#[derive(Clone, Debug)]
pub struct Channel {
    pub(crate) format: ChannelFormat,
    pub(crate) rule: Rule,
    pub(crate) unit: bool,
    /// The fourth half float holds 1 in occupied cells.
    pub(crate) occupancy: bool,
    /// Or their opacity.
    pub(crate) opacity: bool,
    pub(crate) source: Source,
}

impl Channel {
    fn new(name: &str, components: u32, source: Source) -> Self {
        let format =
            ChannelFormat { name: name.to_owned(), components, format: Format::F16, range: [0.0, 1.0] };
        Self { format, rule: Rule::Average, unit: false, occupancy: false, opacity: false, source }
    }

    /// [`ALBEDO`]: linear reflectance, three half floats of four, average.
    pub fn albedo() -> Self {
        Self::new(ALBEDO, 3, Source::Albedo)
    }

    /// [`NORMAL`]: mean normal in three half floats, shorter than one where surfaces disagree; average. The fourth is occupancy: 1, or
    /// with [`SeeThrough::Opacity`] and as an average how much of light it holds back.
    pub fn normal() -> Self {
        Self { occupancy: true, ..Self::new(NORMAL, 3, Source::Normal).range(-1.0, 1.0) }
    }

    /// [`EMISSION`]: emitted radiance in W/(m2 sr), three half floats of four, average, up to 1024.
    pub fn emission() -> Self {
        Self::new(EMISSION, 3, Source::Emission).range(0.0, 1024.0)
    }

    /// `area`: area of all surfaces in the cell in square metres, one float, sum. Its range is set to two cell faces by
    /// [`Voxelizer::new`](super::Voxelizer::new).
    pub fn area() -> Self {
        Self::new("area", 1, Source::Area).format(Format::F32).rule(Rule::Sum)
    }

    /// Output `output` of a function, its first `components` (1 to 4); half floats, average, range 0 to 1.
    pub fn function(name: &str, components: u32, function: &Arc<SurfaceFunction>, output: u32) -> Self {
        let source = Source::Function { function: function.clone(), output };
        Self::new(name, components.clamp(1, 4), source)
    }

    /// The channel under another name.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        name.clone_into(&mut self.format.name);
        self
    }

    /// The channel in another format.
    #[must_use]
    pub fn format(mut self, format: Format) -> Self {
        self.format.format = format;
        self
    }

    /// The channel with another rule.
    #[must_use]
    pub fn rule(mut self, rule: Rule) -> Self {
        self.rule = rule;
        self
    }

    /// The values that [`Format::U8`] stores as 0 and 255, and between which averages count; of sums, the larger end is the
    /// largest single value. Values beyond are cut off. Maximum and nearest values in floats ignore it.
    #[must_use]
    pub fn range(mut self, low: f32, high: f32) -> Self {
        self.format.range = [low, high];
        self
    }

    /// Whether the first three components are brought to unit length in the end.
    #[must_use]
    pub fn unit(mut self, unit: bool) -> Self {
        self.unit = unit;
        self
    }

    /// The channel on cells whose faces have this area: the ranges that depend on it are set, and what its fourth number says.
    pub(crate) fn fitted(mut self, face: f32, see_through: SeeThrough) -> Self {
        let has_room = self.format.components == 3 && self.format.format == Format::F16;
        let is_mean = self.occupancy && self.rule == Rule::Average;
        self.opacity = has_room && is_mean && see_through == SeeThrough::Opacity;
        match self.source {
            Source::Area => self.range(0.0, 2.0 * face),
            _ => self,
        }
    }

    /// The channel's name.
    pub fn name(&self) -> &str {
        &self.format.name
    }

    /// How it is stored.
    pub fn stored(&self) -> &ChannelFormat {
        &self.format
    }
}

/// Refuses channels that cannot be together.
pub(super) fn check(channels: &[Channel]) -> Result<(), VoxelizeError> {
    let bits = channels.iter().map(|c| 8 * c.format.bytes()).sum();
    if bits > MAX_CELL_BITS {
        return Err(VoxelizeError::TooManyBits { bits });
    }
    for (n, channel) in channels.iter().enumerate() {
        let wrong = |reason: &str| {
            Err(VoxelizeError::Channel { name: channel.format.name.clone(), reason: reason.to_owned() })
        };
        if channels[..n].iter().any(|c| c.format.name == channel.format.name) {
            return wrong("there are two of this name");
        }
        let [low, high] = channel.format.range;
        if !(low < high && (high - low).is_finite() && (high - low) >= 1e-30) {
            return wrong("its range has no width, or no end");
        }
    }
    Ok(())
}
