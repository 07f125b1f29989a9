//! Values of channels against `lumivox-voxels`, which has the same rules in double precision, in the cells that both mark.

use libtest_mimic::Failed;
use lumivox::core::Grid;
use lumivox::glam::{Mat4, Vec3, Vec4};
use lumivox::gpu::Gpu;
use lumivox::volume::Format;
use lumivox::voxelize::{
    Channel, Coverage, Material, Mesh, MeshDescriptor, Options, Rule, VertexView, Voxelizer,
};
use lumivox::wgpu::VertexFormat;
use lumivox_voxels as twin;

use super::soups::{Soup, buffer, scattered, sphere, unit_grid};
use crate::Labs;
use crate::support::{Random, run};

/// A mesh with everything, a little out of place.
struct Painted {
    soup: Soup,
    normals: Vec<[f32; 3]>,
    colors: Vec<[f32; 4]>,
    world_from_local: Mat4,
}

impl Painted {
    fn new(soup: Soup) -> Self {
        let mut random = Random::new(7);
        let normals = soup.positions.iter().map(|_| (random.cube() - 0.5).to_array()).collect();
        let colors = soup.positions.iter().map(|_| random.cube().extend(1.0).to_array()).collect();
        let turned = Mat4::from_rotation_y(0.3) * Mat4::from_scale(Vec3::new(1.1, -0.9, 1.0));
        let world_from_local = Mat4::from_translation(Vec3::new(8.3, 8.1, 7.9)) * turned;
        Self { soup, normals, colors, world_from_local }
    }

    const MATERIAL: Material = Material {
        base_color: Vec4::new(0.9, 0.5, 0.8, 1.0),
        emission: Vec3::new(0.25, 4.0, 0.0),
        alpha_cutoff: None,
    };

    fn mesh(&self, gpu: &Gpu) -> Result<Mesh, Failed> {
        let (normals, colors) = (buffer(gpu, &self.normals), buffer(gpu, &self.colors));
        Ok(self.soup.described(gpu, |d| {
            Mesh::new(
                gpu,
                &MeshDescriptor {
                    normals: Some(VertexView {
                        buffer: &normals,
                        offset: 0,
                        stride: 12,
                        format: VertexFormat::Float32x3,
                    }),
                    colors: Some(VertexView {
                        buffer: &colors,
                        offset: 0,
                        stride: 16,
                        format: VertexFormat::Float32x4,
                    }),
                    world_from_local: self.world_from_local,
                    material: Self::MATERIAL,
                    ..d
                },
            )
        })?)
    }

    /// What the CPU makes of it.
    fn twin(
        &self,
        grid: Grid,
        coverage: twin::Coverage,
        channels: Vec<twin::Channel>,
    ) -> Result<twin::SparseVolume, Failed> {
        let view = twin::MeshView {
            normals: Some(&self.normals),
            colors: Some(&self.colors),
            world_from_local: self.world_from_local,
            ..twin::MeshView::new(self.soup.view())
        };
        let material = twin::Material {
            base_color: Self::MATERIAL.base_color,
            emission: Self::MATERIAL.emission,
            ..twin::Material::default()
        };
        let model = twin::Model { meshes: vec![view], materials: vec![material] };
        let options = twin::VoxelizeOptions {
            grid: twin::GridSpec::Grid(grid),
            coverage,
            channels,
            ..twin::VoxelizeOptions::default()
        };
        Ok(twin::voxelize(&model, &options)?)
    }
}

const COVERAGES: [(Coverage, twin::Coverage); 3] = [
    (Coverage::Exact, twin::Coverage::Exact),
    (Coverage::Thin, twin::Coverage::Thin),
    (Coverage::Sampled, twin::Coverage::Sampled),
];

/// Largest difference of each channel over the cells that both mark, and how many cells only one marks.
fn differences(
    gpu: &Gpu,
    painted: &Painted,
    options: Options,
    coverage: twin::Coverage,
    rule: (Rule, twin::Rule),
) -> Result<([f32; 4], usize, usize), Failed> {
    let grid = unit_grid(17, 16, 15);
    let names = ["albedo", "normal", "emission", "area"];
    let emission = Channel::emission().range(0.0, 8.0);
    let channels = [Channel::albedo(), Channel::normal(), emission, Channel::area()];
    let of_rule = |c: Channel| if c.name() == "area" { c } else { c.rule(rule.0).format(Format::F32) };
    let mut voxelizer = Voxelizer::new(gpu, grid, &channels.map(of_rule), &options)?;
    let mut volume = voxelizer.volume(gpu)?;
    let mesh = painted.mesh(gpu)?;
    run(gpu, |e| voxelizer.record(gpu, e, &[&mesh], &mut volume))?;
    let (ours, occupied) = (volume.read_back(gpu)?, voxelizer.read_occupancy(gpu)?);
    let channels = [
        twin::Channel::albedo(),
        twin::Channel::normal().unit(false),
        twin::Channel::emission(),
        twin::Channel::area(),
    ];
    let of_rule = |c: twin::Channel| {
        if c.name() == "area" { c } else { c.rule(rule.1).format(twin::Format::F32) }
    };
    let theirs = painted.twin(grid, coverage, channels.map(of_rule).to_vec())?;
    let marked: std::collections::HashSet<_> = theirs.cells().collect();
    let mut worst = [0.0f32; 4];
    let (mut common, mut apart) = (0, 0);
    for cell in grid.cells() {
        let index = grid.index(cell);
        if occupied[index] != marked.contains(&cell) {
            apart += 1;
            continue;
        }
        for (n, name) in names.into_iter().enumerate() {
            let ours = ours.channel(name).ok_or("no channel")?[index];
            let components = if n == 3 { 1 } else { 3 };
            for (c, value) in ours.to_array().into_iter().take(components).enumerate() {
                let expected =
                    if occupied[index] { theirs.value(name, cell).ok_or("no value")?[c] } else { 0.0 };
                worst[n] = worst[n].max((value - expected).abs());
            }
        }
        common += usize::from(occupied[index]);
    }
    Ok((worst, common, apart))
}

pub(crate) fn averages(labs: &Labs) -> Result<(), Failed> {
    for (soup, what) in [(sphere(Vec3::ZERO, 6.2, 3), "sphere"), (scattered(5, 300, 5.0, 12.0), "soup")] {
        let painted = Painted::new(soup);
        for (ours, theirs) in COVERAGES {
            let options = Options { coverage: ours, ..Options::default() };
            let rule = (Rule::Average, twin::Rule::Average);
            let (worst, common, apart) = differences(&labs.core.gpu, &painted, options, theirs, rule)?;
            eprintln!("{what} {ours:?}: {worst:?} in {common} cells, {apart} apart");
            assert!(apart <= 2 && common > 200, "{what} {ours:?}: {apart} apart, {common} common");
            // The smallest surface counts in 2^-14 of a channel's range, and f32 knows where it lies to some 1e-5 cells.
            assert!(
                worst[0] < 3e-4 && worst[1] < 6e-4 && worst[2] < 1e-3 && worst[3] < 2e-5,
                "{what} {ours:?}: {worst:?}"
            );
        }
    }
    Ok(())
}

/// Sums, maxima and nearest values.
pub(crate) fn rules(labs: &Labs) -> Result<(), Failed> {
    let painted = Painted::new(scattered(6, 300, 3.0, 12.0));
    for (rule, tolerance) in [
        ((Rule::Sum, twin::Rule::Sum), 2e-5),
        ((Rule::Maximum, twin::Rule::Maximum), 2e-5),
        ((Rule::Nearest, twin::Rule::Nearest), 2e-5),
    ] {
        let (worst, common, apart) =
            differences(&labs.core.gpu, &painted, Options::default(), twin::Coverage::Exact, rule)?;
        eprintln!("{:?}: {worst:?} in {common} cells, {apart} apart", rule.0);
        assert!(apart <= 2 && common > 200, "{:?}: {apart} apart, {common} common", rule.0);
        assert!(worst.iter().all(|w| *w < tolerance), "{:?}: {worst:?}", rule.0);
    }
    Ok(())
}

/// Every format gives back what it can hold.
pub(crate) fn formats(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let grid = unit_grid(4, 4, 4);
    let soup = Soup::of([[Vec3::splat(1.5), Vec3::new(1.9, 1.5, 1.5), Vec3::new(1.5, 1.9, 1.5)]]);
    let base_color = Vec4::new(0.7, 0.2, 0.4, 0.9);
    let material = Material { base_color, ..Material::default() };
    let mesh = soup.described(gpu, |d| Mesh::new(gpu, &MeshDescriptor { material, ..d }))?;
    let function = lumivox::voxelize::SurfaceFunction {
        name: "everything".to_owned(),
        text: "fn everything(point: SurfacePoint) -> vec4f { return point.color; }".to_owned(),
        outputs: 1,
    };
    let function = std::sync::Arc::new(function);
    let mut channels = Vec::new();
    for (format, tolerance) in [(Format::U8, 1.0 / 254.0), (Format::F16, 1e-3), (Format::F32, 1e-6)] {
        for components in 1..=4u32 {
            let channel = Channel::function(&format!("{format:?} {components}"), components, &function, 0);
            channels.push((channel.format(format), components, tolerance));
        }
    }
    // Twelve channels: two resolve passes.
    let only: Vec<Channel> = channels.iter().map(|c| c.0.clone()).collect();
    let mut voxelizer = Voxelizer::new(gpu, grid, &only, &Options::default())?;
    let mut volume = voxelizer.volume(gpu)?;
    run(gpu, |e| voxelizer.record(gpu, e, &[&mesh], &mut volume))?;
    let values = volume.read_back(gpu)?;
    for (channel, components, tolerance) in &channels {
        for cell in grid.cells() {
            let found = values.channel(channel.name()).ok_or("no channel")?[grid.index(cell)];
            let is_marked = cell == lumivox::glam::UVec3::ONE;
            for c in 0..4 {
                let held = is_marked && c < *components as usize;
                let expected = if held { base_color[c] } else { 0.0 };
                assert!((found[c] - expected).abs() <= *tolerance, "{} {cell}: {found}", channel.name());
            }
        }
    }
    Ok(())
}
