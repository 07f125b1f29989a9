//! Thickness of glass against a definition cell by cell and against closed forms; what is seen through it.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{DVec3, Mat4, UVec2, Vec2, Vec3};
use lumivox::gpu::{Gpu, Texture, read_texture};
use lumivox::refraction::{
    Backdrop, Edge, Evaluation, Glass, PICTURE_FORMAT, Pyramid, Refraction, RefractionSettings, Thickness,
};
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
    ("refraction: glass takes a power of light, each kind its own", power_law),
    ("refraction: glass that does nothing is not seen", nothing),
    ("refraction: a pyramid keeps its mean", pyramid),
    ("refraction: frost blurs by thickness, bending moves what is behind", frost_and_bend),
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
fn along_z(size: f32) -> View {
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

/// A wall with a light of one colour, seen through glass in kinds.
fn seen(
    gpu: &Gpu,
    things: &[Thing],
    glass: &[Glass],
    meshes: &[(&Mesh, u32)],
    settings: impl FnOnce(RefractionSettings) -> RefractionSettings,
) -> Result<Vec<Vec3>, Failed> {
    let size = UVec2::splat(24);
    let view = along_z(2.4);
    let shot = Shot::take(gpu, view, size, things)?;
    let input = &shot.input;
    let backdrop =
        Backdrop { uniform: &input.uniform, depth: &input.textures.depth, picture: &input.textures.radiance };
    let around = Pyramid::environment(gpu, UVec2::new(8, 4), &[Vec3::new(0.0, 0.0, 2.0); 32])?;
    let mut refraction = Refraction::new(gpu, settings(RefractionSettings::new(size)))?;
    let mut target = Texture::target(gpu, "seen", size.to_array(), PICTURE_FORMAT)?;
    // What is set last holds.
    refraction.set_glass(gpu, &[Glass { through: Vec3::ZERO, ..Glass::default() }; 4]);
    refraction.set_view(gpu, &view, [2.0, 6.0]);
    refraction.set_glass(gpu, glass);
    run(gpu, |e| refraction.record(gpu, e, meshes, &backdrop, &around, &mut target))?;
    let texels: Vec<[half::f16; 4]> = read_texture(gpu, &target)?;
    Ok(texels.into_iter().map(|t| Vec3::new(t[0].to_f32(), t[1].to_f32(), t[2].to_f32())).collect())
}

const PLAIN: Glass = Glass {
    ior: 1.0,
    bend: 0.0,
    through: Vec3::ONE,
    tint: Vec3::ONE,
    body: Vec3::ZERO,
    frost: 0.0,
    roughness: 0.0,
    gloss: 0.0,
    is_thin: false,
};

fn lit(z: f64) -> Thing {
    Thing(Shape::Plane { point: DVec3::new(0.0, 0.0, z), normal: DVec3::Z }, |_| Paint {
        radiance: DVec3::new(1.0, 0.5, 0.25),
        ..Paint::default()
    })
}

fn striped(z: f64) -> Thing {
    Thing(Shape::Plane { point: DVec3::new(0.0, 0.0, z), normal: DVec3::Z }, |p| Paint {
        radiance: DVec3::splat(if p.x < 0.0 { 0.0 } else { 1.0 }),
        ..Paint::default()
    })
}

fn slab(gpu: &Gpu, x: [f32; 2], z: [f32; 2]) -> Result<Mesh, Failed> {
    Ok(cuboid(Vec3::new(x[0], -0.8, z[0]), Vec3::new(x[1], 0.8, z[1])).mesh(gpu)?)
}

fn power_law(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let (left, right) = (slab(gpu, [-0.9, -0.1], [0.0, 1.0])?, slab(gpu, [0.1, 0.9], [-0.5, 1.5])?);
    let red = Glass { through: Vec3::new(1.0, 0.25, 0.25), body: Vec3::new(0.0, 0.0, 4.0), ..PLAIN };
    let grey = Glass { through: Vec3::splat(0.5), tint: Vec3::new(0.5, 1.0, 1.0), ..PLAIN };
    let found = seen(gpu, &[lit(-2.0)], &[red, grey], &[(&left, 0), (&right, 1)], |s| s)?;
    let at = |x: f32| found[(12 * 24 + (10.0 * (x + 1.2)) as usize).min(24 * 24 - 1)];
    let behind = Vec3::new(1.0, 0.5, 0.25);
    for (x, expected) in [
        (-0.5, behind * red.through + (1.0 - red.through) * red.body),
        (0.5, behind * 0.25 * grey.tint),
        (0.0, behind),
        (1.1, behind),
    ] {
        let found = at(x);
        assert!(
            (found - expected).abs().max_element() < 0.01 * (1.0 + expected.max_element()),
            "{x}: {found} of {expected}"
        );
    }
    // The same glass as a thin one is only tinted.
    let thin = [Glass { is_thin: true, ..red }, Glass { is_thin: true, ..grey }];
    let found = seen(gpu, &[lit(-2.0)], &thin, &[(&left, 0), (&right, 1)], |s| s)?;
    assert!((found[12 * 24 + 7] - behind).abs().max_element() < 1e-3);
    assert!((found[12 * 24 + 17] - behind * grey.tint).abs().max_element() < 1e-3);
    // One behind the other: both take.
    let deep = slab(gpu, [-0.9, -0.1], [-1.5, -0.5])?;
    let found = seen(gpu, &[lit(-2.0)], &[grey, grey], &[(&left, 0), (&deep, 1)], |s| s)?;
    let expected = behind * 0.25 * grey.tint;
    assert!(
        (found[12 * 24 + 7] - expected).abs().max_element() < 0.03,
        "{} of {expected}",
        found[12 * 24 + 7]
    );
    Ok(())
}

fn nothing(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let ball = sphere(Vec3::ZERO, 1.0, 3).mesh(gpu)?;
    let dark = Glass { through: Vec3::splat(0.01), ..Glass::default() };
    let plain = seen(gpu, &[striped(-2.0)], &[PLAIN], &[], |s| s)?;
    // Without effect, and behind a wall.
    let differ = |z: f64, glass: Glass| -> Result<f32, Failed> {
        let found = seen(gpu, &[striped(z)], &[glass], &[(&ball, 0)], |s| s)?;
        Ok(found.iter().zip(&plain).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max))
    };
    let found = [differ(-2.0, PLAIN)?, differ(1.5, dark)?, differ(-2.0, dark)?];
    // Samplers have 8 bits between texels.
    assert!(found[0] < 0.01 && found[1] == 0.0 && found[2] > 0.9, "{found:?}");
    // Mirrors at its rim: the environment is blue there.
    let shiny = Glass { ior: 1.5, gloss: 1.0, ..PLAIN };
    let found = seen(gpu, &[lit(-2.0)], &[shiny], &[(&ball, 0)], |s| s)?;
    let middle = found[12 * 24 + 12];
    let expected = 0.96 * Vec3::new(1.0, 0.5, 0.25) + 0.04 * Vec3::new(0.0, 0.0, 2.0);
    assert!((middle - expected).abs().max_element() < 0.01, "{middle} of {expected}");
    // Without the picture the environment is all that is seen.
    let found = seen(gpu, &[lit(-2.0)], &[PLAIN], &[(&ball, 0)], |s| RefractionSettings {
        uses_picture: false,
        ..s
    })?;
    assert!((found[12 * 24 + 12] - Vec3::new(0.0, 0.0, 2.0)).abs().max_element() < 1e-3);
    assert!((found[0] - Vec3::new(1.0, 0.5, 0.25)).abs().max_element() < 1e-3);
    Ok(())
}

fn pyramid(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let size = UVec2::new(16, 8);
    let color = |n: u32| Vec3::new((n % 7) as f32, (n % 3) as f32, 0.5);
    let pixels: Vec<Vec3> = (0..size.element_product()).map(color).collect();
    let mean = pixels.iter().sum::<Vec3>() / pixels.len() as f32;
    let around = Pyramid::environment(gpu, size, &pixels)?;
    gpu.wait()?;
    let mut levels = 0;
    while around.level(levels).is_some() {
        levels += 1;
    }
    assert_eq!(levels, 5);
    let mut plain = Pyramid::new(gpu, size, Edge::Ends)?;
    run(gpu, |e| {
        plain.record(
            gpu,
            e,
            around.level(0).ok_or_else(|| lumivox::gpu::GpuError::Validation(String::new()))?,
        )
    })?;
    for pyramid in [&around, &plain] {
        let last = pyramid.level(3).ok_or("a level of 2 x 1")?;
        let options = lumivox::gpu::TextureOptions {
            size: [2, 1],
            format: PICTURE_FORMAT,
            usage: lumivox::wgpu::TextureUsages::COPY_DST,
            mips: 1,
        };
        let copy = Texture::new(gpu, "copy", options)?;
        run(gpu, |e| {
            let source = lumivox::wgpu::TexelCopyTextureInfo { mip_level: 3, ..last.raw.as_image_copy() };
            e.copy_texture_to_texture(source, copy.raw.as_image_copy(), copy.raw.size());
            Ok(())
        })?;
        let texels: Vec<[half::f16; 4]> = read_texture(gpu, &copy)?;
        let found =
            texels.iter().map(|t| Vec3::new(t[0].to_f32(), t[1].to_f32(), t[2].to_f32())).sum::<Vec3>() / 2.0;
        assert!((found - mean).abs().max_element() < 0.01, "{found} of {mean}");
    }
    assert!(Pyramid::environment(gpu, size, &pixels[1..]).is_err());
    Ok(())
}

fn frost_and_bend(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // Half of what is behind is white: sharp through thin frosted glass, grey through thick.
    let row = |z: [f32; 2], glass: Glass| -> Result<Vec<f32>, Failed> {
        let slab = slab(gpu, [-0.9, 0.9], z)?;
        let found = seen(gpu, &[striped(-2.0)], &[glass], &[(&slab, 0)], |s| s)?;
        Ok((4..20).map(|x| found[12 * 24 + x].x).collect())
    };
    let step = |row: &[f32]| row.windows(2).map(|w| w[1] - w[0]).fold(0.0, f32::max);
    let frosted = Glass { frost: 0.12, ..PLAIN };
    let (thin, thick) = (row([0.0, 0.1], frosted)?, row([-1.0, 1.0], frosted)?);
    assert!(step(&thin) > 0.6 && step(&thick) < 0.35, "steps of {} and {}", step(&thin), step(&thick));
    assert!(thick.windows(2).all(|w| w[1] >= w[0] - 2e-3), "{thick:?}");
    // A ball gathers rays: bent, its rim looks to the other side; the thicker it is, the farther.
    let ball = sphere(Vec3::ZERO, 1.0, 4).mesh(gpu)?;
    let white = |bend: f32| -> Result<usize, Failed> {
        let glass = Glass { ior: 1.5, bend, ..PLAIN };
        let found = seen(gpu, &[striped(-2.0)], &[glass], &[(&ball, 0)], |s| s)?;
        Ok((12..20).filter(|x| found[12 * 24 + x].x > 0.5).count())
    };
    let counts = [white(0.0)?, white(0.4)?, white(2.0)?];
    assert!(counts[0] == 8 && counts[1] <= counts[0] && counts[2] < 5, "{counts:?}");
    Ok(())
}
