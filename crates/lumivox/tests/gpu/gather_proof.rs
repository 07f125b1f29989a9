//! What holds for gathered light: it is a sum over lamps, has no preferred side, no bounce makes light, what is hidden changes
//! nothing, and two patches light each other alike.

use libtest_mimic::Failed;
use lumivox::gather::GatherSettings;
use lumivox::glam::{IVec3, UVec3, Vec3};
use lumivox::gpu::Gpu;

use crate::cells::Cells;
use crate::gather::Room;
use crate::support::Random;
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("gather proof: light of two lamps is their sum", sums),
    ("gather proof: a mirrored scene is lit like its mirror image", mirrored),
    ("gather proof: no bounce makes light", no_bounce_makes_light),
    ("gather proof: what is hidden changes nothing", hidden),
    ("gather proof: two patches light each other alike", reciprocity),
];

/// Irradiance of the six sides of each cell.
type Sides = Vec<[Option<Vec3>; 6]>;

fn light(gpu: &Gpu, cells: &Cells, rays: u32, bounces: u32) -> Result<Sides, Failed> {
    let settings = GatherSettings { rays, ..GatherSettings::default() };
    let mut room = Room::new(gpu, cells, settings)?;
    room.frame(gpu, bounces)?;
    let count = room.light.count(gpu)?;
    assert_eq!(count.refused, 0, "surfels found no room");
    Ok(room.light.read_irradiance(gpu)?)
}

/// A closed room with blocks in it.
fn furnished(albedo: f32) -> Cells {
    let mut random = Random::new(31);
    let mut cells = Cells::new(16);
    cells.room(1, 14, albedo, 0.0);
    let inside = |c: UVec3| c.cmpge(UVec3::splat(4)).all() && c.cmple(UVec3::splat(11)).all();
    for cell in cells.grid.cells().filter(|c| inside(*c)) {
        if random.unit() < 0.06 {
            // No normal: every side is one.
            cells.surface(cell, Vec3::ZERO, albedo);
        }
    }
    cells
}

/// The same with cells that glow.
fn glowing(cells: &Cells, radiance: Vec3, chosen: impl Fn(UVec3) -> bool) -> Cells {
    let mut cells = cells.clone();
    for (index, cell) in cells.grid.cells().enumerate() {
        if cells.occupied(index) && chosen(cell) {
            cells.emission[index] = radiance.extend(0.0);
        }
    }
    cells
}

fn on_floor(c: UVec3) -> bool {
    c.y == 1 && (4..10).contains(&c.x) && (5..9).contains(&c.z)
}

fn on_wall(c: UVec3) -> bool {
    c.x == 14 && (4..8).contains(&c.y) && (8..12).contains(&c.z)
}

fn total(sides: &Sides) -> f32 {
    sides.iter().flatten().flatten().map(|e| e.x).sum()
}

fn sums(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let dark = furnished(0.6);
    let one = glowing(&dark, Vec3::ONE, on_floor);
    let other = glowing(&dark, Vec3::new(4.0, 2.0, 1.0), on_wall);
    let both = glowing(&other, Vec3::ONE, on_floor);
    let [a, b, both] = [light(gpu, &one, 64, 4)?, light(gpu, &other, 64, 4)?, light(gpu, &both, 64, 4)?];
    assert!(total(&both) > 10.0, "there is no light");
    for (sum, (a, b)) in both.iter().flatten().zip(a.iter().flatten().zip(b.iter().flatten())) {
        let (sum, parts) = (sum.unwrap_or_default(), a.unwrap_or_default() + b.unwrap_or_default());
        // Each of four bounces of each of three runs rounds to half floats.
        assert!((sum - parts).length() < 12.0 / 2048.0 * sum.length() + 1e-5, "{sum} and {parts}");
    }
    Ok(())
}

/// Rays of a surfel are not mirrored with it, so two images differ by the grain of their rays, which goes as these become
/// many.
fn mirrored(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let scene = glowing(&furnished(0.6), Vec3::ONE, on_floor);
    for axis in 0..3 {
        let flip = |cell: UVec3| {
            let mut cell = cell;
            cell[axis] = 15 - cell[axis];
            scene.grid.index(cell)
        };
        let mut image = scene.clone();
        for (index, cell) in scene.grid.cells().enumerate() {
            image.normal[index] = scene.normal[flip(cell)];
            image.normal[index][axis] *= -1.0;
            image.albedo[index] = scene.albedo[flip(cell)];
            image.emission[index] = scene.emission[flip(cell)];
        }
        let mut grain = Vec::new();
        for rays in [64, 1024] {
            let (one, other) = (light(gpu, &scene, rays, 4)?, light(gpu, &image, rays, 4)?);
            let (mut off, mut all) = (0.0, 0.0);
            for (index, cell) in scene.grid.cells().enumerate() {
                for (face, a) in one[index].into_iter().enumerate() {
                    let opposite = if face / 2 == axis { face ^ 1 } else { face };
                    let b = other[flip(cell)][opposite];
                    assert_eq!(a.is_some(), b.is_some(), "cell {cell}, face {face}");
                    let (a, b) = (a.unwrap_or_default().x, b.unwrap_or_default().x);
                    off += (a - b) * (a - b);
                    all += a * a;
                }
            }
            grain.push(((off / all).sqrt(), (total(&other) / total(&one) - 1.0).abs()));
        }
        eprintln!("mirrored along {axis}: sides are off by, and all together, 64 and 1024 rays: {grain:.4?}");
        // Were the rays of a surfel as good as random, sixteen times as many would leave a quarter.
        assert!(grain[1].0 < 0.25 * grain[0].0, "along {axis}: {grain:?}");
        assert!(grain[1].1 < 0.005, "along {axis}: all together {grain:?}");
    }
    Ok(())
}

/// What a bounce adds to the side that it adds most to is at most albedo times that of the bounce before.
fn no_bounce_makes_light(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for albedo in [0.5, 0.95f32] {
        let scene = glowing(&furnished(albedo), Vec3::ONE, on_floor);
        let mut before: Option<Sides> = None;
        let mut added = Vec::new();
        for bounces in 1..=6 {
            let now = light(gpu, &scene, 64, bounces)?;
            let was = before.iter().flatten().flatten().map(|e| e.unwrap_or_default().x);
            let was = was.chain(std::iter::repeat(0.0));
            let steps = now.iter().flatten().zip(was).map(|(e, was)| e.unwrap_or_default().x - was);
            added.push(steps.fold(0f32, f32::max));
            before = Some(now);
        }
        eprintln!("albedo {albedo}: bounces add {added:.4?} at most");
        // Half floats: half a unit of each of two numbers.
        let room = added[0] / 1024.0;
        assert!(added.windows(2).all(|w| w[1] <= albedo * w[0] + room), "albedo {albedo}: {added:?}");
        assert!(added[5] > 0.0, "albedo {albedo}: bounces end");
    }
    Ok(())
}

/// A closed box in a lit room: what glows inside changes no bit outside.
fn hidden(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(16);
    cells.room(1, 14, 0.6, 0.0);
    let mut cells = glowing(&cells, Vec3::ONE, on_floor);
    let lamp = UVec3::splat(8);
    let (low, high) = (UVec3::splat(5), UVec3::splat(10));
    for cell in cells.grid.cells() {
        let within = cell.cmpge(low).all() && cell.cmple(high).all();
        if cell == lamp || within && (cell.cmpeq(low) | cell.cmpeq(high)).any() {
            cells.surface(cell, Vec3::ZERO, 0.6);
        }
    }
    let dark = light(gpu, &cells, 64, 4)?;
    let lit = light(gpu, &glowing(&cells, Vec3::splat(50.0), |c| c == lamp), 64, 4)?;
    let inside = |c: IVec3| c.cmpgt(low.as_ivec3()).all() && c.cmplt(high.as_ivec3()).all();
    let mut changed = [0, 0];
    for (index, cell) in cells.grid.cells().enumerate() {
        for face in 0..6 {
            let step = IVec3::AXES[face / 2] * if face % 2 == 0 { 1 } else { -1 };
            let looks_in = inside(cell.as_ivec3() + step);
            changed[usize::from(looks_in)] += usize::from(dark[index][face] != lit[index][face]);
        }
    }
    assert!(total(&dark) > 10.0, "it is dark outside");
    assert!(changed[1] > 50, "the lamp lights nothing: {changed:?}");
    assert_eq!(changed[0], 0, "sides outside that a hidden lamp changes");
    Ok(())
}

/// Irradiance summed over the sides of one patch when the other glows, both ways: first light alone, and all bounces. By the form
/// factor at most 640 of the floor's 24576 rays meet the wall, and as many the other way, so with rays at random the ratio would
/// be off by 6 %. Rays are spread evenly, which leaves less than half of that.
fn reciprocity(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for (albedo, bounces) in [(0.0, 1), (0.6, 8)] {
        let dark = furnished(albedo);
        let received = |from: fn(UVec3) -> bool, to: fn(UVec3) -> bool, side: usize| -> Result<f32, Failed> {
            let found = light(gpu, &glowing(&dark, Vec3::ONE, from), 1024, bounces)?;
            let cells = dark.grid.cells().zip(&found).filter(|(c, _)| to(*c));
            Ok(cells.map(|(_, sides)| sides[side].unwrap_or_default().x).sum())
        };
        let ratio = received(on_floor, on_wall, 1)? / received(on_wall, on_floor, 2)?;
        eprintln!("albedo {albedo}: reciprocity of two patches: {ratio:.4}");
        assert!((ratio - 1.0).abs() < 0.03, "albedo {albedo}: {ratio}");
    }
    Ok(())
}
