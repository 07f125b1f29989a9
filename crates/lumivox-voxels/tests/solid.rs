//! Solid fill: what is inside, and where a surface leaks.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot go on has failed")]

mod common;

use common::{Soup, cuboid, sphere, unit_grid};
use glam::{UVec3, Vec3};
use lumivox_core::{Bounds, Grid};
use lumivox_voxels::{Channel, Coverage, GridSpec, Model, SparseVolume, VoxelizeOptions, voxelize};

fn solid(soup: &Soup, grid: Grid, coverage: Coverage) -> SparseVolume {
    let options = VoxelizeOptions {
        grid: GridSpec::Grid(grid),
        coverage,
        solid: true,
        channels: vec![Channel::normal()],
        ..VoxelizeOptions::default()
    };
    voxelize(&Model::from(soup.view()), &options).unwrap()
}

#[test]
fn closed_surfaces_are_filled_and_nothing_else() {
    for n in [20, 61, 64] {
        let grid = Grid::fit(&Bounds::new(Vec3::splat(-1.0), Vec3::splat(1.0)), n).unwrap();
        let soup = sphere(0.93, 4);
        for coverage in [Coverage::Exact, Coverage::Thin] {
            let volume = solid(&soup, grid, coverage);
            for cell in grid.cells() {
                let depth = (0.93 - grid.center(cell).length()) / grid.cell_size;
                assert!(depth < 0.9 || volume.contains(cell), "{n} {cell}");
                assert!(depth > -0.9 || !volume.contains(cell), "{n} {cell}");
            }
            let report = volume.report().solid.clone().unwrap();
            assert_eq!(report.filled_cells, volume.len() - volume.surface_len());
            assert_eq!((report.boundary_edges, report.hole, report.leaks()), (0, None, false));
            let filled = volume.entries().filter(|(_, slot)| slot.is_none()).count();
            assert_eq!(filled as u64, report.filled_cells);
        }
    }
}

#[test]
fn a_box_on_the_faces_of_its_grid_is_filled_to_the_last_cell() {
    for side in [8, 9, 24] {
        let soup = cuboid(Vec3::ZERO, Vec3::splat(side as f32));
        let volume = solid(&soup, unit_grid(side, side, side), Coverage::Exact);
        assert_eq!(volume.len(), u64::from(side).pow(3));
    }
}

#[test]
fn nested_shells_are_filled_through() {
    let mut soup = cuboid(Vec3::splat(3.5), Vec3::splat(28.5));
    let inner = cuboid(Vec3::splat(10.5), Vec3::splat(20.5));
    let offset = soup.positions.len() as u32;
    soup.positions.extend(inner.positions);
    soup.indices.extend(inner.indices.iter().map(|t| t.map(|i| i + offset)));
    let volume = solid(&soup, unit_grid(32, 32, 32), Coverage::Exact);
    assert_eq!(volume.len(), 26 * 26 * 26);
    // Only what the surface marks has values.
    assert!(volume.value("normal", UVec3::splat(15)).is_none() && volume.contains(UVec3::splat(15)));
    assert!(volume.value("normal", UVec3::new(3, 9, 9)).is_some());
}

#[test]
fn the_place_of_a_leak_is_named() {
    let mut soup = cuboid(Vec3::splat(2.5), Vec3::splat(13.5));
    // Without its upper side, y = 13.5.
    soup.indices.retain(|t| t.iter().any(|&i| soup.positions[i as usize][1] < 13.0));
    assert_eq!(soup.indices.len(), 10);
    let volume = solid(&soup, unit_grid(16, 16, 16), Coverage::Exact);
    let report = volume.report().solid.clone().unwrap();
    assert_eq!((report.filled_cells, report.boundary_edges), (0, 4));
    assert!(report.leaks());
    let hole = report.hole.unwrap();
    assert!((hole.center - Vec3::new(8.0, 13.5, 8.0)).length() < 1e-4, "{hole:?}");
    assert!((hole.length - 44.0).abs() < 1e-3 && hole.edges == 4 && hole.edge.y == 13.5);
}

#[test]
fn a_crack_narrower_than_the_cells_does_not_leak() {
    let mut soup = cuboid(Vec3::splat(2.5), Vec3::splat(13.5));
    // The upper side a quarter of a cell too high.
    let lid =
        soup.indices.iter().position(|t| t.iter().all(|&i| soup.positions[i as usize][1] == 13.5)).unwrap();
    for triangle in lid..lid + 2 {
        for corner in soup.indices[triangle] {
            soup.positions[corner as usize][1] += 0.25;
        }
    }
    let report = solid(&soup, unit_grid(16, 16, 16), Coverage::Exact).report().solid.clone().unwrap();
    assert_eq!((report.boundary_edges, report.leaks()), (8, false));
    assert!(report.filled_cells > 500);
}
