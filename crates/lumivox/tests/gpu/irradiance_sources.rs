//! Light in free space of the ways that go from cell to cell: in the same textures and units as gathered light.

use std::f32::consts::PI;

use libtest_mimic::Failed;
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, View};
use lumivox::gather::GatherSettings;
use lumivox::glam::{DVec3, UVec2, UVec3, Vec2, Vec3};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::irradiance::{IrradianceSource, IrradianceVolume};
use lumivox::light::{IndirectLight, LightSettings};
use lumivox::lpv::{Blocking, LightPropagationVolume};
use lumivox::progressive::CHANNELS;

use crate::cells::{Cells, uploaded};
use crate::gather::Room;
use crate::irradiance::{ALL_AROUND, IN_SPACE, ON_SURFACE, ask, question};
use crate::picture::{Paint, Shape, Thing};
use crate::support::{Lab, Shot, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("irradiance sources: in a furnace all ways give the same", furnace),
    ("irradiance sources: propagation without free space says so", no_free_space),
    ("irradiance sources: light propagation volumes light what faces a lit wall", facing),
];

/// Fills a volume of light by any way.
fn filled(
    gpu: &Gpu,
    source: &dyn IrradianceSource,
    volume: &VolumeBuffer,
    spacing: u32,
) -> Result<IrradianceVolume, GpuError> {
    let mut lattice = IrradianceVolume::new(gpu, volume.grid(), spacing)?;
    // In parts, as a host would.
    for slice in 0..3 {
        run(gpu, |e| source.record_irradiance_volume(gpu, e, volume, &mut lattice, (128, slice, 3)))?;
    }
    Ok(lattice)
}

/// Light of a room by propagation, after so many steps.
fn propagated(lab: &Lab, cells: &Cells, steps: u32) -> Result<(VolumeBuffer, IndirectLight), GpuError> {
    let gpu = &lab.gpu;
    let (world, _) = uploaded(lab, cells)?;
    let mut light = IndirectLight::new(gpu, &world.volume)?.with_free_space(gpu);
    light.update(gpu, &LightSettings::default());
    run(gpu, |e| {
        light.record_transport(gpu, e, &world.volume)?;
        light.record_seed(gpu, e, &world.volume, &world.light)?;
        light.record_propagation(gpu, e, &world.volume, steps)
    })?;
    Ok((world.volume, light))
}

/// Its name, its light and its volume, and the least and the most of the closed form that it may have.
type Way<'a> = (&'static str, &'a dyn IrradianceSource, &'a VolumeBuffer, (f32, f32));

/// A closed room that glows evenly, asked in its middle and before its walls.
fn furnace(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let (radiance, albedo) = (0.25, 0.5);
    let mut cells = Cells::new(16);
    cells.room(0, 15, albedo, radiance);
    let expected = radiance / (1.0 - albedo);
    let (volume, light) = propagated(&labs.core, &cells, 300)?;
    let mut gathered = Room::new(gpu, &cells, GatherSettings::default())?;
    gathered.frame(gpu, 30)?;
    // The gain of free space is that between two walls; six have edges, too.
    let ways: [Way<'_>; 2] = [
        ("propagation", &light, &volume, (0.90, 1.03)),
        ("gather", &gathered.light, &gathered.volume, (0.97, 1.03)),
    ];
    let directions = [Vec3::X, Vec3::NEG_Y, Vec3::Z, Vec3::new(0.6, -0.64, 0.48)];
    for (name, source, volume, (low, high)) in ways {
        for spacing in [1, 2] {
            let lattice = filled(gpu, source, volume, spacing)?;
            let in_space: Vec<_> =
                directions.iter().map(|&n| question(Vec3::new(8.3, 7.6, 6.9), n)).collect();
            let on_wall: Vec<_> = [5.2, 8.0, 10.9]
                .iter()
                .flat_map(|&a| {
                    [
                        question(Vec3::new(1.0, a, 7.4), Vec3::X),
                        question(Vec3::new(a, 15.0, 8.4), Vec3::NEG_Y),
                    ]
                })
                .collect();
            for (asked, call, expected) in [
                (&in_space, IN_SPACE, PI * expected),
                (&on_wall, ON_SURFACE, PI * expected),
                (&in_space, ALL_AROUND, expected),
            ] {
                let parts: Vec<f32> =
                    ask(gpu, &lattice, call, asked)?.iter().map(|found| found.x / expected).collect();
                eprintln!("{name}, spacing {spacing}, {call}: {parts:.3?} of the closed form");
                assert!(parts.iter().all(|part| (low..high).contains(part)), "{name}: {call}: {parts:?}");
                // From all sides, and before all walls, the same.
                let (least, most) = parts.iter().fold((f32::MAX, 0f32), |(l, m), p| (l.min(*p), m.max(*p)));
                assert!(most < 1.1 * least, "{name}: {call}: {parts:?}");
            }
        }
    }
    Ok(())
}

fn no_free_space(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let cells = Cells::new(8);
    let (world, _) = uploaded(&labs.core, &cells)?;
    let light = IndirectLight::new(gpu, &world.volume)?;
    let refused = filled(gpu, &light, &world.volume, 1).err().ok_or("there is light where none is kept")?;
    assert!(refused.to_string().contains("with_free_space"), "{refused}");
    assert!(!light.keeps_free_space() && light.with_free_space(gpu).keeps_free_space());
    Ok(())
}

/// A wall at x = 3 that shines, and nothing else: what faces it is lit, what turns away gets a negative lobe's nothing.
fn facing(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let grid = Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::splat(16) };
    let volume = VolumeBuffer::new(gpu, grid, &CHANNELS)?;
    let mut light = LightPropagationVolume::new(gpu, &volume, Blocking::None)?;
    let (eye, to) = (Vec3::new(14.0, 8.0, 8.0), Vec3::new(3.0, 8.0, 8.0));
    let view = View::orthographic(eye, to, Vec3::Y, Vec2::splat(12.0), 16.0);
    let wall = Shape::Plane { point: DVec3::X * 3.0, normal: DVec3::X };
    let paint = |_: DVec3| Paint { radiance: DVec3::new(4.0, 2.0, 1.0), ..Paint::default() };
    let shot = Shot::take(gpu, view, UVec2::splat(96), &[Thing(wall, paint)])?;
    run(gpu, |e| {
        light.record_begin(e);
        light.record_light(gpu, e, &shot.input, &volume)?;
        light.record_seed(gpu, e, &shot.input, &volume)?;
        light.record_propagation(gpu, e, &volume, 24)
    })?;
    let lattice = filled(gpu, &light, &volume, 1)?;
    let before = Vec3::new(5.5, 8.5, 8.5);
    let asked: Vec<_> = [Vec3::NEG_X, Vec3::Y, Vec3::X].iter().map(|&n| question(before, n)).collect();
    let found = ask(gpu, &lattice, IN_SPACE, &asked)?;
    let cell = light.read_accumulated(gpu)?[grid.index(UVec3::new(5, 8, 8))];
    // What its own reconstruction would say there: two thirds of the cosine lobe's, by the way that light travels.
    let expected = |n: Vec3| {
        let lobe = lumivox::core::sh::cosine_lobe(-n).to_array();
        let dot: f32 = cell[0].iter().zip(lobe).map(|(c, l)| c * l).sum();
        (2.0 / 3.0 * dot).max(0.0)
    };
    for (n, found) in [Vec3::NEG_X, Vec3::Y, Vec3::X].into_iter().zip(&found) {
        assert!(
            (found.x - expected(n)).abs() < 2e-3 * expected(Vec3::NEG_X),
            "{n}: {} for {}",
            found.x,
            expected(n)
        );
        assert!((found.x - 2.0 * found.y).abs() <= 2e-3 * found.x, "colours mix: {found:?}");
    }
    eprintln!("before the wall {:.3}, beside {:.3}, away from it {:.3}", found[0].x, found[1].x, found[2].x);
    assert!(
        found[2].x > 1.0 && found[0].x > 1.03 * found[1].x && found[1].x > 1.03 * found[2].x,
        "{found:?}"
    );
    Ok(())
}
