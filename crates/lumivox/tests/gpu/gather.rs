//! Gathered light: which surfels there are, what their rays find, and that no bounce makes energy.

use std::f32::consts::PI;

use libtest_mimic::Failed;
use lumivox::VolumeBuffer;
use lumivox::gather::{GatherSettings, GatheredLight};
use lumivox::glam::{UVec3, Vec3, Vec4};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::progressive::CHANNELS;
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};
use lumivox_oracle::closed_form;

use crate::cells::Cells;
use crate::support::{Random, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("gather: surfels are the open sides of sub-cells", surfels),
    ("gather: places are given back and out again", places),
    ("gather: a new surfel takes nothing over from its place's last owner", strangers),
    ("gather: a furnace has its closed form", furnace),
    ("gather: facing plates have their form factor", plates),
    ("gather: light is linear, and the same every time", linear),
    ("gather: walls of a quarter of a cell hold light back, corners too", walls),
    ("gather: the sky reaches what can see it", sky),
    ("gather: a sky that is not the same everywhere comes from where it is", sky_sides),
    ("gather: what comes straight from the sky can be left out", sky_apart),
    ("gather: a lamp that is switched off leaves nothing behind", switched_off),
];

const SUBCELLS: u32 = 4;

/// A volume with its gathered light.
pub(crate) struct Room {
    pub(crate) volume: VolumeBuffer,
    pub(crate) light: GatheredLight,
}

impl Room {
    pub(crate) fn new(gpu: &Gpu, cells: &Cells, settings: GatherSettings) -> Result<Self, GpuError> {
        let mut volume = VolumeBuffer::new(gpu, cells.grid, &CHANNELS)?;
        upload(gpu, &mut volume, cells)?;
        let light = GatheredLight::new(gpu, &volume, settings)?;
        Ok(Self { volume, light })
    }

    /// One frame without views.
    pub(crate) fn frame(&mut self, gpu: &Gpu, bounces: u32) -> Result<(), GpuError> {
        let Self { volume, light } = self;
        light.begin_frame(gpu);
        run(gpu, |e| {
            light.record_surfels(gpu, e, volume)?;
            light.record_dark(gpu, e)?;
            light.record_trace(gpu, e, volume)?;
            light.record_bounces(gpu, e, volume, bounces)
        })
    }
}

pub(crate) fn upload(gpu: &Gpu, volume: &mut VolumeBuffer, cells: &Cells) -> Result<(), GpuError> {
    volume.upload(gpu, NORMAL, &cells.normal)?;
    volume.upload(gpu, ALBEDO, &cells.albedo)?;
    volume.upload(gpu, EMISSION, &cells.emission)
}

/// Sub-cells, as a predicate of their positions, and the cells that hold them.
pub(crate) fn filled(side: u32, albedo: f32, is_filled: impl Fn(UVec3) -> bool) -> (Cells, Vec<u64>) {
    let mut cells = Cells::new(side);
    let mut bits = vec![0u64; cells.grid.cell_count() as usize];
    for cell in cells.grid.cells().collect::<Vec<_>>() {
        for bit in 0..64 {
            let place = UVec3::new(bit & 3, (bit >> 2) & 3, bit >> 4);
            if is_filled(SUBCELLS * cell + place) {
                bits[cells.grid.index(cell)] |= 1 << bit;
            }
        }
        if bits[cells.grid.index(cell)] != 0 {
            // No normal: every open side is one.
            cells.surface(cell, Vec3::ZERO, albedo);
        }
    }
    (cells, bits)
}

fn side_normal(face: usize) -> Vec3 {
    let axis = Vec3::AXES[face / 2];
    if face.is_multiple_of(2) { axis } else { -axis }
}

fn surfels(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut random = Random::new(5);
    let solid: Vec<bool> = (0..(5 * SUBCELLS).pow(3)).map(|_| random.unit() < 0.2).collect();
    let side = 5 * SUBCELLS;
    let at = |p: UVec3| solid[(p.x + side * (p.y + side * p.z)) as usize];
    let (cells, bits) = filled(5, 0.5, at);
    let settings = GatherSettings { rays: 1, surfels: Some(12 * 125), ..GatherSettings::default() };
    let mut room = Room::new(gpu, &cells, settings)?;
    room.light.upload_subcells(gpu, &bits)?;
    room.frame(gpu, 1)?;
    let found = room.light.read_irradiance(gpu)?;
    let mut expected = 0;
    for cell in cells.grid.cells() {
        for (face, surfel) in found[cells.grid.index(cell)].iter().enumerate() {
            let step = side_normal(face).as_ivec3();
            // Sub-cell `bit` of the cell, and whether there is free space before it.
            let place = |bit: u32| SUBCELLS * cell + UVec3::new(bit & 3, (bit >> 2) & 3, bit >> 4);
            let free = |bit: u32| {
                let next = place(bit).as_ivec3() + step;
                next.min_element() < 0 || next.max_element() >= side as i32 || !at(next.as_uvec3())
            };
            let open: Vec<u32> = (0..64).filter(|&bit| at(place(bit)) && free(bit)).collect();
            assert_eq!(surfel.is_some(), !open.is_empty(), "cell {cell}, face {face}");
            let Some(&first) = open.first() else { continue };
            // All that the first can be reached from through free space.
            let mut reached = vec![first];
            for n in 0.. {
                let Some(&here) = reached.get(n) else { break };
                let nearby = (0..64).filter(|&bit| {
                    let way = (place(bit).as_ivec3() - place(here).as_ivec3()).abs();
                    way.element_sum() == 1 && free(bit) && !reached.contains(&bit)
                });
                reached.extend(nearby.collect::<Vec<_>>());
            }
            expected += if open.iter().all(|bit| reached.contains(bit)) { 1 } else { 2 };
        }
    }
    let count = room.light.count(gpu)?;
    assert!(expected > 300, "only {expected} surfels expected");
    assert_eq!((count.used, count.refused), (expected, 0));
    assert_eq!(room.light.read_subcells(gpu)?, bits);
    // With too little room the rest is dark, and counted.
    let settings = GatherSettings { surfels: Some(200), ..settings };
    let mut room = Room::new(gpu, &cells, settings)?;
    room.light.upload_subcells(gpu, &bits)?;
    room.frame(gpu, 1)?;
    let count = room.light.count(gpu)?;
    assert_eq!((count.used, count.refused), (200, expected - 200));
    Ok(())
}

fn places(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut random = Random::new(9);
    let empty = Cells::new(8);
    let mut room = Room::new(gpu, &empty, GatherSettings { rays: 1, ..GatherSettings::default() })?;
    for round in 0..20 {
        let mut cells = Cells::new(8);
        let mut expected = 0;
        for cell in cells.grid.cells().collect::<Vec<_>>() {
            // Single cells with six open sides each.
            if cell.to_array().iter().all(|c| c % 2 == 1) && random.unit() < 0.5 {
                cells.surface(cell, Vec3::ZERO, 0.5);
                let index = cells.grid.index(cell);
                cells.emission[index] = Vec4::splat(index as f32 + 1.0);
                expected += 6;
            }
        }
        upload(gpu, &mut room.volume, &cells)?;
        room.frame(gpu, 1)?;
        let count = room.light.count(gpu)?;
        assert_eq!((count.used, count.refused), (expected, 0), "round {round}");
        let found = room.light.read_irradiance(gpu)?;
        let sides = found.iter().flatten().flatten().count();
        assert_eq!(sides, expected as usize, "round {round}");
    }
    Ok(())
}

/// A lamp on one side of a wall, and one cell more, here or there.
fn strangers(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let with = |place: UVec3| {
        let mut cells = Cells::new(16);
        for (y, z) in (0..16).flat_map(|y| (0..16).map(move |z| (y, z))) {
            cells.surface(UVec3::new(10, y, z), Vec3::ZERO, 0.0);
        }
        let lamp = UVec3::new(7, 8, 8);
        cells.surface(lamp, Vec3::ZERO, 0.0);
        let index = cells.grid.index(lamp);
        cells.emission[index] = Vec4::splat(50.0);
        cells.surface(place, Vec3::ZERO, 0.0);
        cells
    };
    let (lit, dark) = (UVec3::new(5, 8, 8), UVec3::new(13, 8, 8));
    let settings = GatherSettings { rays: 64, frames: 64.0, ..GatherSettings::default() };
    let mut room = Room::new(gpu, &with(lit), settings)?;
    for _ in 0..64 {
        room.frame(gpu, 1)?;
    }
    let grid = *room.volume.grid();
    let sum = |room: &Room, cell: UVec3| -> Result<f32, GpuError> {
        let found = room.light.read_irradiance(gpu)?;
        Ok(found[grid.index(cell)].iter().flatten().map(|e| e.x).sum())
    };
    assert!(sum(&room, lit)? > 1.0, "the lamp does not shine on its neighbour");
    upload(gpu, &mut room.volume, &with(dark))?;
    room.frame(gpu, 1)?;
    assert_eq!(sum(&room, dark)?, 0.0);
    Ok(())
}

fn furnace(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for albedo in [0.2, 0.5, 0.8, 0.95] {
        let mut cells = Cells::new(16);
        cells.room(0, 15, albedo, 1.0);
        let mut room = Room::new(gpu, &cells, GatherSettings { rays: 64, ..GatherSettings::default() })?;
        let mut before = 0.0;
        // With albedo 0.95 a hundred bounces leave 0.6 % to come.
        for bounces in [1, 9, 90] {
            room.frame(gpu, bounces)?;
            let found = room.light.read_irradiance(gpu)?;
            let sum: f32 = found.iter().flatten().flatten().map(|e| e.x).sum();
            assert!(sum >= before, "albedo {albedo}: light shrinks from {before} to {sum}");
            before = sum;
        }
        let found = room.light.read_irradiance(gpu)?;
        let expected = PI * closed_form::furnace(f64::from(albedo), 1.0) as f32;
        let inner = |cell: UVec3, face: usize| {
            let next = cell.as_vec3() + side_normal(face);
            next.cmpgt(Vec3::ZERO).all() && next.cmplt(Vec3::splat(15.0)).all()
        };
        let mut worst = 1f32;
        for cell in cells.grid.cells() {
            for (face, e) in found[cells.grid.index(cell)].iter().enumerate() {
                if let (Some(e), true) = (e, inner(cell, face)) {
                    let ratio = e.x / expected;
                    worst = if (ratio - 1.0).abs() > (worst - 1.0).abs() { ratio } else { worst };
                }
            }
        }
        eprintln!("furnace, albedo {albedo}: worst cell {worst:.4} of the closed form");
        assert!((0.98..1.005).contains(&worst), "albedo {albedo}: {worst}");
    }
    Ok(())
}

/// Two square plates that face each other, 8 cells wide and 6 apart; the lower one shines.
fn facing_plates(emission: f32) -> Cells {
    let mut cells = Cells::new(16);
    for (x, z) in (4..12).flat_map(|x| (4..12).map(move |z| (x, z))) {
        cells.surface(UVec3::new(x, 3, z), Vec3::Y, 0.0);
        cells.surface(UVec3::new(x, 10, z), Vec3::NEG_Y, 0.0);
        let index = cells.grid.index(UVec3::new(x, 3, z));
        cells.emission[index] = Vec3::splat(emission).extend(0.0);
    }
    cells
}

fn plates(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let cells = facing_plates(2.0);
    let mut room = Room::new(gpu, &cells, GatherSettings { rays: 256, ..GatherSettings::default() })?;
    room.frame(gpu, 1)?;
    let found = room.light.read_irradiance(gpu)?;
    let under = |x, z| found[cells.grid.index(UVec3::new(x, 10, z))][3].map_or(0.0, |e| e.x);
    let mean = (4..12).flat_map(|x| (4..12).map(move |z| under(x, z))).sum::<f32>() / 64.0;
    let expected = 2.0 * PI * closed_form::facing_rectangles(8.0, 8.0, 6.0) as f32;
    eprintln!("facing plates: {:.4} of the form factor", mean / expected);
    assert!((mean / expected - 1.0).abs() < 0.02, "{mean} for {expected}");
    // What looks away gets nothing.
    assert_eq!(found[cells.grid.index(UVec3::new(7, 10, 7))][2], Some(Vec3::ZERO));
    Ok(())
}

fn linear(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let light = |cells: &Cells| -> Result<Vec<Option<Vec3>>, GpuError> {
        let mut room = Room::new(gpu, cells, GatherSettings::default())?;
        room.frame(gpu, 3)?;
        Ok(room.light.read_irradiance(gpu)?.into_iter().flatten().collect())
    };
    let mut cells = Cells::new(16);
    cells.room(2, 13, 0.7, 0.0);
    let mut brighter = cells.clone();
    for (lamp, power) in [(UVec3::new(5, 2, 6), 0.5), (UVec3::new(2, 7, 7), 2.0)] {
        let index = cells.grid.index(lamp);
        cells.emission[index] = Vec3::splat(power).extend(0.0);
        brighter.emission[index] = Vec3::splat(4.0 * power).extend(0.0);
    }
    let (once, again, more) = (light(&cells)?, light(&cells)?, light(&brighter)?);
    assert!(once.iter().flatten().any(|e| e.x > 0.01), "there is no light");
    assert_eq!(once, again);
    for (dim, bright) in once.iter().zip(&more) {
        let (dim, bright) = (dim.unwrap_or_default(), bright.unwrap_or_default());
        // Powers of two: half floats round alike, but for the smallest.
        assert!((bright - 4.0 * dim).length() <= 1e-3 * bright.length() + 1e-5, "{dim} and {bright}");
    }
    Ok(())
}

/// A closed box in a bright world, its walls a sub-cell thick and not aligned with cells.
fn walls(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let (low, high) = (UVec3::splat(17), UVec3::splat(46));
    let wall = |p: UVec3| p.cmpge(low).all() && p.cmple(high).all() && (p.cmpeq(low) | p.cmpeq(high)).any();
    let (cells, bits) = filled(16, 0.8, wall);
    let settings = GatherSettings { sky: Vec3::ONE, rays: 256, ..GatherSettings::default() };
    let mut room = Room::new(gpu, &cells, settings)?;
    room.light.upload_subcells(gpu, &bits)?;
    room.frame(gpu, 30)?;
    let found = room.light.read_irradiance(gpu)?;
    let (mut inside, mut outside) = ((0.0, 0u32), (0.0f32, 0u32));
    for cell in cells.grid.cells() {
        for (face, e) in found[cells.grid.index(cell)].iter().enumerate() {
            let Some(e) = e else { continue };
            // Where the side looks: into the box or out of it.
            let middle = (0.5 * (low + high).as_vec3() + 0.5) / SUBCELLS as f32;
            let inward = side_normal(face).dot(middle - cell.as_vec3() - 0.5) > 0.0;
            let sum = if inward { &mut inside } else { &mut outside };
            *sum = (sum.0 + e.x, sum.1 + 1);
        }
    }
    let (inside, outside) = (inside.0 / inside.1 as f32, outside.0 / outside.1 as f32);
    eprintln!("walls: inside {inside:.6}, outside {outside:.4}");
    assert!((outside / PI - 1.0).abs() < 0.02, "outside {outside}");
    assert!(inside < 1e-4 * outside, "inside {inside}, outside {outside}");
    Ok(())
}

fn sky(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // A floor, and a disc over it: what the floor's middle sees of the sky is known.
    let mut cells = Cells::new(16);
    for (x, z) in (0..16).flat_map(|x| (0..16).map(move |z| (x, z))) {
        cells.surface(UVec3::new(x, 0, z), Vec3::Y, 0.0);
    }
    let settings = GatherSettings { sky: Vec3::new(1.0, 2.0, 3.0), rays: 256, ..GatherSettings::default() };
    let mut room = Room::new(gpu, &cells, settings)?;
    room.frame(gpu, 1)?;
    let open = room.light.read_irradiance(gpu)?;
    let middle = cells.grid.index(UVec3::new(8, 0, 8));
    let expected = PI * Vec3::new(1.0, 2.0, 3.0);
    assert!((open[middle][2].unwrap_or_default() / expected - 1.0).abs().max_element() < 2e-3);
    for (x, z) in (4..12).flat_map(|x| (4..12).map(move |z| (x, z))) {
        cells.surface(UVec3::new(x, 5, z), Vec3::NEG_Y, 0.0);
    }
    upload(gpu, &mut room.volume, &cells)?;
    room.frame(gpu, 1)?;
    let covered = room.light.read_irradiance(gpu)?;
    // An element below the common corner of four plates of 4 x 4, at four cells' distance.
    let seen = 4.0 * closed_form::element_below_corner(4.0, 4.0, 4.0) as f32;
    let corners = [(7, 7), (8, 7), (7, 8), (8, 8)];
    let mean = corners
        .iter()
        .map(|&(x, z)| covered[cells.grid.index(UVec3::new(x, 0, z))][2].unwrap_or_default().x)
        .sum::<f32>()
        / 4.0;
    eprintln!("sky: {:.4} of it is left, {:.4} expected", mean / PI, 1.0 - seen);
    assert!((mean / PI - (1.0 - seen)).abs() < 0.02, "{mean}");
    Ok(())
}

/// Radiance 1 plus a direction's coordinates: on an open side it gives pi plus two thirds of pi times the side's normal.
fn sky_sides(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(8);
    let middle = UVec3::splat(4);
    cells.surface(middle, Vec3::ZERO, 0.0);
    let mut room = Room::new(gpu, &cells, GatherSettings { rays: 512, ..GatherSettings::default() })?;
    room.light.set_sky(gpu, |direction| Vec3::ONE + direction);
    room.frame(gpu, 1)?;
    let found = room.light.read_irradiance(gpu)?[cells.grid.index(middle)];
    for (face, e) in found.into_iter().enumerate() {
        let expected = PI * (Vec3::ONE + 2.0 / 3.0 * side_normal(face));
        let e = e.ok_or("a side is missing")?;
        assert!((e - expected).abs().max_element() < 0.02 * PI, "face {face}: {e} for {expected}");
    }
    Ok(())
}

/// A white floor and a wall under an even sky.
fn sky_apart(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(16);
    for (x, z) in (2..14).flat_map(|x| (2..14).map(move |z| (x, z))) {
        cells.surface(UVec3::new(x, 2, z), Vec3::Y, 0.5);
        cells.surface(UVec3::new(2, x, z), Vec3::X, 0.5);
    }
    let irradiance = |sky_apart| -> Result<Vec<[Option<Vec3>; 6]>, GpuError> {
        let settings = GatherSettings { sky: Vec3::ONE, sky_apart, rays: 256, ..GatherSettings::default() };
        let mut room = Room::new(gpu, &cells, settings)?;
        // The light must not depend on how often it is taken up.
        room.frame(gpu, 2)?;
        room.frame(gpu, 8)?;
        room.light.read_irradiance(gpu)
    };
    let (all, apart) = (irradiance(false)?, irradiance(true)?);
    let at =
        |e: &[[Option<Vec3>; 6]], x: u32| e[cells.grid.index(UVec3::new(x, 2, 8))][2].map_or(0.0, |e| e.x);
    for x in [4, 7, 11] {
        let (whole, reflected) = (at(&all, x), at(&apart, x));
        // The wall hides a part of the sky and reflects some of what it gets, of half a sky and of the floor.
        assert!(whole > 0.5 * PI && whole < PI, "{x}: {whole}");
        assert!(reflected > 0.01 && reflected < 0.3 * PI, "{x}: {reflected}");
        let hidden = PI - (whole - reflected);
        let ratio = reflected / hidden;
        assert!((0.2..0.45).contains(&ratio), "{x}: the wall's radiance is {ratio}");
    }
    Ok(())
}

fn switched_off(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(16);
    cells.room(1, 14, 0.6, 0.0);
    let lamp = cells.grid.index(UVec3::new(7, 1, 7));
    cells.emission[lamp] = Vec4::splat(40.0);
    let mut room = Room::new(gpu, &cells, GatherSettings::default())?;
    let total = |room: &Room| -> Result<f32, GpuError> {
        let found = room.light.read_irradiance(gpu)?;
        Ok(found.iter().flatten().flatten().map(|e| e.x).sum())
    };
    room.frame(gpu, 1)?;
    let first = total(&room)?;
    room.frame(gpu, 60)?;
    let settled = total(&room)?;
    // 90 % of all bounces within eight frames of one bounce each.
    let mut rising = Room::new(gpu, &cells, GatherSettings::default())?;
    for _ in 0..8 {
        rising.frame(gpu, 1)?;
    }
    let after = total(&rising)? / settled;
    eprintln!("first bounce {:.3}, eight frames {after:.3} of all", first / settled);
    assert!(after > 0.9, "{after} after eight frames");
    cells.emission[lamp] = Vec4::ZERO;
    upload(gpu, &mut room.volume, &cells)?;
    for _ in 0..8 {
        room.frame(gpu, 1)?;
    }
    let left = total(&room)? / settled;
    assert!(left < 0.1, "{left} is left after eight frames");
    room.frame(gpu, 60)?;
    // The smallest half floats round to themselves.
    let dust = total(&room)? / settled;
    assert!(dust < 1e-6, "{dust} is left");
    Ok(())
}
