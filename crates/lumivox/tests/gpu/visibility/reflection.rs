//! Polished reflections, beside the CPU's look-ups and beside exact rays.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{DVec3, Mat4, Vec3};
use lumivox::gpu::{Gpu, GpuError, Texture, TextureOptions, read_texture};
use lumivox::visibility::{
    Fields, HitLamp, HitLight, Objects, Placement, Receiver, ReflectionSettings, Reflections,
};
use lumivox::wgpu::{self, TextureFormat};
use lumivox_field::{Field, Ray, Settings};

use super::objects::{Soup, ball};
use super::occlusion::{SIZE, points};
use crate::picture::{Paint, Shape, Thing};
use crate::support::{Random, Shot, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("visibility: mirrors show what the CPU's look-ups meet", mirrors),
    ("visibility: polished reflections are those of many rays", polished),
    ("visibility: mirrored balls are lit and shaded as by exact rays", exact),
    ("visibility: matt pixels, and those that mirror nothing, cost nothing", culling),
];

const BIAS: f32 = 0.05;

/// Objects with their fields, on both sides.
struct Scene<'f> {
    cpu: Vec<(&'f Field, Mat4, Vec3)>,
    fields: Fields,
    objects: Objects,
}

impl<'f> Scene<'f> {
    fn new(gpu: &Gpu, all: &[(&'f Field, Mat4, Vec3)]) -> Result<Self, GpuError> {
        let packed: Vec<_> =
            all.iter().map(|(field, ..)| field.packed().expect("a field that fits")).collect();
        let fields = Fields::new(gpu, &packed.iter().collect::<Vec<_>>())?;
        let mut objects = Objects::new(gpu, all.len() as u32)?.with_bias(BIAS);
        let place = |(n, (_, place, albedo)): (usize, &(&Field, Mat4, Vec3))| Placement {
            albedo: *albedo,
            ..Placement::new(n, *place, n as u32)
        };
        let placements: Vec<_> = all.iter().enumerate().map(place).collect();
        objects.update(gpu, &fields, &placements)?;
        Ok(Self { cpu: all.to_vec(), fields, objects })
    }

    /// What each pixel mirrors, and the tiles drawn.
    fn color(
        &self,
        gpu: &Gpu,
        shot: &Shot,
        settings: ReflectionSettings,
        light: &HitLight,
        roughness: Option<&Texture>,
    ) -> Result<(Vec<[f32; 4]>, u32), GpuError> {
        let mut reflections = Reflections::new(gpu, SIZE, &self.objects, settings)?;
        reflections.update(gpu, &self.objects, light);
        let receiver = Receiver::from(&shot.input);
        run(gpu, |e| reflections.record(gpu, e, &self.fields, &self.objects, &receiver, roughness))?;
        let texels: Vec<[half::f16; 4]> = read_texture(gpu, reflections.color())?;
        Ok((texels.iter().map(|t| t.map(|v| v.to_f32())).collect(), reflections.read_drawn_tiles(gpu)?))
    }

    /// What the CPU's look-ups show along a ray: radiance under a light from above and below, and whether anything is met.
    fn looked_up(&self, ray: &Ray, light: &HitLight) -> [f32; 4] {
        let mut nearest = (f32::INFINITY, [0.0; 4]);
        for (field, place, albedo) in &self.cpu {
            let object_from_world = lumivox::glam::Affine3A::from_mat4(*place).inverse();
            let Some((distance, normal)) = field.nearest_with_normal(&ray.transformed(&object_from_world))
            else {
                continue;
            };
            let normal = (place.inverse().transpose() * normal.extend(0.0)).truncate().normalize_or(Vec3::Y);
            let facing = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
            if distance < nearest.0 {
                let color = *albedo * light.below.lerp(light.above, 0.5 + 0.5 * facing.y);
                nearest = (distance, color.extend(1.0).to_array());
            }
        }
        nearest.1
    }
}

fn ring() -> Field {
    Soup::ring().baked(Settings { points: 1090, normals: true, ..Settings::default() })
}

/// The floor y = 0 from near, as far as it mirrors what stands on it.
fn floor(gpu: &Gpu) -> Result<Shot, GpuError> {
    let target = Vec3::new(0.0, 0.0, 0.6);
    let view = View::perspective(Vec3::new(0.0, 3.2, 5.0), target, Vec3::Y, 0.75, 96.0 / 72.0, 0.1, 60.0)
        .with_reversed_depth();
    let plane = Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y };
    Shot::take(gpu, view, SIZE, &[Thing(plane, |_| Paint::default())])
}

/// Three objects, one of them turned, stretched and behind another.
fn three(ring: &Field) -> [(&Field, Mat4, Vec3); 3] {
    let turned = Mat4::from_rotation_z(0.9) * Mat4::from_translation(Vec3::new(-3.0, 1.0, -0.5));
    [
        (ball(), Mat4::from_translation(Vec3::new(-1.6, 1.3, -0.5)), Vec3::new(0.9, 0.2, 0.1)),
        (ring, Mat4::from_translation(Vec3::new(0.9, 1.6, -0.4)) * turned, Vec3::new(0.1, 0.7, 0.3)),
        (
            ball(),
            Mat4::from_translation(Vec3::new(0.5, 1.2, -2.6)) * Mat4::from_scale(Vec3::new(1.0, 0.5, 0.8)),
            Vec3::new(0.2, 0.3, 0.9),
        ),
    ]
}

fn gradient() -> HitLight {
    HitLight {
        above: Vec3::new(1.0, 0.9, 0.8),
        below: Vec3::new(0.2, 0.3, 0.4),
        lamps: Vec::new(),
        shadows: false,
    }
}

/// The way that the eye looks at each point.
fn ways(shot: &Shot, points: &[DVec3]) -> Vec<Vec3> {
    let eye = shot.view.eye().as_dvec3();
    points.iter().map(|p| (*p - eye).normalize_or(DVec3::NEG_Y).as_vec3()).collect()
}

fn apart(a: &[f32; 4], b: &[f32; 4]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn mirrors(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let (points, ring) = (points(&shot), ring());
    let scene = Scene::new(gpu, &three(&ring))?;
    let light = gradient();
    let settings = ReflectionSettings { roughness: 0.0, denoise: false, ..ReflectionSettings::default() };
    let (found, drawn) = scene.color(gpu, &shot, settings, &light, None)?;
    let (mut met, mut other) = (0, 0);
    for ((found, p), way) in found.iter().zip(&points).zip(ways(&shot, &points)) {
        let expected = scene.looked_up(&Ray::new(p.as_vec3(), Vec3::new(way.x, -way.y, way.z)), &light);
        met += i32::from(expected[3] > 0.0);
        // Half floats have 11 bits.
        other += i32::from(apart(found, &expected) > 2e-3);
    }
    let all = found.len() as i32;
    eprintln!("{met} pixels of {all} mirror an object, {other} differ, {drawn} tiles of 108");
    // Texels of maps and of normals end within rounding of a few rays.
    assert!(met > 800 && 50 * other < met, "{met} {other}");
    assert!(drawn < 108, "{drawn}");
    Ok(())
}

/// A ray by a random microfacet, written anew: slopes of GGX are inverted from their cumulative distribution.
fn lobe(random: &mut Random, way: Vec3, roughness: f32) -> (Vec3, f32) {
    let alpha = roughness * roughness;
    let (share, turn) = (0.95 * random.unit(), std::f32::consts::TAU * random.unit());
    let angle = (alpha * (share / (1.0 - share)).sqrt()).atan();
    let facet = Vec3::new(angle.sin() * turn.cos(), angle.cos(), angle.sin() * turn.sin());
    let out = way - 2.0 * way.dot(facet) * facet;
    let masking = 2.0 / (1.0 + (1.0 + alpha * alpha * (1.0 / (out.y * out.y) - 1.0)).sqrt());
    let counts = out.y > 0.0 && way.dot(facet) < 0.0;
    (out, if counts { masking * -way.dot(facet) / facet.y } else { 0.0 })
}

fn polished(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let (points, ring) = (points(&shot), ring());
    let scene = Scene::new(gpu, &three(&ring))?;
    let light = gradient();
    let ways = ways(&shot, &points);
    let mut random = Random::new(31);
    for roughness in [0.15, 0.6] {
        let settings =
            ReflectionSettings { rays: 64, roughness, denoise: false, ..ReflectionSettings::default() };
        let (found, _) = scene.color(gpu, &shot, settings, &light, None)?;
        let few = ReflectionSettings { rays: 4, ..settings };
        let (noisy, _) = scene.color(gpu, &shot, few, &light, None)?;
        let (smooth, _) =
            scene.color(gpu, &shot, ReflectionSettings { denoise: true, ..few }, &light, None)?;
        let (mut sums, mut bias, mut count) = ([0.0; 3], [0.0; 4], 0.0);
        for n in (0..points.len()).step_by(7) {
            let (mut mean, mut sent) = ([0.0; 4], 0.0);
            for _ in 0..512 {
                let (out, weight) = lobe(&mut random, ways[n], roughness);
                let seen = scene.looked_up(&Ray::new(points[n].as_vec3(), out), &light);
                mean.iter_mut().zip(seen).for_each(|(mean, seen)| *mean += weight * seen);
                sent += weight;
            }
            let mean = mean.map(|v| v / sent);
            for (sum, found) in sums.iter_mut().zip([found[n], noisy[n], smooth[n]]) {
                *sum += apart(&found, &mean).powi(2);
            }
            bias.iter_mut().zip(found[n]).zip(mean).for_each(|((bias, a), b)| *bias += a - b);
            count += 1.0;
        }
        let bias = bias.map(|b: f32| (b / count).abs()).into_iter().fold(0.0, f32::max);
        let [many, few, denoised] = sums.map(|sum: f32| (sum / count).sqrt());
        eprintln!(
            "roughness {roughness}: RMS {many:.4} of 64 rays, {few:.4} of 4, denoised {denoised:.4}; mean off by {bias:.4}"
        );
        // The means of 64 rays and of 512 random ones scatter; over all pixels together that is a thousandth.
        assert!(many < 0.25 * few && bias < 3e-3, "{many} {few} {bias}");
        // Five pixels of so small a picture blur what is sharp.
        assert!(roughness < 0.5 || denoised < 0.8 * few, "{denoised} {few}");
    }
    Ok(())
}

/// The nearest of some balls along a ray: distance, normal and number.
fn met(balls: &[(DVec3, f64)], p: DVec3, way: DVec3) -> Option<(f64, DVec3, usize)> {
    let hit = |(n, (center, radius)): (usize, &(DVec3, f64))| {
        let from = p - *center;
        let (a, b) = (way.length_squared(), from.dot(way));
        let root = b * b - a * (from.length_squared() - radius * radius);
        let t = (-b - root.max(0.0).sqrt()) / a;
        (root > 0.0 && t > 1e-6).then(|| (t, (from + t * way) / *radius, n))
    };
    balls.iter().enumerate().filter_map(hit).min_by(|a, b| a.0.total_cmp(&b.0))
}

fn exact(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let points = points(&shot);
    // The lamp shines past the upper ball on the lower one's side that the floor mirrors.
    let balls = [(DVec3::new(-0.6, 1.2, -0.6), 0.9), (DVec3::new(1.0, 1.9, 0.9), 0.5)];
    let white = Vec3::splat(0.8);
    let place = |(center, radius): &(DVec3, f64)| {
        Mat4::from_translation(center.as_vec3()) * Mat4::from_scale(Vec3::splat(*radius as f32))
    };
    let scene = Scene::new(gpu, &balls.each_ref().map(|b| (ball(), place(b), white)))?;
    let lamp = DVec3::new(3.2, 2.6, 3.0);
    let point = |shadows| HitLight {
        above: Vec3::ZERO,
        below: Vec3::ZERO,
        lamps: vec![HitLamp::Point { position: lamp.as_vec3(), intensity: Vec3::splat(20.0) }],
        shadows,
    };
    let settings =
        ReflectionSettings { roughness: 0.0, denoise: false, blended: true, ..ReflectionSettings::default() };
    let mut errors = Vec::new();
    for shadows in [true, false] {
        let light = point(shadows);
        let (found, _) = scene.color(gpu, &shot, settings, &light, None)?;
        let (mut square, mut power, mut count, mut missed, mut dark) = (0.0, 0.0, 0, 0, 0);
        for ((found, p), way) in found.iter().zip(&points).zip(ways(&shot, &points)) {
            let up = DVec3::new(way.x.into(), f64::from(-way.y), way.z.into());
            let hit = met(&balls, *p, up);
            missed += i32::from(hit.is_some() != (found[3] > 0.5));
            let Some((t, normal, _)) = hit else { continue };
            let at = *p + t * up;
            let to_lamp = lamp - at;
            let free = met(&balls, at + 1e-4 * normal, to_lamp).is_none_or(|(t, ..)| t > 1.0);
            dark += i32::from(!free && normal.dot(to_lamp) > 0.0);
            let irradiance = 20.0 * normal.dot(to_lamp).max(0.0) / to_lamp.length().powi(3);
            let radiance = if free { 0.8 / std::f64::consts::PI * irradiance } else { 0.0 };
            square += (radiance - f64::from(found[0])).powi(2);
            power += radiance * radiance;
            count += 1;
        }
        let relative = (square / power).sqrt();
        eprintln!("shadows {shadows}: {count} hits, {missed} missed, {dark} in shadow, error {relative:.4}");
        assert!(count > 300 && 20 * missed < count && dark > 20, "{count} {missed} {dark}");
        errors.push(relative);
    }
    // The ball's look-ups have silhouettes of some texels; without shadows the lit part is too large.
    assert!(errors[0] < 0.15 && errors[1] > 1.5 * errors[0], "{errors:?}");
    Ok(())
}

fn culling(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let place = Mat4::from_translation(Vec3::new(0.0, 1.0, 0.0)) * Mat4::from_scale(Vec3::splat(0.3));
    let scene = Scene::new(gpu, &[(ball(), place, Vec3::ONE)])?;
    let light = gradient();
    let drawn = |roughness: f32| -> Result<u32, GpuError> {
        let settings = ReflectionSettings { roughness, ..ReflectionSettings::default() };
        Ok(scene.color(gpu, &shot, settings, &light, None)?.1)
    };
    let counts = [drawn(0.0)?, drawn(0.2)?, drawn(0.4)?, drawn(0.95)?];
    eprintln!("tiles by roughness: {counts:?} of 108");
    assert!(counts[0] > 0 && counts[0] < 12, "{counts:?}");
    assert!(counts.is_sorted() && counts[3] == 108, "{counts:?}");
    assert_eq!(drawn(1.0)?, 0);
    // The right half of the floor is matt.
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let options = TextureOptions { size: SIZE.to_array(), format: TextureFormat::R32Float, usage, mips: 1 };
    let half = Texture::new(gpu, "roughness", options)?;
    let texels: Vec<f32> =
        (0..SIZE.x * SIZE.y).map(|n| if n % SIZE.x < SIZE.x / 2 { 0.1 } else { 1.0 }).collect();
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIZE.x), rows_per_image: None };
    gpu.queue.write_texture(half.raw.as_image_copy(), bytemuck::cast_slice(&texels), layout, half.raw.size());
    let settings = ReflectionSettings { denoise: false, ..ReflectionSettings::default() };
    let (found, some) = scene.color(gpu, &shot, settings, &light, Some(&half))?;
    let right = found.iter().enumerate().filter(|(n, _)| *n as u32 % SIZE.x >= SIZE.x / 2);
    assert!(right.clone().all(|(_, texel)| *texel == [0.0; 4]));
    assert!(found.iter().any(|texel| texel[3] > 0.5) && some > 0);
    let none = scene.color(gpu, &shot, ReflectionSettings { rays: 0, ..settings }, &light, None)?;
    assert!(none.0.iter().any(|texel| texel[3] > 0.5), "at least one ray");
    Ok(())
}
