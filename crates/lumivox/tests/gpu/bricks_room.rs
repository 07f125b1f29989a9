//! Volumes of bricks: windows that move, room that ends, and any channels.

use libtest_mimic::Failed;
use lumivox::core::{Grid, View};
use lumivox::glam::{IVec3, UVec2, UVec3, Vec2, Vec3, Vec4};
use lumivox::gpu::{Gpu, GpuError, Tier};
use lumivox::progressive::{
    AttributeChannel, AttributeKind, AttributeView, CHANNELS, InjectionPattern, ProgressiveVoxelizer,
    VoxelizerSettings,
};

use crate::bricks::{dense_channels, frame, settings, voxelizer};
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, views};
use crate::support::{SCALE, Shot, channel, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("bricks: a window that moves keeps what stays in it", moving_window),
    ("bricks: no room is counted, and room is given back", no_room),
    ("bricks: frames make nothing new once they have seen their views", makes_nothing),
    ("bricks: any channels, in any number", channels),
];

/// Cells of the world, with the channels they hold.
fn world_cells(gpu: &Gpu, volume: &ProgressiveVoxelizer) -> Result<Vec<(IVec3, Vec<Vec4>)>, GpuError> {
    let mut cells: Vec<_> = volume.read_cells(gpu)?.into_iter().map(|c| (c.cell, c.values)).collect();
    cells.sort_by_key(|(cell, _)| cell.to_array());
    Ok(cells)
}

/// A window of half the size goes round over the floor and comes back, while nothing is seen: then it is moved with everything seen.
fn moving_window(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let window = Grid { dims: UVec3::new(12, 16, 12), ..grid() };
    let make = || ProgressiveVoxelizer::new(gpu, window, &dense_channels(), settings());
    let up =
        View::orthographic(Vec3::new(0.0, 30.0, 0.0), Vec3::new(0.0, 40.0, 0.1), Vec3::X, Vec2::ONE, 10.0);
    let nothing = Shot::take(gpu, up, UVec2::splat(16), &[])?;
    let shot = Shot::take(gpu, views()[0].1, SIZE, &[FLOOR, BALL, CHEST])?;
    let half = 0.5 * window.dims.as_vec3() * window.cell_size;
    let mut moving = make()?;
    frame(gpu, &mut moving, &[&shot])?;
    let before = world_cells(gpu, &moving)?;
    assert!(before.len() > 60, "{} cells", before.len());
    // One brick along x and z: what stays is what lies in both windows.
    moving.follow(window.origin + half + Vec3::new(1.1, 0.0, 0.9));
    frame(gpu, &mut moving, &[&nothing])?;
    assert_eq!(moving.grid().origin, window.origin + Vec3::new(1.0, 0.0, 1.0));
    let stays = |cell: IVec3| cell.x >= 4 && cell.z >= 4;
    let expected: Vec<_> = before.iter().filter(|(cell, _)| stays(*cell)).cloned().collect();
    assert!(expected.len() > 20 && expected.len() < before.len());
    assert!(world_cells(gpu, &moving)? == expected, "what stays in the window is not kept");
    // Seen from the new place it is what a volume that was always there holds.
    let place = moving.grid();
    for (step, aside) in
        [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), Vec3::new(-3.0, 0.0, 2.0), Vec3::new(90.0, 0.0, 0.0)]
            .into_iter()
            .enumerate()
    {
        moving.follow(place.origin + half + aside);
        frame(gpu, &mut moving, &[&shot])?;
        let mut fixed = ProgressiveVoxelizer::new(gpu, moving.grid(), &dense_channels(), settings())?;
        frame(gpu, &mut fixed, &[&shot])?;
        let (one, other) = (moving.read_back(gpu)?, fixed.read_back(gpu)?);
        for name in CHANNELS {
            assert!(channel(&one, name) == channel(&other, name), "step {step}: {name}");
        }
    }
    assert_eq!(moving.read_cells(gpu)?.len(), 0, "a window far away is empty");
    Ok(())
}

fn no_room(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = Shot::take(gpu, views()[0].1, SIZE, &[FLOOR, BALL, CHEST])?;
    let undrawn = Shot::take(gpu, views()[0].1, SIZE, &[])?;
    for few in
        [VoxelizerSettings { bricks: 5, ..settings() }, VoxelizerSettings { bricks_in_view: 5, ..settings() }]
    {
        let mut bricks = voxelizer(gpu, few)?;
        for _ in 0..3 {
            let full = frame(gpu, &mut bricks, &[&shot])?;
            assert!(full.refused > 0 && full.occupied > 0, "{full:?}");
            assert!(full.bricks <= few.bricks);
        }
    }
    let mut bricks = voxelizer(gpu, VoxelizerSettings { bricks: 100, ..settings() })?;
    let mut found = Vec::new();
    for _ in 0..4 {
        found.push(frame(gpu, &mut bricks, &[&shot])?.occupied);
        // Everything is seen to be gone, whole cells of it: what reaches out of the picture stays.
        frame(gpu, &mut bricks, &[&undrawn])?;
    }
    assert!(found.iter().all(|n| *n == found[0]), "room is lost: {found:?}");
    Ok(())
}

fn makes_nothing(_: &Labs) -> Result<(), Failed> {
    let gpu = Gpu::new_blocking(&Default::default(), Tier::Core)?;
    let shot = Shot::take(&gpu, views()[0].1, SIZE, &[FLOOR])?;
    let mut bricks = voxelizer(&gpu, settings())?;
    let view = AttributeView::of(&gpu, "test view", &shot.input).with_pattern(InjectionPattern::Stippled, 3);
    let mut made = Vec::new();
    for _ in 0..6 {
        bricks.update(&gpu, &[]);
        view.update(&gpu, &shot.view, SCALE.attribute_points, bricks.frame());
        run(&gpu, |e| bricks.record(&gpu, e, &[&view]))?;
        made.push(gpu.created_objects());
    }
    assert!(made[1..].iter().all(|n| *n == made[0]), "{made:?}");
    Ok(())
}

fn channels(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = Shot::take(gpu, views()[0].1, SIZE, &[FLOOR, BALL])?;
    let textures = &shot.input.textures;
    for count in [1, 4, 8] {
        // The same picture again and again, first with a sign.
        let kinds = (0..count).map(|n| match n {
            0 => AttributeKind::Signed(2.0),
            1 => AttributeKind::Normal,
            _ => AttributeKind::Color(n as f32),
        });
        let channels: Vec<_> =
            kinds.enumerate().map(|(n, kind)| AttributeChannel::new(&format!("c{n}"), kind)).collect();
        let mut bricks = ProgressiveVoxelizer::new(gpu, grid(), &channels, settings())?;
        let pictures = (0..count).filter(|n| *n != 1).map(|n| match n {
            0 => textures.normal.clone(),
            _ => textures.albedo.clone(),
        });
        let view = AttributeView::new(
            gpu,
            "test view",
            textures.depth.clone(),
            textures.normal.clone(),
            pictures.collect(),
            SIZE,
        );
        bricks.update(gpu, &[]);
        view.update(gpu, &shot.view, SCALE.attribute_points, bricks.frame());
        run(gpu, |e| bricks.record(gpu, e, &[&view]))?;
        let cells = bricks.read_cells(gpu)?;
        assert!(cells.len() > 100, "{count} channels: {} cells", cells.len());
        for cell in &cells {
            assert_eq!(cell.values.len(), count);
            let near = |a: Vec4, b: Vec4| (a - b).truncate().abs().max_element() < 2e-3;
            if count > 1 {
                assert!(near(cell.values[0], cell.values[1]), "{cell:?}");
            }
            assert!(cell.values.iter().skip(3).all(|v| near(*v, cell.values[2])), "{cell:?}");
        }
    }
    assert!(ProgressiveVoxelizer::new(gpu, grid(), &[], settings()).is_err());
    let nine = vec![AttributeChannel::new("n", AttributeKind::Normal); 9];
    assert!(ProgressiveVoxelizer::new(gpu, grid(), &nine, settings()).is_err());
    Ok(())
}
