//! Light propagation volumes: what is injected, where it goes, and what blockers do.

use std::f64::consts::PI;

use libtest_mimic::Failed;
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, View};
use lumivox::glam::{DVec3, UVec2, UVec3, Vec2, Vec3};
use lumivox::gpu::{Gpu, GpuError, Texture, read_texture};
use lumivox::light::IRRADIANCE_FORMAT;
use lumivox::lpv::{Blocking, LightPropagationVolume};
use lumivox::progressive::CHANNELS;
use lumivox_oracle::closed_form;

use crate::picture::{Paint, Shape, Thing};
use crate::support::{Shot, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("lpv: a patch's virtual point lights have its flux", injected),
    ("lpv: flux is conserved until it leaves the grid", conserved),
    ("lpv: a facing wall gets the light that diffuses to it", facing),
    ("lpv: without light it is dark", dark),
    ("lpv: light is linear, and the same every time", linear),
    ("lpv: blockers darken what is behind them", blocked),
    ("lpv: without blockers blocking changes nothing", nothing_blocks),
    ("lpv: blockers that reflect make no light", reflected),
];

/// A grid of cells a metre wide, and its light.
struct Room {
    volume: VolumeBuffer,
    light: LightPropagationVolume,
}

impl Room {
    fn new(gpu: &Gpu, side: u32, blocking: Blocking) -> Result<Self, GpuError> {
        let grid = Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::splat(side) };
        let volume = VolumeBuffer::new(gpu, grid, &CHANNELS)?;
        let light = LightPropagationVolume::new(gpu, &volume, blocking)?;
        Ok(Self { volume, light })
    }

    /// Starts from what the lamps show, with what all views show in the way.
    fn seed(&mut self, gpu: &Gpu, lamps: &[&Shot], cameras: &[&Shot]) -> Result<(), GpuError> {
        let Self { volume, light } = self;
        run(gpu, |e| {
            light.record_begin(e);
            for lamp in lamps {
                light.record_light(gpu, e, &lamp.input, volume)?;
            }
            for view in lamps.iter().chain(cameras) {
                light.record_geometry(gpu, e, &view.input, volume)?;
            }
            let any = lamps.iter().chain(cameras).next().expect("a view");
            light.record_seed(gpu, e, &any.input, volume)
        })
    }

    fn go_on(&mut self, gpu: &Gpu, steps: u32) -> Result<(), GpuError> {
        run(gpu, |e| self.light.record_propagation(gpu, e, &self.volume, steps))
    }

    /// Mean irradiance, red, over the pixels of a view.
    fn irradiance(&self, gpu: &Gpu, view: &Shot) -> Result<f64, GpuError> {
        let size = view.picture.size;
        let mut target = Texture::target(gpu, "irradiance", size.to_array(), IRRADIANCE_FORMAT)?;
        run(gpu, |e| self.light.record_reconstruction(gpu, e, &self.volume, &view.input, &mut target))?;
        let pixels: Vec<[half::f16; 4]> = read_texture(gpu, &target)?;
        Ok(pixels.iter().map(|p| p[0].to_f64()).sum::<f64>() / pixels.len() as f64)
    }
}

/// Half the side of the grids here whose middle is lit.
const MIDDLE: f64 = 16.0;

/// A grey square of 8 x 8 m in the middle of the picture that shines with (2, 1, 1/2) W/(m2 sr).
fn square(p: DVec3) -> Paint {
    let lit = (p.y - MIDDLE).abs() < 4.0 && (p.z - MIDDLE).abs() < 4.0;
    let radiance = if lit { DVec3::new(2.0, 1.0, 0.5) } else { DVec3::ZERO };
    Paint { albedo: DVec3::splat(0.95), radiance, ..Paint::default() }
}

fn unlit(_: DVec3) -> Paint {
    Paint { albedo: DVec3::splat(0.95), ..Paint::default() }
}

const SQUARE_FLUX: f64 = PI * 3.5 * 64.0;

/// A view of parallel rays along x, of `width` metres about the middle, at a wall.
fn at_wall(
    gpu: &Gpu,
    (from, wall): (f32, f32),
    width: f32,
    paint: fn(DVec3) -> Paint,
) -> Result<Shot, GpuError> {
    let middle = MIDDLE as f32;
    let (eye, to) = (Vec3::new(from, middle, middle), Vec3::new(wall, middle, middle));
    let view = View::orthographic(eye, to, Vec3::Y, Vec2::splat(width), 1.5 * (wall - from).abs());
    let plane = Shape::Plane { point: to.as_dvec3(), normal: DVec3::X };
    Shot::take(gpu, view, UVec2::splat(96), &[Thing(plane, paint)])
}

/// However a patch is seen, its flux is pi times radiance times area.
fn injected(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let straight = View::orthographic(
        Vec3::new(30.0, 16.0, 16.0),
        Vec3::new(8.0, 16.0, 16.0),
        Vec3::Y,
        Vec2::splat(16.0),
        40.0,
    );
    let aslant = View::orthographic(
        Vec3::new(20.0, 30.0, 12.0),
        Vec3::new(8.0, 16.0, 16.0),
        Vec3::Y,
        Vec2::splat(20.0),
        60.0,
    );
    let near = View::perspective(
        Vec3::new(18.0, 14.0, 19.0),
        Vec3::new(8.0, 16.0, 16.0),
        Vec3::Y,
        1.6,
        1.0,
        0.1,
        60.0,
    );
    let plane = Shape::Plane { point: DVec3::new(8.0, 16.0, 16.0), normal: DVec3::X };
    let views = [
        ("straight", straight),
        ("aslant", aslant),
        ("perspective", near),
        ("reversed", near.with_reversed_depth()),
    ];
    for (name, view) in views {
        for points in [256, 100] {
            let picture = crate::picture::Picture::take(&view, UVec2::splat(256), &[Thing(plane, square)]);
            let shot = Shot::of(gpu, view, picture, UVec2::splat(points))?;
            let mut room = Room::new(gpu, 32, Blocking::None)?;
            room.seed(gpu, &[&shot], &[])?;
            let part = room.light.flux_under_way(gpu)? / SQUARE_FLUX;
            eprintln!("{name}, {points} points a side: {part:.4} of the square's flux");
            // The square's edges fall between points: of 60 to 130 points a side up to one is won or lost.
            assert!((part - 1.0).abs() < 0.035, "{name}, {points} points: {part}");
        }
    }
    Ok(())
}

fn conserved(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let lamp = at_wall(gpu, (30.0, 15.9), 24.0, square)?;
    let mut room = Room::new(gpu, 32, Blocking::None)?;
    room.seed(gpu, &[&lamp], &[])?;
    // The texels' borders are the square's.
    let seeded = room.light.flux_under_way(gpu)?;
    assert!((seeded / SQUARE_FLUX - 1.0).abs() < 1.0 / 1024.0, "{seeded} of {SQUARE_FLUX}");
    let mut parts = Vec::new();
    for step in 1..=60 {
        room.go_on(gpu, 1)?;
        let part = room.light.flux_under_way(gpu)? / seeded;
        parts.push(part);
        // From cells 12 to 19 it is twelve steps to the boundary. A step's rounding, were it all of one sign.
        if step <= 12 {
            assert!((part - 1.0).abs() < f64::from(step) / 2048.0, "{part} after {step} steps");
        }
        assert!(part < 1.0 + 12.0 / 2048.0, "{part} after {step} steps");
    }
    room.go_on(gpu, 540)?;
    let last = room.light.flux_under_way(gpu)? / seeded;
    eprintln!("{:.4} after 12 steps, {:.4} after 60, {last:.4} after 600", parts[11], parts[59]);
    assert!(last < 0.5, "light does not leave the grid: {last}");
    Ok(())
}

/// Light diffuses: after the usual two steps for each cell of a side it has reached a wall nearby and not yet one far away, and
/// in the end all walls have too much, since what goes through one comes back. How much has no closed form; the numbers are those
/// of the method as its papers give it, and a baseline must not drift.
fn facing(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let lamp = at_wall(gpu, (30.0, 8.0), 24.0, square)?;
    let mut room = Room::new(gpu, 32, Blocking::None)?;
    room.seed(gpu, &[&lamp], &[])?;
    let distances = [3.0, 6.0, 10.0, 16.0];
    let receivers = distances.map(|d| at_wall(gpu, (9.0, 8.0 + d), 1.0, unlit));
    let own = at_wall(gpu, (30.0, 8.0), 1.0, unlit)?;
    let parts = [(64, [1.135, 0.724, 0.289, 0.028], 0.959), (936, [1.564, 1.482, 1.441, 1.189], 1.245)];
    for (steps, expected, expected_own) in parts {
        room.go_on(gpu, steps)?;
        for ((distance, receiver), expected) in distances.into_iter().zip(&receivers).zip(expected) {
            let seen = receiver.as_ref().map_err(|e| e.to_string())?;
            let share = 4.0 * closed_form::element_below_corner(4.0, 4.0, f64::from(distance));
            let ratio = room.irradiance(gpu, seen)? / (2.0 * PI * share);
            eprintln!("{steps} steps more, {distance} cells away: {ratio:.3} of the form factor");
            // Half floats, and what drivers make of the views.
            assert!(
                (ratio - expected).abs() < 0.01,
                "{ratio} of the form factor at {distance}, not {expected}"
            );
        }
        // In truth the lit wall sees nothing that is lit. It sends out 2 pi W/m2.
        let own = room.irradiance(gpu, &own)? / (2.0 * PI);
        eprintln!("{steps} steps more: the wall lights itself with {own:.3} of what it sends out");
        assert!((own - expected_own).abs() < 0.01, "the wall lights itself with {own}, not {expected_own}");
    }
    Ok(())
}

fn dark(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let wall = at_wall(gpu, (30.0, 8.0), 24.0, unlit)?;
    let mut room = Room::new(gpu, 32, Blocking::Reflecting)?;
    // Light of a frame before must be gone.
    room.seed(gpu, &[&at_wall(gpu, (30.0, 8.0), 24.0, square)?], &[])?;
    room.go_on(gpu, 4)?;
    room.seed(gpu, &[&wall], &[])?;
    room.go_on(gpu, 8)?;
    assert_eq!(room.light.flux_under_way(gpu)?, 0.0);
    assert!(room.light.read_accumulated(gpu)?.iter().flatten().flatten().all(|v| *v == 0.0));
    Ok(())
}

fn linear(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let lamps = [at_wall(gpu, (30.0, 8.0), 24.0, square)?, at_wall(gpu, (2.0, 21.0), 24.0, square)?];
    let light = |lamps: &[&Shot]| -> Result<Vec<f32>, GpuError> {
        let mut room = Room::new(gpu, 32, Blocking::None)?;
        room.seed(gpu, lamps, &[])?;
        room.go_on(gpu, 24)?;
        Ok(room.light.read_accumulated(gpu)?.into_iter().flatten().flatten().collect())
    };
    let [a, b] = [light(&[&lamps[0]])?, light(&[&lamps[1]])?];
    let both = light(&[&lamps[0], &lamps[1]])?;
    assert!(both == light(&[&lamps[1], &lamps[0]])?, "the order of lamps changes bits");
    let total: f64 = both.iter().map(|v| f64::from(v.abs())).sum();
    let off: f64 = both.iter().zip(a.iter().zip(&b)).map(|(s, (a, b))| f64::from((s - (a + b)).abs())).sum();
    eprintln!("lpv linearity: off by {:.2e}", off / total);
    assert!(total > 100.0, "nothing is lit");
    // Three runs of 24 steps with half floats, as for propagation.
    assert!(off / total < 3.0 * 24f64.sqrt() / 4096.0, "{}", off / total);
    Ok(())
}

/// A wall that the camera sees stands between lamp and receiver.
fn blocked(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let lamp = at_wall(gpu, (30.0, 8.0), 24.0, square)?;
    let camera = at_wall(gpu, (9.0, 16.0), 31.0, unlit)?;
    let (before, behind) = (at_wall(gpu, (9.0, 15.0), 1.0, unlit)?, at_wall(gpu, (17.0, 20.0), 1.0, unlit)?);
    let mut seen = Vec::new();
    for blocking in [Blocking::None, Blocking::Fuzzy, Blocking::Reflecting] {
        let mut room = Room::new(gpu, 32, blocking)?;
        room.seed(gpu, &[&lamp], &[&camera])?;
        room.go_on(gpu, 64)?;
        seen.push([room.irradiance(gpu, &before)?, room.irradiance(gpu, &behind)?]);
    }
    eprintln!("before and behind a wall: {seen:.4?}");
    let [plain, fuzzy, reflecting] = [seen[0], seen[1], seen[2]];
    assert!(plain[1] > 0.1, "{plain:?}");
    assert!(fuzzy[1] < 0.4 * plain[1], "behind the wall {} of {}", fuzzy[1], plain[1]);
    assert!(fuzzy[0] > 0.5 * plain[0], "before the wall {} of {}", fuzzy[0], plain[0]);
    // What comes back from the wall lights the lit wall's side, and not what is behind.
    assert!(reflecting[1] < 0.5 * plain[1], "{reflecting:?}");
    let mut room = Room::new(gpu, 32, Blocking::None)?;
    room.seed(gpu, &[&lamp], &[])?;
    room.go_on(gpu, 64)?;
    assert_eq!(room.irradiance(gpu, &behind)?, plain[1], "plain light depends on geometry");
    Ok(())
}

fn nothing_blocks(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let lamp = at_wall(gpu, (30.0, 8.0), 24.0, square)?;
    let light = |blocking| -> Result<Vec<f32>, GpuError> {
        let mut room = Room::new(gpu, 32, blocking)?;
        let Room { volume, light } = &mut room;
        run(gpu, |e| {
            light.record_begin(e);
            light.record_light(gpu, e, &lamp.input, volume)?;
            light.record_seed(gpu, e, &lamp.input, volume)?;
            light.record_propagation(gpu, e, volume, 24)
        })?;
        Ok(light.read_accumulated(gpu)?.into_iter().flatten().flatten().collect())
    };
    let plain = light(Blocking::None)?;
    let largest = plain.iter().fold(0f32, |a, v| a.max(v.abs()));
    for blocking in [Blocking::Fuzzy, Blocking::Reflecting] {
        for (a, b) in plain.iter().zip(light(blocking)?) {
            // The same fluxes, added up in another order and rounded to half floats in each step.
            assert!((a - b).abs() < 2e-3 * largest, "{a} and {b}, {blocking:?}");
        }
    }
    Ok(())
}

/// Between two walls that reflect 95 %, one of them lit, in a grid that light leaves on four sides.
fn reflected(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let lamp = at_wall(gpu, (30.0, 8.0), 31.0, square)?;
    let camera = at_wall(gpu, (9.0, 16.0), 31.0, unlit)?;
    let mut totals = Vec::new();
    for blocking in [Blocking::Fuzzy, Blocking::Reflecting] {
        let mut room = Room::new(gpu, 32, blocking)?;
        room.seed(gpu, &[&lamp], &[&camera])?;
        let mut last = room.light.flux_under_way(gpu)?;
        let mut sum = 0.0;
        for step in 0..100 {
            room.go_on(gpu, 1)?;
            let flux = room.light.flux_under_way(gpu)?;
            assert!(flux <= last * (1.0 + 1.0 / 2048.0), "step {step}: {flux} after {last}, {blocking:?}");
            sum += flux;
            last = flux;
        }
        totals.push(sum / SQUARE_FLUX);
    }
    eprintln!("flux of 100 steps, of the seed: {totals:.3?}");
    assert!(totals[1] > 1.1 * totals[0], "reflection adds nothing: {totals:?}");
    Ok(())
}
