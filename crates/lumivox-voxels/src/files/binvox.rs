//! `binvox`: occupancy, run-length encoded, in a cube.
//!
//! Shorter axes are filled up with empty cells, because most readers expect a cube. Cells run y fastest, then z, then x.
//! `translate` is the grid's corner and `scale` the cube's side in metres, so that cell `(i, j, k)` of `d` a side has its
//! middle at `translate + scale * ((i, j, k) + 1/2) / d`.

use std::io::{self, Write};
use std::path::Path;

use glam::UVec3;

use super::{FileError, FileReport, create, left_out};
use crate::SparseVolume;
use crate::sparse::SIDE;

pub(super) fn write(path: &Path, volume: &SparseVolume) -> Result<FileReport, FileError> {
    create(path, |out| {
        let grid = volume.grid();
        let side = grid.dims.max_element();
        let [x, y, z] = grid.origin.to_array();
        writeln!(out, "#binvox 1\ndim {side} {side} {side}\ntranslate {x:?} {y:?} {z:?}")?;
        writeln!(out, "scale {:?}\ndata", f64::from(grid.cell_size) * f64::from(side))?;
        let mut runs = Runs { out, value: 0, length: 0 };
        let mut columns: Vec<Vec<(UVec3, _)>> = vec![Vec::new(); side.div_ceil(SIDE) as usize];
        volume.bricks().for_each(|(brick, mask)| columns[brick.x as usize].push((brick, mask)));
        let mut plane = vec![0u8; (side * side) as usize];
        for x in 0..side {
            plane.fill(0);
            for (brick, mask) in &columns[(x / SIDE) as usize] {
                for (z, layer) in mask.iter().enumerate() {
                    // Every eighth bit: the cells of one x.
                    let mut row = layer >> (x % SIDE) & 0x0101_0101_0101_0101;
                    while row != 0 {
                        let y = brick.y * SIDE + row.trailing_zeros() / SIDE;
                        plane[(y + side * (brick.z * SIDE + z as u32)) as usize] = 1;
                        row &= row - 1;
                    }
                }
            }
            plane.iter().try_for_each(|&value| runs.push(value))?;
        }
        runs.finish()
    })?;
    Ok(FileReport { files: vec![path.to_owned()], left_out: left_out(volume, &[]), ..FileReport::default() })
}

/// Pairs of a value and how often it comes, up to 255 times.
struct Runs<W> {
    out: W,
    value: u8,
    length: u8,
}

impl<W: Write> Runs<W> {
    fn push(&mut self, value: u8) -> io::Result<()> {
        if value == self.value && self.length < u8::MAX {
            self.length += 1;
            return Ok(());
        }
        if self.length > 0 {
            self.out.write_all(&[self.value, self.length])?;
        }
        (self.value, self.length) = (value, 1);
        Ok(())
    }

    fn finish(mut self) -> io::Result<()> {
        if self.length > 0 { self.out.write_all(&[self.value, self.length]) } else { Ok(()) }
    }
}
