//! A slicemap in memory: which cells are filled, where they are, and pictures of them.

use glam::{UVec2, Vec3};
use lumivox_core::View;

use super::{Slicemap, SlicemapSettings};
use crate::gpu::{Gpu, GpuError};

/// A slicemap as it was read back.
#[derive(Clone, Debug)]
pub struct HostSlicemap {
    settings: SlicemapSettings,
    view: View,
    range: [f32; 2],
    words: Vec<u32>,
    extents: Vec<Option<[f32; 2]>>,
}

impl Slicemap {
    /// All of it in memory; `view` and `range` are those of [`Self::set_view`]. Waits.
    ///
    /// # Errors
    /// The device's.
    pub fn read_host(&self, gpu: &Gpu, view: &View, range: [f32; 2]) -> Result<HostSlicemap, GpuError> {
        let extents =
            if self.settings.slicing == super::Slicing::Local { self.read_extents(gpu)? } else { Vec::new() };
        Ok(HostSlicemap { settings: self.settings, view: *view, range, words: self.read(gpu)?, extents })
    }
}

impl HostSlicemap {
    /// How it is cut.
    pub fn settings(&self) -> &SlicemapSettings {
        &self.settings
    }

    fn number(&self, column: UVec2) -> usize {
        (column.y * self.settings.size.x + column.x) as usize
    }

    /// Whether a cell is filled; not outside of the slicemap.
    pub fn is_filled(&self, column: UVec2, bit_set: u32, slice: u32) -> bool {
        let SlicemapSettings { size, slices, .. } = self.settings;
        let is_inside = column.cmplt(size).all() && slice < slices && bit_set < self.settings.sets();
        let set = self.number(column) * self.settings.sets() as usize + bit_set as usize;
        let word = set * self.settings.words() as usize + slice as usize / 32;
        is_inside && self.words.get(word).is_some_and(|word| word >> (slice % 32) & 1 == 1)
    }

    /// The distances along the view between which a column lies, metres; none for one without surfaces.
    pub fn extent(&self, column: UVec2) -> Option<[f32; 2]> {
        match self.settings.slicing {
            super::Slicing::Uniform => Some(self.range),
            super::Slicing::Local => self.extents.get(self.number(column)).copied().flatten(),
        }
    }

    /// The middle of a cell in the world; none where a column has no surfaces.
    pub fn center(&self, column: UVec2, slice: u32) -> Option<Vec3> {
        let [near, far] = self.extent(column)?;
        let distance = near + (slice as f32 + 0.5) * (far - near) / self.settings.slices as f32;
        let uv = (column.as_vec2() + 0.5) / self.settings.size.as_vec2();
        let world_from_clip = self.view.world_from_clip();
        let at =
            |depth: f32| world_from_clip.project_point3(Vec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, depth));
        let (a, b) = (at(0.25), at(0.75));
        let along = |p: Vec3| -self.view.eye_from_world.transform_point3(p).z;
        Some(a + (b - a) * ((distance - along(a)) / (along(b) - along(a))))
    }

    /// Filled cells: column, set of bits and slice.
    pub fn filled(&self) -> impl Iterator<Item = (UVec2, u32, u32)> + '_ {
        let SlicemapSettings { size, slices, .. } = self.settings;
        let cells = (0..size.y).flat_map(move |y| (0..size.x).map(move |x| UVec2::new(x, y)));
        cells
            .flat_map(move |column| (0..self.settings.sets()).map(move |set| (column, set)))
            .flat_map(move |(column, set)| (0..slices).map(move |slice| (column, set, slice)))
            .filter(|&(column, set, slice)| self.is_filled(column, set, slice))
    }

    /// All slices beside each other, the nearest first, in rows of `across`: 255 for filled cells, of any set, and 0; with its size.
    pub fn sheet(&self, across: u32) -> (UVec2, Vec<u8>) {
        let SlicemapSettings { size, slices, .. } = self.settings;
        let across = across.clamp(1, slices);
        let whole = size * UVec2::new(across, slices.div_ceil(across));
        let mut pixels = vec![0; whole.element_product() as usize];
        for (column, _, slice) in self.filled() {
            let at = column + size * UVec2::new(slice % across, slice / across);
            pixels[(at.y * whole.x + at.x) as usize] = 255;
        }
        (whole, pixels)
    }
}
