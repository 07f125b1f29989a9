//! PLY with the faces of occupied cells that no other occupied cell hides, binary little-endian.
//!
//! Each face is a quadrangle with corners of its own, counter-clockwise from outside, that carry the cell's attributes
//! as points do (see the format of points).

use std::path::Path;

use glam::{IVec3, UVec3, Vec3};

use super::ply::{Attributes, check_count, grid_comments};
use super::{FileError, FileReport, Place, create};
use crate::SparseVolume;

/// Directions of the faces, each with its corners around a cell.
const FACES: [([i32; 3], [[u32; 3]; 4]); 6] = [
    ([-1, 0, 0], [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]]),
    ([1, 0, 0], [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]]),
    ([0, -1, 0], [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]]),
    ([0, 1, 0], [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]]),
    ([0, 0, -1], [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]),
    ([0, 0, 1], [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]),
];

pub(super) fn write(
    place: &mut dyn Place,
    path: &Path,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    let faces: u64 = volume.cells().map(|cell| open_faces(volume, cell).count() as u64).sum();
    check_count(path, "corners", 4 * faces)?;
    let grid = volume.grid();
    create(place, path, |out| {
        use std::io::Write;
        let attributes = Attributes::new(volume);
        writeln!(out, "ply\nformat binary_little_endian 1.0")?;
        grid_comments(out, volume)?;
        writeln!(out, "element vertex {}\nproperty float x\nproperty float y\nproperty float z", 4 * faces)?;
        attributes.header(out)?;
        writeln!(out, "element face {faces}\nproperty list uchar int vertex_indices\nend_header")?;
        for (cell, slot) in volume.entries() {
            for corners in open_faces(volume, cell) {
                for corner in corners {
                    let corner = (cell + UVec3::from(corner)).as_vec3();
                    let world: Vec3 = grid.origin + grid.cell_size * corner;
                    for number in world.to_array() {
                        out.write_all(&number.to_le_bytes())?;
                    }
                    attributes.write(slot, out)?;
                }
            }
        }
        for face in 0..faces as i32 {
            out.write_all(&[4])?;
            for corner in 0..4 {
                out.write_all(&(4 * face + corner).to_le_bytes())?;
            }
        }
        Ok(())
    })?;
    Ok(FileReport { files: vec![path.to_owned()], ..FileReport::default() })
}

/// The corners of those faces of a cell behind which there is none.
fn open_faces(volume: &SparseVolume, cell: UVec3) -> impl Iterator<Item = [[u32; 3]; 4]> + '_ {
    FACES.iter().filter_map(move |(step, corners)| {
        let next = cell.as_ivec3() + IVec3::from(*step);
        let is_hidden = next.cmpge(IVec3::ZERO).all() && volume.contains(next.as_uvec3());
        (!is_hidden).then_some(*corners)
    })
}
