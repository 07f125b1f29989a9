//! Volumes made by hand, cell by cell, and their light.

use std::sync::{Arc, Mutex};

use lumivox::core::{Grid, sh};
use lumivox::glam::{UVec3, Vec3, Vec4};
use lumivox::gpu::GpuError;
use lumivox::light::{IndirectLight, LightSettings, Reflection};
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};

use crate::support::{Lab, Stages, World, locked, run};

/// A volume and its light in memory, over a grid whose cells are a metre wide.
#[derive(Clone)]
pub(crate) struct Cells {
    pub(crate) grid: Grid,
    pub(crate) normal: Vec<Vec4>,
    pub(crate) albedo: Vec<Vec4>,
    pub(crate) emission: Vec<Vec4>,
    pub(crate) direct: Vec<[Vec4; 3]>,
}

impl Cells {
    pub(crate) fn new(side: u32) -> Self {
        let grid = Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::splat(side) };
        let zero = vec![Vec4::ZERO; grid.cell_count() as usize];
        let direct = vec![[Vec4::ZERO; 3]; zero.len()];
        Self { grid, normal: zero.clone(), albedo: zero.clone(), emission: zero, direct }
    }

    pub(crate) fn surface(&mut self, cell: UVec3, normal: Vec3, albedo: f32) {
        let index = self.grid.index(cell);
        self.normal[index] = normal.extend(1.0);
        self.albedo[index] = Vec3::splat(albedo).extend(0.0);
    }

    /// As [`Self::surface`], of which light meets only the part `occupancy`.
    pub(crate) fn veil(&mut self, cell: UVec3, normal: Vec3, albedo: f32, occupancy: f32) {
        self.surface(cell, normal, albedo);
        let index = self.grid.index(cell);
        self.normal[index].w = occupancy;
    }

    pub(crate) fn occupied(&self, index: usize) -> bool {
        self.normal[index].w > 0.0
    }

    /// Gives a surface the radiance `color`, as direct light.
    pub(crate) fn light(&mut self, index: usize, color: Vec3) {
        let lobe = sh::cosine_lobe(self.normal[index].truncate());
        self.direct[index] = color.to_array().map(|c| c * lobe);
    }

    /// A hollow box with walls one cell thick whose normals look inwards.
    pub(crate) fn room(&mut self, low: u32, high: u32, albedo: f32, emission: f32) {
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

pub(crate) type Incident = Vec<[[f32; 4]; 3]>;

/// A volume and its direct light on the device, and the stages that work on them.
pub(crate) fn uploaded(lab: &Lab, cells: &Cells) -> Result<(World, Arc<Mutex<Stages>>), GpuError> {
    let mut world = World::new(lab, cells.grid)?;
    for (name, values) in [(NORMAL, &cells.normal), (ALBEDO, &cells.albedo), (EMISSION, &cells.emission)] {
        world.volume.upload(&lab.gpu, name, values)?;
    }
    world.light.upload(&lab.gpu, &cells.direct);
    let stages = lab.stages(&world.volume)?;
    locked(&stages).light.update(&lab.gpu, &LightSettings::default());
    Ok((world, stages))
}

/// All kinds of surfaces, by name.
pub(crate) const REFLECTIONS: [(&str, Reflection); 3] = [
    ("Lambertian", Reflection::Lambertian),
    ("axis mirror", Reflection::AxisMirror),
    ("normal mirror", Reflection::NormalMirror),
];

/// Seeds, and calls `look` with the flux under way and the incident light then and after each of `looks` times `steps`
/// iterations.
pub(crate) fn propagate(
    lab: &Lab,
    cells: &Cells,
    counts: (u32, u32),
    look: impl FnMut(f64, Incident),
) -> Result<(), GpuError> {
    let (world, stages) = uploaded(lab, cells)?;
    propagated(lab, &world, &mut locked(&stages).light, counts, look)
}

/// As [`propagate`], with another kind of surfaces and other settings.
pub(crate) fn propagate_by(
    lab: &Lab,
    cells: &Cells,
    (reflection, settings): (Reflection, LightSettings),
    counts: (u32, u32),
    look: impl FnMut(f64, Incident),
) -> Result<(), GpuError> {
    let (world, _) = uploaded(lab, cells)?;
    let mut light = IndirectLight::with_reflection(&lab.gpu, &world.volume, reflection)?;
    light.update(&lab.gpu, &settings);
    propagated(lab, &world, &mut light, counts, look)
}

fn propagated(
    lab: &Lab,
    world: &World,
    light: &mut IndirectLight,
    (steps, looks): (u32, u32),
    mut look: impl FnMut(f64, Incident),
) -> Result<(), GpuError> {
    let gpu = &lab.gpu;
    run(gpu, |e| {
        light.record_transport(gpu, e, &world.volume)?;
        light.record_seed(gpu, e, &world.volume, &world.light)
    })?;
    look(light.flux_under_way(gpu)?, light.read_incident(gpu)?);
    for _ in 0..looks {
        run(gpu, |e| light.record_propagation(gpu, e, &world.volume, steps))?;
        look(light.flux_under_way(gpu)?, light.read_incident(gpu)?);
    }
    Ok(())
}

pub(crate) fn incident(lab: &Lab, cells: &Cells, iterations: u32) -> Result<Incident, GpuError> {
    incident_by(lab, cells, Reflection::default(), iterations)
}

pub(crate) fn incident_by(
    lab: &Lab,
    cells: &Cells,
    reflection: Reflection,
    iterations: u32,
) -> Result<Incident, GpuError> {
    let mut last = Vec::new();
    propagate_by(lab, cells, (reflection, LightSettings::default()), (iterations, 1), |_, l| last = l)?;
    Ok(last)
}
