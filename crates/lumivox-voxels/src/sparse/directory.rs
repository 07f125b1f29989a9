//! From a brick's place to its number, in two levels: a coarse array of pages, and pages of 8 x 8 x 8 entries.
//!
//! A full array of a 2048-cell grid would take 64 MiB; this takes 128 KiB and 2 KiB per page that holds a brick.

use glam::UVec3;

/// Entries along each axis of a page.
const PAGE_SIDE: u32 = 8;
const ENTRIES: usize = (PAGE_SIDE * PAGE_SIDE * PAGE_SIDE) as usize;
/// No page, or no brick.
const NONE: u32 = u32::MAX;

/// A map from brick coordinates to numbers.
#[derive(Clone, Debug)]
pub(crate) struct Directory {
    pages_along: UVec3,
    top: Vec<u32>,
    pages: Vec<[u32; ENTRIES]>,
}

impl Directory {
    /// An empty map for `dims` bricks along the axes.
    pub(crate) fn new(dims: UVec3) -> Self {
        let pages_along = (dims + UVec3::splat(PAGE_SIDE - 1)) / PAGE_SIDE;
        Self { pages_along, top: vec![NONE; pages_along.element_product() as usize], pages: Vec::new() }
    }

    fn place(&self, brick: UVec3) -> (usize, usize) {
        let page = brick / PAGE_SIDE;
        let entry = brick % PAGE_SIDE;
        let n = self.pages_along;
        (
            (page.x + n.x * (page.y + n.y * page.z)) as usize,
            (entry.x + PAGE_SIDE * (entry.y + PAGE_SIDE * entry.z)) as usize,
        )
    }

    /// The number of a brick, if it has one. `brick` must lie in the grid.
    #[inline]
    pub(crate) fn get(&self, brick: UVec3) -> Option<u32> {
        let (page, entry) = self.place(brick);
        let page = self.top[page];
        if page == NONE {
            return None;
        }
        let number = self.pages[page as usize][entry];
        (number != NONE).then_some(number)
    }

    /// The number of a brick; `new` if it had none. `brick` must lie in the grid, and `new` must not be `u32::MAX`.
    #[inline]
    pub(crate) fn get_or_insert(&mut self, brick: UVec3, new: u32) -> u32 {
        let (top, entry) = self.place(brick);
        if self.top[top] == NONE {
            self.top[top] = self.pages.len() as u32;
            self.pages.push([NONE; ENTRIES]);
        }
        let number = &mut self.pages[self.top[top] as usize][entry];
        if *number == NONE {
            *number = new;
        }
        *number
    }

    /// Forgets a brick. `brick` must lie in the grid.
    pub(crate) fn remove(&mut self, brick: UVec3) {
        let (top, entry) = self.place(brick);
        if let Some(page) = self.pages.get_mut(self.top[top] as usize) {
            page[entry] = NONE;
        }
    }

    /// Bytes of memory in use.
    pub(crate) fn bytes(&self) -> u64 {
        (self.top.len() * 4 + self.pages.len() * ENTRIES * 4) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_was_put_in_and_nothing_else() {
        let dims = UVec3::new(20, 9, 1);
        let mut directory = Directory::new(dims);
        let put = [UVec3::ZERO, UVec3::new(19, 8, 0), UVec3::new(7, 8, 0), UVec3::new(8, 0, 0)];
        for (n, brick) in put.into_iter().enumerate() {
            assert_eq!(directory.get_or_insert(brick, n as u32), n as u32);
            assert_eq!(directory.get_or_insert(brick, 99), n as u32);
        }
        for x in 0..20 {
            for y in 0..9 {
                let brick = UVec3::new(x, y, 0);
                let expected = put.iter().position(|&b| b == brick).map(|n| n as u32);
                assert_eq!(directory.get(brick), expected, "{brick}");
            }
        }
    }
}
