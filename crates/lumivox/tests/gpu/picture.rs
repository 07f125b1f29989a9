//! Pictures of planes, spheres and boxes that rays find on the CPU in double precision.

use half::f16;
use lumivox::core::View;
use lumivox::glam::{DMat4, DVec2, DVec3, UVec2};
use lumivox::gpu::{Gpu, GpuError, Texture, TextureOptions};
use lumivox::progressive::ViewTextures;
use lumivox::wgpu;

/// What a surface point is like.
#[derive(Clone, Copy, Default)]
pub(crate) struct Paint {
    pub(crate) albedo: DVec3,
    pub(crate) emission: DVec3,
    pub(crate) radiance: DVec3,
}

#[derive(Clone, Copy)]
pub(crate) enum Shape {
    Plane { point: DVec3, normal: DVec3 },
    Sphere { center: DVec3, radius: f64 },
    Box { min: DVec3, max: DVec3 },
    Triangle([DVec3; 3]),
}

/// A shape and its paint at a world point.
#[derive(Clone, Copy)]
pub(crate) struct Thing(pub(crate) Shape, pub(crate) fn(DVec3) -> Paint);

impl Shape {
    /// Where a ray meets it first at or after its start, and the normal there.
    fn hit(&self, start: DVec3, along: DVec3) -> Option<(f64, DVec3)> {
        match *self {
            Self::Plane { point, normal } => {
                let t = (point - start).dot(normal) / along.dot(normal);
                (t >= 0.0).then_some((t, normal))
            }
            Self::Sphere { center, radius } => {
                let from = start - center;
                let (a, b) = (along.length_squared(), from.dot(along));
                let root = (b * b - a * (from.length_squared() - radius * radius)).sqrt();
                let t = [(-b - root) / a, (-b + root) / a].into_iter().find(|t| *t >= 0.0)?;
                Some((t, (from + t * along) / radius))
            }
            Self::Box { min, max } => {
                let (a, b) = ((min - start) / along, (max - start) / along);
                let (enter, leave) = (a.min(b), a.max(b));
                let (t_in, t_out) = (enter.max_element(), leave.min_element());
                let (t, at) = if t_in >= 0.0 { (t_in, enter) } else { (t_out, leave) };
                let axis = at.to_array().iter().position(|v| *v == t)?;
                (t_in <= t_out && t >= 0.0).then_some((t, DVec3::AXES[axis]))
            }
            Self::Triangle([a, b, c]) => {
                let normal = (b - a).cross(c - a).normalize();
                let t = (a - start).dot(normal) / along.dot(normal);
                let point = start + t * along;
                let is_inside = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) >= 0.0;
                let hits = t >= 0.0 && is_inside(a, b) && is_inside(b, c) && is_inside(c, a);
                hits.then_some((t, normal))
            }
        }
    }
}

/// The pictures of a view as its textures hold them.
pub(crate) struct Picture {
    pub(crate) size: UVec2,
    pub(crate) depth: Vec<f32>,
    pub(crate) normal: Vec<[f16; 4]>,
    pub(crate) albedo: Vec<[u8; 4]>,
    pub(crate) emission: Vec<[f16; 4]>,
    pub(crate) radiance: Vec<[f16; 4]>,
}

/// Four half floats as textures hold them.
pub(crate) fn halves(v: DVec3) -> [f16; 4] {
    v.extend(1.0).to_array().map(f16::from_f64)
}

impl Picture {
    pub(crate) fn take(view: &View, size: UVec2, things: &[Thing]) -> Self {
        let clip_from_world = view.clip_from_world.as_dmat4();
        let far = if view.reversed_depth { 0.0 } else { 1.0 };
        let mut picture = Self {
            size,
            depth: Vec::new(),
            normal: Vec::new(),
            albedo: Vec::new(),
            emission: Vec::new(),
            radiance: Vec::new(),
        };
        for (y, x) in (0..size.y).flat_map(|y| (0..size.x).map(move |x| (y, x))) {
            let ndc = ndc_of_texel(UVec2::new(x, y), size);
            let (start, along) = ray(view, ndc);
            let nearest = things
                .iter()
                .filter_map(|thing| thing.0.hit(start, along).map(|(t, n)| (t, n, thing.1)))
                .filter(|(t, ..)| *t <= 1.0)
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let (depth, normal, paint) = match nearest {
                Some((t, normal, paint)) => {
                    let point = start + t * along;
                    let facing = if normal.dot(along) > 0.0 { -normal } else { normal };
                    (clip_from_world.project_point3(point).z, facing, paint(point))
                }
                None => (far, DVec3::ZERO, Paint::default()),
            };
            picture.depth.push(depth as f32);
            picture.normal.push(halves(normal));
            picture.albedo.push((255.0 * paint.albedo).extend(255.0).to_array().map(|v| v.round() as u8));
            picture.emission.push(halves(paint.emission));
            picture.radiance.push(halves(paint.radiance));
        }
        picture
    }

    pub(crate) fn upload(&self, gpu: &Gpu) -> Result<ViewTextures, GpuError> {
        use wgpu::TextureFormat as F;
        let make = |name: &str, format: F, bytes: &[u8]| -> Result<Texture, GpuError> {
            let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
            let texture = Texture::new(
                gpu,
                name,
                TextureOptions { size: self.size.to_array(), format, usage, mips: 1 },
            )?;
            let row = bytes.len() as u32 / self.size.y;
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
            gpu.queue.write_texture(texture.raw.as_image_copy(), bytes, layout, texture.raw.size());
            Ok(texture)
        };
        Ok(ViewTextures {
            depth: make("depth", F::R32Float, bytemuck::cast_slice(&self.depth))?,
            normal: make("normal", F::Rgba16Float, bytemuck::cast_slice(&self.normal))?,
            albedo: make("albedo", F::Rgba8Unorm, bytemuck::cast_slice(&self.albedo))?,
            emission: make("emission", F::Rgba16Float, bytemuck::cast_slice(&self.emission))?,
            radiance: make("radiance", F::Rgba16Float, bytemuck::cast_slice(&self.radiance))?,
        })
    }
}

/// Normalised device coordinates of a texel's centre.
pub(crate) fn ndc_of_texel(texel: UVec2, size: UVec2) -> DVec2 {
    let uv = (texel.as_dvec2() + 0.5) / size.as_dvec2();
    DVec2::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y)
}

/// The world point that a depth value at these coordinates means; far away where a view without a far plane shows nothing.
pub(crate) fn lifted(view: &View, ndc: DVec2, depth: f32) -> DVec3 {
    let inverse: DMat4 = view.clip_from_world.as_dmat4().inverse();
    let point = inverse * ndc.extend(f64::from(depth)).extend(1.0);
    point.truncate() / point.w.max(1e-9)
}

/// The ray of a texel, from the near plane to the far plane, or 12 metres on where there is none.
pub(crate) fn ray(view: &View, ndc: DVec2) -> (DVec3, DVec3) {
    let inverse: DMat4 = view.clip_from_world.as_dmat4().inverse();
    let (near, far) = if view.reversed_depth { (1.0, 0.0) } else { (0.0, 1.0) };
    let start = inverse.project_point3(ndc.extend(near));
    let end = inverse * ndc.extend(far).extend(1.0);
    let is_endless = end.w.abs() < 1e-5;
    let along = if is_endless { 12.0 * end.truncate().normalize() } else { end.truncate() / end.w - start };
    (start, along)
}
