//! A sparse set of cells: bricks of 8 x 8 x 8 bits, one cache line each, in the order of their index.
//!
//! Word `z` of a brick holds its layer `z`; bit `x + 8 y` of the word is cell `(x, y, z)`. Bricks are numbered
//! `bx + nbx * (by + nby * bz)`, as cells are. A cell of the set also has a *slot*, its rank in the order of bricks and
//! of bits within one; arrays of values have one entry per slot.

use std::ops::Range;

use glam::UVec3;

use super::directory::Directory;

/// Cells along each axis of a brick.
pub(crate) const SIDE: u32 = 8;
/// Cell coordinates shifted by this are brick coordinates.
pub(crate) const SHIFT: u32 = 3;
/// Cells of a brick.
pub(crate) const CELLS: usize = 512;

/// The bits of a brick.
pub(crate) type Mask = [u64; SIDE as usize];

/// Bricks along the axes of a grid of `dims` cells.
pub(crate) fn bricks_along(dims: UVec3) -> UVec3 {
    (dims + UVec3::splat(SIDE - 1)) / SIDE
}

/// Number of bits set.
pub(crate) fn count(mask: &Mask) -> u32 {
    mask.iter().map(|word| word.count_ones()).sum()
}

/// The bits of a word that are set, in order.
pub(crate) fn bits(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros())?;
        word &= word - 1;
        Some(bit as usize)
    })
}

/// Bricks of one y and z: neighbours along x.
#[derive(Clone, Debug)]
struct Row {
    y: u32,
    z: u32,
    bricks: Range<usize>,
}

/// A sparse set of cells of a grid of at most 2048 cells a side.
#[derive(Clone, Debug)]
pub(crate) struct BrickSet {
    along: UVec3,
    indices: Vec<u32>,
    masks: Vec<Mask>,
    /// Slot of each brick's first cell, and the number of cells at the end.
    first: Vec<u64>,
    rows: Vec<Row>,
    directory: Directory,
}

impl BrickSet {
    /// From bricks in ascending order of their index, none of them empty or twice.
    pub(crate) fn new(dims: UVec3, indices: Vec<u32>, masks: Vec<Mask>) -> Self {
        debug_assert!(indices.is_sorted_by(|a, b| a < b) && indices.len() == masks.len());
        let along = bricks_along(dims);
        let mut directory = Directory::new(along);
        let mut first = Vec::with_capacity(masks.len() + 1);
        let mut rows: Vec<Row> = Vec::new();
        let mut slots = 0;
        for (number, (&index, mask)) in indices.iter().zip(&masks).enumerate() {
            let brick = brick_of(along, index);
            directory.get_or_insert(brick, number as u32);
            first.push(slots);
            slots += u64::from(count(mask));
            match rows.last_mut() {
                Some(row) if row.y == brick.y && row.z == brick.z => row.bricks.end = number + 1,
                _ => rows.push(Row { y: brick.y, z: brick.z, bricks: number..number + 1 }),
            }
        }
        first.push(slots);
        Self { along, indices, masks, first, rows, directory }
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> u64 {
        self.first.last().copied().unwrap_or(0)
    }

    /// Number of bricks.
    pub(crate) fn brick_count(&self) -> usize {
        self.masks.len()
    }

    /// Bricks along the axes of the grid.
    pub(crate) fn along(&self) -> UVec3 {
        self.along
    }

    /// The bricks with their places, in order.
    pub(crate) fn bricks(&self) -> impl Iterator<Item = (UVec3, &Mask)> {
        self.indices.iter().map(|&index| brick_of(self.along, index)).zip(&self.masks)
    }

    /// The number of a brick; none if it is empty. `brick` must lie in the grid.
    pub(crate) fn number(&self, brick: UVec3) -> Option<usize> {
        self.directory.get(brick).map(|number| number as usize)
    }

    /// The bits of the brick with a number.
    pub(crate) fn mask_of(&self, number: usize) -> &Mask {
        &self.masks[number]
    }

    /// The slot of a cell, if it is in the set. `cell` must lie in the grid.
    pub(crate) fn slot(&self, cell: UVec3) -> Option<usize> {
        let number = self.directory.get(cell / SIDE)? as usize;
        let local = cell % SIDE;
        let mask = &self.masks[number];
        let bit = local.x + SIDE * local.y;
        (mask[local.z as usize] >> bit & 1 == 1).then(|| self.rank(number, local.z as usize, bit))
    }

    fn rank(&self, number: usize, z: usize, bit: u32) -> usize {
        let mask = &self.masks[number];
        let below: u32 = mask[..z].iter().map(|word| word.count_ones()).sum();
        let beside = (mask[z] & ((1u64 << bit) - 1)).count_ones();
        self.first[number] as usize + (below + beside) as usize
    }

    /// The cells of the set and their slots in the order of [`lumivox_core::Grid::index`], in layers `z`.
    pub(crate) fn entries(&self, z: Range<u32>) -> impl Iterator<Item = (UVec3, usize)> + '_ {
        z.flat_map(move |z| {
            self.layer(z / SIDE).iter().flat_map(move |row| {
                (0..SIDE).flat_map(move |y| {
                    row.bricks.clone().flat_map(move |number| self.octet(number, row, y, z % SIDE))
                })
            })
        })
    }

    /// Rows of the bricks of one layer.
    fn layer(&self, z: u32) -> &[Row] {
        let start = self.rows.partition_point(|row| row.z < z);
        let end = self.rows.partition_point(|row| row.z <= z);
        &self.rows[start..end]
    }

    /// The cells of a brick that differ in x only.
    fn octet(
        &self,
        number: usize,
        row: &Row,
        y: u32,
        z: u32,
    ) -> impl Iterator<Item = (UVec3, usize)> + use<> {
        let mut bits = (self.masks[number][z as usize] >> (SIDE * y)) as u8;
        let mut slot = if bits == 0 { 0 } else { self.rank(number, z as usize, SIDE * y) };
        let first =
            UVec3::new(self.indices[number] % self.along.x, row.y, row.z) * SIDE + UVec3::new(0, y, z);
        std::iter::from_fn(move || {
            if bits == 0 {
                return None;
            }
            let cell = first + UVec3::new(bits.trailing_zeros(), 0, 0);
            bits &= bits - 1;
            slot += 1;
            Some((cell, slot - 1))
        })
    }

    /// Bytes of memory in use.
    pub(crate) fn bytes(&self) -> u64 {
        let per_brick = size_of::<Mask>() + size_of::<u32>() + size_of::<u64>();
        (self.masks.len() * per_brick + self.rows.len() * size_of::<Row>()) as u64 + self.directory.bytes()
    }
}

/// The place of the brick with a linear index.
pub(crate) fn brick_of(along: UVec3, index: u32) -> UVec3 {
    UVec3::new(index % along.x, index / along.x % along.y, index / (along.x * along.y))
}

/// The linear index of a brick.
pub(crate) fn brick_index(along: UVec3, brick: UVec3) -> u32 {
    brick.x + along.x * (brick.y + along.y * brick.z)
}
