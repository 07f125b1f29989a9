//! The lighting rule: means of samples, summed over lights, replaced by the camera, gone with their lamp; and that the
//! same input gives the same bits.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{DVec3, UVec2, Vec2, Vec3, Vec4};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::volume::NORMAL;

use crate::picture::{Paint, Picture, Shape, Thing};
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, views};
use crate::support::{Lab, Shot, World, channel};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("lighting: the means of two lights are summed", lights_are_summed),
    ("lighting: camera samples replace the sum of the lights", camera_replaces),
    ("lighting: views that add light alone add the same light and no attributes", light_only),
    ("lighting: twice the resolution is the same light", resolution_does_not_matter),
    ("lighting: a lamp that goes out leaves no light, seen or not", lamps_go_out),
    ("lighting: the same frames give the same bits, on every tier", same_bits),
];

type Light = Vec<[Vec4; 3]>;

/// The light of one frame in an empty volume.
fn lit(lab: &Lab, lamps: &[&Shot], camera: Option<&Shot>) -> Result<(World, Light), GpuError> {
    let mut world = World::new(lab, grid())?;
    world.inject(&lab.gpu, lamps, camera)?;
    let light = world.light.read_back(&lab.gpu)?;
    Ok((world, light))
}

fn shots(gpu: &Gpu) -> Result<[Shot; 3], GpuError> {
    let [a, b, c] = views().map(|(_, view)| Shot::take(gpu, view, SIZE, &[FLOOR, BALL, CHEST]));
    Ok([a?, b?, c?])
}

fn lights_are_summed(labs: &Labs) -> Result<(), Failed> {
    let [one, two, _] = shots(&labs.core.gpu)?;
    let (_, first) = lit(&labs.core, &[&one], None)?;
    let (_, second) = lit(&labs.core, &[&two], None)?;
    let (_, both) = lit(&labs.core, &[&one, &two], None)?;
    let mut shared = 0;
    for (cell, sum) in both.iter().enumerate() {
        shared += usize::from(first[cell][0].x > 0.0 && second[cell][0].x > 0.0);
        for band in 0..3 {
            let (a, b) = (first[cell][band], second[cell][band]);
            // Three conversions to half floats: of both means here, of the first and of the sum there.
            let tolerance = (a.abs() + b.abs() + sum[band].abs()) / 1024.0 + 1e-6;
            let off = (sum[band] - a - b).abs();
            assert!(off.cmple(tolerance).all(), "cell {cell}: {a} and {b} make {}", sum[band]);
        }
    }
    assert!(shared > 50, "only {shared} cells have both lights");
    Ok(())
}

fn camera_replaces(labs: &Labs) -> Result<(), Failed> {
    let [one, two, camera] = shots(&labs.core.gpu)?;
    let (_, lamps) = lit(&labs.core, &[&one, &two], None)?;
    let (seen, by_camera) = lit(&labs.core, &[], Some(&camera))?;
    let (_, all) = lit(&labs.core, &[&one, &two], Some(&camera))?;
    let seen = seen.read(&labs.core.gpu)?;
    let (mut replaced, mut unseen) = (0, 0);
    for (cell, light) in all.iter().enumerate() {
        let sampled = channel(&seen, NORMAL)[cell].w > 0.0;
        let expected = if sampled { by_camera[cell] } else { lamps[cell] };
        assert_eq!(*light, expected, "cell {cell}, seen by the camera: {sampled}");
        replaced += usize::from(sampled && lamps[cell] != [Vec4::ZERO; 3]);
        unseen += usize::from(!sampled && lamps[cell] != [Vec4::ZERO; 3]);
    }
    assert!(replaced > 50 && unseen > 50, "{replaced} cells replaced, {unseen} not");
    Ok(())
}

/// Two views of one lamp, then the camera, in a volume that already holds something everywhere.
fn light_only(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [one, two, camera] = shots(gpu)?;
    let frame = |only: bool, with_camera: bool| -> Result<_, Failed> {
        let mut world = World::new(&labs.core, grid())?;
        world.scatter(gpu, 11)?;
        let uploaded = world.read(gpu)?;
        world.inject_with(gpu, |progressive, e, volume, light| {
            let views = [&one.input, &two.input];
            match only {
                true => progressive.record_light_only(gpu, e, views, volume, light)?,
                false => progressive.record_light(gpu, e, views, volume, light)?,
            }
            if with_camera {
                progressive.record_camera(gpu, e, &camera.input, volume, light)?;
            }
            progressive.record_end(gpu, e, &camera.input, volume, light)
        })?;
        Ok((uploaded, world.read(gpu)?, world.light.read_back(gpu)?))
    };
    for with_camera in [false, true] {
        let ((_, with, expected), (uploaded, without, light)) =
            (frame(false, with_camera)?, frame(true, with_camera)?);
        assert_eq!(light, expected, "another light, with the camera: {with_camera}");
        assert!(light.iter().filter(|c| c[0].x > 0.0).count() > 100, "nothing was lit");
        assert!(with != without, "attributes of the lamp make no difference");
        assert!(with_camera || without == uploaded, "attributes changed");
    }
    Ok(())
}

/// W/(m2 sr) per metre.
const SLOPE: f64 = 0.2;

fn slope_paint(p: DVec3) -> Paint {
    Paint { radiance: DVec3::splat(1.5 + SLOPE * p.x), ..Default::default() }
}

/// On a plane whose radiance rises evenly, the means of two sample sets of one cell differ by no more than the rise across
/// the cell, and on average by much less. A sum over samples would quadruple.
fn resolution_does_not_matter(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let plane = Thing(Shape::Plane { point: DVec3::new(0.0, -0.9, 0.0), normal: DVec3::Y }, slope_paint);
    let view = View::orthographic(Vec3::Y * 3.0, Vec3::ZERO, Vec3::Z, Vec2::splat(4.4), 6.0);
    let picture = |side| Picture::take(&view, UVec2::splat(side), &[plane]);
    let sizes = [(64, 32), (64, 64), (128, 128)];
    let mut lights = Vec::new();
    for (side, points) in sizes {
        let shot = Shot::of(gpu, view, picture(side), UVec2::splat(points))?;
        lights.push(lit(&labs.core, &[&shot], None)?.1);
    }
    let lobe = std::f64::consts::PI.sqrt() / 2.0;
    let rise = SLOPE * f64::from(grid().cell_size) * lobe;
    for (fine, (side, points)) in lights.iter().zip(sizes).skip(1) {
        let pairs = lights[0].iter().zip(fine).map(|(a, b)| [a[0].x, b[0].x].map(f64::from));
        // The finer grid reaches further by half a point, which may be one more row of cells.
        let both: Vec<_> = pairs.filter(|[a, b]| *a > 0.0 && *b > 0.0).collect();
        assert!(both.len() > 200, "only {} cells are lit", both.len());
        let worst = both.iter().map(|[a, b]| (a - b).abs()).fold(0.0, f64::max);
        let [coarse, fine] = [0, 1].map(|i| both.iter().map(|pair| pair[i]).sum::<f64>());
        eprintln!(
            "{points} points of {side}: worst {:.3} of the rise, total {:.5}",
            worst / rise,
            fine / coarse
        );
        assert!(worst <= rise * 1.02, "{points} of {side}: a cell changed by {worst}, the rise is {rise}");
        assert!((fine / coarse - 1.0).abs() < 2e-3, "the light of all cells changed by {}", fine / coarse);
    }
    Ok(())
}

fn lamps_go_out(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [lamp, _, camera] = shots(gpu)?;
    let dark = |paint: &mut Picture| paint.radiance.fill(Default::default());
    let mut picture = Picture::take(&camera.view, SIZE, &[FLOOR, BALL, CHEST]);
    dark(&mut picture);
    let dark_camera = Shot::of(gpu, camera.view, picture, SIZE)?;
    let (mut world, before) = lit(&labs.core, &[&lamp], Some(&camera))?;
    assert!(before.iter().filter(|c| c[0].x > 0.0).count() > 100, "nothing was lit");
    // Seen by a camera that shows darkness, and then by nothing at all.
    for camera in [Some(&dark_camera), None] {
        world.inject(gpu, &[&lamp], None)?;
        world.inject(gpu, &[], camera)?;
        let light = world.light.read_back(gpu)?;
        let remains = light.iter().flatten().flat_map(|band| band.to_array()).any(|v| v.to_bits() != 0);
        assert!(!remains, "light remains, a camera looks: {}", camera.is_some());
    }
    Ok(())
}

fn same_bits(labs: &Labs) -> Result<(), Failed> {
    let frames = |lab: &Lab| -> Result<_, GpuError> {
        let [one, two, camera] = shots(&lab.gpu)?;
        let mut world = World::new(lab, grid())?;
        for lamps in [[&one, &two], [&two, &one]] {
            for view in [&one, &two, &camera] {
                world.clean(&lab.gpu, view)?;
            }
            world.inject(&lab.gpu, &lamps, Some(&camera))?;
        }
        let light: Vec<u32> = world.light.read_back(&lab.gpu)?.iter().flatten().flat_map(bits).collect();
        let volume = world.read(&lab.gpu)?;
        let cells: Vec<u32> = volume.names().flat_map(|n| channel(&volume, n)).flat_map(bits).collect();
        Ok((light, cells))
    };
    let first = frames(&labs.core)?;
    assert!(first.0.iter().filter(|b| **b != 0).count() > 1000);
    assert!(first == frames(&labs.core)?, "two runs on one device differ");
    assert!(first == frames(&labs.native)?, "two tiers differ");
    Ok(())
}

fn bits(v: &Vec4) -> [u32; 4] {
    v.to_array().map(f32::to_bits)
}
