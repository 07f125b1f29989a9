//! The papers' rule of light, stored until a view samples the cell again, against its definition in double precision, and
//! beside light that is pulled.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{DVec3, UVec2, Vec2, Vec3, Vec4};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::progressive::{CleanupRule, LightRule, Progressive, Rules, SinglePass};

use crate::definition::{Sums, defined_sums};
use crate::picture::{Paint, Picture, Shape, Thing};
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, occupied_cells, views};
use crate::random_views::{ODD_SEEDS, RANDOM_SEEDS, random_shot};
use crate::support::{SCALE, Shot, World, is_mean, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("stored light: of random views, is its definition frame after frame", is_defined),
    ("stored light: outlives its lamp where no view looks, as pulled light does not", stale_light),
    ("stored light: goes with its cell", goes_with_cells),
    ("stored light: more points are the same light, and on a whole cell that of means", points),
    ("stored light: the single pass keeps what it does not see", single_pass),
];

type Light = Vec<[Vec4; 3]>;

const STORED: Rules = Rules { cleanup: CleanupRule::Footprint, light: LightRule::Stored };
/// Fixed-point step of a sum by area.
const STEP: f64 = SCALE.radiance_max as f64 / (1u32 << 25) as f64;

/// A frame: cleanup by all views, then lamps and camera. Returns which cells cleanup has left.
fn frame(
    gpu: &Gpu,
    (world, stages): (&mut World, &mut Progressive),
    lamps: &[&Shot],
    camera: Option<&Shot>,
) -> Result<Vec<bool>, Failed> {
    let all: Vec<&Shot> = lamps.iter().copied().chain(camera).collect();
    let World { volume, .. } = &mut *world;
    run(gpu, |e| all.iter().try_for_each(|shot| stages.record_cleanup(gpu, e, &shot.input, volume)))?;
    let left = occupied_cells(gpu, world)?;
    let World { volume, light, .. } = &mut *world;
    run(gpu, |e| {
        stages.record_begin(e, light);
        for lamp in lamps {
            stages.record_light(gpu, e, [&lamp.input], volume, light)?;
        }
        if let Some(camera) = camera {
            stages.record_camera(gpu, e, &camera.input, volume, light)?;
        }
        match all.first() {
            Some(any) => stages.record_end(gpu, e, &any.input, volume, light),
            None => Ok(()),
        }
    })?;
    Ok(left)
}

fn is_dark(light: &[Vec4; 3]) -> bool {
    *light == [Vec4::ZERO; 3]
}

/// Where the light of a cell comes from in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Origin {
    Camera,
    Lamps,
    Kept,
    Gone,
}

fn is_defined(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shots: Vec<_> = RANDOM_SEEDS
        .chain(ODD_SEEDS)
        .map(|seed| random_shot(gpu, &grid(), seed))
        .collect::<Result<_, _>>()?;
    let mut world = World::new(&labs.core, grid())?;
    let mut stages = Progressive::with_rules(gpu, &world.volume, STORED)?;
    world.scatter(gpu, 3)?;
    let mut counts = [0; 4];
    let (mut unsure, mut worst) = (0, 0f64);
    // Two lamps and a camera; every fourth frame has one lamp and no camera.
    for (number, views) in shots.chunks_exact(3).enumerate() {
        let [one, two, camera] = [0, 1, 2].map(|n| &views[n].1);
        let (lamps, camera) =
            if number % 4 == 3 { (vec![one], None) } else { (vec![one, two], Some(camera)) };
        let before = world.light.read_back(gpu)?;
        let left = frame(gpu, (&mut world, &mut stages), &lamps, camera)?;
        let after = world.light.read_back(gpu)?;
        let of_lamps: Vec<Vec<Sums>> = lamps.iter().map(|lamp| defined_sums(&[lamp], &grid(), 1)).collect();
        let of_camera = camera.map(|camera| defined_sums(&[camera], &grid(), 1));
        for (index, now) in after.iter().enumerate() {
            let lamps: Vec<&Sums> = of_lamps.iter().map(|sums| &sums[index]).collect();
            let camera = of_camera.as_ref().map(|sums| &sums[index]);
            if lamps.iter().copied().chain(camera).any(|sums| sums.uncertain) {
                unsure += 1;
                continue;
            }
            let camera = camera.filter(|sums| sums.count > 0.0);
            let origin = match camera {
                Some(_) => Origin::Camera,
                None if lamps.iter().any(|sums| sums.count > 0.0) => Origin::Lamps,
                None if left[index] => Origin::Kept,
                None => Origin::Gone,
            };
            counts[origin as usize] += usize::from(origin != Origin::Gone || !is_dark(&before[index]));
            for (band, now) in now.iter().enumerate() {
                for c in 0..4 {
                    let summed: f64 = lamps.iter().map(|sums| sums.light_by_area[band][c]).sum();
                    let samples: f64 = lamps.iter().map(|sums| sums.count).sum();
                    let sizes: f64 = lamps.iter().map(|sums| sums.light_by_area[band][0].abs()).sum();
                    let right = match (origin, camera) {
                        (Origin::Camera, Some(sums)) => {
                            let step = f64::from(SCALE.light_points) / 2f64.powi(30);
                            let step = step * f64::from(SCALE.radiance_max);
                            is_mean(now[c], sums.light[band][c] / sums.count, step)
                        }
                        (Origin::Lamps, _) => {
                            let off = (f64::from(now[c]) - summed).abs();
                            // Half a step a sample, and two conversions to half floats, which may truncate.
                            let rounded = 0.5 * STEP * samples + 2.0 * sizes / 1024.0;
                            worst = worst.max(off / rounded);
                            off <= rounded + 1e-7
                        }
                        (Origin::Kept, _) => now[c].to_bits() == before[index][band][c].to_bits(),
                        _ => now[c].to_bits() == 0,
                    };
                    let cell = grid().cell(index);
                    assert!(right, "frame {number}, {cell}, {origin:?}: {now}, sum {summed} of {samples}");
                }
            }
        }
    }
    eprintln!(
        "stored light: camera, lamps, kept, gone {counts:?}, unsure {unsure}, {worst:.2} of the tolerance"
    );
    assert!(counts.iter().all(|n| *n > 1_000), "the views show too little: {counts:?}");
    assert!(unsure * 10 < counts[0] + counts[1], "{unsure} cells are too close to call");
    Ok(())
}

/// A frame with a lamp, and the next without it and with a camera that sees a part, by both rules.
fn stale_light(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [lamp, _, other] = views().map(|(_, view)| Shot::take(gpu, view, SIZE, &[FLOOR, BALL, CHEST]));
    let (lamp, other) = (lamp?, other?);
    let mut dark = Picture::take(&other.view, SIZE, &[FLOOR, BALL, CHEST]);
    dark.radiance.fill(Default::default());
    let camera = Shot::of(gpu, other.view, dark, SIZE)?;
    let seen: Vec<bool> = defined_sums(&[&camera], &grid(), 1).iter().map(|sums| sums.count > 0.0).collect();
    let run_by = |light: LightRule| -> Result<[Light; 2], Failed> {
        let mut world = World::new(&labs.core, grid())?;
        let mut stages = Progressive::with_rules(gpu, &world.volume, Rules { light, ..Rules::default() })?;
        frame(gpu, (&mut world, &mut stages), &[&lamp], None)?;
        let lit = world.light.read_back(gpu)?;
        frame(gpu, (&mut world, &mut stages), &[], Some(&camera))?;
        Ok([lit, world.light.read_back(gpu)?])
    };
    for rule in [LightRule::Pulled, LightRule::Stored] {
        let [lit, after] = run_by(rule)?;
        let (mut unseen, mut dimmed) = (0, 0);
        for (index, (lit, after)) in lit.iter().zip(&after).enumerate().filter(|(_, (lit, _))| !is_dark(lit))
        {
            if rule == LightRule::Stored && !seen[index] && after == lit {
                unseen += 1;
            } else {
                assert!(is_dark(after), "{rule:?}, cell {index}, seen {}: light remains", seen[index]);
                dimmed += 1;
            }
        }
        eprintln!("{rule:?}: {unseen} cells still shine, {dimmed} are dark");
        assert!(dimmed > 50, "{rule:?}: {dimmed} cells have become dark");
        assert_eq!(unseen > 50, rule == LightRule::Stored, "{rule:?}: {unseen} cells still shine");
    }
    Ok(())
}

/// A lit ball that is taken away while only a view without light looks: its cells and their light go, and the floor's stays.
fn goes_with_cells(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [lamp, above, _] = views().map(|(_, view)| view);
    let with = Shot::take(gpu, lamp, SIZE, &[FLOOR, BALL])?;
    let without = Shot::take(gpu, above, SIZE, &[FLOOR])?;
    let mut world = World::new(&labs.core, grid())?;
    let mut stages = Progressive::with_rules(gpu, &world.volume, STORED)?;
    frame(gpu, (&mut world, &mut stages), &[&with], None)?;
    let (lit, stood) = (world.light.read_back(gpu)?, occupied_cells(gpu, &world)?);
    // Cleans, and injects nothing.
    let World { volume, light, .. } = &mut world;
    run(gpu, |e| {
        stages.record_begin(e, light);
        stages.record_cleanup(gpu, e, &without.input, volume)?;
        stages.record_end(gpu, e, &without.input, volume, light)
    })?;
    let (after, stands) = (world.light.read_back(gpu)?, occupied_cells(gpu, &world)?);
    let (mut kept, mut gone) = (0, 0);
    for index in (0..lit.len()).filter(|i| !is_dark(&lit[*i])) {
        assert!(stood[index], "light in an empty cell");
        let expected = if stands[index] { lit[index] } else { Default::default() };
        assert_eq!(after[index], expected, "cell {index}, still there: {}", stands[index]);
        *(if stands[index] { &mut kept } else { &mut gone }) += 1;
    }
    assert!(kept > 50 && gone > 50, "{kept} cells stand, {gone} are gone");
    Ok(())
}

fn white(_: DVec3) -> Paint {
    Paint { albedo: DVec3::ONE, emission: DVec3::ZERO, radiance: DVec3::ONE }
}

/// A plane along cells, seen whole by parallel rays and by a fan of them.
fn points(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let plane = Thing(Shape::Plane { point: DVec3::new(0.0, -0.9, 0.0), normal: DVec3::Y }, white);
    let above = Vec3::new(0.1, 3.5, -0.2);
    let down = above - Vec3::Y;
    let views = [
        ("parallel", View::orthographic(above, down, Vec3::Z, Vec2::splat(12.0), 8.0)),
        ("fan", View::perspective(above, down, Vec3::Z, 2.0, 1.0, 0.5, 9.0)),
    ];
    for (name, view) in views {
        let picture = || Picture::take(&view, UVec2::splat(256), &[plane]);
        let mut total = Vec::new();
        for side in [256, 128] {
            let shot = Shot::of(gpu, view, picture(), UVec2::splat(side))?;
            // As many points as there are, where the scale is for fewer.
            let scale = lumivox::progressive::InjectionScale { light_points: side * side, ..SCALE };
            shot.input.update(gpu, &view, scale);
            let mut lights = Vec::new();
            for light in [LightRule::Stored, LightRule::Pulled] {
                let mut world = World::new(&labs.core, grid())?;
                let mut stages =
                    Progressive::with_rules(gpu, &world.volume, Rules { light, ..Rules::default() })?;
                frame(gpu, (&mut world, &mut stages), &[&shot], None)?;
                lights.push(world.light.read_back(gpu)?);
            }
            let lit: Vec<_> = (0..lights[0].len()).filter(|i| lights[1][*i][0].x > 0.0).collect();
            let [sum, mean] = [0, 1].map(|n: usize| {
                lit.iter().map(|i| f64::from(lights[n][*i][0].x)).sum::<f64>() / lit.len() as f64
            });
            eprintln!("{name}, {side} points a side: {} cells, sum {sum:.4}, mean {mean:.4}", lit.len());
            // The plane covers every cell of a layer whole: up to a row of points is won or lost at the layer's four borders.
            let border = 4.0 * 2.0 / f64::from(side);
            assert_eq!(lit.len(), 24 * 20, "{name}, {side} points");
            assert!((sum / mean - 1.0).abs() < border, "{name}, {side} points: {sum}, of means {mean}");
            total.push(sum);
        }
        assert!((total[1] / total[0] - 1.0).abs() < 0.02, "{name}: {total:?}");
    }
    Ok(())
}

/// The single pass: a lamp, then a camera that sees a part of what it lit.
fn single_pass(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for cleanup in [CleanupRule::Center, CleanupRule::Footprint] {
        let frames = |light: LightRule| -> Result<[Light; 4], GpuError> {
            let [one, two, other] =
                views().map(|(_, view)| Shot::take(gpu, view, SIZE, &[FLOOR, BALL, CHEST]));
            let (one, two, camera) = (one?, two?, other?);
            let mut world = World::new(&labs.core, grid())?;
            let mut single = SinglePass::with_rules(gpu, &world.volume, Rules { cleanup, light })?;
            let World { volume, light, .. } = &mut world;
            let mut states = Vec::new();
            for (lamps, camera) in
                [(vec![&one], None), (vec![], Some(&camera)), (vec![&one, &two], None), (vec![], None)]
            {
                run(gpu, |e| {
                    single.record_begin(e, light);
                    for lamp in lamps {
                        single.record_light(gpu, e, [&lamp.input], volume, light)?;
                    }
                    camera.map_or(Ok(()), |c: &Shot| single.record_camera(gpu, e, &c.input, volume, light))
                })?;
                states.push(light.read_back(gpu)?);
            }
            states.try_into().map_err(|_| GpuError::DeviceLost("four frames were asked for".to_owned()))
        };
        let [pulled, stored] = [frames(LightRule::Pulled)?, frames(LightRule::Stored)?];
        assert!(pulled[0] == stored[0], "{cleanup:?}: the first frame has nothing to keep");
        let (mut stays, mut added) = (0, 0);
        for index in 0..pulled[0].len() {
            for frame in 1..4 {
                let [pulled, stored] = [pulled[frame][index], stored[frame][index]];
                // What a frame writes is the same by both rules; what it does not is kept or cleared.
                if is_dark(&pulled) {
                    stays += usize::from(!is_dark(&stored));
                } else {
                    assert_eq!(stored, pulled, "{cleanup:?}, frame {frame}, cell {index}");
                    added += usize::from(frame == 2);
                }
            }
        }
        assert!(
            pulled[3].iter().all(is_dark) && stored[3] == stored[2],
            "{cleanup:?}: a frame without views"
        );
        assert!(stays > 100 && added > 100, "{cleanup:?}: {stays} stay, {added} are of two lamps");
    }
    Ok(())
}
