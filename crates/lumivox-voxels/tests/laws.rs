//! What holds whatever the mesh: nothing depends on order, parts or threads, and closed surfaces keep in from out.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot go on has failed")]

mod common;

use common::{COVERAGES, Dice, Soup, cuboid, on_grid, sphere, unit_grid};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{UVec3, Vec3, Vec4};
use lumivox_core::{Bounds, Grid, TriangleView};
use lumivox_voxels::{
    Channel, Coverage, Format, GridSpec, Material, MaterialOf, MeshView, Model, Progress, Rule, SparseVolume,
    Stage, VoxelizeError, VoxelizeOptions, voxelize,
};

/// Every rule and format, with values that depend on where one looks.
fn channels() -> Vec<Channel> {
    let mut channels = vec![Channel::albedo(), Channel::normal(), Channel::emission(), Channel::area()];
    for rule in [Rule::Average, Rule::Sum, Rule::Maximum, Rule::Nearest] {
        let place = Channel::custom("place", 4, |s| (1e3 * s.position).extend(s.area).to_array());
        channels.push(place.named(&format!("{rule:?}")).rule(rule).format(Format::F32));
    }
    channels
}

/// Averages of what most triangles have one of, which are summed in a shorter way.
fn plain_channels() -> Vec<Channel> {
    let [albedo, normal] = [Channel::albedo(), Channel::normal()].map(|channel| channel.format(Format::F32));
    vec![albedo, Channel::emission(), normal]
}

fn full(model: &Model<'_>, grid: Grid, coverage: Coverage) -> SparseVolume {
    with(model, grid, coverage, channels())
}

fn with(model: &Model<'_>, grid: Grid, coverage: Coverage, channels: Vec<Channel>) -> SparseVolume {
    let grid = GridSpec::Grid(grid);
    voxelize(model, &VoxelizeOptions { grid, coverage, channels, ..VoxelizeOptions::default() }).unwrap()
}

fn assert_same_bits(a: &SparseVolume, b: &SparseVolume) {
    assert!(a.cells().eq(b.cells()));
    for (a, b) in a.channels().iter().zip(b.channels()) {
        assert_eq!(a.values().as_bytes(), b.values().as_bytes(), "{}", a.name());
    }
}

/// Large and small, many in one cell, all over bricks and beyond the grid.
fn soup() -> Soup {
    let mut dice = Dice(5);
    Soup::of((0..3000).map(|n| {
        let size = if n % 50 == 0 { 40.0 } else { 1.3 };
        let center = 34.0 * dice.point() - 1.0;
        [0; 3].map(|_| center + size * (dice.point() - 0.5))
    }))
}

#[test]
fn neither_order_nor_parts_nor_threads_change_a_bit() {
    let soup = soup();
    let grid = unit_grid(33, 31, 32);
    let cases = COVERAGES.into_iter().flat_map(|c| [(c, channels as fn() -> _), (c, plain_channels)]);
    for (coverage, channels) in cases {
        let full = |model: &Model<'_>, grid, coverage| with(model, grid, coverage, channels());
        let base = full(&Model::from(soup.view()), grid, coverage);
        assert!(base.len() > 1000);

        let mut shuffled = soup.clone();
        let mut dice = Dice(9);
        for n in (1..shuffled.indices.len()).rev() {
            shuffled.indices.swap(n, (dice.roll() * n as f32) as usize);
        }
        assert_same_bits(&base, &full(&Model::from(shuffled.view()), grid, coverage));

        let (first, second) = soup.indices.split_at(1234);
        let part = |indices| MeshView::new(TriangleView { positions: &soup.positions, indices });
        let split = Model { meshes: vec![part(second), part(&[]), part(first)], materials: Vec::new() };
        assert_same_bits(&base, &full(&split, grid, coverage));

        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let other = pool.install(|| full(&Model::from(soup.view()), grid, coverage));
            assert_same_bits(&base, &other);
        }
    }
}

/// Small triangles, as scans have them, are summed where their neighbours have been; and where they come in no order.
#[test]
fn the_order_of_a_fine_mesh_changes_no_bit() {
    let mut fine = sphere(20.3, 5);
    fine.positions.iter_mut().flatten().for_each(|x| *x += 24.6);
    let mut shuffled = fine.clone();
    let mut dice = Dice(11);
    for n in (1..shuffled.indices.len()).rev() {
        shuffled.indices.swap(n, (dice.roll() * n as f32) as usize);
    }
    for coverage in [Coverage::Exact, Coverage::Thin] {
        let run =
            |soup: &Soup| with(&Model::from(soup.view()), unit_grid(49, 50, 48), coverage, plain_channels());
        let base = run(&fine);
        assert!(base.len() > 4000);
        assert_same_bits(&base, &run(&shuffled));
    }
}

/// More triangles in one brick than a thread gets at a time.
#[test]
fn crowded_bricks_are_shared_without_changing_a_bit() {
    let mut dice = Dice(3);
    let soup = Soup::of((0..20_000).map(|_| {
        let center = 4.0 * dice.point();
        [0; 3].map(|_| center + 0.5 * dice.point())
    }));
    let (first, second) = soup.indices.split_at(3000);
    let part = |indices| MeshView::new(TriangleView { positions: &soup.positions, indices });
    let split = Model { meshes: vec![part(second), part(first)], materials: Vec::new() };
    for channels in [channels(), plain_channels()] {
        let full = |model| with(model, unit_grid(5, 5, 5), Coverage::Exact, channels.clone());
        assert_same_bits(&full(&Model::from(soup.view())), &full(&split));
    }
}

/// So much surface in one cell that sums do not fit in a word, for one mesh and for two, and in the long way.
#[test]
fn cells_full_of_surface_lose_none_of_it() {
    let mut dice = Dice(8);
    let soup = Soup::of((0..9_000).map(|n| {
        let up = if n % 3 == 0 { 0.1 } else { 0.9 };
        [[0.0, 0.0, 0.1], [0.9, 0.1, up], [0.1, 0.9, 0.1]]
            .map(|corner| Vec3::splat(2.05) + 0.9 * Vec3::from(corner) + 0.01 * dice.point())
    }));
    let (first, second) = soup.indices.split_at(7000);
    let part = |indices| MeshView::new(TriangleView { positions: &soup.positions, indices });
    let split = Model { meshes: vec![part(second), part(first)], materials: Vec::new() };
    let run = |model: &Model<'_>, channels| with(model, unit_grid(5, 5, 5), Coverage::Exact, channels);
    let volume = run(&Model::from(soup.view()), plain_channels());
    assert_eq!(volume.len(), 1);
    assert_same_bits(&volume, &run(&split, plain_channels()));
    let mut long = plain_channels();
    long.push(Channel::area());
    let long = run(&split, long);
    let cell = UVec3::splat(2);
    assert!(long.value("area", cell).unwrap().x > 2000.0);
    let apart = (volume.value("normal", cell).unwrap() - long.value("normal", cell).unwrap()).abs();
    assert!(apart.max_element() < 1e-5, "{apart}");
    assert_eq!(volume.value("albedo", cell), long.value("albedo", cell));
}

/// The short way of summing has the means of the long way, whatever the materials and however they are told.
#[test]
fn plain_channels_have_the_means_of_all_others() {
    let soup = soup();
    let color = |n: u32| Vec4::new(0.3 * n as f32, 1.0 / (1.0 + n as f32), 0.123, 1.0);
    let materials: Vec<Material<'_>> = (0..3)
        .map(|n| Material {
            base_color: color(n),
            emission: color(n).truncate() * 7.0,
            ..Material::default()
        })
        .collect();
    let numbers: Vec<u32> = (0..soup.indices.len() as u32).map(|n| n / 100 % 3).collect();
    let by_triangle = MeshView { material: MaterialOf::Triangle(&numbers), ..MeshView::new(soup.view()) };
    let parts: Vec<MeshView<'_>> = soup
        .indices
        .chunks(100)
        .enumerate()
        .map(|(n, indices)| MeshView {
            material: MaterialOf::Mesh(n % 3),
            ..MeshView::new(TriangleView { positions: &soup.positions, indices })
        })
        .collect();
    let grid = unit_grid(33, 31, 32);
    let backwards: Vec<[u32; 3]> = soup.indices.iter().rev().copied().collect();
    let numbers_backwards: Vec<u32> = numbers.iter().rev().copied().collect();
    let backwards = MeshView {
        material: MaterialOf::Triangle(&numbers_backwards),
        ..MeshView::new(TriangleView { positions: &soup.positions, indices: &backwards })
    };
    for coverage in COVERAGES {
        let [by_triangle, backwards, by_mesh] = [vec![by_triangle], vec![backwards], parts.clone()]
            .map(|meshes| Model { meshes, materials: materials.clone() });
        let plain = |model| with(model, grid, coverage, plain_channels());
        assert_same_bits(&plain(&by_triangle), &plain(&by_mesh));
        assert_same_bits(&plain(&by_triangle), &plain(&backwards));
        let mut long = plain_channels();
        long.push(Channel::area());
        let long = with(&by_triangle, grid, coverage, long);
        for model in [&by_triangle, &by_mesh] {
            let short = with(model, grid, coverage, plain_channels());
            assert!(short.cells().eq(long.cells()));
            for channel in ["albedo", "emission", "normal"] {
                for cell in long.cells() {
                    let (a, b) = (short.value(channel, cell).unwrap(), long.value(channel, cell).unwrap());
                    // Weights are whole numbers of 2^-22, and normals may cancel.
                    let size = if channel == "emission" { 7.0 } else { 1.0 };
                    let near = (a - b).abs().max_element() < 1e-3 * size;
                    let area = long.value("area", cell).unwrap().x;
                    assert!(near || area < 1e-3, "{coverage:?} {cell} {channel} {a} {b} {area}");
                }
            }
        }
    }
}

#[test]
fn channels_change_no_cell() {
    let soup = soup();
    let grid = unit_grid(33, 31, 32);
    for coverage in COVERAGES {
        let with = full(&Model::from(soup.view()), grid, coverage);
        assert!(with.cells().eq(on_grid(&soup, grid, coverage).cells()), "{coverage:?}");
    }
}

#[test]
fn lists_that_fit_only_slab_by_slab_change_nothing() {
    // With one thread, so that the sums of flat triangles that there is room for are always the same.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let voxelize =
        |model: &Model<'_>, options: &VoxelizeOptions<'_>| pool.install(|| voxelize(model, options));
    // Flat triangles go by larger cubes than others, and have shorter lists.
    for (channel, limit) in [(Channel::area(), 140_000), (Channel::albedo(), 100_000)] {
        let mut soup = soup();
        soup.positions.iter_mut().for_each(|p| p[2] += 16.0);
        let model = Model::from(soup.view());
        let binned = AtomicU64::new(0);
        let count = |progress: Progress| {
            if progress.stage == Stage::Binning {
                binned.fetch_add(1, Ordering::Relaxed);
            }
            ControlFlow::Continue(())
        };
        let mut options = VoxelizeOptions {
            grid: GridSpec::Grid(unit_grid(33, 31, 64)),
            channels: vec![channel],
            progress: Some(&count),
            ..VoxelizeOptions::default()
        };
        let all_at_once = voxelize(&model, &options).unwrap();
        let once = binned.swap(0, Ordering::Relaxed);
        options.memory_limit = limit;
        assert_same_bits(&all_at_once, &voxelize(&model, &options).unwrap());
        // Two halves at least, and what was given up.
        assert!(binned.load(Ordering::Relaxed) > 2 * once, "was it split at all with {limit}?");
        options.memory_limit = 20_000;
        let error = voxelize(&model, &options).unwrap_err();
        assert!(matches!(error, VoxelizeError::TooLarge { limit: 20_000, .. }), "{error}");
    }
}

#[test]
fn thin_and_sampled_lie_inside_exact() {
    for soup in [soup(), sphere(14.2, 4)] {
        let grid = unit_grid(33, 31, 32);
        let exact = on_grid(&soup, grid, Coverage::Exact);
        for coverage in [Coverage::Thin, Coverage::Sampled] {
            let inner = on_grid(&soup, grid, coverage);
            assert!(inner.cells().all(|cell| exact.contains(cell)), "{coverage:?}");
            assert!(!inner.is_empty() && inner.len() < exact.len());
        }
    }
}

/// Cells that are reached from a corner of the grid over free neighbours, `corners` through edges and corners too.
fn reached(volume: &SparseVolume, corners: bool) -> Vec<bool> {
    let grid = *volume.grid();
    let occupied = common::flags(volume);
    let mut reached = vec![false; occupied.len()];
    let mut waiting = vec![UVec3::ZERO];
    reached[0] = true;
    while let Some(cell) = waiting.pop() {
        for n in 0..27 {
            let step = glam::IVec3::new(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
            let next = cell.as_ivec3() + step;
            if (!corners && step.abs().element_sum() != 1)
                || next.cmplt(glam::IVec3::ZERO).any()
                || next.cmpge(grid.dims.as_ivec3()).any()
            {
                continue;
            }
            let index = grid.index(next.as_uvec3());
            if !occupied[index] && !reached[index] {
                reached[index] = true;
                waiting.push(next.as_uvec3());
            }
        }
    }
    reached
}

/// A point's depth inside a convex surface around the origin is positive.
fn assert_separates(what: &str, volume: &SparseVolume, corners: bool, is_inside: impl Fn(Vec3) -> bool) {
    let reached = reached(volume, corners);
    let mut inner = 0;
    for cell in volume.grid().cells().filter(|&cell| !volume.contains(cell)) {
        let inside = is_inside(volume.grid().center(cell));
        inner += usize::from(inside);
        assert_eq!(reached[volume.grid().index(cell)], !inside, "{what} {cell}");
    }
    assert!(inner > 20, "{what}: {inner} free cells inside");
}

#[test]
fn closed_surfaces_keep_in_from_out() {
    for n in [17, 32] {
        let grid = Grid::fit_with_margin(&Bounds::new(Vec3::splat(-1.0), Vec3::splat(1.0)), n).unwrap();
        // Faces, then faces, edges and corners; a fine mesh, and one of eight triangles through corners of cells.
        for (soup, level) in [(sphere(0.97, 4), 4), (sphere(0.9, 0), 0)] {
            let is_inside =
                |p: Vec3| if level == 0 { p.abs().element_sum() < 0.9 } else { p.length() < 0.97 };
            assert_separates("exact", &on_grid(&soup, grid, Coverage::Exact), true, is_inside);
            assert_separates("thin", &on_grid(&soup, grid, Coverage::Thin), false, is_inside);
        }
    }
}

/// The worst case for boundaries: faces, edges and corners of the surface all lie on those of cells.
#[test]
fn surfaces_through_corners_of_cells_have_no_cracks() {
    let grid = unit_grid(16, 16, 16);
    for (what, soup, is_inside) in [
        (
            "box",
            cuboid(Vec3::splat(4.0), Vec3::splat(11.0)),
            (|p: Vec3| (p - 7.5).abs().max_element() < 3.5) as fn(Vec3) -> bool,
        ),
        (
            "octahedron",
            {
                let mut soup = sphere(6.0, 0);
                soup.positions.iter_mut().for_each(|p| *p = (Vec3::from(*p) + 8.0).to_array());
                soup
            },
            |p: Vec3| (p - 8.0).abs().element_sum() < 6.0,
        ),
    ] {
        assert_separates(what, &on_grid(&soup, grid, Coverage::Exact), true, is_inside);
        assert_separates(what, &on_grid(&soup, grid, Coverage::Thin), false, is_inside);
    }
}

#[test]
fn cells_come_in_the_order_of_their_index_and_slots_fit_them() {
    let volume = full(&Model::from(soup().view()), unit_grid(33, 31, 32), Coverage::Exact);
    let grid = *volume.grid();
    let indices: Vec<usize> = volume.cells().map(|cell| grid.index(cell)).collect();
    assert!(indices.is_sorted_by(|a, b| a < b));
    assert_eq!(indices.len() as u64, volume.len());
    let mut slots: Vec<usize> = volume.entries().filter_map(|(_, slot)| slot).collect();
    assert!(volume.entries().all(|(cell, slot)| volume.slot(cell) == slot));
    slots.sort_unstable();
    assert!(slots.into_iter().eq(0..indices.len()));
    // The place of a surface point lies in its cell.
    for cell in volume.cells() {
        let place = volume.value("Average", cell).unwrap().truncate() / 1e3;
        assert!((place - grid.center(cell)).abs().max_element() < 0.5 + 1e-4, "{cell} {place}");
    }
    let dense = volume.to_dense(u64::MAX).unwrap();
    let occupancy = dense.channel("occupancy").unwrap();
    assert_eq!(occupancy.iter().filter(|v| v.x == 1.0).count() as u64, volume.len());
    let cell = volume.cells().nth(100).unwrap();
    assert_eq!(dense.channel("albedo").unwrap()[grid.index(cell)], volume.value("albedo", cell).unwrap());
    assert!(volume.to_dense(1000).unwrap_err().to_string().contains("1000"));
}

/// A volume comes back from full arrays as it was.
#[test]
fn full_arrays_become_the_same_volume() {
    let soup = soup();
    let channels = vec![Channel::albedo(), Channel::normal(), Channel::area()];
    let options = VoxelizeOptions {
        grid: GridSpec::Grid(unit_grid(33, 31, 20)),
        channels: channels.clone(),
        ..VoxelizeOptions::default()
    };
    let volume = voxelize(&Model::from(soup.view()), &options).unwrap();
    let dense = volume.to_dense(u64::MAX).unwrap();
    let occupied: Vec<bool> = dense.channel("occupancy").unwrap().iter().map(|v| v.x > 0.0).collect();
    let lists: Vec<(Channel, &[Vec4])> =
        channels.iter().map(|channel| (channel.clone(), dense.channel(channel.name()).unwrap())).collect();
    let back = SparseVolume::from_dense(*volume.grid(), &occupied, &lists).unwrap();
    assert_same_bits(&volume, &back);
    let error = SparseVolume::from_dense(*volume.grid(), &occupied[1..], &lists).unwrap_err();
    assert_eq!(error.to_string(), "there are 20459 values of occupancy where the grid has 20460 cells");
}
