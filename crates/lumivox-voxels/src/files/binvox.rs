//! `binvox`: occupancy, run-length encoded, in a cube.
//!
//! Shorter axes are filled up with empty cells, because most readers expect a cube. Cells run y fastest, then z, then x.
//! `translate` is the grid's corner and `scale` the cube's side in metres, so that cell `(i, j, k)` of `d` a side has its
//! middle at `translate + scale * ((i, j, k) + 1/2) / d`.

use std::io::{self, Write};
use std::path::Path;

use glam::UVec3;

use super::{FileError, FileFormat, FileReport, Place, create, left_out};
use crate::SparseVolume;
use crate::sparse::SIDE;

pub(super) fn write(
    place: &mut dyn Place,
    path: &Path,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    create(place, path, |out| {
        let grid = volume.grid();
        let side = grid.dims.max_element();
        let [x, y, z] = grid.origin.to_array();
        writeln!(out, "#binvox 1\ndim {side} {side} {side}\ntranslate {x:?} {y:?} {z:?}")?;
        writeln!(out, "scale {:?}\ndata", f64::from(grid.cell_size) * f64::from(side))?;
        let mut runs = Runs { out, value: false, length: 0 };
        let mut columns: Vec<Vec<(UVec3, _)>> = vec![Vec::new(); side.div_ceil(SIDE) as usize];
        volume.bricks().for_each(|(brick, mask)| columns[brick.x as usize].push((brick, mask)));
        // A bit per cell of one x, each z a row of words with y along it.
        let words = side.div_ceil(u64::BITS) as usize;
        let mut plane = vec![0u64; words * side as usize];
        for x in 0..side {
            plane.fill(0);
            for (brick, mask) in &columns[(x / SIDE) as usize] {
                for (z, layer) in mask.iter().enumerate() {
                    // Every eighth bit: the cells of one x.
                    let mut row = layer >> (x % SIDE) & 0x0101_0101_0101_0101;
                    while row != 0 {
                        let y = brick.y * SIDE + row.trailing_zeros() / SIDE;
                        let word = words * (brick.z as usize * SIDE as usize + z) + (y / u64::BITS) as usize;
                        plane[word] |= 1 << (y % u64::BITS);
                        row &= row - 1;
                    }
                }
            }
            for row in plane.chunks_exact(words) {
                for (n, &word) in row.iter().enumerate() {
                    runs.push_bits(word, u64::BITS.min(side - n as u32 * u64::BITS))?;
                }
            }
        }
        runs.write()
    })?;
    Ok(FileReport {
        files: vec![path.to_owned()],
        left_out: left_out(FileFormat::Binvox, volume),
        ..FileReport::default()
    })
}

/// Pairs of a value and how often it comes, up to 255 times.
struct Runs<W> {
    out: W,
    value: bool,
    length: u64,
}

impl<W: Write> Runs<W> {
    /// The lowest `count` bits, the lowest first.
    fn push_bits(&mut self, bits: u64, count: u32) -> io::Result<()> {
        let mut left = count;
        while left > 0 {
            let rest = bits >> (count - left);
            let value = rest & 1 == 1;
            let same = if value { rest.trailing_ones() } else { rest.trailing_zeros() }.min(left);
            if value != self.value {
                self.write()?;
                (self.value, self.length) = (value, 0);
            }
            self.length += u64::from(same);
            left -= same;
        }
        Ok(())
    }

    fn write(&mut self) -> io::Result<()> {
        const LONGEST: u64 = u8::MAX as u64;
        while self.length > 0 {
            let length = self.length.min(LONGEST);
            self.out.write_all(&[u8::from(self.value), length as u8])?;
            self.length -= length;
        }
        Ok(())
    }
}
