//! A small ray tracer whose secondary rays are look-ups (4.5.2, Figure 45): primary rays meet triangles, shadow rays and reflected
//! rays the triangles too, or fields.

use glam::{Affine3A, Vec3};
use lumivox_field::{Baker, Field, Interpolation, Ray};

use super::lobe;

/// Secondary rays of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays {
    /// To each lamp; half as many where a reflection ends.
    pub(super) shadow: u32,
    /// Of a polished point.
    pub(super) polish: u32,
}

const ROUGHNESS: f32 = 0.2;

/// An object in the world.
pub(super) struct Body<'m> {
    pub(super) baker: &'m Baker,
    pub(super) field: &'m Field,
    pub(super) object_from_world: Affine3A,
    pub(super) albedo: Vec3,
}

/// A lamp with a radius.
pub(super) struct Lamp {
    pub(super) position: Vec3,
    pub(super) radius: f32,
    /// W/sr.
    pub(super) intensity: f32,
}

/// A floor at height 0, polished, with bodies on it.
pub(super) struct World<'m> {
    pub(super) bodies: Vec<Body<'m>>,
    pub(super) lamps: Vec<Lamp>,
    pub(super) floor: Vec3,
    /// The part of light that the floor mirrors.
    pub(super) reflectance: f32,
    pub(super) sky: f32,
    pub(super) rays: Rays,
}

/// What secondary rays meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Secondary {
    /// Triangles.
    True,
    /// Fields.
    LookedUp,
}

/// A surface in a ray's way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    p: Vec3,
    normal: Vec3,
    albedo: Vec3,
    is_floor: bool,
}

/// Secondary rays of a picture.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) shadow: u64,
    pub(super) reflected: u64,
}

impl World<'_> {
    /// What a primary ray meets.
    pub(super) fn primary(&self, ray: &Ray) -> Option<Met> {
        self.nearest(ray, Secondary::True)
    }

    fn nearest(&self, ray: &Ray, by: Secondary) -> Option<Met> {
        let down = -ray.origin.y / ray.direction.y;
        let floor = (down > 1e-4 && down.is_finite())
            .then(|| (down, Met { p: ray.at(down), normal: Vec3::Y, albedo: self.floor, is_floor: true }));
        let of = |body: &Body<'_>| {
            let own = ray.transformed(&body.object_from_world);
            let (distance, normal) = match by {
                Secondary::True => body.baker.trace_with_normal(&own)?,
                Secondary::LookedUp => {
                    body.field.ahead_with_normal(&own, body.field.hit_bias(), Interpolation::Nearest)?
                }
            };
            let normal = (body.object_from_world.matrix3.transpose() * normal).normalize_or(Vec3::Y);
            let met = Met { p: ray.at(distance), normal, albedo: body.albedo, is_floor: false };
            Some((distance, met))
        };
        let all = self.bodies.iter().filter_map(of).chain(floor);
        all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, met)| met)
    }

    fn is_blocked(&self, ray: &Ray, by: Secondary) -> bool {
        self.bodies.iter().any(|body| {
            let own = ray.transformed(&body.object_from_world);
            let distance = match by {
                Secondary::True => body.baker.trace(&own),
                Secondary::LookedUp => body.field.ahead(&own, body.field.hit_bias(), Interpolation::Nearest),
            };
            distance.is_some_and(|d| d < 1.0)
        })
    }

    /// Radiance of what a ray along `way` met; `turned` is the pixel's number.
    pub(super) fn shaded(
        &self,
        met: &Met,
        way: Vec3,
        turned: u32,
        by: Secondary,
        counts: &mut Counts,
    ) -> Vec3 {
        let base = self.matt(met, turned, self.rays.shadow, by, counts);
        if !met.is_floor {
            return base;
        }
        let (mut sum, mut sent) = (Vec3::ZERO, 0.0);
        for unit in lobe::square(self.rays.polish, turned) {
            let (out, weight) = lobe::ray(met.normal, way, ROUGHNESS, unit);
            sent += weight;
            if weight == 0.0 {
                continue;
            }
            counts.reflected += 1;
            let ray = Ray::new(met.p + 1e-4 * met.normal, out);
            let light = match self.nearest(&ray, by) {
                Some(hit) => self.matt(&hit, turned, self.rays.shadow / 2, by, counts),
                None => Vec3::splat(self.sky),
            };
            sum += weight * light;
        }
        base.lerp(sum / sent.max(1e-20), self.reflectance)
    }

    /// Radiance of a matt surface.
    fn matt(&self, met: &Met, turned: u32, rays: u32, by: Secondary, counts: &mut Counts) -> Vec3 {
        let mut radiance = self.sky * (0.6 + 0.4 * met.normal.y);
        let from = met.p + 1e-3 * met.normal;
        for lamp in &self.lamps {
            let middle = lamp.position - from;
            let facing = met.normal.dot(middle).max(0.0) / middle.length().powi(3);
            if facing == 0.0 {
                continue;
            }
            let (x, y) = middle.normalize_or(Vec3::Y).any_orthonormal_pair();
            let free = lobe::square(rays, turned).filter(|[s, t]| {
                let (sin, cos) = (std::f32::consts::TAU * t).sin_cos();
                let aim = middle + lamp.radius * s.sqrt() * (cos * x + sin * y);
                !self.is_blocked(&Ray::new(from, aim), by)
            });
            let share = free.count() as f32 / rays as f32;
            counts.shadow += u64::from(rays);
            radiance += share * facing * lamp.intensity / std::f32::consts::PI;
        }
        radiance * met.albedo
    }
}
