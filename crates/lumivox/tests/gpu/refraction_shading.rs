//! What is seen through glass: the power law, frost, bending, and nothing where there is nothing.

use libtest_mimic::Failed;
use lumivox::glam::{DVec3, Mat4, UVec2, Vec3};
use lumivox::gpu::{Gpu, Texture, read_texture};
use lumivox::refraction::{Backdrop, Edge, Glass, PICTURE_FORMAT, Pyramid, Refraction, RefractionSettings};
use lumivox::voxelize::Mesh;

use crate::picture::{Paint, Shape, Thing};
use crate::refraction::along_z;
use crate::support::{Shot, run};
use crate::voxelize::soups::{cuboid, sphere};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("refraction: glass takes a power of light, each kind its own", power_law),
    ("refraction: glass that does nothing is not seen", nothing),
    ("refraction: a pyramid keeps its mean", pyramid),
    ("refraction: frost blurs by thickness, bending moves what is behind", frost_and_bend),
    ("refraction: bent ways meet what stands in them", met),
    ("refraction: what bent ways skip between pixels is seen too", spread),
];

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

/// A post before a wall, seen through a slab that is turned: the post is where its bent rays meet it, once, and not where straight ones do.
fn met(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    const TURN: f32 = 0.4;
    const POST: [f32; 2] = [-0.1, 0.3];
    let (low, high) = (DVec3::new(f64::from(POST[0]), -2.0, -2.3), DVec3::new(f64::from(POST[1]), 2.0, -2.0));
    let things = [
        Thing(Shape::Box { min: low, max: high }, |_| Paint { radiance: DVec3::X, ..Paint::default() }),
        Thing(Shape::Plane { point: DVec3::new(0.0, 0.0, -3.5), normal: DVec3::Z }, |_| Paint {
            radiance: DVec3::Y,
            ..Paint::default()
        }),
    ];
    let mut slab = slab(gpu, [-1.1, 1.1], [-0.5, 0.5])?;
    slab.set_transform(gpu, &Mat4::from_rotation_y(TURN));
    let glass = Glass { ior: 2.0, bend: 1.0, ..PLAIN };
    let found = seen(gpu, &things, &[glass], &[(&slab, 0)], |s| s)?;
    // Of a ray along z: how thick the slab is, where it begins to look, and where it looks.
    let normal = Vec3::new(TURN.sin(), 0.0, TURN.cos());
    let (straight, metres) = (Vec3::NEG_Z, 1.0 / normal.z);
    let cos_in = (1.0 - (TURN.sin() / glass.ior).powi(2)).sqrt();
    let refracted = straight / glass.ior + (normal.z / glass.ior - cos_in) * normal;
    let bent = straight + (glass.bend * metres).min(4.0) * (refracted - straight);
    let at = |x: f32, z: f32| {
        let start = (0.5 - normal.x * x) / normal.z - metres;
        x + (start - z) / -bent.z * bent.x
    };
    let meets_post = |x: f32| {
        let (front, back) = (at(x, -2.0), at(x, -2.3));
        front.min(back) < POST[1] && front.max(back) > POST[0]
    };
    let (mut seen_posts, mut seen_walls) = (0, 0);
    for x in 6..20 {
        let place = 0.1 * (x as f32 + 0.5) - 1.2;
        // In the picture, and where a pixel's width does not matter.
        let expected = [-0.12, 0.0, 0.12].map(|off| meets_post(place + off));
        if at(place, -3.5).abs() < 1.0 && expected[0] == expected[1] && expected[1] == expected[2] {
            let pixel = found[12 * 24 + x];
            let (post, wall) = if expected[0] { (1.0, 0.0) } else { (0.0, 1.0) };
            let is_right = (pixel.x - post).abs() < 0.3 && (pixel.y - wall).abs() < 0.3;
            assert!(is_right, "{pixel} at {place}, where the post is {post}");
            if expected[0] { seen_posts += 1 } else { seen_walls += 1 }
        }
    }
    assert!(seen_posts > 1 && seen_walls > 3, "{seen_posts} of the post, {seen_walls} of the wall");
    Ok(())
}

/// Stripes a pixel wide, seen through a ball so that each pixel looks some pixels away from the next one: nearer to their mean than any stripe
/// is. A slab bends all rays alike and shows them as they are.
fn spread(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let stripes = Thing(Shape::Plane { point: DVec3::new(0.0, 0.0, -3.5), normal: DVec3::Z }, |p| Paint {
        radiance: DVec3::splat((10.0 * p.x).floor().rem_euclid(2.0)),
        ..Paint::default()
    });
    let contrast = |mesh: &Mesh, bend: f32| -> Result<f32, Failed> {
        let glass = Glass { ior: 1.5, bend, ..PLAIN };
        let found = seen(gpu, &[stripes], &[glass], &[(mesh, 0)], |s| s)?;
        let is_middle = |n: usize| (9..15).contains(&(n % 24)) && (9..15).contains(&(n / 24));
        // What looks beside the picture is blue.
        let middle = found.iter().enumerate().filter(|(n, p)| is_middle(*n) && p.z - p.x < 0.01);
        let off: Vec<f32> = middle.map(|(_, p)| 2.0 * (p.x - 0.5).abs()).collect();
        assert!(off.len() > 15, "{} pixels", off.len());
        Ok(off.iter().sum::<f32>() / off.len() as f32)
    };
    let (ball, slab) = (sphere(Vec3::ZERO, 1.0, 4).mesh(gpu)?, slab(gpu, [-0.9, 0.9], [-1.0, 1.0])?);
    let contrasts = [contrast(&slab, 0.0)?, contrast(&slab, 2.0)?, contrast(&ball, 4.0)?];
    // It is 0.43, and 0.59 where each pixel looks at a point.
    assert!(contrasts[0] > 0.95 && contrasts[1] > 0.95 && contrasts[2] < 0.5, "{contrasts:?}");
    Ok(())
}
