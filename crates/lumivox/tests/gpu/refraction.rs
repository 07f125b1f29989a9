//! Thickness of glass against a definition cell by cell and against closed forms.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{DVec3, Mat4, UVec2, Vec2, Vec3};
use lumivox::gpu::Gpu;
use lumivox::refraction::{Backdrop, Evaluation, Thickness};
use lumivox::slicemap::{Slicemap, SlicemapSettings, Slicing};
use lumivox::voxelize::Mesh;

use crate::picture::{Paint, Shape, Thing};
use crate::support::{Shot, run};
use crate::voxelize::soups::{Soup, cuboid, scattered, sphere};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("refraction: inner cells are those of the definition", definition),
    ("refraction: a sphere, a ring and a stack are as thick as they are", closed_forms),
    ("refraction: an open thing is nowhere thicker than it reaches", open_thing),
    ("refraction: what is opaque cuts glass", cut),
];

/// The number of inner cells, cell by cell: the rules as they are written down.
fn inner_cells(fronts: &[bool], backs: &[bool], is_local: bool) -> u32 {
    #[derive(PartialEq)]
    enum State {
        Outside,
        Inside,
        Unknown(u32),
    }
    let mut state = State::Outside;
    let mut count = 0;
    for (&front, &back) in fronts.iter().zip(backs) {
        match (front, back) {
            (true, true) => {
                count += 1;
                state = State::Unknown(0);
            }
            (true, false) => {
                count += 1;
                state = State::Inside;
            }
            (false, true) => {
                if let State::Unknown(empty) = state {
                    count += empty;
                }
                state = State::Outside;
            }
            (false, false) => match &mut state {
                State::Inside => count += 1,
                State::Unknown(empty) => *empty += 1,
                State::Outside => {}
            },
        }
    }
    let closes = backs.last() == Some(&true) && fronts.last() == Some(&false);
    count + u32::from(closes && is_local && count > 0)
}

const SIZE: UVec2 = UVec2::new(24, 20);

fn views() -> [(View, [f32; 2]); 3] {
    let eye = Vec3::new(5.0, 3.0, 7.0);
    let ortho = View::orthographic(eye, Vec3::ZERO, Vec3::Y, Vec2::new(5.0, 4.0), 20.0);
    let far = View::perspective(eye, Vec3::ZERO, Vec3::Y, 0.5, 1.2, 2.0, 20.0);
    let near = View::perspective(Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO, Vec3::Y, 0.9, 1.2, 1.0, 12.0);
    [(ortho, [4.0, 16.0]), (far, [4.0, 16.0]), (near.with_reversed_depth(), [1.0, 12.0])]
}

/// Metres along a column's ray for each along the view.
fn slant(view: &View, size: UVec2, column: UVec2) -> f64 {
    let uv = (column.as_dvec2() + 0.5) / size.as_dvec2();
    let world = view.clip_from_world.as_dmat4().inverse();
    let at = |depth| world.project_point3(DVec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, depth));
    let way = (at(0.75) - at(0.25)).normalize();
    view.eye_from_world.as_dmat4().transform_vector3(way).z.abs().recip()
}

fn definition(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // Not closed, so that there is every order of fronts and backs.
    let soups = [7, 8].map(|seed| {
        let mut soup = scattered(seed, 90, 2.2, 3.0);
        soup.positions.iter_mut().flatten().for_each(|p| *p -= 1.5);
        soup.mesh(gpu)
    });
    let [one, two] = soups;
    let (one, two) = (one?, two?);
    for ((view, range), slices) in views().into_iter().zip([32, 45, 70]) {
        for slicing in [Slicing::Uniform, Slicing::Local] {
            let settings = SlicemapSettings {
                size: SIZE,
                slices,
                kinds: 2,
                slicing,
                splits_faces: true,
                ..Default::default()
            };
            let mut map = Slicemap::new(gpu, settings)?;
            map.set_view(gpu, &view, range);
            let mut found = Vec::new();
            for evaluation in [Evaluation::Bits, Evaluation::Table] {
                let mut thickness = Thickness::new(gpu, SIZE, evaluation)?;
                run(gpu, |e| {
                    map.record(gpu, e, &[(&one, 0), (&two, 1)])?;
                    thickness.record(gpu, e, &map, None)
                })?;
                found.push(thickness.read(gpu)?);
            }
            assert_eq!(found[0], found[1], "bits and tables, {slicing:?}, {slices} slices");
            let (bits, extents) = (map.read(gpu)?, map.read_extents(gpu)?);
            let words = settings.words();
            let mut inside = 0;
            for (n, found) in found[0].iter().enumerate() {
                let column = UVec2::new(n as u32 % SIZE.x, n as u32 / SIZE.x);
                let local = slicing == Slicing::Local;
                let ends = if local { extents[n] } else { Some(range) };
                for kind in 0..2 {
                    let set = |set: u32| -> Vec<bool> {
                        let first = (n as u32 * 4 + set) * words;
                        (0..slices).map(|s| bits[(first + s / 32) as usize] >> (s % 32) & 1 == 1).collect()
                    };
                    let count = inner_cells(&set(2 * kind), &set(2 * kind + 1), local);
                    inside += count;
                    let depth = ends.map_or(0.0, |[near, far]| f64::from(far) - f64::from(near));
                    let expected = f64::from(count) * depth / f64::from(slices) * slant(&view, SIZE, column);
                    let metres = f64::from(found[kind as usize]);
                    assert!(
                        (metres - expected).abs() <= 1e-4 * expected,
                        "{slicing:?}, {slices} slices, {column}, kind {kind}: {metres} of {expected}"
                    );
                }
                assert_eq!(found[2..], [0.0; 2]);
            }
            assert!(inside > 500, "{inside} inner cells");
        }
    }
    Ok(())
}

/// A closed ring about the y axis: of the radius, by the tube's.
fn torus(ring: f32, tube: f32) -> Soup {
    let (around, sides) = (160u32, 80u32);
    let point = |i: u32, j: u32| {
        let (a, b) = (
            i as f32 / around as f32 * std::f32::consts::TAU,
            j as f32 / sides as f32 * std::f32::consts::TAU,
        );
        let away = ring + tube * b.cos();
        Vec3::new(away * a.cos(), tube * b.sin(), away * a.sin())
    };
    Soup::of((0..around).flat_map(|i| {
        (0..sides).flat_map(move |j| {
            let [p, q, r, s] = [
                point(i, j),
                point(i, (j + 1) % sides),
                point((i + 1) % around, j),
                point((i + 1) % around, (j + 1) % sides),
            ];
            [[p, q, r], [q, s, r]]
        })
    }))
}

/// Metres that each column's ray crosses, by 4 sides a metre.
fn metres(
    gpu: &Gpu,
    view: &View,
    range: [f32; 2],
    settings: SlicemapSettings,
    mesh: &Mesh,
) -> Result<Vec<f32>, Failed> {
    let mut map = Slicemap::new(gpu, settings)?;
    map.set_view(gpu, view, range);
    let mut thickness = Thickness::new(gpu, settings.size, Evaluation::Bits)?;
    run(gpu, |e| {
        map.record(gpu, e, &[(mesh, 0)])?;
        thickness.record(gpu, e, &map, None)
    })?;
    Ok(thickness.read(gpu)?.into_iter().map(|kinds| kinds[0]).collect())
}

/// Along z from 4 m before the origin.
pub(crate) fn along_z(size: f32) -> View {
    View::orthographic(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y, Vec2::splat(size), 8.0)
}

type Form = fn(Vec2) -> (f32, u32);

/// Metres along z, and in how many intervals.
fn of_sphere(p: Vec2) -> (f32, u32) {
    let inside = 1.0 - p.length_squared();
    if inside > 0.0 { (2.0 * inside.sqrt(), 1) } else { (0.0, 0) }
}

fn of_torus(p: Vec2) -> (f32, u32) {
    let inside = 0.4f32 * 0.4 - p.y * p.y;
    if inside <= 0.0 {
        return (0.0, 0);
    }
    let chord = |radius: f32| 2.0 * (radius * radius - p.x * p.x).max(0.0).sqrt();
    let (outer, inner) = (chord(1.1 + inside.sqrt()), chord(1.1 - inside.sqrt()));
    (outer - inner, u32::from(outer > 0.0) + u32::from(inner > 0.0))
}

fn of_stack(p: Vec2) -> (f32, u32) {
    if p.abs().max_element() < 1.0 { (0.3 + 0.5 + 0.2, 3) } else { (0.0, 0) }
}

fn stack() -> Soup {
    let mut all = Soup::default();
    for (low, thick) in [(-1.2f32, 0.3f32), (-0.4, 0.5), (1.0, 0.2)] {
        let slab = cuboid(Vec3::new(-1.0, -1.0, low), Vec3::new(1.0, 1.0, low + thick));
        let first = all.positions.len() as u32;
        all.positions.extend(&slab.positions);
        all.indices.extend(slab.indices.iter().map(|t| t.map(|i| i + first)));
    }
    all
}

fn closed_forms(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let things: [(&str, Soup, Form); 3] = [
        ("sphere", sphere(Vec3::ZERO, 1.0, 5), of_sphere),
        ("ring", torus(1.1, 0.4), of_torus),
        ("stack", stack(), of_stack),
    ];
    let view = along_z(3.3);
    let range = [2.0, 6.0];
    for (name, soup, form) in things {
        let plain = soup.mesh(gpu)?;
        // Mirrored twice over: its triangles turn the other way, and the ray comes from the other side.
        let mut mirrored = soup.mesh(gpu)?;
        mirrored.set_transform(gpu, &Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0)));
        for (slicing, slices) in [(Slicing::Uniform, 128), (Slicing::Local, 32), (Slicing::Local, 96)] {
            let size = UVec2::splat(32);
            let settings =
                SlicemapSettings { size, slices, slicing, splits_faces: true, ..Default::default() };
            for mesh in [&plain, &mirrored] {
                let found = metres(gpu, &view, range, settings, mesh)?;
                let (mut worst, mut judged, mut sums) = (0f32, 0, [0.0; 2]);
                for (n, found) in found.iter().enumerate() {
                    let pixel = UVec2::new(n as u32 % size.x, n as u32 / size.x).as_vec2();
                    let p = ((pixel + 0.5) / size.as_vec2() - 0.5) * Vec2::new(3.3, -3.3);
                    let (expected, intervals) = form(p);
                    // Near a silhouette a facet more or less decides.
                    let near = [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y].map(|d| form(p + 0.04 * d).1);
                    if near.iter().any(|&n| n != intervals) {
                        continue;
                    }
                    judged += 1;
                    // A cell for each interval; local columns are at most as long as the thing. And the facets.
                    let cell = if slicing == Slicing::Local { 3.0 } else { 4.0 } / slices as f32;
                    let allowed = intervals as f32 * cell + 0.02;
                    worst = worst.max((found - expected).abs() / allowed.max(1e-9));
                    assert!(
                        (found - expected).abs() <= allowed,
                        "{name}, {slicing:?}: {found} of {expected} at {p}"
                    );
                    sums[0] += found;
                    sums[1] += expected;
                }
                assert!(judged > 400 && sums[1] > 100.0, "{judged} columns");
                // Errors of cells go either way; those of planes across the view are everywhere the same.
                let bias = (sums[0] / sums[1] - 1.0).abs();
                eprintln!(
                    "{name}, {slicing:?}, {slices}: worst {worst:.2} of what is allowed, bias {bias:.4}"
                );
                assert!(bias < 0.01 || name == "stack", "{name}, {slicing:?}, {slices}: bias {bias}");
            }
        }
    }
    Ok(())
}

fn open_thing(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // A ball without its half towards the view, and one without the other half.
    for keeps_front in [false, true] {
        let mut half = sphere(Vec3::ZERO, 1.0, 3);
        let positions = half.positions.clone();
        half.indices.retain(|t| {
            (positions[t[0] as usize][2] + positions[t[1] as usize][2] + positions[t[2] as usize][2] > 0.0)
                == keeps_front
        });
        assert!(lumivox::core::open_edges(&half.view()) > 10);
        let mesh = half.mesh(gpu)?;
        let settings =
            SlicemapSettings { size: UVec2::splat(16), slices: 32, splits_faces: true, ..Default::default() };
        let found = metres(gpu, &along_z(2.5), [2.0, 6.0], settings, &mesh)?;
        assert!(found.iter().all(|m| (0.0..1.1).contains(m)), "{found:?}");
    }
    Ok(())
}

fn black(point: DVec3, normal: DVec3) -> Thing {
    Thing(Shape::Plane { point, normal }, |_| Paint::default())
}

fn cut(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let view = along_z(2.5);
    let size = UVec2::splat(20);
    let ball = sphere(Vec3::ZERO, 1.0, 4).mesh(gpu)?;
    let settings = SlicemapSettings { size, slices: 96, splits_faces: true, ..Default::default() };
    let mut map = Slicemap::new(gpu, settings)?;
    map.set_view(gpu, &view, [2.0, 6.0]);
    for z in [0.0f32, 0.5, -1.5, 1.5] {
        let wall = black(DVec3::new(0.0, 0.0, f64::from(z)), DVec3::Z);
        let shot = Shot::take(gpu, view, size, &[wall])?;
        let input = &shot.input;
        let backdrop = Backdrop {
            uniform: &input.uniform,
            depth: &input.textures.depth,
            picture: &input.textures.radiance,
        };
        for evaluation in [Evaluation::Bits, Evaluation::Table] {
            let mut thickness = Thickness::new(gpu, size, evaluation)?;
            run(gpu, |e| {
                map.record(gpu, e, &[(&ball, 0)])?;
                thickness.record(gpu, e, &map, Some(&backdrop))
            })?;
            for (n, found) in thickness.read(gpu)?.into_iter().enumerate() {
                let p = (Vec2::new((n % 20) as f32, (n / 20) as f32) + 0.5 - 10.0) * 0.125;
                let inside = 1.0 - p.length_squared();
                if inside < 0.1 {
                    continue;
                }
                let half = inside.sqrt();
                let expected = (half - z).clamp(0.0, 2.0 * half);
                assert!((found[0] - expected).abs() < 0.04, "wall at {z}: {} of {expected} at {p}", found[0]);
            }
        }
    }
    Ok(())
}
