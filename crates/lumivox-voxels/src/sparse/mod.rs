//! Volumes whose memory follows the surface: bricks of bits, and one value per occupied cell.

mod bricks;
mod dense;
mod directory;

use std::ops::Range;

use glam::{UVec3, Vec3, Vec4};
use lumivox_core::{Grid, HostVolume};

pub(crate) use bricks::{
    BrickSet, CELLS, Mask, SHIFT, SIDE, bits, brick_index, brick_of, bricks_along, count,
};
pub use dense::SparseBuilder;
pub(crate) use directory::Directory;

use crate::{Channel, Rule, SolidReport, Values, VoxelizeReport};

/// One channel of a volume.
#[derive(Clone, Debug)]
pub struct ChannelData {
    name: String,
    components: usize,
    rule: Rule,
    range: [f32; 2],
    values: Values,
}

impl ChannelData {
    pub(crate) fn new(channel: &Channel, values: Values) -> Self {
        Self {
            name: channel.name.clone(),
            components: channel.components,
            rule: channel.rule,
            range: channel.range,
            values,
        }
    }

    /// The channel's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Numbers per cell, 1 to 4.
    pub fn components(&self) -> usize {
        self.components
    }

    /// What became of several surfaces in a cell.
    pub fn rule(&self) -> Rule {
        self.rule
    }

    /// What 0 and 255 stand for if the numbers are bytes.
    pub fn range(&self) -> [f32; 2] {
        self.range
    }

    /// All numbers, cell after cell in the order of slots.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// The value in a slot; missing components are zero.
    pub fn value(&self, slot: usize) -> Vec4 {
        let mut value = Vec4::ZERO;
        for component in 0..self.components {
            value[component] = self.values.get(slot * self.components + component, self.range);
        }
        value
    }
}

/// Why a volume is not made dense.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a dense copy takes {needed} bytes, more than the {limit} that are allowed")]
pub struct DenseError {
    /// Bytes that it takes.
    pub needed: u64,
    /// Bytes that are allowed.
    pub limit: u64,
}

/// Occupied cells of a grid and their values, in memory that grows with the surface and not with the box.
///
/// Cells lie in bricks of 8 x 8 x 8 bits; a brick takes 64 bytes, 20 more to be found, and what its occupied cells have
/// of channels. Each cell of the surface has a *slot*, under which its values stand in every channel. Cells that a
/// solid fill added have none.
///
/// A grid has at most 2048 cells a side.
#[derive(Clone, Debug)]
pub struct SparseVolume {
    grid: Grid,
    /// The cells of the surface, which have slots.
    surface: BrickSet,
    /// Those and the filled ones, if anything was filled.
    solid: Option<BrickSet>,
    channels: Vec<ChannelData>,
    report: VoxelizeReport,
}

impl SparseVolume {
    pub(crate) fn new(
        grid: Grid,
        surface: BrickSet,
        solid: Option<BrickSet>,
        channels: Vec<ChannelData>,
        report: VoxelizeReport,
    ) -> Self {
        Self { grid, surface, solid, channels, report }
    }

    /// The volume with filled cells.
    pub(crate) fn with_solid(mut self, solid: BrickSet, found: SolidReport) -> Self {
        self.solid = Some(solid);
        self.report.solid = Some(found);
        self
    }

    /// The cells of the surface.
    pub(crate) fn surface(&self) -> &BrickSet {
        &self.surface
    }

    /// The cells' grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// What was done and what was left out.
    pub fn report(&self) -> &VoxelizeReport {
        &self.report
    }

    fn occupied(&self) -> &BrickSet {
        self.solid.as_ref().unwrap_or(&self.surface)
    }

    /// Number of occupied cells.
    pub fn len(&self) -> u64 {
        self.occupied().len()
    }

    /// Number of occupied cells that the surface itself marks; the rest were filled.
    pub fn surface_len(&self) -> u64 {
        self.surface.len()
    }

    /// Whether no cell is occupied.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of bricks that hold an occupied cell.
    pub fn brick_count(&self) -> usize {
        self.occupied().brick_count()
    }

    /// Bytes of memory in use.
    pub fn bytes(&self) -> u64 {
        let values: usize = self.channels.iter().map(|c| c.values.as_bytes().len()).sum();
        self.surface.bytes() + self.solid.as_ref().map_or(0, BrickSet::bytes) + values as u64
    }

    /// Whether a cell is occupied; no cell outside the grid is.
    pub fn contains(&self, cell: UVec3) -> bool {
        cell.cmplt(self.grid.dims).all() && self.occupied().slot(cell).is_some()
    }

    /// The slot of a cell of the surface.
    pub fn slot(&self, cell: UVec3) -> Option<usize> {
        if cell.cmplt(self.grid.dims).all() { self.surface.slot(cell) } else { None }
    }

    /// Whether the cell at a point in the world is occupied.
    pub fn contains_point(&self, world: Vec3) -> bool {
        self.grid.cell_from_world(world).is_some_and(|cell| self.contains(cell))
    }

    /// The occupied cells in the order of [`Grid::index`].
    pub fn cells(&self) -> impl Iterator<Item = UVec3> + '_ {
        self.occupied().entries(0..self.grid.dims.z).map(|(cell, _)| cell)
    }

    /// The occupied cells in the order of [`Grid::index`] with their slots; none for filled ones.
    pub fn entries(&self) -> impl Iterator<Item = (UVec3, Option<usize>)> + '_ {
        self.entries_of_layers(0..self.grid.dims.z)
    }

    /// As [`Self::entries`], for the layers `z` alone.
    pub fn entries_of_layers(&self, z: Range<u32>) -> impl Iterator<Item = (UVec3, Option<usize>)> + '_ {
        let z = z.start..z.end.min(self.grid.dims.z);
        self.occupied().entries(z).map(|(cell, slot)| match &self.solid {
            None => (cell, Some(slot)),
            Some(_) => (cell, self.surface.slot(cell)),
        })
    }

    /// The bits of all bricks of occupied cells, with their places.
    pub(crate) fn bricks(&self) -> impl Iterator<Item = (UVec3, &Mask)> {
        self.occupied().bricks()
    }

    /// The bits of all bricks of surface cells, with their places.
    pub(crate) fn surface_bricks(&self) -> impl Iterator<Item = (UVec3, &Mask)> {
        self.surface.bricks()
    }

    /// All channels.
    pub fn channels(&self) -> &[ChannelData] {
        &self.channels
    }

    /// A channel by its name.
    pub fn channel(&self, name: &str) -> Option<&ChannelData> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// The value of a channel in a cell of the surface.
    pub fn value(&self, name: &str, cell: UVec3) -> Option<Vec4> {
        Some(self.channel(name)?.value(self.slot(cell)?))
    }

    /// Everything in full arrays: `occupancy` (1 or 0 in x), and the channels under their names.
    ///
    /// # Errors
    /// If that takes more than `limit` bytes: 16 for each cell of the grid, channel by channel.
    pub fn to_dense(&self, limit: u64) -> Result<HostVolume, DenseError> {
        let cells = self.grid.cell_count();
        let needed = cells * size_of::<Vec4>() as u64 * (1 + self.channels.len() as u64);
        if needed > limit {
            return Err(DenseError { needed, limit });
        }
        let mut dense = HostVolume::new(self.grid);
        let full = |value: &dyn Fn(Option<usize>) -> Vec4| {
            let mut values = vec![Vec4::ZERO; cells as usize];
            self.entries().for_each(|(cell, slot)| values[self.grid.index(cell)] = value(slot));
            values
        };
        dense.insert("occupancy", full(&|_| Vec4::X));
        for channel in &self.channels {
            let value = |slot: Option<usize>| slot.map_or(Vec4::ZERO, |slot| channel.value(slot));
            dense.insert(&channel.name, full(&value));
        }
        Ok(dense)
    }
}
