//! Laws of sweeps: boundaries, order, and the cells of methods that draw every triangle in every sweep, which the oracle does not know.

use libtest_mimic::Failed;
use lumivox::core::Grid;
use lumivox::glam::{DVec3, UVec3, Vec3};
use lumivox::voxelize::{Directions, Method, Options};
use lumivox_oracle::voxels::{Coverage as Reference, VoxelSet};

use super::coverage::{Marker, Way, ways};
use super::laws::is_reached;
use super::soups::{Soup, cuboid, scattered, sphere, unit_grid};
use crate::Labs;
use crate::support::Random;

/// The methods whose sweeps draw every triangle, whichever way it faces.
fn every_face_ways() -> [Way; 2] {
    [Method::SlicePerPass, Method::Slicemap(Directions::Three)].map(|method| Way {
        options: Options { method, ..Options::default() },
        reference: Reference::Sampled,
    })
}

/// Long triangles, so narrow that most columns miss them.
fn slivers() -> Soup {
    let mut random = Random::new(6);
    Soup::of((0..400).map(|_| {
        let (from, to) = (22.0 * random.cube(), 22.0 * random.cube());
        [from, to, from.lerp(to, 0.5) + 0.2 * (random.cube() - 0.5)]
    }))
}

/// Of slivers, a rasterizer that moves corners by 1/256 of a pixel would lose many cells and find others.
pub(crate) fn narrow(labs: &Labs) -> Result<(), Failed> {
    let grid = unit_grid(23, 17, 22);
    let soup = slivers();
    for way in ways() {
        let d = Marker::new(&labs.core.gpu, way, grid)?.against_oracle(&soup)?;
        eprintln!("{:?}: {d}", way.options);
        assert!(d.is_equal_within_margin() && d.ours > 100, "{way:?}: {d}");
    }
    Ok(())
}

/// The cells in which lines along some axes through the centres of columns meet a triangle, in double precision: surely, and possibly
/// where lines and cells are wider by a ten-thousandth.
fn lines(grid: &Grid, soup: &Soup, axes: &[usize]) -> [Vec<bool>; 2] {
    const MARGIN: f64 = 1e-4;
    let count = grid.cell_count() as usize;
    let (mut surely, mut possibly) = (vec![false; count], vec![false; count]);
    let dims = grid.dims.as_ivec3().to_array();
    for triangle in soup.view().iter() {
        let corners: [DVec3; 3] =
            triangle.map(|p| (p.as_dvec3() - grid.origin.as_dvec3()) / f64::from(grid.cell_size));
        for &axis in axes {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let low = corners[0].min(corners[1]).min(corners[2]);
            let high = corners[0].max(corners[1]).max(corners[2]);
            if normal[axis] == 0.0 {
                continue;
            }
            let range =
                |a: usize| (low[a].floor() as i32 - 1).max(0)..=(high[a].floor() as i32 + 1).min(dims[a] - 1);
            for i in range(u) {
                for j in range(v) {
                    let center = [f64::from(i) + 0.5, f64::from(j) + 0.5];
                    // Distance to the nearest edge, inwards.
                    let inwards = (0..3).map(|n| {
                        let (a, b, c) = (corners[n], corners[(n + 1) % 3], corners[(n + 2) % 3]);
                        let edge = [b[u] - a[u], b[v] - a[v]];
                        let side = |x: f64, y: f64| edge[0] * (y - a[v]) - edge[1] * (x - a[u]);
                        side(center[0], center[1]) * side(c[u], c[v]).signum()
                            / edge[0].hypot(edge[1]).max(1e-300)
                    });
                    let inwards = inwards.fold(f64::INFINITY, f64::min);
                    if inwards < -MARGIN {
                        continue;
                    }
                    let mut point = corners[0];
                    point[u] = center[0];
                    point[v] = center[1];
                    let offset = point - corners[0];
                    let height =
                        corners[0][axis] - (normal[u] * offset[u] + normal[v] * offset[v]) / normal[axis];
                    let height = height.clamp(low[axis], high[axis]);
                    let steepness = normal[u].hypot(normal[v]) / normal[axis].abs();
                    let reach = MARGIN * (1.0 + steepness);
                    let [first, last] = [height - reach, height + reach].map(|h| h.floor() as i32);
                    let index = |k: i32| {
                        let mut cell = [0; 3];
                        (cell[axis], cell[u], cell[v]) = (k, i, j);
                        let [x, y, z] = cell.map(|c: i32| c as u32);
                        grid.index(UVec3::new(x, y, z))
                    };
                    let is_sure = first == last && inwards > MARGIN;
                    for k in first.max(0)..=last.min(dims[axis] - 1) {
                        surely[index(k)] |= is_sure;
                        possibly[index(k)] = true;
                    }
                }
            }
        }
    }
    [surely, possibly]
}

fn assert_between(what: &str, cells: &[bool], [surely, possibly]: &[Vec<bool>; 2]) {
    let missing = cells.iter().zip(surely).filter(|&(&is, &sure)| sure && !is).count();
    let strays = cells.iter().zip(possibly).filter(|&(&is, &possible)| is && !possible).count();
    let marked = cells.iter().filter(|c| **c).count();
    eprintln!("{what}: {marked} cells, {missing} missing, {strays} strays");
    assert!(missing == 0 && strays == 0, "{what}: {marked} cells, {missing} missing, {strays} strays");
}

pub(crate) fn every_face(labs: &Labs) -> Result<(), Failed> {
    let soups = [
        ("sphere", sphere(Vec3::new(11.3, 9.2, 10.9), 8.4, 4)),
        ("dust", scattered(1, 3000, 0.3, 22.0)),
        ("middle", scattered(3, 200, 7.0, 22.0)),
        ("large", scattered(4, 30, 60.0, 22.0)),
        ("slivers", slivers()),
    ];
    for way in every_face_ways() {
        let grid = unit_grid(23, 17, 22);
        let mut marker = Marker::new(&labs.core.gpu, way, grid)?;
        for (what, soup) in &soups {
            let cells = marker.cells(&[soup])?;
            let what = format!("{what}, {:?}", way.options.method);
            assert_between(&what, &cells, &lines(&grid, soup, &[0, 1, 2]));
            let exact = VoxelSet::of(grid, soup.view(), Reference::Exact);
            let strays = (0..cells.len()).filter(|&i| cells[i] && !exact.verdict_at(i).possibly).count();
            assert!(strays == 0, "{what}: {strays} cells outside the exact set");
            let sampled = VoxelSet::of(grid, soup.view(), Reference::Sampled);
            let missing = (0..cells.len()).filter(|&i| !cells[i] && sampled.verdict_at(i).surely).count();
            assert!(missing == 0, "{what}: {missing} cells of the sampled set are missing");
        }
    }
    Ok(())
}

pub(crate) fn one_direction(labs: &Labs) -> Result<(), Failed> {
    let soup = sphere(Vec3::new(10.2, 9.1, 8.7), 7.7, 3);
    let grid = unit_grid(20, 18, 17);
    for axis in 0..3 {
        let method = Method::Slicemap(Directions::One(axis));
        let way = Way { options: Options { method, ..Options::default() }, reference: Reference::Sampled };
        let cells = Marker::new(&labs.core.gpu, way, grid)?.cells(&[&soup])?;
        assert_between(&format!("axis {axis}"), &cells, &lines(&grid, &soup, &[axis as usize]));
    }
    Ok(())
}

/// The line between the centres of face neighbours on two sides of a closed surface meets it in one of the two cells.
pub(crate) fn separation(labs: &Labs) -> Result<(), Failed> {
    let center = Vec3::new(14.2, 13.9, 14.4);
    let shells = [
        ("fine", sphere(center, 11.6, 5)),
        ("coarse", sphere(center, 11.6, 1)),
        ("box", cuboid(Vec3::splat(2.61), Vec3::new(25.7, 25.3, 24.2))),
    ];
    let grid = unit_grid(28, 28, 28);
    for way in every_face_ways() {
        let mut marker = Marker::new(&labs.core.gpu, way, grid)?;
        for (what, soup) in &shells {
            let cells = marker.cells(&[soup])?;
            let inside = center.as_uvec3();
            assert!(!cells[grid.index(inside)] && !cells[0], "{what}, {way:?}");
            assert!(is_reached(&grid, &cells, UVec3::splat(27), false), "{what}, {way:?}");
            assert!(!is_reached(&grid, &cells, inside, false), "{what}, {way:?}");
        }
    }
    Ok(())
}

/// A wall on a boundary marks the cells above it alone, and on the grid's upper face the last ones.
pub(crate) fn planes(labs: &Labs) -> Result<(), Failed> {
    let grid = unit_grid(9, 7, 8);
    for way in every_face_ways() {
        let mut marker = Marker::new(&labs.core.gpu, way, grid)?;
        for axis in 0..3usize {
            for (at, layer) in [(0, 0), (3, 3), (grid.dims[axis], grid.dims[axis] - 1)] {
                let corner = |u: f32, v: f32| {
                    let mut p = Vec3::ZERO;
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (at as f32, u, v);
                    p
                };
                let wall = Soup::of([[corner(-1.0, -1.0), corner(40.0, -1.0), corner(-1.0, 40.0)]]);
                let cells = marker.cells(&[&wall])?;
                for cell in grid.cells() {
                    let expected = cell[axis] == layer;
                    assert!(
                        cells[grid.index(cell)] == expected,
                        "{way:?}: wall at {at} of axis {axis}, {cell}"
                    );
                }
            }
        }
    }
    Ok(())
}

/// The order of triangles and vertices, and how they are spread over meshes, change nothing.
pub(crate) fn order(labs: &Labs) -> Result<(), Failed> {
    let grid = unit_grid(20, 21, 22);
    let soup = scattered(9, 500, 5.0, 20.0);
    let turned = soup.indices.iter().rev().map(|&[a, b, c]| [b, c, a]);
    let backwards = Soup { indices: turned.collect(), ..soup.clone() };
    let part = |keep: usize| Soup {
        indices: soup.indices.iter().enumerate().filter(|(n, _)| n % 3 == keep).map(|(_, t)| *t).collect(),
        ..soup.clone()
    };
    let parts = [part(0), part(1), part(2)];
    for way in every_face_ways() {
        let mut marker = Marker::new(&labs.core.gpu, way, grid)?;
        let cells = marker.cells(&[&soup])?;
        let apart = |other: Vec<bool>| cells.iter().zip(&other).filter(|(a, b)| a != b).count();
        assert!(apart(marker.cells(&[&parts[0], &parts[1], &parts[2]])?) == 0, "split, {way:?}");
        // Turned corners round differently, in cells whose verdict hangs on it.
        let other = apart(marker.cells(&[&backwards])?);
        assert!(other <= 2, "{other} cells apart backwards, {way:?}");
    }
    Ok(())
}
