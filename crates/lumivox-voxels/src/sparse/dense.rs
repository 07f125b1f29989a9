//! From full layers to sparse volumes, for volumes that were made elsewhere, say on a GPU.

use std::collections::BTreeMap;

use glam::{UVec3, Vec4};
use lumivox_core::Grid;

use super::bricks::{BrickSet, Mask, SIDE, brick_index, bricks_along};
use super::{ChannelData, SparseVolume};
use crate::{Channel, Values, VoxelizeError, VoxelizeReport};

/// Puts a volume together from the layers of a grid, the lowest first, of which no more have to be in memory at once than one likes.
#[derive(Clone, Debug)]
pub struct SparseBuilder {
    grid: Grid,
    channels: Vec<Channel>,
    bricks: Vec<u32>,
    masks: Vec<Mask>,
    values: Vec<Values>,
    /// Bricks that have layers to come.
    open: BTreeMap<u32, Open>,
    /// Layers so far.
    layers: u32,
}

/// A brick under way.
#[derive(Clone, Debug)]
struct Open {
    mask: Mask,
    values: Vec<Values>,
}

impl SparseBuilder {
    /// An empty volume. Of a channel its name, its number of components, its format and its range count.
    ///
    /// # Errors
    /// If the grid is impossible.
    pub fn new(grid: Grid, channels: Vec<Channel>) -> Result<Self, VoxelizeError> {
        let grid = crate::GridSpec::Grid(grid).fit(&grid.bounds())?;
        let values = empty(&channels);
        let (bricks, masks, open) = (Vec::new(), Vec::new(), BTreeMap::new());
        Ok(Self { grid, channels, bricks, masks, values, open, layers: 0 })
    }

    /// Appends the next layers. Bit `i % 32` of word `i / 32` of `occupied` stands for cell `i` of these layers, in the order of
    /// [`Grid::index`]; `value` is asked for the values of channels by their number, in occupied cells alone.
    ///
    /// # Errors
    /// If there are fewer bits than the layers have cells.
    pub fn push(
        &mut self,
        layers: u32,
        occupied: &[u32],
        value: impl Fn(usize, usize) -> Vec4,
    ) -> Result<(), VoxelizeError> {
        let UVec3 { x: nx, y: ny, z: nz } = self.grid.dims;
        let layers = layers.min(nz - self.layers);
        let layer = nx as usize * ny as usize;
        let (found, wanted) = (32 * occupied.len() as u64, (layer * layers as usize) as u64);
        if found < wanted {
            return Err(VoxelizeError::Length { name: "occupancy".to_owned(), found, wanted });
        }
        let along = bricks_along(self.grid.dims);
        for n in 0..layers as usize {
            for cell in set_bits(occupied, n * layer, (n + 1) * layer) {
                let in_layer = (cell - n * layer) as u32;
                let place = UVec3::new(in_layer % nx, in_layer / nx, self.layers);
                let open = self
                    .open
                    .entry(brick_index(along, place / SIDE))
                    .or_insert_with(|| Open { mask: Mask::default(), values: empty(&self.channels) });
                let local = place % SIDE;
                open.mask[local.z as usize] |= 1 << (local.x + SIDE * local.y);
                for (number, (channel, to)) in self.channels.iter().zip(&mut open.values).enumerate() {
                    to.push(&value(number, cell).to_array()[..channel.components], channel.range);
                }
            }
            self.layers += 1;
            if self.layers.is_multiple_of(SIDE) {
                self.close();
            }
        }
        Ok(())
    }

    /// The bricks of one layer of bricks, in order, behind those before.
    fn close(&mut self) {
        for (brick, open) in std::mem::take(&mut self.open) {
            self.bricks.push(brick);
            self.masks.push(open.mask);
            self.values.iter_mut().zip(open.values).for_each(|(to, from)| to.append(from));
        }
    }

    /// Bytes of memory in use, but for the bricks that have layers to come.
    pub fn bytes(&self) -> u64 {
        let values: usize = self.values.iter().map(|values| values.as_bytes().len()).sum();
        (self.bricks.len() * (size_of::<u32>() + size_of::<Mask>()) + values) as u64
    }

    /// The volume; layers that were not given are empty.
    pub fn finish(mut self) -> SparseVolume {
        self.close();
        let channels = self.channels.iter().zip(self.values);
        let channels = channels.map(|(channel, values)| ChannelData::new(channel, values)).collect();
        let surface = BrickSet::new(self.grid.dims, self.bricks, self.masks);
        SparseVolume::new(self.grid, surface, None, channels, VoxelizeReport::default())
    }
}

impl SparseVolume {
    /// The cells of a grid that `occupied` names, with the values of some channels, as [`SparseBuilder`] takes them; values come in the
    /// order of [`Grid::index`], one for each cell of the grid.
    ///
    /// # Errors
    /// If the grid is impossible, or a list has another length than the grid has cells.
    pub fn from_dense(
        grid: Grid,
        occupied: &[bool],
        channels: &[(Channel, &[Vec4])],
    ) -> Result<Self, VoxelizeError> {
        let kept = channels.iter().map(|(channel, _)| channel.clone()).collect();
        let mut builder = SparseBuilder::new(grid, kept)?;
        let wanted = builder.grid.cell_count();
        let lengths = std::iter::once(("occupancy", occupied.len()))
            .chain(channels.iter().map(|(channel, values)| (channel.name(), values.len())));
        for (name, found) in lengths {
            let found = found as u64;
            if found != wanted {
                return Err(VoxelizeError::Length { name: name.to_owned(), found, wanted });
            }
        }
        let word = |bits: &[bool]| bits.iter().rev().fold(0, |word, &bit| word << 1 | u32::from(bit));
        let words: Vec<u32> = occupied.chunks(32).map(word).collect();
        builder.push(grid.dims.z, &words, |channel, cell| channels[channel].1[cell])?;
        Ok(builder.finish())
    }
}

fn empty(channels: &[Channel]) -> Vec<Values> {
    channels.iter().map(|channel| Values::new(channel.format)).collect()
}

/// The bits that are set from `first` up to `end`.
fn set_bits(words: &[u32], first: usize, end: usize) -> impl Iterator<Item = usize> + '_ {
    (first / 32..end.div_ceil(32)).flat_map(move |n| {
        let below = if n == first / 32 { (1u32 << (first % 32)) - 1 } else { 0 };
        let beyond = if 32 * (n + 1) > end { u32::MAX << (end % 32) } else { 0 };
        let mut word = words[n] & !below & !beyond;
        std::iter::from_fn(move || {
            let bit = (word != 0).then(|| word.trailing_zeros())?;
            word &= word - 1;
            Some(32 * n + bit as usize)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_of_a_range_are_found() {
        let words = [0x8000_0001, u32::MAX, 0x3];
        assert_eq!(set_bits(&words, 0, 32).collect::<Vec<_>>(), [0, 31]);
        assert_eq!(set_bits(&words, 1, 34).collect::<Vec<_>>(), [31, 32, 33]);
        assert_eq!(set_bits(&words, 62, 96).collect::<Vec<_>>(), [62, 63, 64, 65]);
        assert_eq!(set_bits(&words, 40, 43).collect::<Vec<_>>(), [40, 41, 42]);
        assert_eq!(set_bits(&words, 64, 64).count(), 0);
    }
}
