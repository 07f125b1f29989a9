//! What a camera sees of a floor or an object, as the device takes it and as true rays do.

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
use lumivox_field::{Baker, Field, Ray, Settings, Sphere};
use rayon::prelude::*;

use super::corner::directions;
use super::models::Model;
use crate::bench::report::Row;
use crate::bench::timing::{Time, Timer};

/// Every so many pixels along x and y are held against true rays. Pixels four apart have the same pattern of rays, so this shares
/// no factor with four: all sixteen are seen.
pub(super) const STRIDE: u32 = 5;
/// True rays of each of them, where nothing else is said.
pub(super) const TRUE_RAYS: u32 = 1024;

/// What a camera sees of a floor under a sphere, or of an object itself, as a G-buffer.
pub(super) struct Surface {
    pub(super) size: UVec2,
    depth: Texture,
    normal: Texture,
    uniform: Uniform<ViewUniform>,
    pub(super) points: Vec<Vec3>,
    /// Zero where nothing is seen.
    normals: Vec<Vec3>,
    pub(super) eye: Vec3,
}

impl Surface {
    /// A floor just below a sphere, that fills the picture.
    pub(super) fn floor(gpu: &Gpu, sphere: Sphere, side: u32) -> Result<Self> {
        let (center, radius) = (sphere.center, sphere.radius);
        let height = center.y - 1.02 * radius;
        let target = Vec3::new(center.x, height, center.z);
        let eye = target + radius * Vec3::new(0.0, 4.5, 3.0);
        let view = View::perspective(eye, target, Vec3::Y, 0.8, 1.0, 0.1 * radius, 20.0 * radius);
        Self::seen(gpu, view.with_reversed_depth(), (eye, side), |way| {
            Some((eye + (height - eye.y) / way.y * way, Vec3::Y))
        })
    }

    /// An object by itself, by true rays.
    pub(super) fn own(gpu: &Gpu, baker: &Baker, side: u32) -> Result<Self> {
        let Sphere { center, radius } = baker.sphere();
        let eye = center + radius * Vec3::new(0.9, 0.8, 2.6);
        let view = View::perspective(eye, center, Vec3::Y, 0.75, 1.0, 0.1 * radius, 20.0 * radius);
        Self::seen(gpu, view.with_reversed_depth(), (eye, side), |way| {
            let ray = Ray::new(eye, way);
            baker.trace_with_normal(&ray).map(|(distance, normal)| (ray.at(distance), normal))
        })
    }

    /// What is `met` along the way of each pixel.
    fn seen(
        gpu: &Gpu,
        view: View,
        (eye, side): (Vec3, u32),
        met: impl Fn(Vec3) -> Option<(Vec3, Vec3)>,
    ) -> Result<Self> {
        let world_from_clip = view.world_from_clip();
        let at = |n: u32| {
            let (x, y) = ((n % side) as f32 + 0.5, (n / side) as f32 + 0.5);
            let ndc = [2.0 * x / side as f32 - 1.0, 1.0 - 2.0 * y / side as f32];
            let far = world_from_clip * Vec4::new(ndc[0], ndc[1], 0.5, 1.0);
            met(far.truncate() / far.w - eye).unwrap_or((eye, Vec3::ZERO))
        };
        let (points, normals): (Vec<Vec3>, Vec<Vec3>) = (0..side * side).map(at).unzip();
        let depth = |(p, n): (&Vec3, &Vec3)| match *n {
            // As far as reversed depth goes.
            Vec3::ZERO => 0.0,
            _ => view.clip_from_world.project_point3(*p).z,
        };
        let depths: Vec<f32> = points.iter().zip(&normals).map(depth).collect();
        let packed: Vec<[f16; 4]> =
            normals.iter().map(|n| n.extend(0.0).to_array().map(f16::from_f32)).collect();
        let nothing = InjectionScale { attribute_points: 1, light_points: 1, radiance_max: 1.0 };
        let size = UVec2::splat(side);
        Ok(Self {
            size,
            depth: uploaded(gpu, side, TextureFormat::R32Float, lumivox::bytemuck::cast_slice(&depths))?,
            normal: uploaded(gpu, side, TextureFormat::Rgba16Float, lumivox::bytemuck::cast_slice(&packed))?,
            uniform: Uniform::new(gpu, "bench/view", &ViewUniform::new(&view, size, UVec2::ONE, nothing)),
            points,
            normals,
            eye,
        })
    }

    pub(super) fn receiver(&self) -> Receiver<'_> {
        Receiver { depth: &self.depth, normal: &self.normal, uniform: &self.uniform }
    }

    /// Pixels that show anything.
    pub(super) fn shown(&self) -> usize {
        self.normals.iter().filter(|n| **n != Vec3::ZERO).count()
    }

    /// The pixels that are held against true rays.
    pub(super) fn chosen(&self) -> Vec<usize> {
        let side = self.size.x;
        let all = (0..side * side)
            .filter(|n| (n % side).is_multiple_of(STRIDE) && (n / side).is_multiple_of(STRIDE));
        all.map(|n| n as usize).filter(|&n| self.normals[n] != Vec3::ZERO).collect()
    }

    /// The part that gets through of the true rays that `rays` sends from the chosen pixels, each with its end and weight.
    pub(super) fn truth<R: Iterator<Item = (Ray, f32, f32)>>(
        &self,
        baker: &Baker,
        rays: impl Fn(usize, Vec3, Vec3) -> R + Sync,
    ) -> Vec<f64> {
        // Off the surface, for what rays start on not to stop them.
        let off = 1e-4 * baker.sphere().radius;
        let through = |n: usize| {
            let (mut sent, mut free) = (0.0, 0.0);
            for (ray, ends, weight) in rays(n, self.points[n] + off * self.normals[n], self.normals[n]) {
                let gets_through = weight > 0.0 && baker.trace(&ray).is_none_or(|d| d > ends);
                sent += f64::from(weight);
                free += if gets_through { f64::from(weight) } else { 0.0 };
            }
            if sent > 0.0 { free / sent } else { 1.0 }
        };
        self.chosen().into_par_iter().map(through).collect()
    }

    pub(super) fn chosen_of(&self, gpu: &Gpu, factor: &Texture) -> Result<Vec<f64>> {
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
pub(super) struct Placed {
    pub(super) fields: Fields,
    pub(super) objects: Objects,
}

impl Placed {
    pub(super) fn new(gpu: &Gpu, fields: &[&Field]) -> Result<Self> {
        let packed = fields.iter().map(|f| f.packed().context("a field that fits a texture"));
        let packed = packed.collect::<Result<Vec<_>>>()?;
        let fields = Fields::new(gpu, &packed.iter().collect::<Vec<_>>())?;
        let mut objects = Objects::new(gpu, packed.len() as u32)?;
        let all: Vec<_> = (0..packed.len()).map(|n| Placement::new(n, Mat4::IDENTITY, 0)).collect();
        objects.update(gpu, &fields, &all)?;
        Ok(Self { fields, objects })
    }

    pub(super) fn occlusion(
        &self,
        timer: &Timer<'_>,
        surface: &Surface,
        settings: OcclusionSettings,
    ) -> Result<(Time, Vec<f64>)> {
        let gpu = timer.gpu;
        let mut occlusion = Occlusion::new(gpu, surface.size, &self.objects, settings)?;
        occlusion.update(gpu, &self.objects);
        let receiver = surface.receiver();
        let time = timer
            .median(|| timer.submit(|e| occlusion.record(gpu, e, &self.fields, &self.objects, &receiver)))?;
        Ok((time, surface.chosen_of(gpu, occlusion.factor())?))
    }

    /// Time of the shadows of all lights, and the mean of what gets through of them.
    pub(super) fn shadow(
        &self,
        timer: &Timer<'_>,
        surface: &Surface,
        lights: &[ShadowLight],
        settings: ShadowSettings,
    ) -> Result<(Time, Vec<f64>)> {
        let gpu = timer.gpu;
        let count = lights.len();
        let mut shadows = SoftShadows::new(gpu, surface.size, &self.objects, count, settings)?;
        shadows.update(gpu, &self.objects, lights);
        let receiver = surface.receiver();
        let time = timer
            .median(|| timer.submit(|e| shadows.record(gpu, e, &self.fields, &self.objects, &receiver)))?;
        let mut mean = vec![0.0; surface.chosen().len()];
        for light in 0..lights.len() {
            let factor = shadows.factor(light).context("the factor of the light")?;
            let found = surface.chosen_of(gpu, factor)?;
            mean.iter_mut().zip(found).for_each(|(mean, found)| *mean += found / count as f64);
        }
        Ok((time, mean))
    }
}

/// Rays all over the hemisphere, as dense as their cosine.
pub(super) fn sky_rays(count: u32) -> impl Fn(usize, Vec3, Vec3) -> SkyRays + Sync {
    move |n, p, normal| {
        Box::new(directions(normal, count, n as f32).map(move |d| (Ray::new(p, d), f32::INFINITY, 1.0)))
    }
}

type SkyRays = Box<dyn Iterator<Item = (Ray, f32, f32)>>;

pub(super) fn row(
    figure: &'static str,
    case: String,
    metric: &str,
    value: f64,
    unit: &'static str,
    paper: Option<f64>,
) -> Row {
    Row { figure, case, metric: metric.to_owned(), value, unit, paper, note: String::new() }
}

pub(super) fn side(quick: bool) -> u32 {
    if quick { 128 } else { 256 }
}

/// The fields that are tried.
pub(super) fn sizes(quick: bool) -> &'static [(u32, u32)] {
    if quick {
        &[(290, 32), (1090, 64)]
    } else {
        &[(1090, 32), (1090, 64), (1090, 128), (4226, 32), (4226, 64), (16642, 32)]
    }
}

pub(super) fn baker_of(model: &Model) -> Result<Baker> {
    let small = Settings { points: 82, directions: 32, ..Settings::default() };
    Ok(Baker::new(model.object.mesh(), small)?)
}
