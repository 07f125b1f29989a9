//! Volumes of bricks: the same cells as cleanup and injection over all cells make, and what these do not have.

use libtest_mimic::Failed;
use lumivox::core::{Bounds, View};
use lumivox::glam::{IVec3, UVec2, Vec2, Vec3};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::progressive::{
    AttributeChannel, AttributeKind, AttributeView, CHANNELS, FrameDiagnostics, ProgressiveVoxelizer,
    VoxelizerSettings,
};

use crate::picture::Thing;
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, views};
use crate::support::{SCALE, Shot, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("bricks: what happened in a frame is counted", counted),
    ("bricks: views that only clean clean", cleaning_views),
    ("bricks: cleanup looks only into boxes where there are some", boxes),
    ("bricks: cells seldom seen die of age, others stay", age),
    ("bricks: cleanup in turns takes as many frames as it has turns", turns),
];

/// The channels of the dense form.
pub(crate) fn dense_channels() -> Vec<AttributeChannel> {
    let kinds = [AttributeKind::Normal, AttributeKind::Color(1.0), AttributeKind::Color(SCALE.radiance_max)];
    CHANNELS.iter().zip(kinds).map(|(name, kind)| AttributeChannel::new(name, kind)).collect()
}

pub(crate) fn settings() -> VoxelizerSettings {
    VoxelizerSettings { bricks: 1024, bricks_in_view: 1024, ..VoxelizerSettings::default() }
}

pub(crate) fn voxelizer(gpu: &Gpu, settings: VoxelizerSettings) -> Result<ProgressiveVoxelizer, GpuError> {
    ProgressiveVoxelizer::new(gpu, grid(), &dense_channels(), settings)
}

/// A frame of these views, those beyond `injecting` with their depth alone.
fn frame_of(
    gpu: &Gpu,
    volume: &mut ProgressiveVoxelizer,
    shots: &[&Shot],
    injecting: usize,
    changed: &[Bounds],
) -> Result<FrameDiagnostics, Failed> {
    volume.update(gpu, changed);
    let views: Vec<_> = shots
        .iter()
        .enumerate()
        .map(|(n, shot)| {
            let view = if n < injecting {
                AttributeView::of(gpu, "test view", &shot.input)
            } else {
                AttributeView::cleaning(gpu, "test depth", shot.input.textures.depth.clone())
            };
            view.update(gpu, &shot.view, SCALE.attribute_points, volume.frame());
            view
        })
        .collect();
    run(gpu, |e| volume.record(gpu, e, &views.iter().collect::<Vec<_>>()))?;
    Ok(volume.diagnostics(gpu, None)?)
}

pub(crate) fn frame(
    gpu: &Gpu,
    volume: &mut ProgressiveVoxelizer,
    shots: &[&Shot],
) -> Result<FrameDiagnostics, Failed> {
    frame_of(gpu, volume, shots, shots.len(), &[])
}

fn counted(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut bricks = voxelizer(gpu, settings())?;
    let view = views()[0].1;
    let [with, without] =
        [&[FLOOR, BALL][..], &[FLOOR]].map(|things: &[Thing]| Shot::take(gpu, view, SIZE, things));
    let (with, without) = (with?, without?);
    let first = frame(gpu, &mut bricks, &[&with])?;
    let cells = bricks.read_cells(gpu)?;
    assert!(first.occupied > 100 && first.occupied == first.injected && first.occupied == first.new);
    assert_eq!(first.occupied as usize, cells.len());
    assert_eq!((first.cleaned, first.died, first.left, first.refused), (0, 0, 0, 0));
    assert_eq!(first.entered, first.bricks);
    let again = frame(gpu, &mut bricks, &[&with])?;
    assert_eq!((again.occupied, again.new, again.cleaned, again.entered), (first.occupied, 0, 0, 0));
    assert!(bricks.read_cells(gpu)?.iter().all(|c| c.age == 0 && c.frames == 2));
    let gone = frame(gpu, &mut bricks, &[&without])?;
    assert!(gone.cleaned > 50 && gone.new > 0, "{gone:?}");
    assert_eq!(gone.occupied, again.occupied - gone.cleaned + gone.new);
    // Bricks that became empty are given back in the next frame.
    let after = frame(gpu, &mut bricks, &[&without])?;
    assert!(after.left > 0 && after.bricks < gone.bricks, "{after:?}");
    assert!(after.bytes > 0 && after.bytes < gone.bytes);
    Ok(())
}

fn cleaning_views(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut bricks = voxelizer(gpu, settings())?;
    let [front, above, _] = views().map(|(_, view)| view);
    let full = Shot::take(gpu, front, SIZE, &[FLOOR, BALL])?;
    let before = frame(gpu, &mut bricks, &[&full])?;
    let depth_alone = Shot::take(gpu, above, SIZE, &[FLOOR])?;
    let after = frame_of(gpu, &mut bricks, &[&depth_alone], 0, &[])?;
    assert!(after.cleaned > 50 && after.injected == 0, "{after:?}");
    assert_eq!(after.occupied, before.occupied - after.cleaned);
    Ok(())
}

fn boxes(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let view = views()[0].1;
    let [with, without] =
        [&[FLOOR, BALL, CHEST][..], &[FLOOR]].map(|t: &[Thing]| Shot::take(gpu, view, SIZE, t));
    let (with, without) = (with?, without?);
    let around_chest = Bounds::new(Vec3::new(-2.3, -1.6, -1.8), Vec3::new(-0.7, 0.2, -0.2));
    let far_away = Bounds::new(Vec3::splat(50.0), Vec3::splat(51.0));
    let cells_after = |changed: &[Bounds]| -> Result<_, Failed> {
        let mut bricks = voxelizer(gpu, settings())?;
        frame(gpu, &mut bricks, &[&with])?;
        let before: Vec<IVec3> = bricks.read_cells(gpu)?.into_iter().map(|c| c.cell).collect();
        frame_of(gpu, &mut bricks, &[&without], 0, changed)?;
        let after: Vec<IVec3> = bricks.read_cells(gpu)?.into_iter().map(|c| c.cell).collect();
        Ok(before.into_iter().filter(|c| !after.contains(c)).collect::<Vec<_>>())
    };
    let everywhere = cells_after(&[])?;
    let touches = |cell: &IVec3| {
        let low = grid().origin + grid().cell_size * cell.as_vec3();
        low.cmple(around_chest.max).all() && (low + grid().cell_size).cmpge(around_chest.min).all()
    };
    let mut expected: Vec<_> = everywhere.iter().copied().filter(touches).collect();
    let mut there = cells_after(&[around_chest, far_away])?;
    expected.sort_by_key(|c| c.to_array());
    there.sort_by_key(|c| c.to_array());
    assert!(expected.len() > 20 && expected.len() < everywhere.len());
    assert_eq!(there, expected);
    assert!(cells_after(&[far_away])?.is_empty());
    // More than fit become one around all.
    let many: Vec<_> = (0..100).map(|_| far_away).chain([around_chest]).collect();
    assert!(cells_after(&many)?.len() >= expected.len());
    Ok(())
}

fn age(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let view = views()[0].1;
    let aged = VoxelizerSettings { max_age: 4, confident: 3, ..settings() };
    let up =
        View::orthographic(Vec3::new(0.0, 30.0, 0.0), Vec3::new(0.0, 40.0, 0.1), Vec3::X, Vec2::ONE, 10.0);
    let nothing = Shot::take(gpu, up, UVec2::splat(16), &[])?;
    let [chest, ball] = [CHEST, BALL].map(|thing| Shot::take(gpu, view, SIZE, &[thing]));
    let (chest, ball) = (chest?, ball?);
    // The chest in three frames, the ball in one of them.
    let both = Shot::take(gpu, view, SIZE, &[CHEST, BALL])?;
    let mut bricks = voxelizer(gpu, aged)?;
    for shot in [&chest, &chest, &both] {
        frame(gpu, &mut bricks, &[shot])?;
    }
    let all = bricks.read_cells(gpu)?.len();
    let mut died = Vec::new();
    for _ in 0..8 {
        let cells = bricks.read_cells(gpu)?;
        let expected = cells.iter().filter(|c| c.age + 1 > aged.max_age && c.frames < aged.confident).count();
        let happened = frame(gpu, &mut bricks, &[&nothing])?;
        assert_eq!((happened.died as usize, happened.cleaned), (expected, 0));
        died.push(expected);
    }
    let left = bricks.read_cells(gpu)?;
    assert!(died[..3] == [0; 3] && died[4] > 30 && died[5..] == [0; 3], "{died:?}");
    assert!(left.len() > 30 && left.len() == all - died.iter().sum::<usize>());
    assert!(left.iter().all(|c| c.frames == 3 && c.age == 8), "cells seen in few frames are left");
    // Within boxes alone.
    let mut bricks = voxelizer(gpu, aged)?;
    let far_away = Bounds::new(Vec3::splat(50.0), Vec3::splat(51.0));
    frame(gpu, &mut bricks, &[&ball])?;
    for _ in 0..8 {
        assert_eq!(frame_of(gpu, &mut bricks, &[&nothing], 1, &[far_away])?.died, 0);
    }
    Ok(())
}

fn turns(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let view = views()[0].1;
    let [with, without] = [&[FLOOR, BALL][..], &[FLOOR]].map(|t: &[Thing]| Shot::take(gpu, view, SIZE, t));
    let (with, without) = (with?, without?);
    let cleaned = |turns: &dyn Fn(u32) -> f32| -> Result<Vec<u32>, Failed> {
        let mut bricks = voxelizer(gpu, settings())?;
        frame(gpu, &mut bricks, &[&with])?;
        (0..9)
            .map(|n| {
                bricks.set_turns(turns(n));
                Ok(frame_of(gpu, &mut bricks, &[&without], 0, &[])?.cleaned)
            })
            .collect()
    };
    let at_once = cleaned(&|_| 1.0)?;
    assert!(at_once[0] > 50 && at_once[1..].iter().all(|n| *n == 0), "{at_once:?}");
    let in_turns = cleaned(&|_| 4.0)?;
    assert_eq!(in_turns.iter().sum::<u32>(), at_once[0]);
    assert!(in_turns[..4].iter().all(|n| *n > 0) && in_turns[5..] == [0; 4], "{in_turns:?}");
    // Of a round that grows and shrinks, every brick has its turn once the shares add up to one.
    let changing = cleaned(&|n| [2.5, 7.0, 3.1][n as usize % 3])?;
    assert_eq!(changing.iter().sum::<u32>(), at_once[0]);
    assert!(changing[6..] == [0; 3] && changing[0] > changing[1], "{changing:?}");
    for strange in [0.0, -3.0, f32::NAN, f32::INFINITY] {
        assert_eq!(cleaned(&|_| strange)?[0], at_once[0], "{strange} turns");
    }
    Ok(())
}
