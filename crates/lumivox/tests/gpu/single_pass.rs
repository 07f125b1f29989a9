//! The single pass against its definition, computed in double precision, cell by cell, and beside cleanup and injection.

use libtest_mimic::Failed;
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, HostVolume, View};
use lumivox::glam::{DVec3, DVec4, UVec2, UVec3, Vec2, Vec3, Vec4};
use lumivox::gpu::Gpu;
use lumivox::progressive::{CHANNELS, CleanupRule, SinglePass};
use lumivox::volume::NORMAL;

use crate::definition::{Verdict, sample, verdict};
use crate::picture::{Paint, Shape, Thing};
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, views};
use crate::random_views::{ODD_SEEDS, RANDOM_DIMS, RANDOM_SEEDS, random_grid, random_shot};
use crate::support::{Shot, World, channel, is_mean, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("single pass: by random views it is its definition, as a light and as the camera", random_views),
    (
        "single pass: by footprint and by rays it clears what they clear, and writes what it wrote",
        by_whole_cells,
    ),
    ("single pass: the views of a point light count once, on their borders too", point_light),
    ("single pass: frames of a still scene change nothing after the first", still_scene),
    ("single pass: a removed object vanishes when its place is seen", removed_object),
    ("single pass: finds a part of what injection finds", beside_injection),
    ("single pass: walls are as thick as the view direction makes them", thickness_of_walls),
];

/// A volume and its light in memory.
struct State {
    volume: HostVolume,
    light: Vec<[Vec4; 3]>,
}

impl State {
    fn of(gpu: &Gpu, world: &World) -> Result<Self, Failed> {
        Ok(Self { volume: world.read(gpu)?, light: world.light.read_back(gpu)? })
    }

    fn bits(&self) -> Vec<u32> {
        let cells = self.volume.names().flat_map(|name| channel(&self.volume, name));
        cells.chain(self.light.iter().flatten()).flat_map(|v| v.to_array().map(f32::to_bits)).collect()
    }

    fn occupied(&self) -> Vec<bool> {
        channel(&self.volume, NORMAL).iter().map(|v| v.w > 0.0).collect()
    }

    /// Whether a cell holds what it should after this verdict, up to the rounding of half floats.
    fn follows(&self, before: &Self, shot: &Shot, index: usize, verdict: Verdict, keep: f64) -> bool {
        let written = match verdict {
            Verdict::Written(texel) => sample(shot, texel),
            _ => None,
        };
        let now = CHANNELS.map(|name| channel(&self.volume, name)[index]);
        let was = CHANNELS.map(|name| channel(&before.volume, name)[index]);
        match (verdict, written) {
            (Verdict::NotSeen | Verdict::Kept, _) => now == was && self.light[index] == before.light[index],
            (Verdict::Cleared, _) => now == [Vec4::ZERO; 3] && self.light[index] == [Vec4::ZERO; 3],
            (Verdict::Written(_), Some((attributes, light))) => {
                let equal = |(now, value): (Vec4, DVec3)| (0..3).all(|i| is_mean(now[i], value[i], 0.0));
                let lit = self.light[index].into_iter().zip(before.light[index]).zip(light);
                let sums = lit.map(|((now, was), new): (_, DVec4)| (now, keep * was.as_dvec4() + new));
                now.map(|v| v.w) == [1.0, 0.0, 0.0]
                    && now.into_iter().zip(attributes).all(equal)
                    && sums.into_iter().all(|(now, sum)| (0..4).all(|i| is_mean(now[i], sum[i], 0.0)))
            }
            (Verdict::Written(_), None) => false,
        }
    }
}

fn random_views(labs: &Labs) -> Result<(), Failed> {
    is_defined(labs, CleanupRule::Center)
}

fn by_whole_cells(labs: &Labs) -> Result<(), Failed> {
    is_defined(labs, CleanupRule::Footprint)?;
    is_defined(labs, CleanupRule::Rays)
}

/// Each view in a volume with random contents; first as a light, then as the camera.
fn is_defined(labs: &Labs, rule: CleanupRule) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // Random grids have as many cells as one of these.
    let singles = RANDOM_DIMS.map(|dims| {
        let of_size = VolumeBuffer::new(gpu, Grid { dims, ..grid() }, &CHANNELS)?;
        SinglePass::with_rule(gpu, &of_size, rule)
    });
    let mut singles = singles.into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut all = [0; 5];
    for seed in RANDOM_SEEDS.chain(ODD_SEEDS) {
        let grid = random_grid(seed);
        let (name, shot) = random_shot(gpu, &grid, seed)?;
        let of_dims = RANDOM_DIMS.iter().zip(&mut singles).find(|(dims, _)| **dims == grid.dims);
        let (_, single) = of_dims.ok_or("a grid of other dimensions")?;
        for (role, keep) in [("light", 1.0), ("camera", 0.0)] {
            let mut world = World::new(&labs.core, grid)?;
            world.scatter(gpu, seed)?;
            let before = State::of(gpu, &world)?;
            let World { volume, light, .. } = &mut world;
            run(gpu, |e| match keep {
                1.0 => single.record_light(gpu, e, [&shot.input], volume, light),
                _ => single.record_camera(gpu, e, &shot.input, volume, light),
            })?;
            let after = State::of(gpu, &world)?;
            let mut counts = [0; 5];
            for (index, cell) in grid.cells().enumerate() {
                let verdict = verdict(rule, &shot, &grid, cell);
                counts[match verdict {
                    Some(Verdict::NotSeen) => 0,
                    Some(Verdict::Kept) => 1,
                    Some(Verdict::Cleared) => 2,
                    Some(Verdict::Written(_)) => 3,
                    None => 4,
                }] += 1;
                if let Some(verdict) = verdict {
                    let right = after.follows(&before, &shot, index, verdict, keep);
                    assert!(right, "{rule:?}, {name}, as {role}, {cell} should be {verdict:?}");
                }
            }
            eprintln!("single pass, {rule:?}, {name}, as {role}: {counts:?}");
            all = std::array::from_fn(|i| all[i] + counts[i]);
        }
    }
    let [unseen, kept, cleared, written, close] = all;
    eprintln!(
        "unseen {unseen}, kept {kept}, cleared {cleared}, written {written}, too close to call {close}"
    );
    assert!([unseen, kept, cleared, written].iter().all(|n| *n > 5_000), "the views show too little");
    let seen = kept + cleared + written;
    assert!(close * 500 < seen, "{close} of {seen} seen cells are too close to call");
    Ok(())
}

fn white(_: DVec3) -> Paint {
    Paint { albedo: DVec3::ONE, emission: DVec3::ZERO, radiance: DVec3::ONE }
}

/// A lamp amid cells and one on a cell's corner, in a room: where six views share borders there are centres exactly on them.
fn point_light(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let grid = Grid { origin: Vec3::splat(-2.5), cell_size: 0.25, dims: UVec3::splat(20) };
    let room = Thing(Shape::Box { min: DVec3::splat(-1.7), max: DVec3::splat(1.7) }, white);
    for lamp in [Vec3::splat(0.125), Vec3::ZERO] {
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let shots: Vec<_> = axes
            .into_iter()
            .map(|axis| {
                let quarter = std::f32::consts::FRAC_PI_2;
                let view = View::perspective(lamp, lamp + axis, Vec3::Y, quarter, 1.0, 0.01, 6.0);
                Shot::take(gpu, view, UVec2::splat(64), &[room])
            })
            .collect::<Result<_, _>>()?;
        let mut world = World::new(&labs.core, grid)?;
        world.single_pass(gpu, |single, e, volume, light| {
            single.record_begin(e, light);
            single.record_light(gpu, e, shots.iter().map(|s| &s.input), volume, light)
        })?;
        let after = State::of(gpu, &world)?;
        let constant = 0.5 * std::f64::consts::PI.sqrt();
        let (mut lit, mut on_borders) = (0, 0);
        for (index, cell) in grid.cells().enumerate() {
            let toward = (grid.center(cell) - lamp).abs().to_array();
            let farthest = toward.iter().fold(0f32, |a, b| a.max(*b));
            let shared = toward.iter().filter(|d| farthest - **d < 1e-4).count() > 1;
            // The walls stand in a shell of cells, 14 a side, and a view along an axis writes one layer of cells.
            let light = after.light[index][0].x;
            let in_shell = cell.min_element() == 3 || cell.max_element() == 16;
            let in_walls = in_shell && cell.min_element() >= 3 && cell.max_element() <= 16;
            assert_eq!(light != 0.0, in_walls, "{cell}");
            if light == 0.0 {
                continue;
            }
            lit += 1;
            on_borders += usize::from(shared);
            assert!(
                is_mean(light, constant, 0.0),
                "{cell} has {} times one view's light",
                f64::from(light) / constant
            );
            assert_eq!(channel(&after.volume, NORMAL)[index].w, 1.0, "{cell} is lit and empty");
        }
        eprintln!("lamp at {lamp}: {lit} cells lit, {on_borders} of them on a border of two views");
        assert_eq!(lit, 14usize.pow(3) - 12usize.pow(3));
        assert!(on_borders > 100, "only {on_borders} cells are on borders");
    }
    Ok(())
}

/// One frame: lamps, then the camera.
fn frame(gpu: &Gpu, world: &mut World, lamps: &[&Shot], camera: &Shot) -> Result<State, Failed> {
    world.single_pass(gpu, |single, e, volume, light| {
        single.record_begin(e, light);
        for lamp in lamps {
            single.record_light(gpu, e, [&lamp.input], volume, light)?;
        }
        single.record_camera(gpu, e, &camera.input, volume, light)
    })?;
    State::of(gpu, world)
}

fn still_scene(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [one, two, camera] = views().map(|(_, view)| Shot::take(gpu, view, SIZE, &[FLOOR, CHEST]));
    let (one, two, camera) = (one?, two?, camera?);
    let mut world = World::new(&labs.core, grid())?;
    world.scatter(gpu, 5)?;
    let first = frame(gpu, &mut world, &[&one, &two], &camera)?;
    assert!(first.occupied().iter().filter(|o| **o).count() > 500);
    for number in 1..4 {
        let next = frame(gpu, &mut world, &[&one, &two], &camera)?;
        assert!(next.bits() == first.bits(), "frame {number} changes something");
    }
    Ok(())
}

fn removed_object(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for (name, view) in views() {
        let with = Shot::take(gpu, view, SIZE, &[FLOOR, BALL])?;
        let without = Shot::take(gpu, view, SIZE, &[FLOOR])?;
        let mut world = World::new(&labs.core, grid())?;
        let first = frame(gpu, &mut world, &[], &with)?.occupied();
        let ball = |index: &usize| grid().center(grid().cell(*index)).y > -0.7;
        let found = (0..first.len()).filter(ball).filter(|i| first[*i]).count();
        assert!(found > 50, "{name}: the ball fills only {found} cells");
        let second = frame(gpu, &mut world, &[], &without)?.occupied();
        let left = (0..second.len()).filter(ball).filter(|i| second[*i]).count();
        assert_eq!(left, 0, "{name}: cells of the ball are left of {found}");
    }
    Ok(())
}

/// Of the cells that injection fills from dense points, the share that the single pass fills too; and of the cells that the
/// single pass fills, the share that injection does not. From one view, and from three in one frame.
fn beside_injection(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [one, two, three] =
        views().map(|(_, view)| Shot::take(gpu, view, UVec2::new(320, 256), &[FLOOR, BALL, CHEST]));
    let shots = [one?, two?, three?];
    let [a, b, c] = shots.each_ref();
    let cases: [(&[&Shot], &Shot, f64, f64); 4] =
        [(&[], a, 0.76, 0.16), (&[], b, 0.74, 0.46), (&[], c, 0.52, 0.12), (&[a, b], c, 0.78, 0.24)];
    for (lamps, camera, share, extra) in cases {
        let mut two_phases = World::new(&labs.core, grid())?;
        two_phases.inject(gpu, lamps, Some(camera))?;
        let injected = State::of(gpu, &two_phases)?.occupied();
        let mut world = World::new(&labs.core, grid())?;
        let found = frame(gpu, &mut world, lamps, camera)?.occupied();
        let count = |cells: &[bool]| cells.iter().filter(|c| **c).count() as f64;
        let both = injected.iter().zip(&found).filter(|(a, b)| **a && **b).count() as f64;
        let got = [both / count(&injected), 1.0 - both / count(&found)];
        eprintln!("{} cells injected, {} found, shares {got:?}", count(&injected), count(&found));
        assert!((got[0] - share).abs() < 0.02, "{} of injection's cells found, not {share}", got[0]);
        assert!((got[1] - extra).abs() < 0.02, "{} of the cells are not injection's, not {extra}", got[1]);
    }
    Ok(())
}

/// A wall across one axis, at 40 positions within a cell, is written `|d| * (|dx| + |dy| + |dz|)` layers thick on average, for
/// `d` the part of the view direction along that axis. Below one it is missed at some positions.
fn thickness_of_walls(labs: &Labs) -> Result<(), Failed> {
    const POSITIONS: u32 = 40;
    let gpu = &labs.core.gpu;
    let angle = |degrees: f32| Vec3::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0);
    let slant = Vec3::new(0.3, 0.5, -0.8).normalize_or_zero();
    for direction in
        [Vec3::X, angle(20.0), angle(45.0), angle(60.0), angle(75.0), Vec3::ONE.normalize_or_zero(), slant]
    {
        let center = grid().bounds().center();
        let view = View::orthographic(center - 5.0 * direction, center, Vec3::Z, Vec2::splat(8.0), 10.0);
        let mut written = 0;
        for position in 0..POSITIONS {
            let cells = 12.0 + (position as f32 + 0.5) / POSITIONS as f32;
            let x = f64::from(grid().origin.x + cells * grid().cell_size);
            let point = DVec3::new(x, 0.0, 0.0);
            let wall = Thing(Shape::Plane { point, normal: DVec3::X }, white);
            let shot = Shot::take(gpu, view, UVec2::splat(256), &[wall])?;
            let mut world = World::new(&labs.core, grid())?;
            let found = frame(gpu, &mut world, &[], &shot)?.occupied();
            written += found.iter().filter(|o| **o).count();
        }
        let columns = grid().dims.y * grid().dims.z * POSITIONS;
        let layers = written as f64 / f64::from(columns);
        let expected = f64::from(direction.x.abs() * direction.abs().element_sum());
        eprintln!("seen along {direction:.2}: {layers:.3} layers, expected {expected:.3}");
        assert!((layers - expected).abs() < 0.03, "{layers} layers seen along {direction}, not {expected}");
    }
    Ok(())
}
