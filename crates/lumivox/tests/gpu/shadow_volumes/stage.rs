//! Meshes under a light, seen by rays in double precision.

use half::f16;
use lumivox::core::View;
use lumivox::glam::{DVec3, UVec2, Vec3};
use lumivox::gpu::{Gpu, GpuError, Texture, TextureOptions, read_texture};
use lumivox::shadow_volumes::{ShadowVolumes, Topology, VolumeLight};
use lumivox::voxelize::{Mesh, VoxelizeError};
use lumivox::wgpu;

use crate::picture::{ndc_of_texel, ray};
use crate::support::Random;
use crate::voxelize::soups::{Soup, cuboid, scattered, sphere};

pub(crate) const BIAS: f32 = 2e-3;

/// Meshes, and the view that sees them.
pub(crate) struct Stage {
    pub(crate) soups: Vec<Soup>,
    pub(crate) view: View,
    pub(crate) size: UVec2,
}

/// What a pixel shows.
#[derive(Clone, Copy)]
pub(crate) struct Seen {
    pub(crate) point: DVec3,
    depth: f32,
    /// Across the surface, as long as a pixel is wide there.
    tangents: [DVec3; 2],
}

/// Corners of all triangles.
type Triangles = Vec<[DVec3; 3]>;

impl Stage {
    pub(crate) fn topologies(&self) -> Vec<Topology> {
        self.soups.iter().map(|soup| Topology::new(&soup.view())).collect()
    }

    pub(crate) fn meshes(&self, gpu: &Gpu) -> Result<Vec<Mesh>, VoxelizeError> {
        self.soups.iter().map(|soup| soup.mesh(gpu)).collect()
    }

    pub(crate) fn triangles(&self) -> Triangles {
        self.soups.iter().flat_map(corners).collect()
    }

    /// What each pixel shows, if anything.
    pub(crate) fn seen(&self) -> Vec<Option<Seen>> {
        let bodies: Vec<_> = self.soups.iter().map(|soup| Body::new(corners(soup))).collect();
        let pixels = (0..self.size.y).flat_map(|y| (0..self.size.x).map(move |x| UVec2::new(x, y)));
        let look = |pixel: UVec2| {
            let (start, along) = ray(&self.view, ndc_of_texel(pixel, self.size));
            let near =
                bodies.iter().filter(|body| body.is_near(start, along)).flat_map(|body| &body.triangles);
            let hits = near.filter_map(|t| Some((hit(t, start, along)?, t)));
            let (t, triangle) =
                hits.filter(|(t, _)| (0.0..=1.0).contains(t)).min_by(|a, b| a.0.total_cmp(&b.0))?;
            let point = start + t * along;
            let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalize_or_zero();
            let (next, _) = ray(&self.view, ndc_of_texel(pixel + 1, self.size));
            let eye = self.view.eye().as_dvec3();
            let is_parallel = self.view.clip_from_world.w_axis.w == 1.0;
            let grown = if is_parallel { 1.0 } else { point.distance(eye) / start.distance(eye) };
            let width = grown * next.distance(start);
            let (u, v) = normal.any_orthonormal_pair();
            let depth = self.view.clip_from_world.as_dmat4().project_point3(point).z as f32;
            Some(Seen { point, depth, tangents: [width * u, width * v] })
        };
        pixels.map(look).collect()
    }

    /// The depth image of it.
    pub(crate) fn depth(&self, gpu: &Gpu, seen: &[Option<Seen>]) -> Result<Texture, GpuError> {
        let far = if self.view.reversed_depth { 0.0 } else { 1.0 };
        let depths: Vec<f32> = seen.iter().map(|s| s.map_or(far, |s| s.depth)).collect();
        let options = TextureOptions {
            size: self.size.to_array(),
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            mips: 1,
        };
        let texture = Texture::new(gpu, "depth", options)?;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * self.size.x),
            rows_per_image: None,
        };
        let bytes = lumivox::bytemuck::cast_slice(&depths);
        gpu.queue.write_texture(texture.raw.as_image_copy(), bytes, layout, texture.raw.size());
        Ok(texture)
    }
}

fn corners(soup: &Soup) -> Triangles {
    let place = |i: u32| DVec3::from(soup.positions[i as usize].map(f64::from));
    soup.indices.iter().map(|t| t.map(place)).collect()
}

/// Triangles, and a ball around them.
struct Body {
    triangles: Triangles,
    center: DVec3,
    radius: f64,
}

impl Body {
    fn new(triangles: Triangles) -> Self {
        let points = triangles.as_flattened();
        let center = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let radius = points.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
        Self { triangles, center, radius: 1.000_001 * radius }
    }

    /// Whether a line meets the ball.
    fn is_near(&self, start: DVec3, along: DVec3) -> bool {
        (self.center - start).cross(along).length() <= self.radius * along.length()
    }
}

/// Where a ray meets a triangle.
fn hit([a, b, c]: &[DVec3; 3], start: DVec3, along: DVec3) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let p = along.cross(v);
    let inverse = 1.0 / u.dot(p);
    let from = start - a;
    let x = inverse * from.dot(p);
    let q = from.cross(u);
    let y = inverse * along.dot(q);
    (x >= 0.0 && y >= 0.0 && x + y <= 1.0).then_some(inverse * v.dot(q))
}

/// Whether the light reaches a point, of which nothing counts that is nearer than `bias`.
fn is_lit(triangles: &Triangles, light: &VolumeLight, point: DVec3, bias: f64) -> bool {
    let (towards, far) = match *light {
        VolumeLight::Directional { direction } => (-direction.as_dvec3().normalize_or_zero(), f64::INFINITY),
        VolumeLight::Point { position } => {
            let way = position.as_dvec3() - point;
            (way.normalize_or_zero(), way.length())
        }
    };
    !triangles.iter().any(|t| hit(t, point, towards).is_some_and(|t| t > bias && t < far))
}

/// Whether the light reaches a pixel; none where a hundredth of a pixel or of the bias would change the answer.
pub(crate) fn reference(triangles: &Triangles, light: &VolumeLight, seen: &Seen) -> Option<bool> {
    let bias = f64::from(BIAS);
    let lit = is_lit(triangles, light, seen.point, bias);
    let [u, v] = seen.tangents.map(|t| 0.05 * t);
    let moved = [u, -u, v, -v].map(|by| is_lit(triangles, light, seen.point + by, bias));
    let biased = [0.9, 1.1].map(|factor| is_lit(triangles, light, seen.point, factor * bias));
    (moved.iter().chain(&biased).all(|other| *other == lit)).then_some(lit)
}

/// The mask of the last recording.
pub(crate) fn mask(gpu: &Gpu, volumes: &ShadowVolumes) -> Result<Vec<bool>, GpuError> {
    let texels: Vec<f16> = read_texture(gpu, volumes.mask(0).expect("one light"))?;
    Ok(texels.into_iter().map(|t| t == f16::ONE).collect())
}

/// A floor with things on it and over it: boxes, balls, sheets and loose triangles.
pub(crate) fn things(seed: u64, count: u32) -> Vec<Soup> {
    let mut random = Random::new(seed);
    let floor = cuboid(Vec3::new(-8.0, -0.5, -8.0), Vec3::new(8.0, 0.0, 8.0));
    let thing = |n: u32| {
        let at = Vec3::new(12.0, 3.0, 12.0) * random.cube() + Vec3::new(-6.0, 0.3, -6.0);
        let size = 0.5 + random.unit();
        match n % 4 {
            0 => cuboid(at - 0.5 * size, at + Vec3::new(0.5, 0.9, 0.7) * size),
            1 => sphere(at, 0.6 * size, 2),
            2 => {
                let [u, v] = [(); 2].map(|()| 2.0 * size * (random.cube() - 0.5));
                Soup::of([[at, at + u, at + u + v], [at, at + u + v, at + v]])
            }
            _ => {
                let mut soup = scattered(seed + u64::from(n), 4, 1.0, 0.0);
                soup.positions.iter_mut().for_each(|p| *p = (at + 0.5 * Vec3::from(*p)).to_array());
                soup
            }
        }
    };
    std::iter::once(floor).chain((0..count).map(thing)).collect()
}
