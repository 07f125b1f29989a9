//! Cleanup and injection against their definitions, computed in double precision, cell by cell.

use libtest_mimic::Failed;
use lumivox::core::{Grid, View};
use lumivox::glam::{DVec2, DVec3, DVec4, IVec3, UVec2, UVec3, Vec2, Vec3, Vec4};
use lumivox::gpu::Gpu;
use lumivox::progressive::SURFACE_SHIFT;
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};

use crate::Labs;
use crate::Test;
use crate::support::{
    Paint, Picture, Random, SCALE, Shape, Shot, Thing, World, channel, lifted, ndc_of_texel,
};

pub(crate) const TESTS: &[Test] = &[
    ("progressive: cleanup clears what its definition clears", cleanup_is_its_definition),
    ("progressive: injection fills what its definition fills", injection_is_its_definition),
    ("progressive: half the points inject half the picture", coarse_injection_is_its_definition),
    ("progressive: nothing is injected where no surface is", nothing_from_nothing),
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

fn random_volume(grid: &Grid) -> [Vec<Vec4>; 3] {
    let mut random = Random::new(7);
    let mut channels = [const { Vec::new() }; 3];
    for _ in 0..grid.cell_count() {
        let occupied = if random.unit() < 0.5 { 0.0 } else { 1.0 };
        channels[0].push(occupied * (random.cube() - 0.5).extend(1.0));
        channels[1].push(occupied * random.cube().extend(0.0));
        channels[2].push(occupied * random.cube().extend(0.0));
    }
    channels
}

/// Distance from the eye along the view direction, in double precision.
fn distance_along(view: &View, point: DVec3) -> f64 {
    -view.eye_from_world.as_dmat4().transform_point3(point).z
}

/// How far a cell lies before what the view shows there, less the bias, in cells: positive when it is proven empty. None
/// when it is not in the picture, or so near a texel's border that single precision may look into the next texel.
fn margin_of_emptiness(shot: &Shot, grid: &Grid, cell: UVec3) -> Result<f64, bool> {
    const CLEAR_OF_BORDER: f64 = 1e-4;
    let cell_size = f64::from(grid.cell_size);
    let center = grid.origin.as_dvec3() + cell_size * (cell.as_dvec3() + 0.5);
    let clip: DVec4 = shot.view.clip_from_world.as_dmat4() * center.extend(1.0);
    let ndc = clip.truncate() / clip.w;
    let at = DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * shot.picture.size.as_dvec2();
    if (at - at.round()).abs().min_element() < CLEAR_OF_BORDER {
        return Err(true);
    }
    if clip.w <= 0.0 || at.min_element() < 0.0 || at.cmpge(shot.picture.size.as_dvec2()).any() {
        return Err(false);
    }
    if ndc.z < 0.0 || ndc.z > 1.0 {
        return Err(ndc.z.abs().min((ndc.z - 1.0).abs()) < 1e-5);
    }
    let depth = shot.picture.depth[(at.y as u32 * shot.picture.size.x + at.x as u32) as usize];
    // What was not drawn lies at the far plane: a surface behind it may reach into the last cell before it.
    let surface = distance_along(&shot.view, lifted(&shot.view, ndc.truncate(), depth));
    let forward = shot.view.forward().as_dvec3().abs();
    let bias = 0.5 * cell_size * forward.element_sum();
    Ok((surface - bias - distance_along(&shot.view, center)) / cell_size)
}

fn cleanup_is_its_definition(labs: &Labs) -> Result<(), Failed> {
    let (lab, grid) = (&labs.core, grid());
    let before = random_volume(&grid);
    for (name, view) in views() {
        let shot = Shot::take(&lab.gpu, view, SIZE, &[FLOOR, BALL, CHEST])?;
        let mut world = World::new(lab, grid)?;
        for (channel, values) in [NORMAL, ALBEDO, EMISSION].into_iter().zip(&before) {
            world.volume.upload(&lab.gpu, channel, values)?;
        }
        let uploaded = world.read(&lab.gpu)?;
        world.clean(&lab.gpu, &shot)?;
        let after = world.read(&lab.gpu)?;
        let (mut borderline, mut cleared, mut kept) = (0, 0, 0);
        for (index, cell) in grid.cells().enumerate() {
            let empty = match margin_of_emptiness(&shot, &grid, cell) {
                Ok(margin) if margin.abs() < 1e-4 => None,
                Ok(margin) => Some(margin > 0.0),
                Err(true) => None,
                Err(false) => Some(false),
            };
            let Some(empty) = empty else {
                borderline += 1;
                continue;
            };
            for name_of_channel in [NORMAL, ALBEDO, EMISSION] {
                let was = channel(&uploaded, name_of_channel)[index];
                let expected = if empty { Vec4::ZERO } else { was };
                assert_eq!(channel(&after, name_of_channel)[index], expected, "{name}, {cell}");
            }
            if before[0][index].w > 0.0 {
                *(if empty { &mut cleared } else { &mut kept }) += 1;
            }
        }
        let all = grid.cell_count();
        eprintln!("cleanup, {name}: {cleared} cleared, {kept} kept, {borderline} of {all} borderline");
        assert!(cleared > 100 && kept > 100, "{name} shows too little: {cleared} cleared, {kept} kept");
        assert!(borderline * 100 < all, "{name}: {borderline} of {all} cells are too close to call");
    }
    Ok(())
}

/// Sums of the samples that fall in one cell: normal, albedo, emission, and three bands of light.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    attributes: [DVec3; 3],
    light: [DVec4; 3],
    /// A sample lies so near the cell's border that single precision may put it on the other side.
    uncertain: bool,
}

/// What injection is defined to add up, with every `stride`-th texel as a point.
fn defined_sums(shots: &[&Shot], grid: &Grid, stride: u32) -> Vec<Sums> {
    /// Error of a depth value lifted in single precision, in cells.
    const CLEAR_OF_BORDER: f64 = 5e-4;
    let pi = std::f64::consts::PI;
    let mut cells = vec![Sums::default(); grid.cell_count() as usize];
    for shot in shots {
        let size = shot.picture.size;
        let points = (stride / 2..size.y).step_by(stride as usize);
        let points =
            points.flat_map(|y| (stride / 2..size.x).step_by(stride as usize).map(move |x| (x, y)));
        for (x, y) in points {
            let texel = (y * size.x + x) as usize;
            let [nx, ny, nz, _] = shot.picture.normal[texel].map(f64::from);
            let Some(n) = DVec3::new(nx, ny, nz).try_normalize() else { continue };
            let depth = shot.picture.depth[texel];
            let world = lifted(&shot.view, ndc_of_texel(UVec2::new(x, y), size), depth);
            let p = (world - grid.origin.as_dvec3()) / f64::from(grid.cell_size) - SURFACE_SHIFT * n;
            let inside = |c: IVec3| c.cmpge(IVec3::ZERO).all() && c.cmplt(grid.dims.as_ivec3()).all();
            let corners = [-CLEAR_OF_BORDER, CLEAR_OF_BORDER].map(|d| (p + d).floor().as_ivec3());
            if corners[0] != corners[1] {
                for corner in 0..8 {
                    let c = IVec3::from_array(std::array::from_fn(|i| corners[corner >> i & 1][i]));
                    if inside(c) {
                        cells[grid.index(c.as_uvec3())].uncertain = true;
                    }
                }
                continue;
            }
            if !inside(corners[0]) {
                continue;
            }
            let sums = &mut cells[grid.index(corners[0].as_uvec3())];
            let rgb = |v: [half::f16; 4]| {
                DVec3::new(v[0].into(), v[1].into(), v[2].into()).min(DVec3::splat(SCALE.radiance_max.into()))
            };
            let albedo = shot.picture.albedo[texel].map(|v| f64::from(v) / 255.0);
            sums.count += 1.0;
            sums.attributes[0] += n;
            sums.attributes[1] += DVec3::new(albedo[0], albedo[1], albedo[2]);
            sums.attributes[2] += rgb(shot.picture.emission[texel]);
            // The clamped cosine about n in the first four spherical harmonics.
            let linear = (pi / 3.0).sqrt() * n;
            let lobe = DVec4::new(0.5 * pi.sqrt(), linear.x, linear.y, linear.z);
            for (band, l) in rgb(shot.picture.radiance[texel]).to_array().into_iter().enumerate() {
                sums.light[band] += l * lobe;
            }
        }
    }
    cells
}

/// Whether a stored half float is a mean of samples that were each rounded to a step: half a step, and one part in 1024 for the
/// conversion, which may truncate.
fn is_mean(stored: f32, mean: f64, step: f64) -> bool {
    let stored = f64::from(stored);
    (stored - mean).abs() <= 0.5 * step + mean.abs() / 1024.0 + 1e-7
}

fn check_injection(gpu: &Gpu, world: &World, shots: &[&Shot], stride: u32, name: &str) -> Result<(), Failed> {
    let step = f64::from(SCALE.total_points) / 2f64.powi(30);
    let radiance_step = step * f64::from(SCALE.radiance_max);
    let (volume, light) = (world.read(gpu)?, world.light.read_back(gpu)?);
    let stored = [NORMAL, ALBEDO, EMISSION].map(|name| channel(&volume, name));
    let (mut occupied, mut uncertain) = (0, 0);
    for (index, sums) in defined_sums(shots, world.volume.grid(), stride).iter().enumerate() {
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
        for (i, step) in [step, step, radiance_step].into_iter().enumerate() {
            let mean = sums.attributes[i] / sums.count;
            let got = stored[i][index];
            let equal = (0..3).all(|a| is_mean(got[a], mean[a], step));
            assert!(equal, "{name}, {cell}: channel {i} is {got}, should be {mean}");
        }
        for band in 0..3 {
            let (got, mean) = (light[index][band], sums.light[band] / sums.count);
            let equal = (0..4).all(|c| is_mean(got[c], mean[c], radiance_step));
            assert!(equal, "{name}, {cell}: light {band} is {got}, should be {mean}");
        }
    }
    eprintln!("injection, {name}: {occupied} cells, {uncertain} of them with a sample on their border");
    assert!(occupied > 100, "{name} shows too little");
    assert!(uncertain * 20 < occupied, "{name}: {uncertain} of {occupied} cells are too close to call");
    Ok(())
}

fn injection_is_its_definition(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for (name, view) in views() {
        let shot = Shot::take(gpu, view, SIZE, &[FLOOR, BALL, CHEST])?;
        let mut world = World::new(&labs.core, grid())?;
        world.inject(gpu, &[], Some(&shot))?;
        check_injection(gpu, &world, &[&shot], 1, name)?;
    }
    Ok(())
}

fn coarse_injection_is_its_definition(labs: &Labs) -> Result<(), Failed> {
    let (gpu, view) = (&labs.core.gpu, views()[0].1);
    let picture = Picture::take(&view, SIZE, &[FLOOR, BALL, CHEST]);
    let shot = Shot::of(gpu, view, picture, SIZE / 2)?;
    let mut world = World::new(&labs.core, grid())?;
    world.inject(gpu, &[&shot], None)?;
    check_injection(gpu, &world, &[&shot], 2, "every other texel")
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

fn occupied_cells(gpu: &Gpu, world: &World) -> Result<Vec<bool>, Failed> {
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
