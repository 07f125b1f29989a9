//! Marked cells against the oracle, which asks every triangle about every cell in double precision.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot go on has failed")]

mod common;

use common::{Dice, Soup, against_oracle, assert_agrees, cuboid, on_grid, sphere, unit_grid};
use glam::{UVec3, Vec3};
use lumivox_core::{Bounds, Grid};
use lumivox_voxels::Coverage;

#[test]
fn one_triangle_at_every_tilt() {
    // All directions of a lattice, large and small, across borders of bricks.
    for n in 0..216 {
        let part = |n: u32| (n % 6) as f32 - 2.5;
        let normal = Vec3::new(part(n), part(n / 6), part(n / 36)).normalize_or_zero();
        let (u, v) = normal.any_orthonormal_pair();
        for size in [0.7, 3.0, 20.0] {
            let center = Vec3::new(9.17, 8.03, 7.91);
            let corners = [u * size, (v - u) * size, (-v - 0.3 * u) * size].map(|p| center + p);
            let soup = Soup::of([corners]);
            for coverage in common::COVERAGES {
                let d = against_oracle(&soup, unit_grid(18, 17, 16), coverage);
                assert!(d.is_equal_within_margin(), "{normal} {size} {coverage:?}: {d}");
            }
        }
    }
}

#[test]
fn soups_of_all_sizes_and_shapes() {
    let mut dice = Dice(1);
    for (what, count, size) in
        [("dust", 4000, 0.2), ("small", 800, 1.5), ("middle", 200, 6.0), ("large", 40, 60.0)]
    {
        let soup = Soup::of((0..count).map(|_| {
            let center = 24.0 * dice.point() - 1.0;
            [0; 3].map(|_| center + size * (dice.point() - 0.5))
        }));
        assert_agrees(what, &soup, unit_grid(23, 17, 22));
    }
}

#[test]
fn slivers_and_needles() {
    let mut dice = Dice(2);
    let soup = Soup::of((0..300).map(|_| {
        let (from, to) = (20.0 * dice.point(), 20.0 * dice.point());
        [from, to, from.lerp(to, 0.5) + 1e-3 * (dice.point() - 0.5)]
    }));
    assert_agrees("slivers", &soup, unit_grid(20, 20, 20));
}

#[test]
fn triangles_without_area_are_lines_and_points() {
    let (a, b) = (Vec3::new(1.3, 2.2, 3.4), Vec3::new(14.7, 9.1, 12.3));
    for triangle in [[a, b, a], [a, b, a.lerp(b, 0.3)], [b, b, b]] {
        let soup = Soup::of([triangle]);
        let grid = unit_grid(16, 16, 16);
        for coverage in [Coverage::Exact, Coverage::Thin] {
            let d = against_oracle(&soup, grid, coverage);
            assert!(d.is_equal_within_margin() && d.ours > 0, "{triangle:?} {coverage:?}: {d}");
        }
        assert!(on_grid(&soup, grid, Coverage::Sampled).is_empty());
    }
}

#[test]
fn one_triangle_across_the_whole_grid_and_beyond() {
    let corners = [[-400.0, -300.0, -200.0], [900.0, 100.0, 150.0], [-100.0, 700.0, 500.0]];
    assert_agrees("across", &Soup::of([corners.map(Vec3::from)]), unit_grid(90, 80, 100));
}

#[test]
fn closed_surfaces_on_fitted_grids() {
    for (n, level) in [(9, 1), (40, 3), (96, 5), (31, 6)] {
        let soup = sphere(1.37, level);
        let grid = Grid::fit(&Bounds::new(Vec3::splat(-1.37), Vec3::splat(1.37)), n).unwrap();
        assert_agrees(&format!("sphere {level} on {n}"), &soup, grid);
    }
    let soup = cuboid(Vec3::new(-0.31, 0.2, 0.7), Vec3::new(1.1, 0.93, 0.71));
    let grid = Grid::fit(&soup.view().bounds(), 50).unwrap();
    assert_agrees("flat box", &soup, grid);
}

#[test]
fn odd_cell_sizes_far_from_the_origin() {
    let mut soup = sphere(0.37, 4);
    soup.positions.iter_mut().for_each(|p| *p = (Vec3::from(*p) + Vec3::new(103.1, -57.3, 9.7)).to_array());
    let grid = Grid { cell_size: 0.013, origin: Vec3::new(102.7, -57.7, 9.3), dims: UVec3::new(61, 61, 61) };
    assert_agrees("far away", &soup, grid);
}

/// A wall on a cell boundary marks the cells above it alone, and on the grid's upper face the last cells.
#[test]
fn walls_on_cell_boundaries_mark_the_cells_above() {
    for axis in 0..3 {
        for (at, expected) in [(0.0, 0), (1.0, 1), (3.0, 3), (4.0, 3)] {
            let wall = [[-1.0, -1.0], [9.0, -1.0], [-1.0, 9.0]].map(|[p, q]| {
                let mut corner = Vec3::splat(at);
                corner[(axis + 1) % 3] = p;
                corner[(axis + 2) % 3] = q;
                corner
            });
            for coverage in common::COVERAGES {
                let volume = on_grid(&Soup::of([wall]), unit_grid(4, 4, 4), coverage);
                let layers: Vec<u32> = volume.cells().map(|cell| cell[axis]).collect();
                assert_eq!(layers, [expected; 16], "{axis} {at} {coverage:?}");
            }
        }
    }
}

/// A box of whole cells, on a grid fitted to it and on a larger one.
#[test]
fn a_box_of_four_cells_is_four_cells() {
    let soup = cuboid(Vec3::splat(0.1), Vec3::splat(0.5));
    let grid = Grid::fit(&soup.view().bounds(), 4).unwrap();
    for coverage in common::COVERAGES {
        assert_eq!(on_grid(&soup, grid, coverage).len(), 64 - 8, "{coverage:?}");
    }
    let volume = on_grid(&cuboid(Vec3::splat(2.0), Vec3::splat(6.0)), unit_grid(9, 9, 9), Coverage::Exact);
    assert_eq!(volume.len(), 125 - 27, "the upper faces belong to the cells above them");
}

/// A million cells a side would be lost in f32; corners a hundred thousand cells outside must not move the middle.
#[test]
fn far_corners_do_not_move_the_middle() {
    let far = 1e6;
    let corners = [Vec3::new(-far, 5.25, -far), Vec3::new(far, 5.25, -far), Vec3::new(0.0, 5.25, far)];
    let volume = on_grid(&Soup::of([corners]), unit_grid(12, 12, 12), Coverage::Exact);
    assert_eq!(volume.len(), 144);
    assert!(volume.cells().all(|cell| cell.y == 5));
}
