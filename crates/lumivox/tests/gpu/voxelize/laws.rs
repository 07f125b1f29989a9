//! What must hold for every method: order and partition of triangles, layers, windows, walls on cell boundaries, closed shells.

use libtest_mimic::Failed;
use lumivox::core::Grid;
use lumivox::glam::{UVec3, Vec3, Vec4};
use lumivox::gpu::Gpu;
use lumivox::progressive::SURFACE_SHIFT;
use lumivox::volume::Format;
use lumivox::voxelize::{Channel, Coverage, Interleaved, Mesh, Options, Rule, Voxelizer};

use super::coverage::{Marker, each_way, ways};
use super::soups::{Soup, cuboid, scattered, sphere, unit_grid};
use crate::Labs;
use crate::support::{Random, run};

/// A channel of every rule, of what differs from triangle to triangle.
fn channels() -> Vec<Channel> {
    [Rule::Average, Rule::Sum, Rule::Maximum, Rule::Nearest]
        .into_iter()
        .map(|rule| Channel::normal().named(&format!("{rule:?}")).rule(rule).format(Format::F32))
        .collect()
}

type Values = (Vec<bool>, Vec<Vec<Vec4>>);

fn values(gpu: &Gpu, voxelizer: &Voxelizer, volume: &lumivox::VolumeBuffer) -> Result<Values, Failed> {
    let read = volume.read_back(gpu)?;
    let channels =
        channels().iter().map(|c| read.channel(c.name()).map(<[_]>::to_vec)).collect::<Option<_>>();
    Ok((voxelizer.read_occupancy(gpu)?, channels.ok_or("a channel is missing")?))
}

fn soups() -> [Soup; 3] {
    [scattered(1, 600, 1.5, 15.0), scattered(2, 30, 30.0, 15.0), sphere(Vec3::splat(7.5), 5.0, 3)]
}

fn joined<'a>(soups: impl IntoIterator<Item = &'a Soup>) -> Soup {
    Soup::of(soups.into_iter().flat_map(|s| s.view().iter().collect::<Vec<_>>()))
}

fn at_once(gpu: &Gpu, voxelizer: &mut Voxelizer, soups: &[&Soup]) -> Result<Values, Failed> {
    let mut volume = voxelizer.volume(gpu)?;
    let meshes = soups.iter().map(|s| s.mesh(gpu)).collect::<Result<Vec<Mesh>, _>>()?;
    let meshes: Vec<&Mesh> = meshes.iter().collect();
    run(gpu, |e| voxelizer.record(gpu, e, &meshes, &mut volume))?;
    values(gpu, voxelizer, &volume)
}

pub(crate) fn order(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [small, large, ball] = soups();
    let all = joined([&small, &large, &ball]);
    let mut shuffled = all.clone();
    let mut random = Random::new(9);
    for n in (1..shuffled.indices.len()).rev() {
        shuffled.indices.swap(n, (random.unit() * (n + 1) as f32) as usize);
    }
    for way in ways() {
        let mut voxelizer = Voxelizer::new(gpu, unit_grid(15, 16, 17), &channels(), &way.options)?;
        let expected = at_once(gpu, &mut voxelizer, &[&all])?;
        assert!(expected.0.iter().filter(|c| **c).count() > 100, "{way:?}");
        assert!(expected == at_once(gpu, &mut voxelizer, &[&shuffled])?, "{way:?}: order");
        assert!(expected == at_once(gpu, &mut voxelizer, &[&ball, &large, &small])?, "{way:?}: meshes");
        assert!(expected == at_once(gpu, &mut voxelizer, &[&all])?, "{way:?}: again");
    }
    Ok(())
}

pub(crate) fn layers(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [small, large, ball] = soups();
    for way in ways() {
        let mut voxelizer = Voxelizer::new(gpu, unit_grid(15, 16, 17), &channels(), &way.options)?;
        let expected = at_once(gpu, &mut voxelizer, &[&small, &large, &ball])?;
        let without = at_once(gpu, &mut voxelizer, &[&small, &large])?;
        let [small, large, ball] = [small.mesh(gpu)?, large.mesh(gpu)?, ball.mesh(gpu)?];
        let mut volume = voxelizer.volume(gpu)?;
        let (mut still, mut moving) = (voxelizer.layer(gpu)?, voxelizer.layer(gpu)?);
        run(gpu, |e| voxelizer.record_layer(gpu, e, &[&small, &large], &mut still))?;
        // What moves comes and goes; what stands still is not looked at again.
        for (meshes, expected) in [(vec![&ball], &expected), (vec![], &without), (vec![&ball], &expected)] {
            run(gpu, |e| {
                voxelizer.record_layer(gpu, e, &meshes, &mut moving)?;
                voxelizer.record_merge(gpu, e, &[&still, &moving], &mut volume)
            })?;
            assert!(*expected == values(gpu, &voxelizer, &volume)?, "{way:?}: {} moving", meshes.len());
        }
        // One axis a frame.
        let mut interleaved = Interleaved::new(gpu, &voxelizer)?;
        let mut counts = Vec::new();
        for _ in 0..3 {
            let meshes = [&small, &large, &ball];
            run(gpu, |e| voxelizer.record_interleaved(gpu, e, &meshes, &mut interleaved, &mut volume))?;
            counts.push(voxelizer.read_occupancy(gpu)?.iter().filter(|c| **c).count());
        }
        assert!(0 < counts[0] && counts[0] < counts[1] && counts[1] < counts[2], "{way:?}: {counts:?}");
        assert!(expected == values(gpu, &voxelizer, &volume)?, "{way:?}: interleaved");
    }
    Ok(())
}

/// Slab by slab, the last one thinner: the cells and values of the whole grid, walls on the slabs' ends too.
pub(crate) fn slabs(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let wall = cuboid(Vec3::new(2.0, 2.0, 5.0), Vec3::new(12.0, 12.0, 10.0));
    let all = joined([&wall, &scattered(1, 600, 1.5, 15.0), &scattered(2, 30, 30.0, 15.0)]);
    let grid = unit_grid(15, 16, 17);
    for way in ways() {
        let mut whole = Voxelizer::new(gpu, grid, &channels(), &way.options)?;
        let expected = at_once(gpu, &mut whole, &[&all])?;
        let mut voxelizer = Voxelizer::for_slabs(gpu, grid, 5, &channels(), &way.options)?;
        let mut found: Values = (Vec::new(), vec![Vec::new(); channels().len()]);
        let mut slabs = Vec::new();
        for first in [0, 5, 10, 15] {
            voxelizer.move_to_layer(gpu, first);
            slabs.push(voxelizer.layers());
            let cells = 15 * 16 * voxelizer.layers().len();
            let (occupied, values) = at_once(gpu, &mut voxelizer, &[&all])?;
            assert!(!occupied[cells..].contains(&true), "{way:?}: beyond the grid");
            found.0.extend(&occupied[..cells]);
            found.1.iter_mut().zip(values).for_each(|(all, slab)| all.extend(&slab[..cells]));
        }
        assert_eq!(slabs, [0..5, 5..10, 10..15, 15..17]);
        assert!(expected == found, "{way:?}");
    }
    Ok(())
}

/// So many numbers a cell that their sums do not fit one binding: the same values as from a voxelizer of few.
pub(crate) fn windows(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let side = 88;
    let soup = joined([&sphere(Vec3::splat(44.0), 40.0, 4), &scattered(3, 50, 60.0, 88.0)]);
    let mut few = Voxelizer::new(gpu, unit_grid(side, side, side), &channels(), &Options::default())?;
    let mut many = channels();
    let function = lumivox::voxelize::SurfaceFunction {
        name: "everything".to_owned(),
        text: "fn everything(point: SurfacePoint) -> vec4f { return vec4f(point.normal, point.area); }"
            .to_owned(),
        outputs: 1,
    };
    let function = std::sync::Arc::new(function);
    for n in 0..5 {
        let own = Channel::function(&format!("own {n}"), 4, &function, 0);
        many.push(own.range(-1.0, 1.0).format(Format::F32));
    }
    let mut many = Voxelizer::new(gpu, unit_grid(side, side, side), &many, &Options::default())?;
    assert!(few.triangle_passes() == 2 && many.triangle_passes() == 4, "{}", many.triangle_passes());
    let expected = at_once(gpu, &mut few, &[&soup])?;
    assert!(expected == at_once(gpu, &mut many, &[&soup])?, "in one window and in two");
    Ok(())
}

pub(crate) fn boundaries(labs: &Labs) -> Result<(), Failed> {
    each_way(labs, unit_grid(4, 4, 4), |marker| {
        for axis in 0..3 {
            for (at, expected) in [(0.0, 0), (1.0, 1), (3.0, 3), (4.0, 3)] {
                let wall = [[-1.0, -1.0], [9.0, -1.0], [-1.0, 9.0]].map(|[p, q]| {
                    let mut corner = Vec3::splat(at);
                    corner[(axis + 1) % 3] = p;
                    corner[(axis + 2) % 3] = q;
                    corner
                });
                let cells = marker.cells(&[&Soup::of([wall])])?;
                let grid = unit_grid(4, 4, 4);
                for cell in grid.cells() {
                    let is = cells[grid.index(cell)];
                    assert_eq!(is, cell[axis] == expected, "{:?}: {axis} {at} {cell}", marker.way);
                }
            }
        }
        Ok(())
    })
}

/// Whether a path of face neighbours (and of edge and corner neighbours, if `diagonal`) leads from the first cell to a cell.
pub(crate) fn is_reached(grid: &Grid, marked: &[bool], goal: UVec3, diagonal: bool) -> bool {
    let mut reached = vec![false; marked.len()];
    let mut open = vec![UVec3::ZERO];
    reached[0] = true;
    while let Some(cell) = open.pop() {
        for n in 0..27 {
            let step = UVec3::new(n % 3, n / 3 % 3, n / 9).as_ivec3() - 1;
            if !diagonal && step.abs().element_sum() != 1 {
                continue;
            }
            let next = cell.as_ivec3() + step;
            if next.min_element() < 0 || next.cmpge(grid.dims.as_ivec3()).any() {
                continue;
            }
            let index = grid.index(next.as_uvec3());
            if !marked[index] && !std::mem::replace(&mut reached[index], true) {
                open.push(next.as_uvec3());
            }
        }
    }
    reached[grid.index(goal)]
}

pub(crate) fn separation(labs: &Labs) -> Result<(), Failed> {
    for (soup, side) in [
        (sphere(Vec3::splat(15.3), 12.1, 1), 31),
        (sphere(Vec3::splat(15.3), 12.1, 5), 31),
        (cuboid(Vec3::splat(2.0), Vec3::splat(22.0)), 25),
    ] {
        let grid = unit_grid(side, side, side);
        let middle = UVec3::splat(side / 2);
        for way in ways().into_iter().filter(|w| w.options.coverage != Coverage::Sampled) {
            let marked = Marker::new(&labs.core.gpu, way, grid)?.cells(&[&soup])?;
            assert!(!marked[grid.index(middle)], "{way:?}: it is hollow");
            assert!(!is_reached(&grid, &marked, middle, false), "{way:?}: a way in through faces");
            if way.options.coverage == Coverage::Exact {
                assert!(!is_reached(&grid, &marked, middle, true), "{way:?}: a way in through corners");
            }
        }
    }
    Ok(())
}

/// A surface on a cell boundary belongs to the cell behind its visible side if it is moved.
pub(crate) fn shift(labs: &Labs) -> Result<(), Failed> {
    let grid = unit_grid(8, 8, 8);
    let options = Options { coverage: Coverage::Thin, shift: SURFACE_SHIFT as f32, ..Options::default() };
    let way = super::coverage::Way { options, ..ways()[1] };
    let marked =
        Marker::new(&labs.core.gpu, way, grid)?.cells(&[&cuboid(Vec3::splat(2.0), Vec3::splat(6.0))])?;
    for cell in grid.cells() {
        let inside = cell.cmpge(UVec3::splat(2)).all() && cell.cmple(UVec3::splat(5)).all();
        let on_shell = inside && (cell.cmpeq(UVec3::splat(2)) | cell.cmpeq(UVec3::splat(5))).any();
        assert_eq!(marked[grid.index(cell)], on_shell, "{cell}");
    }
    Ok(())
}
