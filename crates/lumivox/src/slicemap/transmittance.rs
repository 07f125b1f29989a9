//! Transmittance shadow maps (3.1): leaves and other thin absorbers take a part of the light, and a point has what those before it
//! leave, `(1 - sigma)^n` with n counted in the slicemap's bits.
//!
//! Opaque things have a standard shadow map of the host's beside it; the factors multiply. A point light has six slicemaps,
//! whose factors go into one target one after the other.
//!
//! **Counting.** The default counts the ones of a word by an instruction. The paper's table of the ones of each byte is there for devices where
//! that is slower ([`Transmittance::new`]): four look-ups a word, and 1 KB.

use glam::Vec3;

use super::{SLICEMAP, Slicemap};
use crate::gpu::{Bindings, Buffer, FullscreenPass, Gpu, GpuError, Shader, Texture, Uniform};
use crate::light::IRRADIANCE_FORMAT;
use crate::progressive::ViewInput;
use crate::wgsl::{FULLSCREEN, VIEW};

pub(super) const SHADER: Shader = Shader {
    name: "slicemap/transmittance",
    parts: &[VIEW, SLICEMAP, LIGHT_LEFT, FULLSCREEN, include_str!("transmittance.wgsl")],
};

const LIGHT_LEFT: &str = include_str!("light_left.wgsl");

/// The same for a host's own shaders, such as those that shade each fragment as it is drawn: plain WGSL with four bindings of a group, from
/// `first_binding` on, and `lumivox_light_left(world: vec3f) -> vec3f`. The bindings are, in this order, [`Slicemap::buffers`] and
/// [`Transmittance::buffer`].
pub fn transmittance_wgsl(group: u32, first_binding: u32) -> String {
    let bindings = [
        "var<uniform> slicemap: SlicemapUniform",
        "var<storage, read> slicemap_bits: array<u32>",
        "var<storage, read> slicemap_extents: array<u32>",
        "var<uniform> transmittance: TransmittanceUniform",
    ];
    let bound = (first_binding..).zip(bindings);
    let declared = bound.map(|(n, binding)| format!("@group({group}) @binding({n}) {binding};\n"));
    let ones = "fn slicemap_ones(word: u32) -> u32 { return countOneBits(word); }\n";
    [declared.collect::<String>().as_str(), ones, SLICEMAP, LIGHT_LEFT].join("\n")
}

/// How light is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransmittanceSettings {
    /// Of each kind of bits the part of light, 0 to 1, that one surface lets through in each colour: `1 - sigma`. Colours of
    /// absorbers multiply.
    pub through: [Vec3; super::MAX_KINDS as usize],
    /// Metres that a point is moved towards the light before it is looked up, so that a leaf does not shade itself: half a slice is
    /// plenty. More lets light through the first layers.
    pub bias: f32,
    /// Whether the slice that a point lies in counts in part, by how deep the point lies in it: shadows without steps at the
    /// borders of slices, for half a surface of error within one.
    pub interpolates: bool,
    /// Whether only pixels inside of the slicemap's view are written; the others keep what the target holds. For the second to sixth view
    /// of a point light.
    pub only_inside: bool,
}

impl Default for TransmittanceSettings {
    /// Leaves that take a quarter of the light.
    fn default() -> Self {
        Self { through: [Vec3::splat(0.75); 4], bias: 0.0, interpolates: false, only_inside: false }
    }
}

crate::gpu_struct! {
    /// [`TransmittanceSettings`] as shaders see them.
    pub struct TransmittanceUniform {
        /// Of the first kind.
        pub through_0: Vec3,
        /// Metres.
        pub bias: f32,
        /// Of the second.
        pub through_1: Vec3,
        /// Whether a slice counts in part.
        pub interpolates: u32,
        /// Of the third.
        pub through_2: Vec3,
        /// Whether other pixels are kept.
        pub only_inside: u32,
        /// Of the fourth.
        pub through_3: Vec3,
        /// Unused.
        pub reserved: f32,
    }
}

/// The pass: a slicemap of a light in, and what is left of the light at each pixel of a G-buffer out.
#[derive(Debug)]
pub struct Transmittance {
    pass: FullscreenPass,
    uniform: Uniform<TransmittanceUniform>,
    summask: Buffer,
}

impl Transmittance {
    /// The pass; with `uses_table` ones are counted by the paper's table.
    ///
    /// # Errors
    /// The device's.
    pub fn new(gpu: &Gpu, uses_table: bool) -> Result<Self, GpuError> {
        let constants = [("USES_TABLE", f64::from(u8::from(uses_table)))];
        let ones: Vec<u32> = (0..256u32).map(u32::count_ones).collect();
        Ok(Self {
            pass: FullscreenPass::with_constants(gpu, &SHADER, IRRADIANCE_FORMAT, false, &constants),
            uniform: Uniform::new(gpu, "slicemap/transmittance", &bytemuck::Zeroable::zeroed()),
            summask: Buffer::storage_with(gpu, "slicemap/summask", &ones)?,
        })
    }

    /// Changes how light is taken, from the next submission on.
    pub fn update(&self, gpu: &Gpu, settings: &TransmittanceSettings) {
        let [through_0, through_1, through_2, through_3] =
            settings.through.map(|through| through.clamp(Vec3::ZERO, Vec3::ONE));
        let uniform = TransmittanceUniform {
            through_0,
            bias: settings.bias,
            through_1,
            interpolates: u32::from(settings.interpolates),
            through_2,
            only_inside: u32::from(settings.only_inside),
            through_3,
            reserved: 0.0,
        };
        self.uniform.write(gpu, &uniform);
    }

    /// What [`transmittance_wgsl`] reads the settings from.
    pub fn buffer(&self) -> &Buffer {
        &self.uniform.buffer
    }

    /// The part of the light that is left at every pixel of `view`, 0 to 1 in each colour, into a target of
    /// [`IRRADIANCE_FORMAT`]. 1 where nothing was drawn, and outside of the slicemap's view.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        slicemap: &Slicemap,
        view: &ViewInput,
        target: &mut Texture,
        keep: bool,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal", &view.textures.normal)
            .read("slicemap", slicemap.uniform())
            .read("slicemap_bits", &slicemap.bits)
            .read("slicemap_extents", &slicemap.extents)
            .read("transmittance", &self.uniform)
            .read("summask", &self.summask);
        self.pass.record(gpu, encoder, &bindings, target, keep)
    }
}
