//! Marked cells against the oracle, which asks every triangle about every cell in double precision: one body for all methods.

use libtest_mimic::Failed;
use lumivox::core::{Bounds, Grid};
use lumivox::glam::{UVec3, Vec3};
use lumivox::gpu::Gpu;
use lumivox::voxelize::{Coverage, Method, Options, Voxelizer};
use lumivox_oracle::voxels::{Coverage as Reference, VoxelDifference, VoxelSet};

use super::soups::{Soup, cuboid, scattered, sphere, unit_grid};
use crate::Labs;
use crate::support::{Random, run};

/// A way to voxelize, and what its cells must be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    pub(crate) options: Options,
    /// The set it must equal but for the margin of verdicts.
    pub(crate) reference: Reference,
}

/// Every method with every coverage that it knows.
pub(crate) fn ways() -> Vec<Way> {
    let direct = [
        (Coverage::Exact, Reference::Exact),
        (Coverage::Thin, Reference::Thin),
        (Coverage::Sampled, Reference::Sampled),
    ];
    let direct = direct
        .into_iter()
        .map(|(coverage, reference)| Way { options: Options { coverage, ..Options::default() }, reference });
    let swept = [Method::Slicing { output_vertices: None }, Method::Clipping { output_vertices: None }];
    let swept = swept.into_iter().map(|method| Way {
        options: Options { method, coverage: Coverage::Sampled, ..Options::default() },
        reference: Reference::Sampled,
    });
    direct.chain(swept).collect()
}

/// The cells that a way finds on a grid, for one soup after another.
pub(crate) struct Marker<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) way: Way,
    voxelizer: Voxelizer,
    volume: lumivox::VolumeBuffer,
}

impl<'a> Marker<'a> {
    pub(crate) fn new(gpu: &'a Gpu, way: Way, grid: Grid) -> Result<Self, Failed> {
        let voxelizer = Voxelizer::new(gpu, grid, &[], &way.options)?;
        let volume = voxelizer.volume(gpu)?;
        Ok(Self { gpu, way, voxelizer, volume })
    }

    pub(crate) fn cells(&mut self, soups: &[&Soup]) -> Result<Vec<bool>, Failed> {
        let meshes = soups.iter().map(|s| s.mesh(self.gpu)).collect::<Result<Vec<_>, _>>()?;
        let meshes: Vec<_> = meshes.iter().collect();
        run(self.gpu, |e| self.voxelizer.record(self.gpu, e, &meshes, &mut self.volume))?;
        Ok(self.voxelizer.read_occupancy(self.gpu)?)
    }

    pub(crate) fn against_oracle(&mut self, soup: &Soup) -> Result<VoxelDifference, Failed> {
        let set = VoxelSet::of(*self.voxelizer.grid(), soup.view(), self.way.reference);
        Ok(VoxelDifference::between(&self.cells(&[soup])?, &set)?)
    }

    fn assert_agrees(&mut self, what: &str, soup: &Soup) -> Result<(), Failed> {
        let difference = self.against_oracle(soup)?;
        let way = self.way;
        eprintln!("{what}, {:?} {:?}: {difference}", way.options.method, way.options.coverage);
        assert!(difference.is_equal_within_margin(), "{what}, {way:?}: {difference}");
        Ok(())
    }
}

pub(crate) fn each_way(
    labs: &Labs,
    grid: Grid,
    mut body: impl FnMut(&mut Marker<'_>) -> Result<(), Failed>,
) -> Result<(), Failed> {
    ways().into_iter().try_for_each(|way| body(&mut Marker::new(&labs.core.gpu, way, grid)?))
}

pub(crate) fn every_tilt(labs: &Labs) -> Result<(), Failed> {
    each_way(labs, unit_grid(18, 17, 16), |marker| {
        for n in 0..216 {
            let part = |n: u32| (n % 6) as f32 - 2.5;
            let normal = Vec3::new(part(n), part(n / 6), part(n / 36)).normalize_or_zero();
            let (u, v) = normal.any_orthonormal_pair();
            for size in [0.7, 3.0, 20.0] {
                let center = Vec3::new(9.17, 8.03, 7.91);
                let corners = [u * size, (v - u) * size, (-v - 0.3 * u) * size].map(|p| center + p);
                let d = marker.against_oracle(&Soup::of([corners]))?;
                assert!(d.is_equal_within_margin(), "{normal} {size} {:?}: {d}", marker.way);
            }
        }
        Ok(())
    })
}

pub(crate) fn all_sizes(labs: &Labs) -> Result<(), Failed> {
    each_way(labs, unit_grid(23, 17, 22), |marker| {
        for (what, count, size) in
            [("dust", 4000, 0.2), ("small", 800, 1.5), ("middle", 200, 6.0), ("large", 40, 60.0)]
        {
            marker.assert_agrees(what, &scattered(1, count, size, 23.0))?;
        }
        let mut random = Random::new(2);
        let slivers = Soup::of((0..300).map(|_| {
            let (from, to) = (20.0 * random.cube(), 20.0 * random.cube());
            [from, to, from.lerp(to, 0.5) + 1e-3 * (random.cube() - 0.5)]
        }));
        marker.assert_agrees("slivers", &slivers)
    })
}

pub(crate) fn degenerate(labs: &Labs) -> Result<(), Failed> {
    each_way(labs, unit_grid(16, 16, 16), |marker| {
        let (a, b) = (Vec3::new(1.3, 2.2, 3.4), Vec3::new(14.7, 9.1, 12.3));
        let is_sampled = marker.way.reference == Reference::Sampled;
        for triangle in [[a, b, a], [a, b, b], [b, b, b]] {
            let soup = Soup::of([triangle]);
            let d = marker.against_oracle(&soup)?;
            assert!(d.is_equal_within_margin() && (d.ours > 0) != is_sampled, "{triangle:?}: {d}");
        }
        // What is no triangle marks nothing, and does not keep others from it.
        let good = [a, b, Vec3::new(2.0, 9.0, 5.0)];
        let mut soup = Soup::of([
            [a, b, Vec3::splat(f32::NAN)],
            [a, Vec3::new(f32::INFINITY, 0.0, 0.0), b],
            [a, b, Vec3::new(0.0, f32::NEG_INFINITY, 3.0)],
            good,
        ]);
        soup.indices.push([0, 1, 12]);
        soup.indices.push([u32::MAX, 1, 2]);
        assert!(marker.cells(&[&soup])? == marker.cells(&[&Soup::of([good])])?, "{:?}", marker.way);
        let nothing = marker.cells(&[])?;
        assert!(nothing.iter().all(|c| !c), "cells without meshes");
        Ok(())
    })
}

pub(crate) fn across(labs: &Labs) -> Result<(), Failed> {
    each_way(labs, unit_grid(90, 80, 100), |marker| {
        let corners = [[-400.0, -300.0, -200.0], [900.0, 100.0, 150.0], [-100.0, 700.0, 500.0]];
        marker.assert_agrees("across and beyond", &Soup::of([corners.map(Vec3::from)]))?;
        let corners = [[0.0, 0.0, 0.0], [90.0, 80.0, 3.0], [4.0, 2.0, 100.0]];
        marker.assert_agrees("across", &Soup::of([corners.map(Vec3::from)]))
    })
}

pub(crate) fn closed(labs: &Labs) -> Result<(), Failed> {
    for (n, level) in [(9, 1), (40, 3), (96, 5), (31, 6)] {
        let soup = sphere(Vec3::ZERO, 1.37, level);
        let grid = Grid::fit(&Bounds::new(Vec3::splat(-1.37), Vec3::splat(1.37)), n)?;
        each_way(labs, grid, |marker| marker.assert_agrees(&format!("sphere {level} on {n}"), &soup))?;
    }
    let soup = cuboid(Vec3::new(-0.31, 0.2, 0.7), Vec3::new(1.1, 0.93, 0.71));
    let grid = Grid::fit(&soup.view().bounds(), 50)?;
    each_way(labs, grid, |marker| marker.assert_agrees("flat box", &soup))?;
    let grid = Grid { cell_size: 0.013, origin: Vec3::new(102.7, -57.7, 9.3), dims: UVec3::new(61, 61, 61) };
    let soup = sphere(Vec3::new(103.1, -57.3, 9.7), 0.37, 4);
    each_way(labs, grid, |marker| marker.assert_agrees("far away", &soup))
}
