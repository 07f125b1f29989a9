//! A floor under an object, as the device sees it and as true rays do.

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

/// Every so many pixels along x and y are held against true rays, of which there are so many.
const STRIDE: u32 = 4;
pub(super) const TRUE_RAYS: u32 = 256;

/// A floor under a sphere, as a G-buffer.
pub(super) struct Floor {
    pub(super) size: UVec2,
    depth: Texture,
    normal: Texture,
    uniform: Uniform<ViewUniform>,
    pub(super) points: Vec<Vec3>,
    pub(super) eye: Vec3,
}

impl Floor {
    pub(super) fn new(gpu: &Gpu, sphere: Sphere, side: u32) -> Result<Self> {
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
            eye,
        })
    }

    pub(super) fn receiver(&self) -> Receiver<'_> {
        Receiver { depth: &self.depth, normal: &self.normal, uniform: &self.uniform }
    }

    /// The pixels that are held against true rays.
    pub(super) fn chosen(&self) -> Vec<usize> {
        let side = self.size.x;
        let all = (0..side * side)
            .filter(|n| (n % side).is_multiple_of(STRIDE) && (n / side).is_multiple_of(STRIDE));
        all.map(|n| n as usize).collect()
    }

    /// The part of true rays from the chosen pixels that get through.
    pub(super) fn truth<R: Iterator<Item = (Ray, f32)>>(
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

    pub(super) fn shadow(
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

pub(super) fn sky_rays(n: usize, p: Vec3) -> impl Iterator<Item = (Ray, f32)> {
    directions(Vec3::Y, TRUE_RAYS, n as f32).map(move |d| (Ray::new(p, d), f32::INFINITY))
}

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
