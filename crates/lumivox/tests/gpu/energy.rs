//! Where light goes: none is made, none is lost, the furnace has its closed form, walls hold light back, and pixels
//! gather it from occupied cells.
//!
//! Totals are sums of signed flux. Four coefficients that keep their direction overshoot, so single cells may receive less
//! than nothing, and others more for it.

use std::f64::consts::PI;

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{DVec3, IVec3, UVec2, UVec3, Vec2, Vec3};
use lumivox::gpu::{GpuError, Texture, read_texture};
use lumivox::light::{IRRADIANCE_FORMAT, LightSettings};

use crate::cells::{Cells, Incident, incident, propagate, uploaded};
use crate::picture::{Paint, Shape, Thing};
use crate::support::{Lab, Shot, locked, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("energy: flux is conserved in empty space until it leaves the grid", conserved),
    ("energy: flux under way and absorbed never grows", never_grows),
    ("energy: a furnace has its closed form", furnace),
    ("energy: walls hold light back", walls),
    ("energy: reconstruction uses occupied cells only", occupied_only),
];

/// Flux that has been absorbed, over cells and colour bands. `gather` is the cell's correction of received
/// light: 1 where exactly one open face looks along the normal.
fn absorbed(cells: &Cells, incident: &Incident) -> f64 {
    let flux_per_constant = PI.sqrt();
    let of_cell = |(cell, light): (usize, &[[f32; 4]; 3])| -> f64 {
        let albedo = cells.albedo[cell].to_array();
        let stored = albedo.map(|a| half::f16::from_f32(a).to_f64());
        (0..3).map(|b| (1.0 - stored[b]) * f64::from(light[b][0]) * flux_per_constant).sum()
    };
    incident.iter().enumerate().map(of_cell).sum()
}

/// Flux under way and absorbed after each of 40 steps of light that one surface cell sends along x through a grid of so many empty
/// cells a side, of one unit: in double precision, by the shares alone. A lobe about `d` sends `1/6 + p/2 (d.f)` through the face `f`, and
/// a surface's lobe, of which nothing goes back, `1/6 (1 + d.f)`.
fn of_one_surface(side: i32, lamp: IVec3) -> Vec<f64> {
    let persistence = f64::from(LightSettings::default().persistence);
    let axes = [IVec3::X, IVec3::Y, IVec3::Z].map(|axis| [axis, -axis]);
    let faces: Vec<IVec3> = axes.into_iter().flatten().collect();
    let is_inside = |c: IVec3| c.cmpge(IVec3::ZERO).all() && c.cmplt(IVec3::splat(side)).all();
    // Flux by the cell that it is in and the way that it came, and the persistence of its lobe.
    let mut under_way = std::collections::HashMap::from([((lamp + IVec3::X, IVec3::X), (1.0, 1.0 / 3.0))]);
    let (mut totals, mut absorbed) = (vec![1.0, 1.0], 0.0);
    for _ in 2..=40 {
        let mut next = std::collections::HashMap::new();
        for ((cell, way), (flux, persistence_here)) in under_way {
            for &face in &faces {
                let sent: f64 = flux * (1.0 / 6.0 + 0.5 * persistence_here * f64::from(way.dot(face)));
                if cell + face == lamp {
                    absorbed += sent;
                } else if is_inside(cell + face) {
                    next.entry((cell + face, face)).or_insert((0.0, persistence)).0 += sent;
                }
            }
        }
        under_way = next;
        totals.push(under_way.values().map(|(flux, _)| flux).sum::<f64>() + absorbed);
    }
    totals
}

/// Light of one black surface in empty space is what its lobes make of it, to the last step: all of it until the boundary is reached, in
/// the eighth, and then less by what left. Narrow lobes leave a little that is negative when most of the light has gone.
fn conserved(labs: &Labs) -> Result<(), Failed> {
    let mut cells = Cells::new(16);
    let lamp = UVec3::new(8, 7, 8);
    cells.surface(lamp, Vec3::X, 0.0);
    cells.light(cells.grid.index(lamp), Vec3::new(10.0, 5.0, 2.5));
    let seeded = 17.5 * PI;
    let mut totals = Vec::new();
    propagate(&labs.core, &cells, (1, 40), |flux, light| {
        totals.push((flux + absorbed(&cells, &light)) / seeded)
    })?;
    let expected = of_one_surface(16, lamp.as_ivec3());
    let off = totals.iter().zip(&expected).map(|(t, e)| (t - e).abs()).fold(0.0, f64::max);
    eprintln!(
        "empty space: off by {off:.2e} of the seed at most; {:.4} of {:.4} in the end",
        totals[40], expected[40]
    );
    assert!(expected[7] > 0.999_999 && expected[8] < 0.98 && expected[40] < 0.0, "{expected:?}");
    // Half floats round by a part in 4096 at most. The seed and the first steps are few numbers, whose roundings may have one sign; from
    // then on they are many.
    assert!(off < 4.0 / 4096.0, "{off} of the seed");
    Ok(())
}

/// A floor with a pillar and a roof, with lamps on them. All normals are those of open faces, so that incident light says
/// exactly what arrived.
fn hall(albedo: f32) -> Cells {
    let mut cells = Cells::new(16);
    for cell in cells.grid.cells() {
        if cell.y == 1 {
            cells.surface(cell, Vec3::Y, albedo);
        } else if cell.y == 13 && cell.x > 4 {
            cells.surface(cell, Vec3::NEG_Y, albedo);
        } else if cell.x == 9 && cell.z == 6 && (2..13).contains(&cell.y) {
            cells.surface(cell, Vec3::X, albedo);
        }
    }
    for (cell, color) in [((3, 1, 3), 8.0), ((9, 5, 6), 4.0), ((12, 13, 9), 6.0), ((0, 1, 15), 2.0)] {
        let index = cells.grid.index(UVec3::from(cell));
        cells.light(index, Vec3::new(color, 0.5 * color, 0.25 * color));
    }
    cells
}

fn never_grows(labs: &Labs) -> Result<(), Failed> {
    let mut closed = Cells::new(16);
    closed.room(0, 15, 0.95, 0.0);
    let lamp = closed.grid.index(UVec3::new(7, 0, 5));
    closed.light(lamp, Vec3::splat(8.0));
    let mut grown = Vec::new();
    for (name, cells) in [("hall, 0.5", hall(0.5)), ("hall, 0.95", hall(0.95)), ("closed, 0.95", closed)] {
        let mut totals = Vec::new();
        let mut flows = Vec::new();
        propagate(&labs.core, &cells, (1, 200), |flux, light| {
            flows.push(flux);
            totals.push(flux + absorbed(&cells, &light));
        })?;
        let growth = totals.windows(2).map(|w| (w[1] - w[0]) / totals[0]).fold(f64::MIN, f64::max);
        let most = totals.iter().fold(f64::MIN, |a, b| a.max(*b)) / totals[0];
        eprintln!(
            "{name}: grows by {growth:.2e} in a step at most, reaches {most:.5} of the seed; in the end {:.4} under way, {:.4} in all",
            flows[200] / flows[0],
            totals[200] / totals[0]
        );
        // Half a unit in the last of a half float's 11 places, were all roundings of a step of one sign.
        if growth > 1.0 / 4096.0 || most > 1.0 + 1.0 / 512.0 {
            grown.push(format!("{name}: by {growth:.2e} in a step, to {most:.5} of the seed"));
        }
    }
    if grown.is_empty() { Ok(()) } else { Err(grown.join("; ").into()) }
}

/// A camera of parallel rays that looks straight at the left wall of the room, four pixels a cell, from its other end.
fn look_at_wall() -> View {
    let (eye, to) = (Vec3::new(15.0, 8.0, 8.0), Vec3::new(0.0, 8.0, 8.0));
    View::orthographic(eye, to, Vec3::Y, Vec2::splat(14.0), 15.5)
}

/// Red irradiance on a wall at x = `wall`, whatever cells there are, over the 14 cells between the other walls.
fn seen_on_wall(lab: &Lab, cells: &Cells, steps: u32, wall: f64) -> Result<Vec<f64>, GpuError> {
    let gpu = &lab.gpu;
    let (world, stages) = uploaded(lab, cells)?;
    let plane = Shape::Plane { point: DVec3::X * wall, normal: DVec3::X };
    let shot = Shot::take(gpu, look_at_wall(), UVec2::splat(PIXELS), &[Thing(plane, |_| Paint::default())])?;
    let mut target = Texture::target(gpu, "irradiance", [PIXELS; 2], IRRADIANCE_FORMAT)?;
    let light = &mut locked(&stages).light;
    run(gpu, |e| {
        light.record_transport(gpu, e, &world.volume)?;
        light.record_seed(gpu, e, &world.volume, &world.light)?;
        light.record_propagation(gpu, e, &world.volume, steps)?;
        light.record_reconstruction(gpu, e, &world.volume, &shot.input, &mut target)
    })?;
    let pixels: Vec<[half::f16; 4]> = read_texture(gpu, &target)?;
    Ok(pixels.iter().map(|p| p[0].to_f64()).collect())
}

const PIXELS: u32 = 56;

/// Those of a wall's pixels that lie three cells or more from its edges.
fn inner(pixels: &[f64]) -> Vec<f64> {
    let far = |i: u32| (12..PIXELS - 12).contains(&i);
    let index = |i: usize| (i as u32 % PIXELS, i as u32 / PIXELS);
    let inner = pixels.iter().enumerate().filter(|(i, _)| far(index(*i).0) && far(index(*i).1));
    inner.map(|(_, v)| *v).collect()
}

/// A closed room that glows evenly: irradiance is pi times the emitted radiance over one minus the albedo. Four
/// coefficients get the whole right, and have too little in the middle of a wall and too much along its edges.
fn furnace(labs: &Labs) -> Result<(), Failed> {
    let radiance = 0.25;
    for (albedo, steps) in [(0.2, 150), (0.5, 300), (0.8, 700)] {
        let mut cells = Cells::new(16);
        cells.room(0, 15, albedo, radiance);
        let expected = PI * f64::from(radiance) / (1.0 - f64::from(albedo));
        let seen = seen_on_wall(&labs.core, &cells, steps, 0.5)?;
        let mean = seen.iter().sum::<f64>() / seen.len() as f64 / expected;
        let inner = inner(&seen);
        let low = inner.iter().copied().fold(f64::MAX, f64::min) / expected;
        let high = inner.iter().copied().fold(0.0, f64::max) / expected;
        let most = seen.iter().copied().fold(0.0, f64::max) / expected;
        eprintln!("furnace {albedo}: mean {mean:.4}, {low:.4} to {high:.4} off the edges, {most:.4} at most");
        assert!((mean - 1.0).abs() < 0.03, "albedo {albedo}: the mean is {mean} of the closed form");
        assert!(low > 0.92 && high < 1.08, "albedo {albedo}: {low} to {high} of it off the edges");
    }
    Ok(())
}

fn largest(light: &[[f32; 4]; 3]) -> f32 {
    light.iter().flatten().fold(0f32, |a, b| a.max(b.abs()))
}

fn walls(labs: &Labs) -> Result<(), Failed> {
    // A dark room with walls of its own against those of a lit one: dark to the last bit.
    let mut cells = Cells::new(16);
    cells.room(0, 15, 0.8, 1.0);
    cells.room(5, 10, 0.8, 0.0);
    for (cell, normal) in cells.grid.cells().zip(cells.normal.clone()) {
        // The outer side of the inner room, which is a room around a room.
        let (low, high) = (UVec3::splat(4), UVec3::splat(11));
        let shell = cell.cmpge(low).all() && cell.cmple(high).all();
        let on_it = (cell.cmpeq(low) | cell.cmpeq(high)).any();
        if shell && on_it && normal.w == 0.0 {
            let axis = (0..3).find(|a| cell[*a] == 4 || cell[*a] == 11).expect("on the shell");
            let outward = if cell[axis] == 4 { -Vec3::AXES[axis] } else { Vec3::AXES[axis] };
            cells.surface(cell, outward, 0.8);
        }
    }
    let light = incident(&labs.core, &cells, 200)?;
    let inside = |c: UVec3| c.cmpge(UVec3::splat(5)).all() && c.cmple(UVec3::splat(10)).all();
    let (mut lit, mut dark) = (0f32, 0f32);
    for (light, cell) in light.iter().zip(cells.grid.cells()) {
        *(if inside(cell) { &mut dark } else { &mut lit }) += largest(light);
    }
    assert!(lit > 100.0, "the outer room is dark");
    assert_eq!(dark, 0.0, "light came through two walls");

    // Two rooms left and right of a wall at x = 8, one cell thick, lit on the left and on the wall itself.
    let mut cells = Cells::new(16);
    cells.room(0, 15, 0.8, 0.0);
    for (y, z) in (1..15).flat_map(|y| (1..15).map(move |z| (y, z))) {
        cells.surface(UVec3::new(8, y, z), Vec3::NEG_X, 0.8);
    }
    for cell in [UVec3::new(4, 0, 7), UVec3::new(0, 5, 5), UVec3::new(8, 6, 9)] {
        cells.light(cells.grid.index(cell), Vec3::splat(10.0));
    }
    let light = incident(&labs.core, &cells, 200)?;
    let (mut lit, mut dark) = (0f32, 0f32);
    for (light, cell) in light.iter().zip(cells.grid.cells()) {
        let side = if cell.x > 8 { &mut dark } else { &mut lit };
        *side = side.max(largest(light));
    }
    eprintln!("a shared wall one cell thick lets {dark:.2e} through, beside {lit:.2e}");
    assert!(lit > 1.0, "the left room is dark");
    // Which side light leaves on is the difference of two coefficients, each rounded to 11 places: half a unit of each.
    assert!(dark <= lit / 2048.0, "the wall lets {dark} through, beside {lit}");
    Ok(())
}

/// Pixels before, in and on the far side of the middle of a wall's cells have the same occupied cells around them, and more
/// or fewer empty ones, which hold no light and must not darken them. Far from any surface there is none.
fn occupied_only(labs: &Labs) -> Result<(), Failed> {
    let mut cells = Cells::new(16);
    cells.room(0, 15, 0.5, 1.0);
    let middle = inner(&seen_on_wall(&labs.core, &cells, 100, 0.5)?);
    assert!(middle.iter().all(|v| *v > 1.0), "the wall is dark");
    for wall in [0.1, 0.8, 1.0, 1.3] {
        let other = inner(&seen_on_wall(&labs.core, &cells, 100, wall)?);
        let ratios = other.iter().zip(&middle).map(|(a, b)| a / b);
        let (low, high) = ratios.fold((f64::MAX, 0f64), |(l, h), r| (l.min(r), h.max(r)));
        // Both are half floats.
        let tolerance = 1.0 / 1024.0;
        assert!(low > 1.0 - tolerance && high < 1.0 + tolerance, "at {wall}: {low} to {high} of the middle");
    }
    let midair = inner(&seen_on_wall(&labs.core, &cells, 100, 8.0)?);
    assert!(midair.iter().all(|v| *v == 0.0), "irradiance where no occupied cell is near");
    Ok(())
}
