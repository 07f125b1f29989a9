//! Cells of a block in which several colours may meet: the sums of one colour after the other.

use std::ops::Range;

use crate::channels::{FlatPiece, MixedCell};
use crate::sparse::bits;

/// The sums of all colours in the cells of a block.
#[derive(Debug, Default)]
pub(super) struct MixedSums {
    /// Of each cell, the number of its sums, if it is marked.
    slots: Vec<u32>,
    marks: Vec<u64>,
    cells: Vec<Sums>,
    /// Weights times values, per channel, of cells with several colours.
    values: Vec<[i128; 4]>,
}

/// The sums of one cell.
#[derive(Clone, Copy, Debug)]
struct Sums {
    /// The first colour.
    color: u32,
    /// Where its values begin, if there is another colour.
    first_value: Option<u32>,
    /// Weights, and weights times normals.
    sums: [i128; 4],
}

impl MixedSums {
    /// Adds the sums of one colour in the marked cells, and unmarks them; `colors` are the values of each.
    pub(super) fn add(
        &mut self,
        (color, colors): (u32, &[Vec<[i64; 4]>]),
        marks: &mut [u64],
        sums: &[[i64; 4]],
        aside: &mut Vec<(u32, FlatPiece)>,
    ) {
        self.slots.resize(64 * marks.len(), 0);
        self.marks.resize(marks.len(), 0);
        for (n, word) in marks.iter_mut().enumerate() {
            for bit in bits(std::mem::take(word)) {
                self.add_one(64 * n + bit, (color, colors), sums[64 * n + bit]);
            }
        }
        for (place, piece) in aside.drain(..) {
            self.add_one(place as usize, (color, colors), piece.0);
        }
    }

    fn add_one(&mut self, place: usize, (color, colors): (u32, &[Vec<[i64; 4]>]), piece: [i64; 4]) {
        let (word, bit) = (&mut self.marks[place >> 6], 1 << (place & 63));
        if *word & bit == 0 {
            *word |= bit;
            self.slots[place] = self.cells.len() as u32;
            self.cells.push(Sums { color, first_value: None, sums: piece.map(i128::from) });
            return;
        }
        let cell = &mut self.cells[self.slots[place] as usize];
        let of = |color: u32| colors.get(color as usize).map_or(&[][..], Vec::as_slice);
        if cell.color != color && cell.first_value.is_none() {
            cell.first_value = Some(self.values.len() as u32);
            self.values.extend(of(cell.color).iter().map(|value| times(cell.sums[0], value)));
        }
        if let Some(first) = cell.first_value {
            for (sums, value) in self.values[first as usize..].iter_mut().zip(of(color)) {
                let more = times(piece[0].into(), value);
                sums.iter_mut().zip(more).for_each(|(sum, more)| *sum = sum.wrapping_add(more));
            }
        }
        cell.sums.iter_mut().zip(piece).for_each(|(sum, number)| *sum += i128::from(number));
    }

    /// The marks of some words.
    pub(super) fn marks(&self, words: Range<usize>) -> &[u64] {
        self.marks.get(words).unwrap_or_default()
    }

    /// The sums of a marked cell.
    pub(super) fn cell(&self, place: usize) -> MixedCell<'_> {
        let Sums { color, first_value, sums } = &self.cells[self.slots[place] as usize];
        MixedCell { color: *color, sums, values: first_value.map(|first| &self.values[first as usize..]) }
    }

    /// Forgets all sums.
    pub(super) fn clear(&mut self) {
        self.marks.fill(0);
        self.cells.clear();
        self.values.clear();
    }
}

/// A weight times a value.
fn times(weight: i128, value: &[i64; 4]) -> [i128; 4] {
    value.map(|value| weight.wrapping_mul(i128::from(value)))
}
