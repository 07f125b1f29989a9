//! Options, errors, progress, and input that nobody should have.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot go on has failed")]

mod common;

use std::ops::ControlFlow;
use std::sync::Mutex;

use common::{Dice, Soup, sphere, unit_grid};
use glam::{Mat4, UVec3, Vec3};
use lumivox_core::{Bounds, Grid, TriangleView};
use lumivox_voxels::{
    Channel, Coverage, GridSpec, MeshView, Model, Progress, Stage, VoxelizeError, VoxelizeOptions, voxelize,
};

#[test]
fn grids_are_chosen_by_resolution_cell_size_or_dims() {
    let bounds = Bounds::new(Vec3::ZERO, Vec3::new(2.0, 1.0, 0.5));
    let dims = |spec: GridSpec| spec.fit(&bounds).map(|grid| grid.dims);
    assert_eq!(dims(GridSpec::Resolution(8)), Ok(UVec3::new(8, 4, 2)));
    assert_eq!(dims(GridSpec::CellSize(0.25)), Ok(UVec3::new(8, 4, 2)));
    assert_eq!(dims(GridSpec::CellSize(0.3)), Ok(UVec3::new(7, 4, 2)));
    let wide = GridSpec::Dims(UVec3::new(5, 10, 10)).fit(&bounds).unwrap();
    assert_eq!((wide.dims, wide.cell_size), (UVec3::new(5, 10, 10), 0.4));
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-5] {
        let error = dims(GridSpec::CellSize(bad)).unwrap_err();
        assert!(matches!(error, VoxelizeError::CellSize { .. }), "{bad} {error}");
    }
    for bad in [UVec3::new(0, 1, 1), UVec3::new(1, 2049, 1)] {
        assert_eq!(dims(GridSpec::Dims(bad)), Err(VoxelizeError::Dims { dims: bad }));
    }
    assert!(matches!(dims(GridSpec::Resolution(4000)), Err(VoxelizeError::Grid(_))));
    let grid = Grid { cell_size: f32::NAN, ..unit_grid(2, 2, 2) };
    assert!(dims(GridSpec::Grid(grid)).is_err());
}

#[test]
fn nothing_to_voxelize_is_said_so() {
    let none = Model::default();
    assert_eq!(voxelize(&none, &VoxelizeOptions::default()).unwrap_err(), VoxelizeError::Empty);
    // A grid of one's own may well stay empty.
    let options = VoxelizeOptions { grid: GridSpec::Grid(unit_grid(3, 3, 3)), ..VoxelizeOptions::default() };
    assert!(voxelize(&none, &options).unwrap().is_empty());
    let point = Soup::of([[Vec3::ONE; 3]]);
    let error = voxelize(&Model::from(point.view()), &VoxelizeOptions::default()).unwrap_err();
    assert!(matches!(error, VoxelizeError::Grid(_)), "{error}");
}

#[test]
fn attributes_that_do_not_fit_are_refused() {
    let soup = sphere(1.0, 0);
    let mesh = MeshView { uvs: Some(&[[0.0; 2]; 3]), ..MeshView::new(soup.view()) };
    let model = Model { meshes: vec![MeshView::new(soup.view()), mesh], materials: vec![] };
    let error = voxelize(&model, &VoxelizeOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "mesh 1 has 3 texture coordinates where 24 are needed");
}

/// Whatever the numbers: no panic, no hang, and what is not finite is counted.
#[test]
fn wild_numbers_are_survived() {
    let mut dice = Dice(11);
    let wild =
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45, 0.0, -0.0];
    let positions: Vec<[f32; 3]> = (0..600)
        .map(|_| {
            [0; 3].map(|_| {
                if dice.roll() < 0.1 { wild[(dice.roll() * 8.99) as usize] } else { 9.0 * dice.roll() }
            })
        })
        .collect();
    let indices: Vec<[u32; 3]> = (0..2000)
        .map(|_| [0; 3].map(|_| if dice.roll() < 0.01 { u32::MAX } else { (dice.roll() * 600.0) as u32 }))
        .collect();
    let finite = |i: u32| positions.get(i as usize).is_some_and(|p| p.iter().all(|v| v.is_finite()));
    let sound = indices.iter().filter(|t| t.iter().all(|&i| finite(i))).count() as u64;
    for matrix in [
        Mat4::IDENTITY,
        Mat4::from_scale(Vec3::new(1e-20, 1.0, -1e20)),
        Mat4::ZERO,
        Mat4::from_scale(Vec3::splat(f32::NAN)),
    ] {
        let triangles = TriangleView { positions: &positions, indices: &indices };
        let mesh = MeshView { world_from_local: matrix, ..MeshView::new(triangles) };
        let model = Model { meshes: vec![mesh], materials: vec![] };
        for coverage in common::COVERAGES {
            let options = VoxelizeOptions {
                grid: GridSpec::Grid(unit_grid(9, 9, 9)),
                coverage,
                channels: vec![Channel::albedo(), Channel::normal(), Channel::area()],
                solid: true,
                ..VoxelizeOptions::default()
            };
            let volume = voxelize(&model, &options).unwrap();
            let report = volume.report();
            assert_eq!(report.triangles, 2000);
            if matrix == Mat4::IDENTITY {
                assert_eq!(report.skipped_triangles, 2000 - sound);
                assert!(!volume.is_empty());
            }
            for channel in volume.channels() {
                let range = channel.range();
                assert!((0..channel.values().len()).all(|n| channel.values().get(n, range).is_finite()));
            }
        }
        // Bounds that are not a box are an error and not a crash.
        let _ = voxelize(&model, &VoxelizeOptions::resolution(16));
    }
}

#[test]
fn snapping_heals_faces_that_miss_the_grid_by_rounding() {
    let box_of = |side: f32| common::cuboid(Vec3::splat(2.0 - 1e-4), Vec3::splat(side));
    let count = |soup: &Soup, snap: f64| {
        let grid = GridSpec::Grid(unit_grid(9, 9, 9));
        voxelize(&Model::from(soup.view()), &VoxelizeOptions { grid, snap, ..VoxelizeOptions::default() })
            .unwrap()
            .len()
    };
    assert_eq!(count(&box_of(6.0), 1e-3), 125 - 27);
    assert_eq!(count(&box_of(6.0), 0.0), 216 - 64);
}

#[test]
fn progress_reaches_its_end_and_break_cancels() {
    let soup = sphere(1.0, 5);
    let seen = Mutex::new(Vec::new());
    let note = |progress: Progress| {
        seen.lock().unwrap().push(progress);
        ControlFlow::Continue(())
    };
    let options = VoxelizeOptions { progress: Some(&note), solid: true, ..VoxelizeOptions::resolution(100) };
    voxelize(&Model::from(soup.view()), &options).unwrap();
    let seen = seen.lock().unwrap().clone();
    for stage in [Stage::Binning, Stage::Cells, Stage::Filling] {
        let of_stage: Vec<&Progress> = seen.iter().filter(|p| p.stage == stage).collect();
        assert!(of_stage.iter().all(|p| p.done <= p.total));
        assert!(of_stage.iter().any(|p| p.done == p.total), "{stage:?}");
    }
    for stage in [Stage::Binning, Stage::Cells, Stage::Filling] {
        let stop =
            |p: Progress| if p.stage == stage { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let options = VoxelizeOptions { progress: Some(&stop), ..options.clone() };
        assert_eq!(voxelize(&Model::from(soup.view()), &options).unwrap_err(), VoxelizeError::Cancelled);
    }
}

/// The papers' largest grid with a surface across it, in the memory that the surface needs.
#[test]
fn memory_follows_the_surface_and_not_the_box() {
    let soup = sphere(1.0, 2);
    let options = VoxelizeOptions {
        memory_limit: 256 << 20,
        coverage: Coverage::Thin,
        ..VoxelizeOptions::resolution(2048)
    };
    let volume = voxelize(&Model::from(soup.view()), &options).unwrap();
    assert!(volume.len() > 10_000_000);
    assert!(volume.bytes() < 32 << 20, "{}", volume.bytes());
}

/// What will not fit is refused before the work, with a size that does fit.
#[test]
fn too_much_is_refused_with_numbers_that_hold() {
    let soup = sphere(1.0, 4);
    let model = Model::from(soup.view());
    for (channels, solid) in
        [(vec![], false), (vec![Channel::albedo(), Channel::normal()], false), (vec![], true)]
    {
        let mut options = VoxelizeOptions {
            channels,
            solid,
            memory_limit: 8 << 20,
            progress: Some(&|_| panic!("work was begun")),
            ..VoxelizeOptions::resolution(1024)
        };
        let VoxelizeError::TooLarge { dims, needed, limit, largest } =
            voxelize(&model, &options).unwrap_err()
        else {
            panic!("refused for another reason");
        };
        assert_eq!((dims, limit), (UVec3::splat(1024), 8 << 20));
        let largest = largest.unwrap();
        assert!((200..1024).contains(&largest), "{largest}");
        (options.memory_limit, options.progress) = (u64::MAX, None);
        let truth = voxelize(&model, &options).unwrap().bytes() as f64;
        assert!((0.8..1.25).contains(&(needed as f64 / truth)), "{needed} {truth}");
        options.grid = GridSpec::Resolution(largest);
        let fitting = voxelize(&model, &options).unwrap().bytes() as f64 / f64::from(8 << 20);
        assert!((0.7..1.25).contains(&fitting), "{fitting}");
    }
}
