//! Inner cells: those of a column that lie between a front and the next back, counted and turned into metres along the eye ray.
//!
//! A column is a word of fronts and a word of backs for each 32 slices. Cells that hold one of them alone are unambiguous, and those that hold
//! both are *ambiguous*: how often the surface is crossed there is unknown. The rules are the paper's:
//!
//! - an ambiguous cell is inside as a whole;
//! - empty cells behind it wait for the next cell that is not empty: a back says that they were inside, a front that they were not;
//! - between two ambiguous cells they are not inside.
//!
//! Of an interval from a front to a back the front's cell counts and the back's does not, since on average a surface lies in the middle of its
//! cell. The last cell of a local column is an exception: the farthest surface lies at its very end, so it counts.
//! (The paper's caption to Figure 9 reads as if a front meant inside; that is for an unambiguous cell before an ambiguous one. Whether it
//! counts the cells of fronts and backs, its text leaves open.)

use glam::UVec2;

use super::Backdrop;
use crate::gpu::{Bindings, Buffer, FullscreenPass, Gpu, GpuError, Shader, Texture, Uniform, read_texture};
use crate::slicemap::{SLICEMAP, Slicemap};
use crate::wgsl::{FULLSCREEN, VIEW, ViewUniform};

pub(super) const SHADER: Shader = Shader {
    name: "refraction/thickness",
    parts: &[VIEW, SLICEMAP, FULLSCREEN, include_str!("thickness.wgsl")],
};

/// How inner cells are counted; both come to the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evaluation {
    /// From one surface to the next, by bit instructions: the time of a column goes with its surfaces.
    Bits,
    /// A byte of eight slices after the other, by the paper's table of 256 x 256 entries: 256 KB, four look-ups a word.
    Table,
}

crate::gpu_struct! {
    /// What [`Thickness`] does besides counting.
    pub struct ThicknessUniform {
        /// Whether opaque things cut columns.
        pub is_cut: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
        /// Unused.
        pub reserved_2: u32,
    }
}

/// The pass, and the texture that it fills: in each column the metres of four kinds that its ray crosses.
#[derive(Debug)]
pub struct Thickness {
    pass: FullscreenPass,
    table: Buffer,
    uniforms: [Uniform<ThicknessUniform>; 2],
    /// Stands where nothing is opaque.
    nothing: Texture,
    no_view: Uniform<ViewUniform>,
    target: Texture,
}

impl Thickness {
    /// For slicemaps of a size.
    ///
    /// # Errors
    /// The device's.
    pub fn new(gpu: &Gpu, columns: UVec2, evaluation: Evaluation) -> Result<Self, GpuError> {
        let uses_table = evaluation == Evaluation::Table;
        let constants = [("USES_TABLE", f64::from(u8::from(uses_table)))];
        let format = wgpu::TextureFormat::Rgba32Float;
        let uniform = |is_cut| {
            let value = ThicknessUniform { is_cut, reserved_0: 0, reserved_1: 0, reserved_2: 0 };
            Uniform::new(gpu, "refraction/thickness", &value)
        };
        let table = if uses_table { evaluation_table() } else { vec![0] };
        Ok(Self {
            pass: FullscreenPass::with_constants(gpu, &SHADER, format, false, &constants),
            table: Buffer::storage_with(gpu, "refraction/table", &table)?,
            uniforms: [uniform(0), uniform(1)],
            nothing: Texture::target(gpu, "refraction/nothing", [1, 1], wgpu::TextureFormat::R32Float)?,
            no_view: Uniform::new(gpu, "refraction/no view", &bytemuck::Zeroable::zeroed()),
            target: Texture::target(gpu, "refraction/thickness", columns.to_array(), format)?,
        })
    }

    /// Counts a slicemap that [splits faces](crate::slicemap::SlicemapSettings::splits_faces), up to what is opaque, if that is given.
    ///
    /// # Errors
    /// A slicemap that does not split faces, and the device's.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        slicemap: &Slicemap,
        opaque: Option<&Backdrop<'_>>,
    ) -> Result<(), GpuError> {
        if !slicemap.settings().splits_faces {
            return Err(GpuError::Validation("thickness needs a slicemap that splits faces".to_owned()));
        }
        let bindings = Bindings::new()
            .read("view", opaque.map_or(&self.no_view, |o| o.uniform))
            .read("depth", opaque.map_or(&self.nothing, |o| o.depth))
            .read("slicemap", slicemap.uniform())
            .read("slicemap_bits", &slicemap.bits)
            .read("slicemap_extents", &slicemap.extents)
            .read("thickness", &self.uniforms[usize::from(opaque.is_some())])
            .read("evaluation", &self.table);
        self.pass.record(gpu, encoder, &bindings, &mut self.target, false)
    }

    /// Metres of kinds 0 to 3 in four channels of 32-bit floats, a texel for each column.
    pub fn texture(&self) -> &Texture {
        &self.target
    }

    /// The same in memory, row by row from the top. Waits.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<[f32; 4]>, GpuError> {
        read_texture(gpu, &self.target)
    }
}

/// The paper's table for eight slices at once: entry `fronts + 256 * backs` has four bytes. The first is the number of inner cells if
/// the ray comes in inside, plus 128 if it goes on inside; the second the same if it comes in outside; the third whether the first cell
/// that is not empty is a back alone; the fourth, if the last that is not empty is ambiguous, one and the number of empty ones behind it.
pub fn evaluation_table() -> Vec<u32> {
    (0..0x1_0000u32).map(|pair| entry(pair & 0xff, pair >> 8)).collect()
}

fn entry(fronts: u32, backs: u32) -> u32 {
    let any = fronts | backs;
    let first = any & any.wrapping_neg();
    let begins_with_back = u32::from(first & backs & !fronts != 0);
    let (inside, _) = walk(fronts, backs, true);
    let (outside, waiting) = walk(fronts, backs, false);
    inside | outside << 8 | begins_with_back << 16 | waiting << 24
}

/// Inner cells of eight, plus 128 if the ray goes on inside; and what waits.
fn walk(fronts: u32, backs: u32, mut is_inside: bool) -> (u32, u32) {
    let mut count = 0;
    // Behind an ambiguous cell, with the empty ones since.
    let mut waiting: Option<u32> = None;
    for n in 0..8 {
        match (fronts >> n & 1, backs >> n & 1) {
            (1, 1) => {
                count += 1;
                is_inside = false;
                waiting = Some(0);
            }
            (1, 0) => {
                count += 1;
                is_inside = true;
                waiting = None;
            }
            (0, 1) => {
                count += waiting.take().unwrap_or(0);
                is_inside = false;
            }
            _ => match &mut waiting {
                Some(empty) => *empty += 1,
                None => count += u32::from(is_inside),
            },
        }
    }
    (count + 128 * u32::from(is_inside), waiting.map_or(0, |empty| empty + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(fronts: u32, backs: u32) -> [u8; 4] {
        evaluation_table()[(fronts + 256 * backs) as usize].to_le_bytes()
    }

    #[test]
    fn entries_say_what_they_should() {
        // Nothing: all inside, or none.
        assert_eq!(bytes(0, 0), [8 + 128, 0, 0, 0]);
        // A front in slice 3: the five from there on.
        assert_eq!(bytes(0b1000, 0)[1], 5 + 128);
        // A back there: the three before.
        assert_eq!(bytes(0, 0b1000), [3, 0, 1, 0]);
        // From slice 1 to slice 4.
        assert_eq!(bytes(0b10, 0b10000)[1], 3);
        // Both in slice 5, then two empty ones: one inside, and what waits.
        assert_eq!(bytes(0b100000, 0b100000), [6, 1, 0, 3]);
        // Both in slice 1, then a back in slice 4: what lay between was inside.
        assert_eq!(bytes(0b10, 0b10010)[1], 3);
        // Both in slice 1, then a front in slice 4: it was not.
        assert_eq!(bytes(0b10010, 0b10)[1], 5 + 128);
        // Both twice: it is not.
        assert_eq!(bytes(0b10010, 0b10010)[1], 2);
    }
}
