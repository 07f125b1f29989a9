//! From full arrays to sparse volumes, for volumes that were made elsewhere, say on a GPU.

use glam::{UVec3, Vec4};
use lumivox_core::Grid;

use super::bricks::{BrickSet, Mask, SIDE, brick_index, brick_of, bricks_along};
use super::{ChannelData, SparseVolume};
use crate::{Channel, Values, VoxelizeError, VoxelizeReport};

impl SparseVolume {
    /// The cells of a grid that `occupied` names, with the values of some channels. Of a channel its name, its number of
    /// components, its format and its range count; values come in the order of [`Grid::index`], one for each cell of the
    /// grid.
    ///
    /// # Errors
    /// If the grid is impossible, or a list has another length than the grid has cells.
    pub fn from_dense(
        grid: Grid,
        occupied: &[bool],
        channels: &[(Channel, &[Vec4])],
    ) -> Result<Self, VoxelizeError> {
        let grid = crate::GridSpec::Grid(grid).fit(&grid.bounds())?;
        let wanted = grid.cell_count();
        let lengths = std::iter::once(("occupancy", occupied.len()))
            .chain(channels.iter().map(|(channel, values)| (channel.name(), values.len())));
        for (name, found) in lengths {
            let found = found as u64;
            if found != wanted {
                return Err(VoxelizeError::Length { name: name.to_owned(), found, wanted });
            }
        }
        let along = bricks_along(grid.dims);
        let (mut bricks, mut masks) = (Vec::new(), Vec::new());
        let mut values: Vec<Values> =
            channels.iter().map(|(channel, _)| Values::new(channel.format)).collect();
        for number in 0..along.element_product() {
            let low = SIDE * brick_of(along, number);
            let mut mask: Mask = [0; SIDE as usize];
            let end = (grid.dims - low).min(UVec3::splat(SIDE));
            for z in 0..end.z {
                for y in 0..end.y {
                    let row = grid.index(low + UVec3::new(0, y, z));
                    for x in (0..end.x).filter(|&x| occupied[row + x as usize]) {
                        mask[z as usize] |= 1 << (x + SIDE * y);
                        for ((channel, from), to) in channels.iter().zip(&mut values) {
                            let value = from[row + x as usize].to_array();
                            to.push(&value[..channel.components], channel.range);
                        }
                    }
                }
            }
            if mask != [0; SIDE as usize] {
                bricks.push(brick_index(along, low / SIDE));
                masks.push(mask);
            }
        }
        let channels =
            channels.iter().zip(values).map(|((channel, _), values)| ChannelData::new(channel, values));
        let surface = BrickSet::new(grid.dims, bricks, masks);
        Ok(Self::new(grid, surface, None, channels.collect(), VoxelizeReport::default()))
    }
}
