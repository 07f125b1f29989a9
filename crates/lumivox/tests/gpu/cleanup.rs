//! Cleanup by every rule against its definition, computed in double precision, cell by cell.

use libtest_mimic::Failed;
use lumivox::core::Grid;
use lumivox::glam::{Mat4, UVec2, UVec3, Vec3, Vec4};
use lumivox::progressive::{CHANNELS, CleanupRule};
use lumivox::volume::NORMAL;

use crate::definition::{proven_empty, proven_empty_by_rays, proven_empty_whole};
use crate::picture::Thing;
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, occupied_cells, views};
use crate::random_views::{ODD_SEEDS, RANDOM_SEEDS, random_grid, random_shot};
use crate::support::{Lab, Shot, World, channel};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("progressive: cleanup clears what its definition clears", cleanup_is_its_definition),
    ("progressive: cleanup by random views is its definition", cleanup_by_random_views),
    ("progressive: cleanup of cells that cover many texels is its definition", cleanup_of_wide_cells),
    ("progressive: by footprint and by rays no view clears a cell that it injects into", footprint_holds),
    ("progressive: rays clear what is left on a floor, and footprints do not", rays_clear_beside_floors),
];

const RULES: [CleanupRule; 3] = [CleanupRule::Center, CleanupRule::Footprint, CleanupRule::Rays];

fn defined(rule: CleanupRule, shot: &Shot, grid: &Grid, cell: UVec3) -> Option<bool> {
    match rule {
        CleanupRule::Center => proven_empty(shot, grid, cell),
        CleanupRule::Footprint => proven_empty_whole(shot, grid, cell),
        CleanupRule::Rays => proven_empty_by_rays(shot, grid, cell),
    }
}

/// Cells that cleanup cleared, kept, and whose verdict is too close to call.
fn check_cleanup(
    lab: &Lab,
    grid: Grid,
    shot: &Shot,
    rule: CleanupRule,
    name: &str,
) -> Result<[u64; 3], Failed> {
    let mut world = World::new(lab, grid)?;
    world.scatter(&lab.gpu, 7)?;
    let before = world.read(&lab.gpu)?;
    world.clean_by(&lab.gpu, rule, shot)?;
    let after = world.read(&lab.gpu)?;
    let [mut cleared, mut kept, mut close] = [0; 3];
    for (index, cell) in grid.cells().enumerate() {
        let Some(empty) = defined(rule, shot, &grid, cell) else {
            close += 1;
            continue;
        };
        for channel_name in CHANNELS {
            let was = channel(&before, channel_name)[index];
            let expected = if empty { Vec4::ZERO } else { was };
            assert_eq!(channel(&after, channel_name)[index], expected, "{rule:?}, {name}, {cell}");
        }
        if channel(&before, NORMAL)[index].w > 0.0 {
            *(if empty { &mut cleared } else { &mut kept }) += 1;
        }
    }
    eprintln!("cleanup, {rule:?}, {name}: {cleared} cleared, {kept} kept, {close} too close to call");
    assert!(close * 100 < grid.cell_count(), "{name}: {close} cells are too close to call");
    Ok([cleared, kept, close])
}

fn cleanup_is_its_definition(labs: &Labs) -> Result<(), Failed> {
    let lab = &labs.core;
    for ((name, view), rule) in views().into_iter().flat_map(|view| RULES.map(|rule| (view, rule))) {
        let shot = Shot::take(&lab.gpu, view, SIZE, &[FLOOR, BALL, CHEST])?;
        let [cleared, kept, _] = check_cleanup(lab, grid(), &shot, rule, name)?;
        assert!(cleared > 100 && kept > 100, "{name} shows too little: {cleared} cleared, {kept} kept");
    }
    Ok(())
}

fn cleanup_by_random_views(labs: &Labs) -> Result<(), Failed> {
    for rule in RULES {
        let mut all = [0; 3];
        for seed in RANDOM_SEEDS.chain(ODD_SEEDS) {
            let grid = random_grid(seed);
            let (name, shot) = random_shot(&labs.core.gpu, &grid, seed)?;
            let counts = check_cleanup(&labs.core, grid, &shot, rule, &name)?;
            all = std::array::from_fn(|i| all[i] + counts[i]);
        }
        eprintln!("cleanup by random views, {rule:?}: cleared, kept, too close to call {all:?}");
        assert!(all[0] > 10_000 && all[1] > 10_000, "the views show too little: {all:?}");
        assert!(all[2] * 1000 < all[0] + all[1], "too many cells are too close to call: {all:?}");
    }
    Ok(())
}

/// Wide footprints: cells that cover a hundred texels and more, which are looked up in blocks.
fn cleanup_of_wide_cells(labs: &Labs) -> Result<(), Failed> {
    let (gpu, mut all) = (&labs.core.gpu, [0; 3]);
    for (number, (name, view)) in views().into_iter().enumerate() {
        // The same view through a window that is eight times as narrow, and moved aside.
        let aside = Vec3::new(1.5 - number as f32, 2.0 * number as f32 - 2.0, 0.0);
        let mut near = view;
        near.clip_from_world =
            Mat4::from_translation(aside) * Mat4::from_scale(Vec3::new(8.0, 8.0, 1.0)) * view.clip_from_world;
        for things in [vec![FLOOR, BALL, CHEST], vec![CHEST], Vec::new()] {
            let shot = Shot::take(gpu, near, UVec2::new(251, 190), &things)?;
            for rule in [CleanupRule::Footprint, CleanupRule::Rays] {
                let counts = check_cleanup(&labs.core, grid(), &shot, rule, name)?;
                all = std::array::from_fn(|i| all[i] + counts[i]);
            }
        }
    }
    eprintln!("cleanup of wide cells: cleared, kept, too close to call {all:?}");
    assert!(all[0] > 100, "the views show too little: {all:?}");
    assert!(all[2] * 1000 < all[0] + all[1], "too many cells are too close to call: {all:?}");
    Ok(())
}

/// Cells that stand on a floor which passes through the cells below them.
fn rays_clear_beside_floors(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let view = views()[0].1;
    let [with, without] = [&[FLOOR, CHEST][..], &[FLOOR]].map(|t: &[Thing]| Shot::take(gpu, view, SIZE, t));
    let (with, without) = (with?, without?);
    let mut left = Vec::new();
    for rule in RULES {
        let mut world = World::new(&labs.core, grid())?;
        world.inject(gpu, &[], Some(&with))?;
        world.clean_by(gpu, rule, &without)?;
        // The floor lies in the layer of number 2.
        let cells = occupied_cells(gpu, &world)?;
        left.push(grid().cells().filter(|c| c.y > 2 && cells[grid().index(*c)]).count());
    }
    eprintln!("of a chest that is gone, by center, by footprint and by rays: {left:?} cells are left");
    assert!(left[1] > 5 && left[0] == 0 && left[2] == 0, "{left:?} cells are left");
    Ok(())
}

/// What a view injects it does not clear, nor does any other of the same things that sees it with as many points.
fn footprint_holds(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut lost = [0; 3];
    let mut found = 0;
    for seed in RANDOM_SEEDS.chain(ODD_SEEDS) {
        let (name, shot) = random_shot(gpu, &grid(), seed)?;
        for (rule, lost) in RULES.into_iter().zip(&mut lost) {
            let mut world = World::new(&labs.core, grid())?;
            world.inject(gpu, &[], Some(&shot))?;
            let before = occupied_cells(gpu, &world)?;
            world.clean_by(gpu, rule, &shot)?;
            let after = occupied_cells(gpu, &world)?;
            let gone = before.iter().zip(&after).filter(|(b, a)| **b && !**a).count();
            assert!(rule == CleanupRule::Center || gone == 0, "{name}: {gone} cells of its own are gone");
            *lost += gone;
            found += before.iter().filter(|b| **b).count() / RULES.len();
        }
    }
    eprintln!("of {found} cells their own views clear, by center, by footprint and by rays, {lost:?}");
    assert!(lost[0] > 500, "the views are too easy: center loses {} cells", lost[0]);
    Ok(())
}
