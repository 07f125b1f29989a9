//! Laws of propagation and reconstruction: linear, scale-free, symmetric, never more energy, the furnace, and walls that
//! hold light back.

use std::f64::consts::PI;
use std::sync::{Arc, Mutex};

use libtest_mimic::Failed;
use lumivox::core::{Grid, View, sh};
use lumivox::glam::{DVec3, UVec2, UVec3, Vec3, Vec4};
use lumivox::gpu::{GpuError, Texture, read_texture};
use lumivox::light::{IRRADIANCE_FORMAT, LightSettings};
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};

use crate::support::{Lab, Paint, Random, Shape, Shot, Stages, Thing, World, locked, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("light: propagation is linear", linear),
    ("light: propagation is scale-free", scale_free),
    ("light: a mirrored scene is lit like its mirror image", mirrored),
    ("light: flux is conserved in empty space until it leaves the grid", conserved),
    ("light: flux under way and absorbed never grows", never_grows),
    ("light: a furnace has its closed form", furnace),
    ("light: walls hold light back", walls),
    ("light: reconstruction uses occupied cells only", occupied_only),
];

/// A volume and its light in memory, over a grid whose cells are a metre wide.
#[derive(Clone)]
struct Cells {
    grid: Grid,
    normal: Vec<Vec4>,
    albedo: Vec<Vec4>,
    emission: Vec<Vec4>,
    direct: Vec<[Vec4; 3]>,
}

impl Cells {
    fn new(side: u32) -> Self {
        let grid = Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::splat(side) };
        let zero = vec![Vec4::ZERO; grid.cell_count() as usize];
        let direct = vec![[Vec4::ZERO; 3]; zero.len()];
        Self { grid, normal: zero.clone(), albedo: zero.clone(), emission: zero, direct }
    }

    fn surface(&mut self, cell: UVec3, normal: Vec3, albedo: f32) {
        let index = self.grid.index(cell);
        self.normal[index] = normal.extend(1.0);
        self.albedo[index] = Vec3::splat(albedo).extend(0.0);
    }

    fn occupied(&self, index: usize) -> bool {
        self.normal[index].w > 0.0
    }

    /// Gives a surface the radiance `color`, as direct light.
    fn light(&mut self, index: usize, color: Vec3) {
        let lobe = sh::cosine_lobe(self.normal[index].truncate());
        self.direct[index] = color.to_array().map(|c| c * lobe);
    }

    /// A hollow box with walls one cell thick whose normals look inwards.
    fn room(&mut self, low: u32, high: u32, albedo: f32, emission: f32) {
        for cell in self.grid.cells() {
            let (c, l, h) = (cell, UVec3::splat(low), UVec3::splat(high));
            let wall = c.cmpge(l).all() && c.cmple(h).all() && (c.cmpeq(l) | c.cmpeq(h)).any();
            if wall {
                let axis = (0..3).find(|a| c[*a] == low || c[*a] == high).expect("a wall");
                let normal = if c[axis] == low { Vec3::AXES[axis] } else { -Vec3::AXES[axis] };
                self.surface(cell, normal, albedo);
                let index = self.grid.index(cell);
                self.emission[index] = Vec3::splat(emission).extend(0.0);
            }
        }
    }
}

/// A seeded propagation.
struct Run {
    world: World,
    stages: Arc<Mutex<Stages>>,
}

type Incident = Vec<[[f32; 4]; 3]>;

impl Run {
    /// Seeds, propagates, and calls `look` with the flux under way and the incident light before each of `looks` and after the
    /// last; between two looks lie `steps` iterations.
    fn go(
        lab: &Lab,
        cells: &Cells,
        steps: u32,
        looks: u32,
        mut look: impl FnMut(u32, f64, Incident),
    ) -> Result<Self, GpuError> {
        let gpu = &lab.gpu;
        let mut world = World::new(lab, cells.grid)?;
        world.volume.upload(gpu, NORMAL, &cells.normal)?;
        world.volume.upload(gpu, ALBEDO, &cells.albedo)?;
        world.volume.upload(gpu, EMISSION, &cells.emission)?;
        world.light.upload(gpu, &cells.direct);
        let stages = lab.stages(&world.volume)?;
        let mut guard = locked(&stages);
        let light = &mut guard.light;
        light.update(gpu, &LightSettings::default());
        run(gpu, |e| {
            light.record_transport(gpu, e, &world.volume)?;
            light.record_seed(gpu, e, &world.volume, &world.light)
        })?;
        look(0, light.flux_under_way(gpu)?, light.read_incident(gpu)?);
        for n in 1..=looks {
            run(gpu, |e| light.record_propagation(gpu, e, &world.volume, steps))?;
            look(n, light.flux_under_way(gpu)?, light.read_incident(gpu)?);
        }
        drop(guard);
        Ok(Self { world, stages })
    }
}

fn incident(lab: &Lab, cells: &Cells, iterations: u32) -> Result<Incident, GpuError> {
    let mut last = Vec::new();
    Run::go(lab, cells, iterations, 1, |_, _, light| last = light)?;
    Ok(last)
}

/// Scattered surfaces that look into all directions, some of them lit.
fn clutter(seed: u64) -> Cells {
    let mut random = Random::new(seed);
    let mut cells = Cells::new(16);
    for cell in cells.grid.cells() {
        if random.unit() < 0.2 {
            let normal = (random.cube() - 0.5).try_normalize().unwrap_or(Vec3::Y);
            cells.surface(cell, normal, 0.7 * random.unit());
        }
    }
    cells
}

fn lit_at_random(cells: &Cells, seed: u64) -> Cells {
    let (mut cells, mut random) = (cells.clone(), Random::new(seed));
    for index in 0..cells.normal.len() {
        if cells.occupied(index) && random.unit() < 0.3 {
            cells.light(index, 8.0 * random.cube());
        }
    }
    cells
}

/// Differences over values, summed over all coefficients of all cells; and the same for the worst cell, over the mean of
/// the cells that have light.
fn distance(a: &Incident, b: &Incident) -> (f64, f64) {
    let magnitude = |cell: &[[f32; 4]; 3]| cell.iter().flatten().map(|v| f64::from(v.abs())).sum::<f64>();
    let difference = |(a, b): (&[[f32; 4]; 3], &[[f32; 4]; 3])| -> f64 {
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from((a - b).abs())).sum()
    };
    let total: f64 = b.iter().map(magnitude).sum();
    let lit = b.iter().filter(|c| magnitude(c) > 0.0).count() as f64;
    let off: Vec<f64> = a.iter().zip(b).map(difference).collect();
    (off.iter().sum::<f64>() / total, off.iter().fold(0.0, |a: f64, b| a.max(*b)) / (total / lit))
}

const STEPS: u32 = 24;
/// Each step rounds every coefficient to a half float, half a unit in the last of 11 places; three
/// runs are compared. Were all errors of one sign, this would be their sum.
const HALF_FLOAT_BOUND: f64 = 3.0 * STEPS as f64 / 4096.0;

fn linear(labs: &Labs) -> Result<(), Failed> {
    let empty = clutter(1);
    let (a, b) = (lit_at_random(&empty, 2), lit_at_random(&empty, 3));
    let mut both = empty;
    for (index, direct) in both.direct.iter_mut().enumerate() {
        *direct = std::array::from_fn(|band| a.direct[index][band] + 2.0 * b.direct[index][band]);
    }
    let [of_a, of_b] = [incident(&labs.core, &a, STEPS)?, incident(&labs.core, &b, STEPS)?];
    let of_both = incident(&labs.core, &both, STEPS)?;
    let mut sum = of_a;
    for (cell, b) in sum.iter_mut().flatten().flatten().zip(of_b.iter().flatten().flatten()) {
        *cell += 2.0 * b;
    }
    let (total, worst) = distance(&sum, &of_both);
    eprintln!("linearity: off by {total:.2e} in all, by {worst:.2e} of a mean cell at worst");
    assert!(of_both.iter().flatten().flatten().any(|v| *v > 1.0), "nothing is lit");
    assert!(total < HALF_FLOAT_BOUND && worst < HALF_FLOAT_BOUND, "off by {total} in all, {worst} at worst");
    Ok(())
}

/// Powers of two change no digit of a floating-point number, so the result is the same but for numbers below the
/// smallest normal half float.
fn scale_free(labs: &Labs) -> Result<(), Failed> {
    let one = lit_at_random(&clutter(4), 5);
    let mut many = one.clone();
    many.direct.iter_mut().flatten().for_each(|band| *band *= 64.0);
    let one = incident(&labs.core, &one, STEPS)?;
    let many = incident(&labs.core, &many, STEPS)?;
    let subnormal_step = 2f32.powi(-24);
    let tolerance = subnormal_step * 6.0 * (STEPS * STEPS) as f32;
    for (cell, (a, b)) in one.iter().flatten().zip(many.iter().flatten()).enumerate() {
        for i in 0..4 {
            let off = (64.0 * a[i] - b[i]).abs() / 64.0;
            assert!(off <= tolerance, "cell {}: {} becomes {}", cell / 3, a[i], b[i]);
        }
    }
    Ok(())
}

fn mirrored(labs: &Labs) -> Result<(), Failed> {
    let scene = lit_at_random(&clutter(6), 7);
    for axis in 0..3 {
        let flip = |cell: UVec3| {
            let mut cell = cell;
            cell[axis] = scene.grid.dims[axis] - 1 - cell[axis];
            scene.grid.index(cell)
        };
        let mut image = scene.clone();
        for (index, cell) in scene.grid.cells().enumerate() {
            let from = flip(cell);
            image.normal[index] = scene.normal[from];
            image.normal[index][axis] *= -1.0;
            image.albedo[index] = scene.albedo[from];
            image.direct[index] = scene.direct[from];
            image.direct[index].iter_mut().for_each(|band| band[axis + 1] *= -1.0);
        }
        let expected = incident(&labs.core, &scene, STEPS)?;
        let got = incident(&labs.core, &image, STEPS)?;
        let back: Incident = scene
            .grid
            .cells()
            .map(|cell| {
                got[flip(cell)].map(|mut band| {
                    band[axis + 1] *= -1.0;
                    band
                })
            })
            .collect();
        let (total, worst) = distance(&back, &expected);
        eprintln!("mirrored along {axis}: off by {total:.2e} in all, by {worst:.2e} of a mean cell at worst");
        // The neighbours are added up in another order, and two runs are rounded.
        let bound = HALF_FLOAT_BOUND * 2.0 / 3.0;
        assert!(total < bound && worst < bound, "along {axis}: off by {total} in all, {worst} at worst");
    }
    Ok(())
}

/// Flux that has been absorbed, over cells and colour bands. `gather` is the cell's correction of received
/// light: 1 where exactly one open face looks along the normal.
fn absorbed(cells: &Cells, incident: &Incident) -> f64 {
    let flux_per_constant = PI.sqrt();
    let of_cell = |(cell, light): (usize, &[[f32; 4]; 3])| -> f64 {
        let albedo = cells.albedo[cell].to_array();
        (0..3).map(|b| (1.0 - f64::from(albedo[b])) * f64::from(light[b][0]) * flux_per_constant).sum()
    };
    incident.iter().enumerate().map(of_cell).sum()
}

fn conserved(labs: &Labs) -> Result<(), Failed> {
    let mut cells = Cells::new(16);
    let lamp = UVec3::new(8, 7, 8);
    cells.surface(lamp, Vec3::X, 0.0);
    cells.light(cells.grid.index(lamp), Vec3::new(10.0, 5.0, 2.5));
    let seeded = 17.5 * PI;
    // The seventh step reaches the boundary; what is sent out of the grid is gone with the eighth.
    let mut totals = Vec::new();
    Run::go(&labs.core, &cells, 1, 40, |_, flux, light| totals.push(flux + absorbed(&cells, &light)))?;
    eprintln!("empty space: {:.5?} of the seed", totals.iter().map(|t| t / seeded).collect::<Vec<_>>());
    for (step, total) in totals.iter().enumerate().take(8) {
        // A step's rounding, were it all of one sign.
        let tolerance = (step + 1) as f64 / 2048.0;
        assert!((total / seeded - 1.0).abs() < tolerance, "after {step} steps {total} of {seeded}");
    }
    assert!(totals[40] < 0.5 * seeded, "light does not leave the grid: {}", totals[40] / seeded);
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
        Run::go(&labs.core, &cells, 1, 200, |_, flux, light| {
            flows.push(flux);
            totals.push(flux + absorbed(&cells, &light));
        })?;
        let growth = totals.windows(2).map(|w| w[1] / w[0] - 1.0).fold(f64::MIN, f64::max);
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

fn furnace(labs: &Labs) -> Result<(), Failed> {
    let radiance = 0.25;
    for (albedo, steps) in [(0.2, 200), (0.5, 300), (0.8, 700)] {
        let mut cells = Cells::new(16);
        cells.room(0, 15, albedo, radiance);
        let expected = PI * f64::from(radiance) / (1.0 - f64::from(albedo));
        let seen = seen_in_room(&labs.core, &cells, steps, 1.0)?;
        let mean = seen.iter().sum::<f64>() / seen.len() as f64 / expected;
        let low = seen.iter().copied().fold(f64::MAX, f64::min) / expected;
        let high = seen.iter().copied().fold(0.0, f64::max) / expected;
        eprintln!("furnace {albedo}: mean {mean:.4}, {low:.4} to {high:.4} of the closed form");
        assert!((mean - 1.0).abs() < 0.03, "albedo {albedo}: the mean is {mean} of the closed form");
        assert!(low > 0.85 && high < 1.15, "albedo {albedo}: {low} to {high} of the closed form");
    }
    Ok(())
}

/// Red irradiance that a camera in the middle of a room reconstructs on walls that lie `wall` cells within the grid.
fn seen_in_room(lab: &Lab, cells: &Cells, steps: u32, wall: f64) -> Result<Vec<f64>, GpuError> {
    let gpu = &lab.gpu;
    let run_ = Run::go(lab, cells, steps, 1, |_, _, _| ())?;
    let side = f64::from(cells.grid.dims.x);
    let inside = Shape::Box { min: DVec3::splat(wall), max: DVec3::splat(side - wall) };
    let (eye, to) = (Vec3::new(5.0, 9.0, 12.5), Vec3::new(9.0, 6.5, 2.0));
    let view = View::perspective(eye, to, Vec3::Y, 1.6, 1.0, 0.25, 40.0);
    let size = UVec2::splat(48);
    let shot = Shot::take(gpu, view, size, &[Thing(inside, |_| Paint::default())])?;
    let mut target = Texture::target(gpu, "irradiance", size.to_array(), IRRADIANCE_FORMAT)?;
    // The same stages may have served another test since.
    let mut stages = locked(&run_.stages);
    let light = &mut stages.light;
    let world = &run_.world;
    run(gpu, |e| {
        light.record_transport(gpu, e, &world.volume)?;
        light.record_seed(gpu, e, &world.volume, &world.light)?;
        light.record_propagation(gpu, e, &world.volume, steps)?;
        light.record_reconstruction(gpu, e, &world.volume, &shot.input, &mut target)
    })?;
    let pixels: Vec<[half::f16; 4]> = read_texture(gpu, &target)?;
    Ok(pixels.iter().map(|p| p[0].to_f64()).collect())
}

fn walls(labs: &Labs) -> Result<(), Failed> {
    // Two rooms on the left and right of a wall at x = 8 that they share.
    let mut cells = Cells::new(16);
    cells.room(0, 15, 0.8, 0.0);
    for (y, z) in (1..15).flat_map(|y| (1..15).map(move |z| (y, z))) {
        cells.surface(UVec3::new(8, y, z), Vec3::NEG_X, 0.8);
    }
    // Lit in the left room, on its walls and on the one between.
    for cell in [UVec3::new(4, 0, 7), UVec3::new(0, 5, 5), UVec3::new(8, 6, 9)] {
        cells.light(cells.grid.index(cell), Vec3::splat(10.0));
    }
    let light = incident(&labs.core, &cells, 200)?;
    let mut most = 0f32;
    let mut lit = 0f32;
    for (index, cell) in cells.grid.cells().enumerate() {
        let value = light[index].iter().flatten().fold(0f32, |a, b| a.max(b.abs()));
        if cell.x > 8 { most = most.max(value) } else { lit = lit.max(value) }
    }
    eprintln!("a shared wall lets through {most:.2e} of {lit:.2e}");
    assert!(lit > 1.0, "the left room is dark");

    // A room within a room, with its own walls, is dark to the last bit.
    let mut cells = Cells::new(16);
    cells.room(0, 15, 0.8, 1.0);
    cells.room(5, 10, 0.8, 0.0);
    for index in 0..cells.normal.len() {
        if cells.emission[index] == Vec4::ZERO {
            cells.normal[index] *= Vec4::new(1.0, 1.0, 1.0, 1.0);
        }
    }
    assert_eq!(most, 0.0, "a shared wall lets {most} through, beside {lit}");
    Ok(())
}

/// In a furnace all walls have one irradiance. Pixels at 0.2, 0.5 and 0.8 of the way through the wall cells lie between more and
/// fewer occupied cells; empty neighbours, which hold no light, must not darken them.
fn occupied_only(labs: &Labs) -> Result<(), Failed> {
    let mut cells = Cells::new(16);
    cells.room(0, 15, 0.5, 1.0);
    let at = [0.5, 0.8, 1.0].map(|wall| seen_in_room(&labs.core, &cells, 100, wall));
    let [middle, edge, boundary] = at;
    let middle = middle?;
    for (name, other) in [("0.8", edge?), ("1.0", boundary?)] {
        let ratios = other.iter().zip(&middle).map(|(a, b)| a / b);
        let (low, high) = ratios.fold((f64::MAX, 0f64), |(l, h), r| (l.min(r), h.max(r)));
        eprintln!("walls seen at {name} of their cells: {low:.3} to {high:.3} of the irradiance at 0.5");
        assert!(low > 0.9 && high < 1.1, "{name}: {low} to {high} of the irradiance in the middle");
    }
    Ok(())
}
