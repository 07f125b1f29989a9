//! Methods that draw slices: limits on vertices, values, and the axis of a frame.

use std::sync::Arc;

use libtest_mimic::Failed;
use lumivox::core::{Bounds, Grid, HostVolume};
use lumivox::glam::{Vec3, Vec4};
use lumivox::gpu::Gpu;
use lumivox::volume::Format;
use lumivox::voxelize::{
    Channel, Coverage, Directions, Interleaved, Method, Options, Rule, SurfaceFunction, VoxelizeError,
    Voxelizer,
};

use super::soups::{Soup, scattered, sphere, unit_grid};
use crate::Labs;
use crate::support::run;

fn cells(gpu: &Gpu, grid: Grid, method: Method, soup: &Soup) -> Result<Vec<bool>, Failed> {
    let mut voxelizer = Voxelizer::new(gpu, grid, &[], &Options { method, ..Options::default() })?;
    let mut volume = voxelizer.volume(gpu)?;
    let mesh = soup.mesh(gpu)?;
    run(gpu, |e| voxelizer.record(gpu, e, &[&mesh], &mut volume))?;
    Ok(voxelizer.read_occupancy(gpu)?)
}

fn count(cells: &[bool]) -> usize {
    cells.iter().filter(|c| **c).count()
}

/// Figure 7: few vertices, many holes; each larger limit has all the cells of the smaller.
pub(crate) fn limits(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let soup = sphere(Vec3::ZERO, 1.37, 3);
    let grid = Grid::fit(&Bounds::new(Vec3::splat(-1.37), Vec3::splat(1.37)), 64)?;
    for (is_slicing, limits) in [(true, [3, 7, 15, 43]), (false, [3, 6, 12, 30])] {
        let of = |output_vertices: Option<u32>| {
            if is_slicing {
                Method::Slicing { output_vertices }
            } else {
                Method::Clipping { output_vertices }
            }
        };
        let whole = cells(gpu, grid, of(None), &soup)?;
        let mut before = vec![false; whole.len()];
        let mut holes = Vec::new();
        for limit in limits {
            let limited = cells(gpu, grid, of(Some(limit)), &soup)?;
            assert!(before.iter().zip(&limited).all(|(a, b)| !a || *b), "{limit} loses cells of less");
            assert!(limited.iter().zip(&whole).all(|(a, b)| !a || *b), "{limit} has cells of its own");
            holes.push(count(&whole) - count(&limited));
            before = limited;
        }
        eprintln!("{} cells, holes {holes:?} of limits {limits:?}", count(&whole));
        assert!(holes.is_sorted_by(|a, b| a >= b) && holes[0] > 100 && holes[1] < holes[0], "{holes:?}");
        assert!(holes[3] == 0, "{holes:?}: every triangle reaches at most 10 slices");
        assert!(count(&cells(gpu, grid, of(Some(2)), &soup)?) == 0, "no triangle has two vertices");
    }
    // By hand: a wall of slope one through 8 slices, a row of columns for each slice.
    let [v1, v2, v3] = [[0.3, -2.0, 0.35], [4.1, 6000.0, 4.15], [7.7, -2.0, 7.75]];
    let wall = Soup::of([[v1, v3, v2].map(Vec3::from)]);
    let grid = unit_grid(8, 3, 8);
    let slices = |method| -> Result<usize, Failed> {
        let cells = cells(gpu, grid, method, &wall)?;
        let layers = (0..8).filter(|&z| grid.cells().any(|c| c.z == z && cells[grid.index(c)]));
        Ok(layers.count())
    };
    for (limit, expected) in [(3, 1), (8, 2), (9, 3), (24, 8)] {
        assert_eq!(slices(Method::Clipping { output_vertices: Some(limit) })?, expected, "clipping {limit}");
    }
    // A tip of 3, strips of 4, two of them in the fifth slice, where v2 is, and a tip.
    for (limit, expected) in [(6, 1), (7, 2), (15, 4), (22, 4), (23, 5), (33, 7), (34, 8)] {
        assert_eq!(slices(Method::Slicing { output_vertices: Some(limit) })?, expected, "slicing {limit}");
    }
    Ok(())
}

fn volume(
    gpu: &Gpu,
    grid: Grid,
    channels: &[Channel],
    options: &Options,
    soup: &Soup,
) -> Result<HostVolume, Failed> {
    let mut voxelizer = Voxelizer::new(gpu, grid, channels, options)?;
    let mut volume = voxelizer.volume(gpu)?;
    let mesh = soup.mesh(gpu)?;
    run(gpu, |e| voxelizer.record(gpu, e, &[&mesh], &mut volume))?;
    Ok(volume.read_back(gpu)?)
}

fn channels() -> Vec<Channel> {
    let normal = |name, rule| Channel::normal().format(Format::F32).named(name).rule(rule);
    vec![
        normal("average", Rule::Average),
        normal("largest", Rule::Maximum),
        normal("nearest", Rule::Nearest),
        Channel::area(),
    ]
}

/// The same samples as direct, so the same values but for rounding.
pub(crate) fn values(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let grid = unit_grid(17, 16, 15);
    for soup in [sphere(Vec3::new(8.3, 8.1, 7.9), 6.2, 3), scattered(5, 300, 5.0, 14.0)] {
        let direct = Options { coverage: Coverage::Sampled, ..Options::default() };
        let reference = volume(gpu, grid, &channels(), &direct, &soup)?;
        for method in [Method::Slicing { output_vertices: None }, Method::Clipping { output_vertices: None }]
        {
            let ours = volume(gpu, grid, &channels(), &Options { method, ..Options::default() }, &soup)?;
            for name in ["average", "largest", "nearest", "area"] {
                let pairs = ours.channel(name).zip(reference.channel(name)).ok_or("no channel")?;
                let difference = |(a, b): (&Vec4, &Vec4)| (*a - *b).abs().max_element();
                let apart = pairs.0.iter().zip(pairs.1).map(difference).filter(|d| *d > 1e-5).count();
                // A sample on the edge of two cells or triangles may be in the other one.
                assert!(apart <= 2, "{method:?}, {name}: {apart} cells apart");
            }
        }
    }
    Ok(())
}

/// The areas of all cells are that of the surface, with one sample in a column and with three that share it.
pub(crate) fn areas(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let grid = unit_grid(40, 40, 40);
    let soup = sphere(Vec3::new(20.2, 19.9, 20.4), 17.0, 4);
    let area = |t: [Vec3; 3]| 0.5 * f64::from((t[1] - t[0]).cross(t[2] - t[0]).length());
    let expected: f64 = soup.view().iter().map(area).sum();
    let slices = [Method::Slicing { output_vertices: None }, Method::Clipping { output_vertices: None }];
    for method in slices.into_iter().chain([Method::SlicePerPass]) {
        let options = Options { method, ..Options::default() };
        let volume = volume(gpu, grid, &[Channel::area()], &options, &soup)?;
        let sum: f64 = volume.channel("area").ok_or("no channel")?.iter().map(|v| f64::from(v.x)).sum();
        eprintln!("{method:?}: {sum:.1} of {expected:.1}");
        assert!((sum / expected - 1.0).abs() < 0.01, "{method:?}: {sum} of {expected}");
    }
    Ok(())
}

/// Three frames of an axis each are one frame of all.
pub(crate) fn interleaved(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let grid = unit_grid(20, 18, 16);
    let soup = scattered(11, 200, 8.0, 20.0);
    let options = Options { method: Method::SlicePerPass, ..Options::default() };
    let expected = volume(gpu, grid, &channels(), &options, &soup)?;
    let mut voxelizer = Voxelizer::new(gpu, grid, &channels(), &options)?;
    let mut interleaved = Interleaved::new(gpu, &voxelizer)?;
    let mut volume = voxelizer.volume(gpu)?;
    let mesh = soup.mesh(gpu)?;
    let mut counts = Vec::new();
    for _ in 0..3 {
        run(gpu, |e| voxelizer.record_interleaved(gpu, e, &[&mesh], &mut interleaved, &mut volume))?;
        counts.push(count(&voxelizer.read_occupancy(gpu)?));
    }
    assert!(0 < counts[0] && counts[0] < counts[1] && counts[1] < counts[2], "{counts:?}");
    let ours = volume.read_back(gpu)?;
    for name in ["average", "largest", "nearest", "area"] {
        assert!(ours.channel(name) == expected.channel(name), "{name}");
    }
    Ok(())
}

/// Sums that do not fit one binding are made in two windows, with the same values.
pub(crate) fn windows(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let grid = unit_grid(86, 90, 88);
    let soup = scattered(3, 80, 60.0, 88.0);
    let function = Arc::new(SurfaceFunction {
        name: "everything".to_owned(),
        text: "fn everything(point: SurfacePoint) -> vec4f { return vec4f(point.normal, point.area); }"
            .to_owned(),
        outputs: 1,
    });
    let own =
        |n| Channel::function(&format!("own {n}"), 4, &function, 0).range(-1.0, 1.0).format(Format::F32);
    let (few, many) = (channels(), channels().into_iter().chain((0..5).map(own)).collect::<Vec<_>>());
    let slices = [Method::Slicing { output_vertices: None }, Method::Clipping { output_vertices: None }];
    for method in slices.into_iter().chain([Method::SlicePerPass]) {
        let options = Options { method, ..Options::default() };
        let passes =
            |channels: &[Channel]| Voxelizer::new(gpu, grid, channels, &options).map(|v| v.triangle_passes());
        // Twice as many as windows, since nearest values take a second pass.
        assert_eq!((passes(&few)?, passes(&many)?), (2, 4));
        let (one, two) =
            (volume(gpu, grid, &few, &options, &soup)?, volume(gpu, grid, &many, &options, &soup)?);
        for channel in &few {
            assert!(
                one.channel(channel.name()) == two.channel(channel.name()),
                "{method:?}: {}",
                channel.name()
            );
        }
    }
    Ok(())
}

pub(crate) fn refusals(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let refused = |grid: Grid, channels: &[Channel], method: Method| match Voxelizer::new(
        gpu,
        grid,
        channels,
        &Options { method, ..Options::default() },
    ) {
        Err(error @ VoxelizeError::Method { .. }) => Ok(error.to_string()),
        other => Err(format!("{method:?}: {other:?}")),
    };
    let slicemap = Method::Slicemap(Directions::Three);
    assert!(refused(unit_grid(8, 8, 8), &[Channel::albedo()], slicemap)?.contains("albedo"));
    assert!(refused(unit_grid(8, 8, 8), &[], Method::Slicemap(Directions::One(3)))?.contains("axis 3"));
    for method in [Method::Slicing { output_vertices: None }, Method::Clipping { output_vertices: None }] {
        assert!(refused(unit_grid(5000, 1, 1), &[], method)?.contains("4096"));
    }
    Ok(())
}
