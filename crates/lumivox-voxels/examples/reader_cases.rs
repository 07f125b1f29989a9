//! Files for readers of other programs to be tried on: `reader_cases FOLDER` writes one volume in every format, and
//! `cells.txt`, in which each line has a cell, its middle in the world and its values. `tests/readers.py` compares.

use std::fmt::Write;
use std::path::PathBuf;

use lumivox_core::TriangleView;
use lumivox_voxels::files::{self, FileFormat};
use lumivox_voxels::{Channel, Format, GridSpec, Model, VoxelizeOptions, voxelize};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("which folder?")?);
    std::fs::create_dir_all(&folder)?;
    // Lopsided, so that no two axes can be mistaken for one another, and more than a brick and a half along each.
    let positions = [[-3.0, 1.0, 20.0], [1.75, 1.5, 20.5], [-2.5, 8.0, 21.0], [0.0, 2.0, 22.25]];
    let indices = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let model = Model::from(TriangleView { positions: &positions, indices: &indices });
    let tint = |s: &lumivox_voxels::SurfacePoint| [s.position.x * 0.1 + 0.5, 0.25, s.position.y * 0.1, 0.0];
    let options = VoxelizeOptions {
        grid: GridSpec::CellSize(0.125),
        channels: vec![
            Channel::custom("albedo", 3, tint).format(Format::U8),
            Channel::normal(),
            Channel::area(),
            Channel::custom("place", 4, |s| s.position.extend(s.area).to_array()).format(Format::F32),
        ],
        ..VoxelizeOptions::default()
    };
    let volume = voxelize(&model, &options)?;
    for name in ["a.npz", "a.nhdr", "a.ktx2", "a.vdb", "a.ply", "a.vox", "a.binvox"] {
        let path = folder.join(name);
        files::write(&path, FileFormat::of_path(&path).ok_or("format")?, &volume)?;
    }
    files::write(&folder.join("cubes.ply"), FileFormat::PlyCubes, &volume)?;
    let mut text = String::new();
    let grid = volume.grid();
    writeln!(text, "{} {} {} {}", grid.dims.x, grid.dims.y, grid.dims.z, grid.cell_size)?;
    for (cell, slot) in volume.entries() {
        let center = grid.center(cell);
        write!(text, "{} {} {} {} {} {}", cell.x, cell.y, cell.z, center.x, center.y, center.z)?;
        for channel in volume.channels() {
            let value = slot.map(|slot| channel.value(slot)).unwrap_or_default();
            value.to_array()[..channel.components()].iter().try_for_each(|v| write!(text, " {v}"))?;
        }
        writeln!(text)?;
    }
    std::fs::write(folder.join("cells.txt"), text)?;
    Ok(())
}
