//! In a scene that stands still no cell lies beyond its triangles, in any frame, whatever form, rule and views there are.

use libtest_mimic::Failed;
use lumivox::core::{Grid, HostVolume};
use lumivox::glam::{DVec3, UVec2, Vec3};
use lumivox::progressive::{AttributeView, CleanupRule, SURFACE_SHIFT, Storage};
use lumivox::volume::NORMAL;
use lumivox_oracle::voxels::{Coverage, VoxelSet};

use crate::bricks::dense_channels;
use crate::definition::LIFT_ERROR;
use crate::forms::Kind;
use crate::picture::{Paint, Shape, Thing};
use crate::random_views::{random_grid, random_view};
use crate::support::{Random, Shot, World, channel};
use crate::voxelize::soups::{Soup, cuboid, sphere};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] =
    &[("strays: no cell of a still scene lies beyond its triangles, in any frame", none)];

const RULES: [CleanupRule; 3] = [CleanupRule::Center, CleanupRule::Footprint, CleanupRule::Rays];
const KINDS: [Kind; 3] = [Kind::Bricks, Kind::Dense(Storage::Buffers), Kind::Dense(Storage::Textures)];
const FRAMES: usize = 10;

fn plain(_: DVec3) -> Paint {
    Paint { albedo: DVec3::splat(0.5), ..Paint::default() }
}

/// A ball of 32 triangles, a box, and a slanted triangle that reaches out of the grid.
fn model(grid: &Grid) -> Soup {
    let (bounds, cell) = (grid.bounds(), grid.cell_size);
    let at = |x: f32, y: f32, z: f32| bounds.min + Vec3::new(x, y, z) * bounds.size();
    let ball = sphere(at(0.3, 0.6, 0.4), 0.25 * bounds.size().min_element(), 1);
    // Its lower faces lie on borders of cells, two others so little beyond some that their points are moved across.
    let corner = grid.origin + cell * (0.5 * grid.dims.as_vec3()).floor();
    let chest = cuboid(corner, corner + cell * Vec3::new(4.0 + 1.0 / 80.0, 2.0 + 1.0 / 80.0, 3.3));
    let ramp = Soup::of([[at(-0.2, 0.1, -0.1), at(1.2, 0.3, 0.2), at(0.4, 0.05, 1.3)]]);
    let corners = [ball, chest, ramp].into_iter().flat_map(|soup| {
        let Soup { positions, indices } = soup;
        indices.into_iter().map(move |t| t.map(|n| Vec3::from(positions[n as usize])))
    });
    Soup::of(corners.collect::<Vec<_>>())
}

/// Occupied cells, and how many of them no triangle touches, so that they are there for the move of points alone.
#[derive(Clone, Copy, Default)]
struct Counts {
    occupied: usize,
    beside: usize,
}

/// Every occupied cell has a part of a triangle within 1/64 cell around it, and as much as single precision is off.
fn check(volume: &HostVolume, exact: &VoxelSet, what: &str) -> Counts {
    let occupied: Vec<usize> =
        (0..).zip(channel(volume, NORMAL)).filter(|(_, v)| v.w > 0.0).map(|(n, _)| n).collect();
    for index in &occupied {
        let cell = exact.grid().cell(*index);
        assert!(exact.verdict_at(*index).possibly, "{what}: {cell} lies beyond all triangles");
    }
    let beside = occupied.iter().filter(|index| !exact.verdict_at(**index).marked).count();
    Counts { occupied: occupied.len(), beside }
}

fn none(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let (mut compared, mut beside) = (0, 0);
    for seed in 0..3 {
        let grid = random_grid(seed);
        let soup = model(&grid);
        let margin = 2.0 * (SURFACE_SHIFT + LIFT_ERROR);
        let exact = VoxelSet::with_margin(grid, soup.view(), Coverage::Exact, margin);
        let triangle = |n| Thing(Shape::Triangle(soup.view().triangle(n).map(|p| p.as_dvec3())), plain);
        let things: Vec<Thing> = (0..soup.indices.len()).map(triangle).collect();
        let mut random = Random::new(seed.wrapping_add(77));
        let shots: Vec<Shot> = (0..FRAMES)
            .map(|_| Shot::take(gpu, random_view(&mut random, &grid), UVec2::new(72, 60), &things))
            .collect::<Result<_, _>>()?;
        for rule in RULES {
            // One view a frame, then the ones before it again in pairs.
            let frames = (0..2 * FRAMES).map(|n| match n {
                n if n < FRAMES => vec![&shots[n]],
                n => vec![&shots[n - FRAMES], &shots[(7 * n) % FRAMES]],
            });
            let frames: Vec<_> = frames.collect();
            for kind in KINDS {
                let mut form = kind.make(gpu, grid, &dense_channels(), rule)?;
                let mut last = Counts::default();
                for (number, views) in (1..).zip(&frames) {
                    let views: Vec<_> =
                        views.iter().map(|s| (AttributeView::of(gpu, "test view", &s.input), *s)).collect();
                    form.frame(gpu, &views, number)?;
                    let what = format!("{kind:?}, {rule:?}, grid {seed}, frame {number}");
                    last = check(&form.read(gpu)?, &exact, &what);
                    (compared, beside) = (compared + last.occupied, beside + last.beside);
                }
                assert!(last.occupied > 150, "{kind:?}, {rule:?}, grid {seed}: {} cells", last.occupied);
            }
            let mut world = World::new(&labs.core, grid)?;
            for (number, views) in frames.iter().enumerate() {
                for shot in views {
                    world.clean_by(gpu, rule, shot)?;
                }
                world.inject(gpu, views, None)?;
                let what = format!("{rule:?}, grid {seed}, frame {number}");
                let counts = check(&world.read(gpu)?, &exact, &what);
                compared += counts.occupied;
            }
        }
    }
    eprintln!("no strays among {compared} cells, of which {beside} lie beside all triangles");
    assert!(beside > 1_000, "only {beside} cells are there for the move of points alone");
    Ok(())
}
