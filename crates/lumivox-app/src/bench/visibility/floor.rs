//! Pictures of a floor under an object, on the device: occlusion (Figures 37, 38 and 48) and soft shadows (Figures 42 to 44).

use anyhow::{Context, Result};
use glam::{Mat4, UVec2, Vec3, Vec4};
use half::f16;
use lumivox::core::View;
use lumivox::gpu::{Gpu, Texture, TextureOptions, Uniform, read_texture};
use lumivox::progressive::InjectionScale;
use lumivox::visibility::{
    Fields, Objects, Occlusion, OcclusionSettings, Placement, Receiver, ShadowLight, ShadowSettings,
    SoftShadows,
};
use lumivox::wgpu::{self, TextureFormat};
use lumivox::wgsl::ViewUniform;
use lumivox_field::{Baker, Field, Ray, Settings, Sphere, parts};
use rayon::prelude::*;

use super::corner::{directions, rms};
use super::models::{Model, cane};
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, Row, ms};
use crate::bench::timing::{Time, Timer};

/// Figure 37: milliseconds and RMS error.
const FIGURE_37: [(u32, u32, [f64; 2]); 6] = [
    (1090, 32, [81.2, 0.59578]),
    (1090, 64, [82.7, 0.58886]),
    (1090, 128, [82.9, 0.58606]),
    (4226, 32, [83.2, 0.45392]),
    (4226, 64, [83.3, 0.42404]),
    (16642, 32, [84.2, 0.42054]),
];
/// Figure 42: three lights, 20 rays each.
const FIGURE_42: [(u32, u32, [f64; 2]); 8] = [
    (1090, 32, [347.0, 6.00]),
    (1090, 64, [347.7, 4.85]),
    (1090, 128, [348.1, 4.66]),
    (4226, 32, [348.0, 5.95]),
    (4226, 64, [348.5, 4.82]),
    (4226, 128, [348.7, 4.44]),
    (16642, 32, [348.5, 5.94]),
    (16642, 64, [348.6, 4.80]),
];
/// Every so many pixels along x and y are held against true rays, of which there are so many.
const STRIDE: u32 = 4;
const TRUE_RAYS: u32 = 256;

/// A floor under a sphere, as a G-buffer.
struct Floor {
    size: UVec2,
    depth: Texture,
    normal: Texture,
    uniform: Uniform<ViewUniform>,
    points: Vec<Vec3>,
}

impl Floor {
    fn new(gpu: &Gpu, sphere: Sphere, side: u32) -> Result<Self> {
        let size = UVec2::splat(side);
        let (center, radius) = (sphere.center, sphere.radius);
        let height = center.y - 1.02 * radius;
        let target = Vec3::new(center.x, height, center.z);
        let eye = target + radius * Vec3::new(0.0, 4.5, 3.0);
        let view = View::perspective(eye, target, Vec3::Y, 0.8, 1.0, 0.1 * radius, 20.0 * radius)
            .with_reversed_depth();
        let world_from_clip = view.world_from_clip();
        let point = |n: u32| {
            let (x, y) = ((n % side) as f32 + 0.5, (n / side) as f32 + 0.5);
            let ndc = [2.0 * x / side as f32 - 1.0, 1.0 - 2.0 * y / side as f32];
            let far = world_from_clip * Vec4::new(ndc[0], ndc[1], 0.5, 1.0);
            let way = far.truncate() / far.w - eye;
            eye + (height - eye.y) / way.y * way
        };
        let points: Vec<Vec3> = (0..side * side).map(point).collect();
        let depths: Vec<f32> = points.iter().map(|p| view.clip_from_world.project_point3(*p).z).collect();
        let up = [f16::ZERO, f16::ONE, f16::ZERO, f16::ZERO];
        let normals = vec![up; points.len()];
        let nothing = InjectionScale { attribute_points: 1, light_points: 1, radiance_max: 1.0 };
        Ok(Self {
            size,
            depth: uploaded(gpu, side, TextureFormat::R32Float, lumivox::bytemuck::cast_slice(&depths))?,
            normal: uploaded(gpu, side, TextureFormat::Rgba16Float, lumivox::bytemuck::cast_slice(&normals))?,
            uniform: Uniform::new(gpu, "bench/view", &ViewUniform::new(&view, size, UVec2::ONE, nothing)),
            points,
        })
    }

    fn receiver(&self) -> Receiver<'_> {
        Receiver { depth: &self.depth, normal: &self.normal, uniform: &self.uniform }
    }

    /// The pixels that are held against true rays.
    fn chosen(&self) -> Vec<usize> {
        let side = self.size.x;
        let all = (0..side * side)
            .filter(|n| (n % side).is_multiple_of(STRIDE) && (n / side).is_multiple_of(STRIDE));
        all.map(|n| n as usize).collect()
    }

    /// The part of true rays from the chosen pixels that get through.
    fn truth<R: Iterator<Item = (Ray, f32)>>(
        &self,
        baker: &Baker,
        rays: impl Fn(usize, Vec3) -> R + Sync,
    ) -> Vec<f64> {
        let through = |n: usize| {
            let free =
                rays(n, self.points[n]).filter(|(ray, ends)| baker.trace(ray).is_none_or(|d| d > *ends));
            free.count() as f64 / f64::from(TRUE_RAYS)
        };
        self.chosen().into_par_iter().map(through).collect()
    }

    fn chosen_of(&self, gpu: &Gpu, factor: &Texture) -> Result<Vec<f64>> {
        let texels: Vec<f16> = read_texture(gpu, factor)?;
        Ok(self.chosen().into_iter().map(|n| texels[n].to_f64()).collect())
    }
}

fn uploaded(gpu: &Gpu, side: u32, format: TextureFormat, bytes: &[u8]) -> Result<Texture> {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = Texture::new(gpu, "bench", TextureOptions { size: [side; 2], format, usage, mips: 1 })?;
    let row = bytes.len() as u32 / side;
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    gpu.queue.write_texture(texture.raw.as_image_copy(), bytes, layout, texture.raw.size());
    Ok(texture)
}

/// Fields of one object on the device.
struct Placed {
    fields: Fields,
    objects: Objects,
}

impl Placed {
    fn new(gpu: &Gpu, fields: &[&Field]) -> Result<Self> {
        let packed = fields.iter().map(|f| f.packed().context("a field that fits a texture"));
        let packed = packed.collect::<Result<Vec<_>>>()?;
        let fields = Fields::new(gpu, &packed.iter().collect::<Vec<_>>())?;
        let mut objects = Objects::new(gpu, packed.len() as u32, 0.05)?;
        let all: Vec<_> = (0..packed.len()).map(|n| Placement::new(n, Mat4::IDENTITY, 0)).collect();
        objects.update(gpu, &fields, &all)?;
        Ok(Self { fields, objects })
    }

    fn occlusion(
        &self,
        timer: &Timer<'_>,
        floor: &Floor,
        settings: OcclusionSettings,
    ) -> Result<(Time, Vec<f64>)> {
        let gpu = timer.gpu;
        let mut occlusion = Occlusion::new(gpu, floor.size, &self.objects, settings)?;
        occlusion.update(gpu, &self.objects);
        let receiver = floor.receiver();
        let time = timer
            .median(|| timer.submit(|e| occlusion.record(gpu, e, &self.fields, &self.objects, &receiver)))?;
        Ok((time, floor.chosen_of(gpu, occlusion.factor())?))
    }

    fn shadow(
        &self,
        timer: &Timer<'_>,
        floor: &Floor,
        light: ShadowLight,
        rays: u32,
    ) -> Result<(Time, Vec<f64>)> {
        let gpu = timer.gpu;
        let settings = ShadowSettings { rays, blended: false, denoise: true };
        let mut shadows = SoftShadows::new(gpu, floor.size, &self.objects, 1, settings)?;
        shadows.update(gpu, &self.objects, &[light]);
        let receiver = floor.receiver();
        let time = timer
            .median(|| timer.submit(|e| shadows.record(gpu, e, &self.fields, &self.objects, &receiver)))?;
        let factor = shadows.factor(0).context("the factor of the light")?;
        Ok((time, floor.chosen_of(gpu, factor)?))
    }
}

fn sky_rays(n: usize, p: Vec3) -> impl Iterator<Item = (Ray, f32)> {
    directions(Vec3::Y, TRUE_RAYS, n as f32).map(move |d| (Ray::new(p, d), f32::INFINITY))
}

fn row(
    figure: &'static str,
    case: String,
    metric: &str,
    value: f64,
    unit: &'static str,
    paper: Option<f64>,
) -> Row {
    Row { figure, case, metric: metric.to_owned(), value, unit, paper, note: String::new() }
}

fn side(quick: bool) -> u32 {
    if quick { 128 } else { 512 }
}

/// The fields that are tried.
fn sizes(quick: bool) -> &'static [(u32, u32)] {
    if quick {
        &[(290, 32), (1090, 64)]
    } else {
        &[(1090, 32), (1090, 64), (1090, 128), (4226, 32), (4226, 64), (16642, 32)]
    }
}

fn baker_of(model: &Model) -> Result<Baker> {
    let small = Settings { points: 82, directions: 32, ..Settings::default() };
    Ok(Baker::new(model.object.mesh(), small)?)
}

/// Figures 37 and 38.
pub(super) fn occlusion(timer: &Timer<'_>, model: &Model, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Occlusion on the device (Figures 37 and 38)");
    let side = side(quick);
    let rays = if quick { 16 } else { 256 };
    report.say(&format!(
        "{} over a floor that fills a picture of {side} x {side} pixels; {rays} rays per pixel, denoised: milliseconds / RMS error in grey levels of \
         255 beside {TRUE_RAYS} true rays, of which the look-ups take other directions. In parentheses the papers', whose floor filled 75 % of 512 x 512.",
        model.title()
    ));
    let baker = baker_of(model)?;
    let floor = Floor::new(timer.gpu, baker.sphere(), side)?;
    let truth = floor.truth(&baker, sky_rays);
    let base = OcclusionSettings { rays, denoise: false, ..OcclusionSettings::default() };
    let mut lines = Vec::new();
    let mut last = None;
    for &(points, directions) in sizes(quick) {
        let (_, field, _) = model.baked(Settings { points, directions, ..Settings::default() })?;
        let placed = Placed::new(timer.gpu, &[&field])?;
        let case = format!("{points} x {directions} x {directions}");
        let paper = FIGURE_37.iter().find(|(p, d, _)| (*p, *d) == (points, directions)).map(|(.., v)| *v);
        let mut line = vec![case.clone()];
        for (name, blended) in [("nearest map", false), ("three maps", true)] {
            let settings = OcclusionSettings { blended, denoise: true, ..base };
            let (time, found) = placed.occlusion(timer, &floor, settings)?;
            let error = rms(&found, &truth);
            let beside = paper.filter(|_| !blended).map_or(String::new(), |[a, b]| format!(" ({a} / {b})"));
            line.push(format!("{} / {error:.3}{beside}", ms(time.ms)));
            let paper = paper.filter(|_| !blended);
            report.push(row(
                "Figure 37",
                format!("{case}, {name}"),
                "time",
                time.ms,
                "ms",
                paper.map(|p| p[0]),
            ));
            report.push(row(
                "Figure 37",
                format!("{case}, {name}"),
                "RMS",
                error,
                "grey levels",
                paper.map(|p| p[1]),
            ));
        }
        lines.push(line);
        last = Some(placed);
    }
    report.table(&["field", "nearest map", "three maps"].map(str::to_owned), &lines);
    let Some(placed) = last else { return Ok(()) };
    let counts: &[u32] = if quick { &[4, 16] } else { &[1, 4, 16, 64, 121, 256] };
    let mut series = ["milliseconds", "RMS", "RMS, denoised"]
        .map(|name| Series { name: name.to_owned(), points: Vec::new() });
    let mut lines = Vec::new();
    for &rays in counts {
        let (time, found) = placed.occlusion(timer, &floor, OcclusionSettings { rays, ..base })?;
        let (_, smooth) =
            placed.occlusion(timer, &floor, OcclusionSettings { rays, denoise: true, ..base })?;
        let values = [time.ms, rms(&found, &truth), rms(&smooth, &truth)];
        for ((series, value), metric) in series.iter_mut().zip(values).zip(["time", "RMS", "RMS, denoised"]) {
            series.points.push((f64::from(rays), value));
            let unit = if metric == "time" { "ms" } else { "grey levels" };
            report.push(row("Figure 38", format!("{rays} rays"), metric, value, unit, None));
        }
        lines.push(vec![
            rays.to_string(),
            ms(values[0]),
            format!("{:.3}", values[1]),
            format!("{:.3}", values[2]),
        ]);
    }
    report.table(&["rays per pixel", "ms", "RMS", "RMS, denoised"].map(str::to_owned), &lines);
    report.plot(
        "rays",
        &Plot { title: model.title(), x: "rays per pixel", y: "ms, grey levels", series: series.to_vec() },
    )
}

/// Figures 42 to 44.
pub(super) fn shadows(timer: &Timer<'_>, model: &Model, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Soft shadows on the device (Figures 42 to 44)");
    let side = side(quick);
    report.say(&format!(
        "{} under a ball of light of a fifth of its radius, 20 rays per pixel, denoised, {side} x {side} pixels: milliseconds / RMS error in grey \
         levels of 255 beside {TRUE_RAYS} true rays. In parentheses the papers' bunny, three lights, with primary rays that take most of \
         the time.",
        model.title()
    ));
    let baker = baker_of(model)?;
    let Sphere { center, radius } = baker.sphere();
    let floor = Floor::new(timer.gpu, baker.sphere(), side)?;
    let (position, size) = (center + radius * Vec3::new(1.5, 4.0, 1.0), 0.2 * radius);
    let to_light = |n: usize, p: Vec3| {
        let way = position - p;
        let (x, y) = way.normalize_or(Vec3::Y).any_orthonormal_pair();
        (0..TRUE_RAYS).map(move |i| {
            let out = size * ((i as f32 + 0.5) / TRUE_RAYS as f32).sqrt();
            let (sin, cos) = (2.399_963 * i as f32 + n as f32).sin_cos();
            (Ray::new(p, way + out * (cos * x + sin * y)), 1.0)
        })
    };
    let truth = floor.truth(&baker, to_light);
    let light = ShadowLight::Ball { position, radius: size };
    let mut lines = Vec::new();
    for &(points, directions) in sizes(quick) {
        let (_, field, _) = model.baked(Settings { points, directions, ..Settings::default() })?;
        let (time, found) = Placed::new(timer.gpu, &[&field])?.shadow(timer, &floor, light, 20)?;
        let error = rms(&found, &truth);
        let case = format!("{points} x {directions} x {directions}");
        let paper = FIGURE_42.iter().find(|(p, d, _)| (*p, *d) == (points, directions)).map(|(.., v)| *v);
        let beside = paper.map_or(String::new(), |[a, b]| format!(" ({a} / {b})"));
        lines.push(vec![case.clone(), format!("{} / {error:.3}{beside}", ms(time.ms))]);
        report.push(row("Figure 42", case.clone(), "time", time.ms, "ms", paper.map(|p| p[0])));
        report.push(row("Figure 42", case, "RMS", error, "grey levels", paper.map(|p| p[1])));
    }
    report.table(&["field", "ms / RMS"].map(str::to_owned), &lines);
    Ok(())
}

/// Figure 48.
pub(super) fn elongated(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("An elongated object (Figure 48)");
    let model = cane();
    let baker = baker_of(&model)?;
    let floor = Floor::new(timer.gpu, baker.sphere(), side(quick))?;
    let truth = floor.truth(&baker, sky_rays);
    report.say(&format!(
        "{}; 121 rays per pixel without denoising, one sphere with all maps and several with fewer each: memory, milliseconds, and RMS error in \
         grey levels of 255.",
        model.title()
    ));
    let settings = OcclusionSettings { rays: 121, denoise: false, ..OcclusionSettings::default() };
    let cases: &[(usize, u32)] =
        if quick { &[(1, 290), (4, 82)] } else { &[(1, 4226), (1, 16642), (4, 1090), (8, 1090)] };
    let mut lines = Vec::new();
    for &(most, points) in cases {
        let settings_of = Settings { points, directions: 64, ..Settings::default() };
        let pieces = parts(&model.object.mesh(), most)?;
        let bake = |part: &lumivox_field::Part| -> Result<Field> {
            let baker = Baker::new(part.mesh(), settings_of)?;
            Ok(baker.bake(|_| std::ops::ControlFlow::Continue(()))?)
        };
        let fields = pieces.iter().map(bake).collect::<Result<Vec<_>>>()?;
        let placed = Placed::new(timer.gpu, &fields.iter().collect::<Vec<_>>())?;
        let (time, found) = placed.occlusion(timer, &floor, settings)?;
        let error = rms(&found, &truth);
        let mib = fields.iter().map(|f| f.bytes() as f64).sum::<f64>() / f64::from(1 << 20);
        let case = format!("{} of {points} x 64 x 64", pieces.len());
        lines.push(vec![case.clone(), format!("{mib:.1}"), ms(time.ms), format!("{error:.3}")]);
        report.push(row("Figure 48", case.clone(), "time", time.ms, "ms", None));
        report.push(row("Figure 48", case.clone(), "memory", mib, "MiB", None));
        report.push(row("Figure 48", case, "RMS", error, "grey levels", None));
    }
    report.table(&["spheres", "MiB", "ms", "RMS"].map(str::to_owned), &lines);
    Ok(())
}
