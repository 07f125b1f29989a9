//! Slicemaps: the voxels of a scene as one bit each, a column of cells for each pixel of a camera, made in one pass over the
//! triangles.
//!
//! Source: Eisemann and Decoret, *Fast Scene Voxelization and Applications* (2006), section 2.
//!
//! A [`Slicemap`] belongs to a camera, orthographic or perspective, that stands anywhere outside of what it slices. Each of its
//! pixels is a column of cells, and each cell a bit: whether a triangle passes through it. Cells are even in the distance along the
//! view, not in depth, so that a perspective view wastes none on what is near (equation 1).
//!
//! ```text
//!   camera  near |0|1|2|3| ... |n-1| far      one bit each; uniform: the same planes for all columns,
//!                                             local: the nearest and farthest surface of each column
//! ```
//!
//! | stage | does |
//! | --- | --- |
//! | `draw` (extents) | local slicing alone: the nearest and the farthest surface of each column |
//! | `draw` (bits) | each fragment sets the bit of the cell that it lies in |
//! | [`Transmittance`] | light that is left behind the bits before a point (3.1) |
//!
//! **Sets.** The paper trades slices for several bits a cell, one for leaves of each colour; here a column has as many *kinds* of
//! bits as asked for, each with all slices, and [`SlicemapSettings::splits_faces`] keeps what faces the camera apart from what
//! faces away: all in one pass, since fragments pick the words they write.
//!
//! **Core WebGPU** blends with no logical operations, which the paper has in its targets. Fragments set bits by atomics in a buffer, so
//! there may be any number of slices: 512 take what the paper hoped for of later hardware. The paper looks masks up in a texture
//! because bits could not be shifted; here they can, and [`SlicemapSettings::uses_table`] brings the table back.
//!
//! **What it misses** (2.5): a fragment is one sample of a column, so triangles seen edge-on are missed, and steep ones leave gaps
//! between slices. [`SlicemapSettings::conservative`] closes both: each column that a triangle touches gets all the bits
//! that it crosses there.
//!
//! **Memory**: `width * height * sets * slices / 8` bytes, and 8 for each column where slicing is local.

mod draw;
mod host;
mod settings;
mod transmittance;

pub use host::HostSlicemap;
pub use settings::{SlicemapSettings, SlicemapUniform, Slicing};
pub use transmittance::{Transmittance, TransmittanceSettings, TransmittanceUniform, transmittance_wgsl};

use glam::UVec2;
use lumivox_core::View;

use crate::gpu::{Buffer, GeneratedText, Gpu, GpuError, Shader, Uniform, read_buffer};
use crate::voxelize::Mesh;
use draw::{Draw, Phase};

/// The shared shader part: what a column holds. The shader that uses it binds `slicemap`, `slicemap_bits` and `slicemap_extents`.
pub const SLICEMAP: &str = include_str!("slicemap.wgsl");

/// Kinds of bits at most.
pub const MAX_KINDS: u32 = 4;

/// The voxels of a scene, a bit each, in the columns of a camera.
#[derive(Debug)]
pub struct Slicemap {
    settings: SlicemapSettings,
    pub(crate) bits: Buffer,
    pub(crate) extents: Buffer,
    /// One for each kind of bits that a drawing may write.
    uniforms: Vec<Uniform<SlicemapUniform>>,
    extents_draw: Option<Draw>,
    bits_draw: Draw,
}

impl Slicemap {
    /// An empty slicemap.
    ///
    /// # Errors
    /// Sizes of nothing, more than [`MAX_KINDS`] kinds, or more bits than the device binds (with the numbers).
    pub fn new(gpu: &Gpu, settings: SlicemapSettings) -> Result<Self, GpuError> {
        let bytes = settings.check(gpu)?;
        let columns = u64::from(settings.size.element_product());
        let bits = Buffer::storage(gpu, "slicemap/bits", bytes)?;
        let is_local = settings.slicing == Slicing::Local;
        let extents = Buffer::storage(gpu, "slicemap/extents", if is_local { 8 * columns } else { 8 })?;
        let uniform = |_| Uniform::new(gpu, "slicemap", &bytemuck::Zeroable::zeroed());
        let uniforms: Vec<_> = (0..settings.kinds).map(uniform).collect();
        let drawn = (&uniforms[..], &bits, &extents);
        let extents_draw = is_local.then(|| Draw::new(gpu, &settings, Phase::Extents, drawn)).transpose()?;
        let bits_draw = Draw::new(gpu, &settings, Phase::Bits, drawn)?;
        Ok(Self { settings, bits, extents, uniforms, extents_draw, bits_draw })
    }

    /// Its settings.
    pub fn settings(&self) -> &SlicemapSettings {
        &self.settings
    }

    /// Where the camera stands, from the next submission on. `range` is the distance along the view, in metres, of the first cells'
    /// near side and of the last cells' far side; surfaces outside of it are in no cell. Local slicing takes each column's own
    /// range within it.
    pub fn set_view(&self, gpu: &Gpu, view: &View, range: [f32; 2]) {
        for (kind, uniform) in (0..).zip(&self.uniforms) {
            uniform.write(gpu, &SlicemapUniform::new(&self.settings, view, range, kind));
        }
    }

    /// Empties it, and slices `meshes`, each with the number of its kind of bits. Meshes that hold moving vertices of the
    /// host's are sliced as they are when this runs.
    ///
    /// # Errors
    /// A kind that the settings do not have.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[(&Mesh, u32)],
    ) -> Result<(), GpuError> {
        self.record_extents(gpu, encoder, meshes)?;
        self.record_bits(gpu, encoder, meshes)
    }

    /// The first half of [`Self::record`]: with local slicing, where each column begins and ends. From `bounds`, which may be simpler than what
    /// is sliced and has to enclose it: what lies before a column's begin or behind its end goes to its first or last cell.
    ///
    /// # Errors
    /// A kind that the settings do not have.
    pub fn record_extents(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bounds: &[(&Mesh, u32)],
    ) -> Result<(), GpuError> {
        self.check(gpu, bounds)?;
        encoder.clear_buffer(&self.extents.raw, 0, None);
        if let Some(draw) = &self.extents_draw {
            draw.record(encoder, bounds);
        }
        Ok(())
    }

    /// The second half: the bits, between the extents that there are.
    ///
    /// # Errors
    /// A kind that the settings do not have.
    pub fn record_bits(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[(&Mesh, u32)],
    ) -> Result<(), GpuError> {
        self.check(gpu, meshes)?;
        encoder.clear_buffer(&self.bits.raw, 0, None);
        self.bits_draw.record(encoder, meshes);
        Ok(())
    }

    fn check(&self, gpu: &Gpu, meshes: &[(&Mesh, u32)]) -> Result<(), GpuError> {
        gpu.check()?;
        let kinds = self.settings.kinds;
        match meshes.iter().find(|(_, kind)| *kind >= kinds) {
            Some((_, kind)) => {
                Err(GpuError::Validation(format!("a slicemap of {kinds} kinds has none of number {kind}")))
            }
            None => Ok(()),
        }
    }

    /// All words of all columns: [`SlicemapSettings::words`] for each set, sets of a column one after the other, columns row by row from the
    /// top. Bit `s % 32` of word `s / 32` is slice `s`, the nearest first. Waits.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        read_buffer(gpu, &self.bits)
    }

    /// The range of each column in metres, where slicing is local; none for columns without surfaces. Waits.
    pub fn read_extents(&self, gpu: &Gpu) -> Result<Vec<Option<[f32; 2]>>, GpuError> {
        let words: Vec<[u32; 2]> = read_buffer(gpu, &self.extents)?;
        // Both are maxima, so that nothing is zero: of the inverted nearest distance, and of the farthest.
        let extent = |[near, far]: [u32; 2]| {
            ([near, far] != [0, 0]).then(|| [f32::from_bits(!near), f32::from_bits(far)])
        };
        Ok(words.into_iter().map(extent).collect())
    }

    /// For shaders of the host, beside [`SLICEMAP`] or [`transmittance_wgsl`]: the uniform, the bits and the ranges of columns.
    pub fn buffers(&self) -> [&Buffer; 3] {
        [&self.uniforms[0].buffer, &self.bits, &self.extents]
    }

    /// Its size in columns.
    pub fn size(&self) -> UVec2 {
        self.settings.size
    }

    /// What drawings of each kind read it by.
    pub(crate) fn uniforms(&self) -> &[Uniform<SlicemapUniform>] {
        &self.uniforms
    }

    /// What shaders read it by.
    pub(crate) fn uniform(&self) -> &Uniform<SlicemapUniform> {
        &self.uniforms[0]
    }
}

pub(crate) fn shaders() -> Vec<Shader> {
    vec![transmittance::SHADER]
}

/// A host's shader that asks at each fragment.
const FORWARD: &str = "@fragment fn fragment(@location(0) world: vec3f) -> @location(0) vec4f {
    return vec4f(lumivox_light_left(world), 1.0);
}";

/// For validation and for reading.
pub(crate) fn texts() -> Vec<GeneratedText> {
    let phases = [Phase::Extents, Phase::Bits];
    let plain = phases
        .into_iter()
        .flat_map(|phase| [false, true].map(|conservative| draw::text(phase, conservative, false)));
    let forward = GeneratedText { name: "slicemap/forward", source: transmittance_wgsl(1, 2) + FORWARD };
    plain.chain([draw::text(Phase::Bits, false, true), forward]).collect()
}
