//! Sums of a few bricks at a time, for triangles that come in neighbourhoods.

use glam::{IVec3, UVec3};

use super::LONGEST;
use crate::channels::FlatPiece;
use crate::sparse::{CELLS, Directory, Mask, SHIFT, SIDE, bits, brick_index, bricks_along};

/// Bricks and cells at a time: their sums stay in a processor's cache.
const MOST_BRICKS: usize = 512;
const MOST_CELLS: usize = 1 << 14;
/// Pieces per cell below which sums do not pay.
const PAYS: usize = 3;
/// Slot of a cell that has no sum; a triangle cannot bring as many.
const NONE: u16 = u16::MAX;

/// Sums of the marked cells of some bricks, in the order in which they were marked.
#[derive(Debug)]
pub(super) struct CellSums {
    along: UVec3,
    directory: Directory,
    bricks: Vec<IVec3>,
    masks: Vec<Mask>,
    /// Of each cell of each brick.
    slots: Vec<[u16; CELLS]>,
    sums: Vec<[i64; 4]>,
    /// Pieces in these.
    pieces: usize,
    /// Sums that are as long as may be, the bricks and the cells they belong to.
    aside: Vec<(IVec3, usize, [i64; 4])>,
    /// The bricks asked for last, by the lowest bits of their places, and their numbers.
    near: [(u32, u32); NEAR],
}

/// Bricks that are found at once: 4 x 4 x 4 neighbours.
const NEAR: usize = 64;
const NOWHERE: (u32, u32) = (u32::MAX, 0);

/// The place of a brick in one word, and where it is among its neighbours.
#[inline(always)]
fn key_of(brick: IVec3) -> (u32, usize) {
    let UVec3 { x, y, z } = brick.as_uvec3();
    (x | y << 8 | z << 16, (x & 3 | (y & 3) << 2 | (z & 3) << 4) as usize)
}

impl CellSums {
    pub(super) fn new(dims: UVec3) -> Self {
        let along = bricks_along(dims);
        Self {
            along,
            directory: Directory::new(along),
            bricks: Vec::new(),
            masks: Vec::new(),
            slots: Vec::new(),
            sums: Vec::new(),
            pieces: 0,
            aside: Vec::new(),
            near: [NOWHERE; NEAR],
        }
    }

    /// Adds a piece to a cell of the grid.
    #[inline(always)]
    pub(super) fn add(&mut self, cell: IVec3, piece: &FlatPiece) {
        self.pieces += 1;
        let brick = cell >> SHIFT;
        let (key, near) = key_of(brick);
        let number = match self.near[near] {
            (found, number) if found == key => number,
            _ => self.seek(brick),
        };
        let local = cell & (SIDE as i32 - 1);
        let place = (local.x | local.y << SHIFT | local.z << (2 * SHIFT)) as usize;
        let slot = self.slots[number as usize][place];
        match self.sums.get_mut(usize::from(slot)) {
            Some(sum) if sum[0] + piece.0[0] < LONGEST => {
                sum.iter_mut().zip(piece.0).for_each(|(sum, number)| *sum += number);
            }
            _ => self.insert(number, place, piece),
        }
    }

    /// Not inlined, as there are many places where pieces are added.
    #[inline(never)]
    fn seek(&mut self, brick: IVec3) -> u32 {
        let new = self.bricks.len() as u32;
        let number = self.directory.get_or_insert(brick.as_uvec3(), new);
        if number == new {
            self.bricks.push(brick);
            self.masks.push([0; SIDE as usize]);
            self.slots.push([NONE; CELLS]);
        }
        let (key, near) = key_of(brick);
        self.near[near] = (key, number);
        number
    }

    /// The first piece of a cell, or one that its sum has no room for.
    #[inline(never)]
    fn insert(&mut self, number: u32, place: usize, piece: &FlatPiece) {
        let slot = &mut self.slots[number as usize][place];
        if let Some(sum) = self.sums.get_mut(usize::from(*slot)) {
            self.aside.push((self.bricks[number as usize], place, std::mem::replace(sum, piece.0)));
            return;
        }
        *slot = self.sums.len() as u16;
        self.sums.push(piece.0);
        self.masks[number as usize][place >> 6] |= 1 << (place & 63);
    }

    /// Whether it is time to flush. What one small triangle adds fits in any case.
    pub(super) fn is_full(&self) -> bool {
        self.bricks.len() >= MOST_BRICKS || self.sums.len() >= MOST_CELLS
    }

    /// Whether most cells have had more than a piece or two.
    pub(super) fn pays(&self) -> bool {
        self.pieces >= PAYS * self.sums.len()
    }

    /// Appends all sums to a list, and starts anew; returns by how many bytes the list has grown.
    pub(super) fn flush(&mut self, list: &mut SumList) -> u64 {
        let before = list.bytes();
        list.sums.reserve(self.sums.len() + self.aside.len());
        for ((&brick, mask), slots) in self.bricks.iter().zip(&self.masks).zip(&self.slots) {
            list.begin(brick_index(self.along, brick.as_uvec3()), *mask);
            for (z, &word) in mask.iter().enumerate() {
                list.sums.extend(bits(word).map(|bit| self.sums[usize::from(slots[64 * z + bit])]));
            }
        }
        for &(brick, place, sum) in &self.aside {
            let mut mask = [0; SIDE as usize];
            mask[place >> 6] = 1 << (place & 63);
            list.begin(brick_index(self.along, brick.as_uvec3()), mask);
            list.sums.push(sum);
        }
        self.clear();
        list.bytes() - before
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.bricks.iter().for_each(|brick| self.directory.remove(brick.as_uvec3()));
        self.bricks.clear();
        self.masks.clear();
        self.slots.clear();
        self.sums.clear();
        self.pieces = 0;
        self.aside.clear();
        self.near = [NOWHERE; NEAR];
    }
}

/// Sums of some bricks, of which some may come several times.
#[derive(Debug, Default)]
pub(crate) struct SumList {
    bricks: Vec<(u32, u32)>,
    masks: Vec<Mask>,
    sums: Vec<[i64; 4]>,
}

/// The sums of a brick's marked cells, in the order of their bits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BrickSums<'a> {
    pub(crate) brick: u32,
    pub(crate) mask: &'a Mask,
    pub(crate) sums: &'a [[i64; 4]],
}

impl SumList {
    fn begin(&mut self, brick: u32, mask: Mask) {
        self.bricks.push((brick, self.sums.len() as u32));
        self.masks.push(mask);
    }

    pub(crate) fn len(&self) -> usize {
        self.bricks.len()
    }

    pub(crate) fn get(&self, n: usize) -> BrickSums<'_> {
        let (brick, first) = self.bricks[n];
        let end = self.bricks.get(n + 1).map_or(self.sums.len(), |next| next.1 as usize);
        BrickSums { brick, mask: &self.masks[n], sums: &self.sums[first as usize..end] }
    }

    /// Bytes of memory in use.
    fn bytes(&self) -> u64 {
        (size_of_val(&self.bricks[..]) + size_of_val(&self.masks[..]) + size_of_val(&self.sums[..])) as u64
    }
}
