//! Gathered light and what it is given: what a view lights, and which sub-cells it fills and clears; sub-cells of other sources.

use std::f32::consts::PI;

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::gather::GatherSettings;
use lumivox::glam::{DVec3, UVec2, UVec3, Vec2, Vec3};
use lumivox::gpu::{AdapterChoice, Buffer, Gpu, GpuError, Tier};
use lumivox_oracle::closed_form;

use crate::cells::Cells;
use crate::gather::{Room, upload};
use crate::picture::{Paint, Shape, Thing};
use crate::support::{Random, Shot, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("gather: a view lights what it sees, in parts", direct),
    ("gather: views fill and clear sub-cells", views),
    ("gather: sub-cells from the bits of a finer grid", from_bits),
    ("gather: nothing is made while a frame is recorded", no_objects),
];

/// A floor that shines in a view from above for x below 7.5, in the middle of a cell.
fn half_lit() -> (Cells, [Thing; 1]) {
    let mut cells = Cells::new(16);
    for (x, z) in (0..16).flat_map(|x| (0..16).map(move |z| (x, z))) {
        cells.surface(UVec3::new(x, 2, z), Vec3::Y, 0.5);
        cells.surface(UVec3::new(x, 12, z), Vec3::NEG_Y, 0.0);
    }
    let paint = |p: DVec3| Paint {
        radiance: if p.x < 7.5 { DVec3::new(3.0, 2.0, 1.0) } else { DVec3::ZERO },
        ..Paint::default()
    };
    let floor = Thing(Shape::Plane { point: DVec3::new(0.0, 2.95, 0.0), normal: DVec3::Y }, paint);
    (cells, [floor])
}

/// Sub-cells of the floor and the roof: a layer each.
fn layers(cells: &Cells) -> Vec<u64> {
    let layer = |y: u32| (0..64u32).filter(|bit| (bit >> 2) & 3 == y).fold(0u64, |sum, bit| sum | 1 << bit);
    cells
        .grid
        .cells()
        .map(|c| match c.y {
            2 => layer(3),
            12 => layer(0),
            _ => 0,
        })
        .collect()
}

fn from_above(gpu: &Gpu, things: &[Thing]) -> Result<Shot, GpuError> {
    let view = View::orthographic(
        Vec3::new(8.0, 11.0, 8.0),
        Vec3::new(8.0, 0.0, 8.0),
        Vec3::Z,
        Vec2::splat(16.0),
        20.0,
    );
    Shot::take(gpu, view, UVec2::splat(128), things)
}

fn direct(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let (cells, things) = half_lit();
    let shot = from_above(gpu, &things)?;
    let mut room = Room::new(gpu, &cells, GatherSettings { rays: 256, ..GatherSettings::default() })?;
    room.light.upload_subcells(gpu, &layers(&cells))?;
    room.light.begin_frame(gpu);
    let Room { volume, light } = &mut room;
    run(gpu, |e| {
        light.record_surfels(gpu, e, volume)?;
        light.record_dark(gpu, e)?;
        light.record_light(gpu, e, &shot.input, volume)?;
        light.record_trace(gpu, e, volume)?;
        light.record_bounces(gpu, e, volume, 2)
    })?;
    let direct = light.read_direct(gpu)?;
    let floor = |x: u32| direct[cells.grid.index(UVec3::new(x, 2, 8))][2].unwrap_or_default();
    assert!((floor(3) - Vec3::new(3.0, 2.0, 1.0)).length() < 1e-3, "lit: {}", floor(3));
    // The border runs through the middle of a cell: eight of its sixteen points are lit.
    assert!((floor(7) - Vec3::new(1.5, 1.0, 0.5)).length() < 1e-3, "half lit: {}", floor(7));
    assert_eq!(floor(12), Vec3::ZERO);
    let roof = direct[cells.grid.index(UVec3::new(3, 12, 8))];
    assert_eq!((roof[3], roof[2]), (Some(Vec3::ZERO), Some(Vec3::ZERO)), "the view does not show the roof");
    // The roof is lit by the floor: half a plane, as seen from the point above its border.
    let e = light.read_irradiance(gpu)?[cells.grid.index(UVec3::new(7, 12, 8))][3].unwrap_or_default();
    let seen = 2.0 * closed_form::element_below_corner(7.5, 8.0, 9.25) as f32;
    eprintln!("roof over the border: {:.4} of {:.4}", e.x / (3.0 * PI), seen);
    assert!((e.x / (3.0 * PI) - seen).abs() < 0.02, "{e}");
    assert!((e.x / e.z - 3.0).abs() < 0.01, "colours mix: {e}");
    Ok(())
}

fn views(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let (cells, things) = half_lit();
    let shot = from_above(gpu, &things)?;
    let mut room = Room::new(gpu, &cells, GatherSettings { rays: 1, ..GatherSettings::default() })?;
    // Something that is not there any more, above the floor in the floor's cells and in others.
    let mut stale = cells.clone();
    stale.surface(UVec3::new(5, 6, 5), Vec3::Y, 0.5);
    upload(gpu, &mut room.volume, &stale)?;
    let bits: Vec<u64> = stale.normal.iter().map(|n| if n.w > 0.0 { u64::MAX } else { 0 }).collect();
    room.light.upload_subcells(gpu, &bits)?;
    let Room { volume, light } = &mut room;
    light.begin_frame(gpu);
    run(gpu, |e| {
        light.record_cleanup(gpu, e, &shot.input, volume)?;
        light.record_injection(gpu, e, &shot.input, volume)?;
        light.record_surfels(gpu, e, volume)
    })?;
    let found = light.read_subcells(gpu)?;
    assert_eq!(
        found[cells.grid.index(UVec3::new(5, 6, 5))],
        0,
        "a sub-cell that the view sees through stays"
    );
    let floor = found[cells.grid.index(UVec3::new(5, 2, 5))];
    // The floor's plane lies in the topmost layer; a camera that looks along a layer's middle proves nothing of it.
    let top = layers(&cells)[cells.grid.index(UVec3::new(5, 2, 5))];
    assert_eq!(floor & top, top, "the floor has holes");
    // From nothing.
    run(gpu, |e| {
        light.record_clear_subcells(e);
        light.record_injection(gpu, e, &shot.input, volume)?;
        light.record_surfels(gpu, e, volume)
    })?;
    let found = light.read_subcells(gpu)?;
    for x in 1..15 {
        assert_eq!(found[cells.grid.index(UVec3::new(x, 2, 5))], top, "cell {x} of the floor");
        assert_eq!(found[cells.grid.index(UVec3::new(x, 12, 5))], 0, "the view does not show the roof");
    }
    Ok(())
}

fn no_objects(_: &Labs) -> Result<(), Failed> {
    // A device of its own: other tests make objects meanwhile.
    let gpu = &Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let (cells, things) = half_lit();
    let shot = from_above(gpu, &things)?;
    let mut room = Room::new(gpu, &cells, GatherSettings { frames: 4.0, ..GatherSettings::default() })?;
    let Room { volume, light } = &mut room;
    let mut frame = || -> Result<u64, GpuError> {
        let before = gpu.created_objects();
        light.begin_frame(gpu);
        run(gpu, |e| {
            light.record_cleanup(gpu, e, &shot.input, volume)?;
            light.record_injection(gpu, e, &shot.input, volume)?;
            light.record_surfels(gpu, e, volume)?;
            light.record_dark(gpu, e)?;
            light.record_light(gpu, e, &shot.input, volume)?;
            light.record_trace(gpu, e, volume)?;
            light.record_bounces(gpu, e, volume, 3)
        })?;
        Ok(gpu.created_objects() - before)
    };
    // Bind groups are made for either side of the ping-pong.
    frame()?;
    frame()?;
    for _ in 0..4 {
        assert_eq!(frame()?, 0);
    }
    Ok(())
}

/// A bit each, in the order of a grid four times as fine.
fn from_bits(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(5);
    let mut random = Random::new(7);
    let mut words = vec![0u32; 20 * 20 * 20 / 32];
    let mut expected = vec![0u64; 125];
    for n in (0..8000u32).filter(|_| random.unit() < 0.1) {
        let fine = UVec3::new(n % 20, n / 20 % 20, n / 400);
        let place = fine % 4;
        words[n as usize / 32] |= 1 << (n % 32);
        expected[cells.grid.index(fine / 4)] |= 1 << (place.x + 4 * (place.y + 4 * place.z));
        cells.surface(fine / 4, Vec3::ZERO, 0.5);
    }
    let mut room = Room::new(gpu, &cells, GatherSettings { rays: 1, ..GatherSettings::default() })?;
    let fine = Buffer::storage_with(gpu, "fine", &words)?;
    let Room { volume, light } = &mut room;
    light.begin_frame(gpu);
    run(gpu, |e| {
        light.record_subcells(gpu, e, volume, &fine)?;
        light.record_surfels(gpu, e, volume)
    })?;
    assert_eq!(light.read_subcells(gpu)?, expected);
    let few = Buffer::storage_with(gpu, "few", &words[1..])?;
    let refused = run(gpu, |e| light.record_subcells(gpu, e, volume, &few));
    assert!(refused.is_err_and(|error| error.to_string().contains("7968 bits")));
    Ok(())
}
