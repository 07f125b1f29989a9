//! How a slicemap is cut.

use glam::{Mat4, UVec2};
use lumivox_core::View;

use super::MAX_KINDS;
use crate::gpu::{Gpu, GpuError};

/// Where the cells of a column begin and end (2.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slicing {
    /// The same planes for all columns: a regular grid.
    Uniform,
    /// From the nearest to the farthest surface of each column: finer where little is in it, for one more pass.
    Local,
}

/// How a slicemap is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlicemapSettings {
    /// Columns across and down.
    pub size: UVec2,
    /// Cells in a column, 1 to 1024. More tell more surfaces apart, for a bit each; a word of 32 is the smallest.
    pub slices: u32,
    /// Kinds of bits, 1 to [`MAX_KINDS`]: leaves of different colours, say.
    pub kinds: u32,
    /// Where cells begin and end.
    pub slicing: Slicing,
    /// Whether what faces the camera and what faces away have bits of their own: sets `2 * kind` and `2 * kind + 1`.
    pub splits_faces: bool,
    /// Whether columns get all bits that any triangle touches in them. Slower, by two triangles as large as the box around each.
    pub conservative: bool,
    /// Whether a fragment looks its bit up in a table of 32, as the paper does, in place of shifting; not where `conservative`.
    pub uses_table: bool,
}

impl Default for SlicemapSettings {
    /// The paper's tree: 512 x 512 columns of 96 cells, in local slices.
    fn default() -> Self {
        Self {
            size: UVec2::splat(512),
            slices: 96,
            kinds: 1,
            slicing: Slicing::Local,
            splits_faces: false,
            conservative: false,
            uses_table: false,
        }
    }
}

impl SlicemapSettings {
    /// Words of a set in a column.
    pub fn words(&self) -> u32 {
        self.slices.div_ceil(32)
    }

    /// Sets of bits in a column.
    pub fn sets(&self) -> u32 {
        self.kinds * if self.splits_faces { 2 } else { 1 }
    }

    /// Bytes of all bits.
    pub fn bytes(&self) -> u64 {
        let columns = u64::from(self.size.x) * u64::from(self.size.y);
        columns * u64::from(self.sets()) * u64::from(self.words()) * 4
    }

    pub(super) fn check(&self, gpu: &Gpu) -> Result<u64, GpuError> {
        let Self { size, slices, kinds, .. } = *self;
        let limits = gpu.device.limits();
        if size.min_element() == 0 || size.max_element() > limits.max_texture_dimension_2d {
            let most = limits.max_texture_dimension_2d;
            return Err(GpuError::Validation(format!(
                "a slicemap of {} x {} columns; 1 to {most} a side are possible",
                size.x, size.y
            )));
        }
        if !(1..=1024).contains(&slices) || !(1..=MAX_KINDS).contains(&kinds) {
            return Err(GpuError::Validation(format!(
                "a slicemap of {slices} slices and {kinds} kinds; 1 to 1024 and 1 to {MAX_KINDS} are possible"
            )));
        }
        let (bytes, most) = (self.bytes(), limits.max_storage_buffer_binding_size);
        if bytes > most {
            return Err(GpuError::Validation(format!(
                "a slicemap of {} x {} columns with {} sets of {slices} bits needs {bytes} bytes, but this device binds at most {most}",
                size.x,
                size.y,
                self.sets()
            )));
        }
        Ok(bytes)
    }
}

crate::gpu_struct! {
    /// A slicemap as shaders see it.
    pub struct SlicemapUniform {
        /// World to clip space.
        pub clip_from_world: Mat4,
        /// And back.
        pub world_from_clip: Mat4,
        /// World to eye space.
        pub eye_from_world: Mat4,
        /// Columns across and down.
        pub size: UVec2,
        /// Cells in a column.
        pub slices: u32,
        /// Words of a set.
        pub words: u32,
        /// Metres to the near side of the first cell.
        pub near: f32,
        /// Metres to the far side of the last.
        pub far: f32,
        /// Sets of a column.
        pub sets: u32,
        /// The set that a drawing writes, of what faces the camera.
        pub bit_set: u32,
        /// 1 where columns have ranges of their own.
        pub is_local: u32,
        /// 1 where what faces away is in the set after.
        pub splits_faces: u32,
        /// Depth of what is far away.
        pub far_depth: f32,
        /// Unused.
        pub reserved: u32,
    }
}

impl SlicemapUniform {
    pub(super) fn new(settings: &SlicemapSettings, view: &View, range: [f32; 2], kind: u32) -> Self {
        let splits = u32::from(settings.splits_faces);
        Self {
            clip_from_world: view.clip_from_world,
            world_from_clip: view.world_from_clip(),
            eye_from_world: view.eye_from_world,
            size: settings.size,
            slices: settings.slices,
            words: settings.words(),
            near: range[0],
            far: range[1],
            sets: settings.sets(),
            bit_set: kind * (1 + splits),
            is_local: u32::from(settings.slicing == Slicing::Local),
            splits_faces: splits,
            far_depth: if view.reversed_depth { 0.0 } else { 1.0 },
            reserved: 0,
        }
    }
}
