//! Random cameras and random pictures: perspective and orthographic, standard and reversed depth, from outside a volume and
//! from inside, of things, of noise and of nothing.

use lumivox::core::{Grid, Projection, View};
use lumivox::glam::{DVec3, Mat4, UVec2, UVec3, Vec2, Vec3, Vec3Swizzles, Vec4};
use lumivox::gpu::{Gpu, GpuError};

use crate::picture::{Paint, Picture, Shape, Thing, halves, ndc_of_texel, ray};
use crate::support::{Random, Shot};

/// What random views show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Subject {
    /// Planes, boxes and spheres.
    Things,
    /// A surface of its own at every texel, which makes a silhouette of every border between texels.
    Noise,
    /// Nothing was drawn.
    Nothing,
}

/// Seeds of the random views that every definition is held against.
pub(crate) const RANDOM_SEEDS: std::ops::Range<u64> = 1..49;
/// Seeds of views as some hosts have them: moved by parts of a texel, and without a far plane where depth is reversed.
pub(crate) const ODD_SEEDS: std::ops::Range<u64> = 49..73;

/// Cells along the axes of random grids; few, since stages are made for each.
pub(crate) const RANDOM_DIMS: [UVec3; 3] =
    [UVec3::new(24, 17, 20), UVec3::new(13, 29, 18), UVec3::new(33, 10, 15)];

/// A grid of 5 to 7 metres at its longest side, somewhere.
pub(crate) fn random_grid(seed: u64) -> Grid {
    let mut random = Random::new(seed.wrapping_add(1 << 32));
    let dims = RANDOM_DIMS[(seed % 3) as usize];
    let cell_size = (5.0 + 2.0 * random.unit()) / dims.max_element() as f32;
    let center = 3.0 * (random.cube() - 0.5);
    Grid { origin: center - 0.5 * cell_size * dims.as_vec3(), cell_size, dims }
}

/// A random view of the grid and what it shows.
pub(crate) fn random_shot(gpu: &Gpu, grid: &Grid, seed: u64) -> Result<(String, Shot), GpuError> {
    let mut random = Random::new(seed);
    let subject = match seed % 8 {
        0 => Subject::Nothing,
        1..=4 => Subject::Things,
        _ => Subject::Noise,
    };
    let view = random_view(&mut random, grid);
    let view = if ODD_SEEDS.contains(&seed) { odd(&mut random, view) } else { view };
    let side = |random: &mut Random| 16 + (80.0 * random.unit()) as u32;
    let size = UVec2::new(side(&mut random), side(&mut random));
    let picture = match subject {
        Subject::Nothing => Picture::take(&view, size, &[]),
        Subject::Things => Picture::take(&view, size, &random_things(&mut random, grid)),
        Subject::Noise => noise(&mut random, &view, size),
    };
    let name = format!("{seed}, {subject:?}, {:?}, reversed {}", view.projection, view.reversed_depth);
    Ok((name, Shot::of(gpu, view, picture, size)?))
}

fn direction(random: &mut Random) -> Vec3 {
    (random.cube() - 0.5).try_normalize().unwrap_or(Vec3::Y)
}

/// Planes near enough that single precision lifts a depth value to a few 1e-5 cells.
pub(crate) fn random_view(random: &mut Random, grid: &Grid) -> View {
    let bounds = grid.bounds();
    let inside = random.unit() < 0.4;
    let eye = match inside {
        true => bounds.min + random.cube() * bounds.size(),
        false => bounds.center() + (0.5 + 0.6 * random.unit()) * bounds.size().length() * direction(random),
    };
    let target = bounds.min + random.cube() * bounds.size();
    let up = direction(random);
    let far = 5.0 + 5.0 * random.unit();
    let view = if random.unit() < 0.6 {
        let (near, fov) = (0.3 + 0.7 * random.unit(), 0.4 + 1.8 * random.unit());
        View::perspective(eye, target, up, fov, 0.6 + random.unit(), near, far)
    } else {
        View::orthographic(eye, target, up, Vec2::splat(1.0) + 7.0 * random.cube().truncate(), far)
    };
    if random.unit() < 0.5 { view.with_reversed_depth() } else { view }
}

fn odd(random: &mut Random, mut view: View) -> View {
    let shift = 0.04 * (random.cube() - 0.5);
    if view.reversed_depth && view.projection == Projection::Perspective {
        // Depth is the near plane's distance over the point's.
        let near = 0.3 + 0.7 * random.unit();
        let rows = view.clip_from_world.transpose();
        view.clip_from_world =
            Mat4::from_cols(rows.x_axis, rows.y_axis, near * Vec4::W, rows.w_axis).transpose();
    }
    view.clip_from_world = Mat4::from_translation(shift.xy().extend(0.0)) * view.clip_from_world;
    view
}

fn paint(p: DVec3) -> Paint {
    let wave = |k: f64| 0.5 + 0.5 * (k * p.x + 2.0 * p.y - 1.3 * p.z).sin();
    let albedo = DVec3::new(wave(1.0), wave(2.7), wave(4.1));
    // Partly brighter than the scale represents.
    Paint { albedo, emission: 5.0 * albedo.yzx(), radiance: 6.0 * albedo.zxy() }
}

fn random_things(random: &mut Random, grid: &Grid) -> Vec<Thing> {
    let bounds = grid.bounds();
    (0..8)
        .map(|number| {
            let point = (bounds.min + random.cube() * bounds.size()).as_dvec3();
            let extent = DVec3::splat(0.02) + 1.5 * random.cube().as_dvec3();
            let shape = match number {
                0 => Shape::Plane { point, normal: direction(random).as_dvec3() },
                1..=4 => Shape::Sphere { center: point, radius: extent.x },
                _ => Shape::Box { min: point - extent, max: point + extent },
            };
            Thing(shape, paint)
        })
        .collect()
}

/// Of a hundred texels eight show nothing, of which some have a normal all the same, and some others have none.
fn noise(random: &mut Random, view: &View, size: UVec2) -> Picture {
    let mut picture = Picture::take(view, size, &[]);
    let clip_from_world = view.clip_from_world.as_dmat4();
    let forward = view.forward();
    for texel in 0..(size.x * size.y) {
        let index = texel as usize;
        let ndc = ndc_of_texel(UVec2::new(texel % size.x, texel / size.x), size);
        let (start, along) = ray(view, ndc);
        let point = start + f64::from(random.unit()) * along;
        let (kind, n) = (random.unit(), direction(random));
        if kind > 0.08 {
            picture.depth[index] = clip_from_world.project_point3(point).z as f32;
        }
        if kind > 0.05 && kind < 0.95 {
            picture.normal[index] = halves((n * -n.dot(forward).signum()).as_dvec3());
        }
        let shown = paint(point);
        picture.albedo[index] = (255.0 * shown.albedo).extend(255.0).to_array().map(|v| v.round() as u8);
        picture.emission[index] = halves(shown.emission);
        picture.radiance[index] = halves(shown.radiance);
    }
    picture
}
