//! Injection against its definition, computed in double precision, cell by cell, and what vanishes.

use libtest_mimic::Failed;
use lumivox::core::{Grid, View};
use lumivox::glam::{DVec3, UVec2, UVec3, Vec2, Vec3, Vec4};
use lumivox::gpu::{Gpu, read_buffer};
use lumivox::progressive::{CellAges, InjectionPattern};
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};

use crate::definition::{Sums, defined_sums, defined_sums_of, is_taken};
use crate::picture::{Paint, Picture, Shape, Thing};
use crate::random_views::{ODD_SEEDS, RANDOM_SEEDS, random_grid, random_shot};
use crate::support::{SCALE, Shot, World, channel, is_mean};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("progressive: injection by random views is its definition", injection_by_random_views),
    ("progressive: injection fills what its definition fills", injection_is_its_definition),
    ("progressive: half the points inject half the picture", coarse_injection_is_its_definition),
    ("progressive: points in any order, split over frames, are the definition's", patterns),
    ("progressive: nothing is injected where no surface is", nothing_from_nothing),
    ("progressive: cells know for how many frames no view has shown them", ages),
    ("progressive: a removed object vanishes when its place is seen", removed_objects_vanish),
];

/// Not cubic, not a multiple of a workgroup along any axis, and with a corner that is no round number of cells.
pub(crate) fn grid() -> Grid {
    Grid { origin: Vec3::new(-3.0, -2.1, -2.5), cell_size: 0.25, dims: UVec3::new(24, 17, 20) }
}

fn floor_paint(p: DVec3) -> Paint {
    let stripe = 0.5 + 0.4 * (3.0 * p.x).sin();
    let lit = DVec3::new(1.0, 0.6 + 0.2 * p.x.cos(), stripe);
    Paint { albedo: DVec3::new(stripe, 0.3, 0.2), emission: DVec3::ZERO, radiance: lit }
}

fn ball_paint(p: DVec3) -> Paint {
    // Partly brighter than the scale represents.
    let glow = DVec3::new(2.0 + 3.0 * p.y.max(0.0), 0.5, 0.0);
    Paint { albedo: DVec3::new(0.1, 0.8, 0.5), emission: glow, radiance: DVec3::splat(0.25 + p.z.abs()) }
}

pub(crate) const FLOOR: Thing =
    Thing(Shape::Plane { point: DVec3::new(0.0, -1.37, 0.0), normal: DVec3::Y }, floor_paint);
pub(crate) const BALL: Thing =
    Thing(Shape::Sphere { center: DVec3::new(0.4, 0.3, -0.3), radius: 0.9 }, ball_paint);
pub(crate) const CHEST: Thing = Thing(
    Shape::Box { min: DVec3::new(-2.03, -1.37, -1.51), max: DVec3::new(-0.94, -0.11, -0.42) },
    floor_paint,
);

/// Perspective, orthographic and reversed depth, all from different sides.
pub(crate) fn views() -> [(&'static str, View); 3] {
    let target = Vec3::new(0.0, -0.4, 0.0);
    let perspective = |eye| View::perspective(eye, target, Vec3::Y, 0.9, 1.25, 0.5, 9.0);
    let eye = Vec3::new(-2.0, 4.0, 1.0);
    [
        ("perspective", perspective(Vec3::new(2.5, 2.2, 4.5))),
        ("orthographic", View::orthographic(eye, target, Vec3::Y, Vec2::new(6.0, 5.0), 9.0)),
        ("reversed", perspective(Vec3::new(-3.5, 1.7, -3.9)).with_reversed_depth()),
    ]
}

pub(crate) const SIZE: UVec2 = UVec2::new(80, 64);

/// Cells that hold samples, and those of them with a sample on their border.
fn check_injection(
    gpu: &Gpu,
    world: &World,
    shots: &[&Shot],
    stride: u32,
    name: &str,
) -> Result<[u64; 2], Failed> {
    check_sums(gpu, world, &defined_sums(shots, world.volume.grid(), stride), name)
}

fn check_sums(gpu: &Gpu, world: &World, defined: &[Sums], name: &str) -> Result<[u64; 2], Failed> {
    let [step, light_step] =
        [SCALE.attribute_points, SCALE.light_points].map(|n| f64::from(n) / 2f64.powi(30));
    let [emission_step, light_step] = [step, light_step].map(|step| step * f64::from(SCALE.radiance_max));
    let (volume, light) = (world.read(gpu)?, world.light.read_back(gpu)?);
    let stored = [NORMAL, ALBEDO, EMISSION].map(|name| channel(&volume, name));
    let (mut occupied, mut uncertain) = (0, 0);
    for (index, sums) in defined.iter().enumerate() {
        let cell = world.volume.grid().cell(index);
        let holds = stored[0][index].w;
        if sums.count == 0.0 && !sums.uncertain {
            let all_zero = stored.iter().all(|c| c[index] == Vec4::ZERO);
            assert!(all_zero && light[index] == [Vec4::ZERO; 3], "{name}, {cell}: something from nothing");
            continue;
        }
        occupied += 1;
        if sums.count > 0.0 {
            assert_eq!(holds, 1.0, "{name}, {cell}: {} samples and not occupied", sums.count);
        }
        if sums.uncertain {
            uncertain += 1;
            continue;
        }
        for (i, step) in [step, step, emission_step].into_iter().enumerate() {
            let mean = sums.attributes[i] / sums.count;
            let got = stored[i][index];
            let equal = (0..3).all(|a| is_mean(got[a], mean[a], step));
            assert!(equal, "{name}, {cell}: channel {i} is {got}, should be {mean}");
        }
        for (band, (got, sum)) in light[index].into_iter().zip(sums.light).enumerate() {
            let mean = sum / sums.count;
            let equal = (0..4).all(|c| is_mean(got[c], mean[c], light_step));
            assert!(equal, "{name}, {cell}: light {band} is {got}, should be {mean}");
        }
    }
    eprintln!("injection, {name}: {occupied} cells, {uncertain} of them with a sample on their border");
    Ok([occupied, uncertain])
}

fn assert_few_uncertain([occupied, uncertain]: [u64; 2]) {
    assert!(uncertain * 20 < occupied, "{uncertain} of {occupied} cells are too close to call");
}

fn injection_is_its_definition(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for (name, view) in views() {
        let shot = Shot::take(gpu, view, SIZE, &[FLOOR, BALL, CHEST])?;
        let mut world = World::new(&labs.core, grid())?;
        world.inject(gpu, &[], Some(&shot))?;
        let counts = check_injection(gpu, &world, &[&shot], 1, name)?;
        assert!(counts[0] > 100, "{name} shows too little");
        assert_few_uncertain(counts);
    }
    Ok(())
}

fn injection_by_random_views(labs: &Labs) -> Result<(), Failed> {
    let (gpu, mut all) = (&labs.core.gpu, [0; 2]);
    for seed in RANDOM_SEEDS.chain(ODD_SEEDS) {
        let grid = random_grid(seed);
        let (name, shot) = random_shot(gpu, &grid, seed)?;
        let mut world = World::new(&labs.core, grid)?;
        world.inject(gpu, &[], Some(&shot))?;
        let counts = check_injection(gpu, &world, &[&shot], 1, &name)?;
        all = std::array::from_fn(|i| all[i] + counts[i]);
    }
    assert!(all[0] > 5_000, "the views show too little: {} cells", all[0]);
    assert_few_uncertain(all);
    Ok(())
}

fn coarse_injection_is_its_definition(labs: &Labs) -> Result<(), Failed> {
    let (gpu, view) = (&labs.core.gpu, views()[0].1);
    let picture = Picture::take(&view, SIZE, &[FLOOR, BALL, CHEST]);
    let shot = Shot::of(gpu, view, picture, SIZE / 2)?;
    let mut world = World::new(&labs.core, grid())?;
    world.inject(gpu, &[&shot], None)?;
    let counts = check_injection(gpu, &world, &[&shot], 2, "every other texel")?;
    assert!(counts[0] > 100, "every other texel shows too little");
    assert_few_uncertain(counts);
    Ok(())
}

fn patterns(labs: &Labs) -> Result<(), Failed> {
    let (gpu, view) = (&labs.core.gpu, views()[0].1);
    // Neither side is a multiple of a block.
    let size = UVec2::new(75, 61);
    for pattern in [InjectionPattern::Linear, InjectionPattern::Block, InjectionPattern::Stippled] {
        for split in [1, 2, 5] {
            let mut shot = Shot::take(gpu, view, size, &[FLOOR, BALL, CHEST])?;
            shot.input = shot.input.with_pattern(pattern, split);
            let mut taken = 0;
            for frame in split..2 * split {
                shot.input.update_frame(gpu, &view, SCALE, frame);
                let mut world = World::new(&labs.core, grid())?;
                world.inject(gpu, &[], Some(&shot))?;
                let takes = |point: UVec2| is_taken((pattern, split, frame), size, point);
                let defined = defined_sums_of(&[&shot], &grid(), 1, &takes);
                let name = format!("{pattern:?}, frame {frame} of a split in {split}");
                check_sums(gpu, &world, &defined, &name)?;
                taken += defined.iter().map(|sums| sums.count as u32).sum::<u32>();
            }
            let all: u32 = defined_sums(&[&shot], &grid(), 1).iter().map(|sums| sums.count as u32).sum();
            assert!(all > 1_000, "{pattern:?} shows too little");
            assert_eq!(taken, all, "{pattern:?}: {split} frames take every point once");
        }
    }
    Ok(())
}

fn nothing_from_nothing(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for (name, view) in views() {
        let undrawn = Shot::take(gpu, view, SIZE, &[])?;
        let mut blank = Picture::take(&view, SIZE, &[FLOOR, BALL]);
        blank.normal.fill(Default::default());
        let without_normal = Shot::of(gpu, view, blank, SIZE)?;
        let mut world = World::new(&labs.core, grid())?;
        world.inject(gpu, &[&undrawn, &without_normal], Some(&undrawn))?;
        let volume = world.read(gpu)?;
        for channel_name in [NORMAL, ALBEDO, EMISSION] {
            assert!(channel(&volume, channel_name).iter().all(|v| *v == Vec4::ZERO), "{name}");
        }
        assert!(world.light.read_back(gpu)?.iter().all(|v| *v == [Vec4::ZERO; 3]), "{name}");
    }
    Ok(())
}

pub(crate) fn occupied_cells(gpu: &Gpu, world: &World) -> Result<Vec<bool>, Failed> {
    Ok(channel(&world.read(gpu)?, NORMAL).iter().map(|v| v.w > 0.0).collect())
}

fn removed_objects_vanish(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for (name, view) in views() {
        let with = Shot::take(gpu, view, SIZE, &[FLOOR, BALL])?;
        let without = Shot::take(gpu, view, SIZE, &[FLOOR])?;
        // Looks down on the corner of the floor where the ball never was.
        let eye = Vec3::new(-2.4, 3.0, 1.8);
        let aside = View::orthographic(eye, eye - Vec3::Y, Vec3::Z, Vec2::splat(1.0), 6.0);
        let aside = Shot::take(gpu, aside, SIZE, &[FLOOR])?;

        let mut world = World::new(&labs.core, grid())?;
        world.inject(gpu, &[], Some(&with))?;
        let first = world.read(gpu)?;
        let ball: Vec<usize> = (0..grid().cell_count() as usize)
            .filter(|i| grid().center(grid().cell(*i)).y > -0.7 && channel(&first, NORMAL)[*i].w > 0.0)
            .collect();
        assert!(ball.len() > 50, "{name}: the ball fills only {} cells", ball.len());

        for _ in 0..3 {
            world.clean(gpu, &aside)?;
            world.inject(gpu, &[], Some(&aside))?;
        }
        let unseen = world.read(gpu)?;
        for channel_name in [NORMAL, ALBEDO, EMISSION] {
            let same = |i: &usize| channel(&first, channel_name)[*i] == channel(&unseen, channel_name)[*i];
            assert!(ball.iter().all(same), "{name}: an unseen cell changed");
        }

        world.clean(gpu, &without)?;
        world.inject(gpu, &[], Some(&without))?;
        let left = occupied_cells(gpu, &world)?;
        let left = ball.iter().filter(|i| left[**i]).count();
        assert_eq!(left, 0, "{name}: cells of the ball are left of {}", ball.len());
    }
    Ok(())
}

/// Floor and ball, nothing at all, the floor alone, and the ball proven gone.
fn ages(labs: &Labs) -> Result<(), Failed> {
    let lab = &labs.core;
    let gpu = &lab.gpu;
    let view = views()[0].1;
    let shot = |things: &[Thing]| Shot::take(gpu, view, SIZE, things);
    let (all, none, floor) = (shot(&[FLOOR, BALL])?, shot(&[])?, shot(&[FLOOR])?);
    let occupied = |world: &World| -> Result<Vec<bool>, Failed> {
        Ok(channel(&world.read(gpu)?, NORMAL).iter().map(|n| n.w > 0.0).collect())
    };
    let mut alone = World::new(lab, grid())?;
    alone.inject(gpu, &[], Some(&floor))?;
    let of_floor = occupied(&alone)?;
    let mut world = World::new(lab, grid())?;
    let mut ages = CellAges::new(gpu, &world.volume)?;
    let mut unseen_in = [0; 3];
    for (n, shot) in [&all, &none, &floor].into_iter().enumerate() {
        world.inject_with(gpu, |stages, e, volume, light| {
            stages.record_camera(gpu, e, &shot.input, volume, light)?;
            stages.record_end(gpu, e, &shot.input, volume, light)?;
            ages.record(gpu, e, stages, volume)
        })?;
        let found: Vec<u32> = read_buffer(gpu, ages.ages())?;
        for ((age, is_there), is_floor) in found.iter().zip(occupied(&world)?).zip(&of_floor) {
            let expected = match n {
                _ if !is_there => 0,
                2 if *is_floor => 1,
                n => n as u32 + 1,
            };
            assert_eq!(*age, expected, "frame {n}");
            unseen_in[n] += u32::from(expected > 1);
        }
    }
    assert!(unseen_in[0] == 0 && unseen_in[1] > 200 && unseen_in[2] > 50, "{unseen_in:?}");
    let before = occupied(&world)?;
    world.clean(gpu, &floor)?;
    world.inject_with(gpu, |stages, e, volume, _| ages.record(gpu, e, stages, volume))?;
    let found: Vec<u32> = read_buffer(gpu, ages.ages())?;
    let left = occupied(&world)?;
    assert!(found.iter().zip(&left).all(|(age, is_there)| (*age > 0) == *is_there));
    let count = |cells: &[bool]| cells.iter().filter(|is_there| **is_there).count();
    assert!(count(&left) + 50 < count(&before), "{} of {}", count(&left), count(&before));
    Ok(())
}
