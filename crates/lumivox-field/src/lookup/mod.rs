//! Looking rays up in a field on the CPU (dissertation 4.4.2, Algorithm 2): a ray is met with the bounding sphere, and
//! the map of the nearest sample point tells the rest of its way, in constant time.
//!
//! One thing is not as the text has it, which adds the map's distance to that of the sphere. The map's ray starts at
//! the sample point and not where the ray enters, up to half a spacing further or nearer *along the ray*. We count from
//! the sample point: a wall across the ray then has its exact distance wherever the ray enters.

mod ray;

use glam::Vec3;

pub use ray::Ray;

use crate::directions::Frame;
use crate::field::maps::{BYTE_STEPS, from_octahedral};
use crate::{BYTE_MISS, Distances, Field};

/// What the three maps around a ray's entry say together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// The part of the maps, by weight, that meet the object: from 0 to 1.
    pub coverage: f32,
    /// Their mean distance in lengths of the ray's direction; infinite where the coverage is 0.
    pub distance: f32,
}

impl Blend {
    /// The distance, if at least half of the maps by weight meet the object.
    pub fn hit(&self) -> Option<f32> {
        (self.coverage >= 0.5).then_some(self.distance)
    }
}

/// Rays whose maps [`Field::nearest_many`] reads at once.
const RAYS_AT_ONCE: usize = 32;

/// A ray of the unit sphere's space, where it meets the sphere.
struct Entry {
    /// A unit vector.
    direction: Vec3,
    /// Where the line enters and leaves, unit vectors.
    point: Vec3,
    exit: Vec3,
    way: Way,
}

impl Field {
    /// The distance to the object along a ray, in lengths of the ray's direction, by the map of the nearest sample
    /// point; `None` where nothing is met.
    ///
    /// For a ray that starts within the sphere this is what a ray from outside would meet first, if that lies ahead.
    /// See [`Field::is_blocked`] for rays that start on the object itself.
    #[inline]
    pub fn nearest(&self, ray: &Ray) -> Option<f32> {
        self.read(&self.aim(ray)?)
    }

    /// [`Field::nearest`] for many rays, as many as both slices hold. Faster than one by one: the maps, larger than most
    /// caches, are read for some rays at once.
    pub fn nearest_many(&self, rays: &[Ray], distances: &mut [Option<f32>]) {
        let mut aims = [const { None }; RAYS_AT_ONCE];
        for (rays, distances) in rays.chunks(RAYS_AT_ONCE).zip(distances.chunks_mut(RAYS_AT_ONCE)) {
            aims.iter_mut().zip(rays).for_each(|(aim, ray)| *aim = self.aim(ray));
            let found = aims.iter().take(rays.len()).map(|aim| self.read(aim.as_ref()?));
            distances.iter_mut().zip(found).for_each(|(distance, found)| *distance = found);
        }
    }

    /// The same with the normal that is kept there, a unit vector of the object's space; `None` without normals too.
    pub fn nearest_with_normal(&self, ray: &Ray) -> Option<(f32, Vec3)> {
        let aim = self.aim(ray)?;
        let normal = self.maps.normals.get(aim.at.place)?;
        Some((self.read(&aim)?, from_octahedral(*normal)))
    }

    /// The maps of the three sample points around the ray's entry, weighted by how near they are.
    pub fn blend(&self, ray: &Ray) -> Blend {
        let mut blend = Blend { coverage: 0.0, distance: 0.0 };
        if let Some(entry) = self.entry(ray) {
            let around = self.points.surrounding(entry.point);
            for (point, weight) in around.points.into_iter().zip(around.weights) {
                let at = self.at(point, entry.direction);
                if let Some(distance) = self.distance(&at).and_then(|d| entry.way.to(d + at.offset)) {
                    blend.coverage += weight;
                    blend.distance += weight * distance;
                }
            }
        }
        // A weight so small that it vanishes beside the others covers nothing.
        if blend.coverage > f32::MIN_POSITIVE {
            blend.distance /= blend.coverage;
            blend.coverage = blend.coverage.min(1.0);
            blend
        } else {
            Blend { coverage: 0.0, distance: f32::INFINITY }
        }
    }

    /// Whether the object blocks a ray that starts within its bounding sphere, on its way out (Figure 31): the map where
    /// the ray leaves, looked up backwards, shows something nearer than the origin. `bias`, in metres of the object's
    /// space, is how much nearer it must be, for the surface that the ray starts on not to block it.
    ///
    /// A ray that starts outside the sphere is blocked when it meets the object.
    pub fn is_blocked(&self, ray: &Ray, bias: f32) -> bool {
        let Some(entry) = self.entry(ray) else { return false };
        if entry.way.entry >= 0.0 {
            return self.nearest(ray).is_some();
        }
        let at = self.at(self.points.nearest(entry.exit), -entry.direction);
        let Some(distance) = self.distance(&at) else { return false };
        // Along the ray, the object lies beyond the origin.
        -(distance + at.offset) > entry.way.origin + bias / self.sphere.radius
    }

    /// Where a ray meets the sphere; `None` if it passes it, lies behind, or is no ray.
    #[inline]
    fn entry(&self, ray: &Ray) -> Option<Entry> {
        let Ray { origin, direction } = ray.in_unit_sphere(self.sphere);
        let length = direction.length();
        let direction = direction / length;
        // Half of the quadratic's middle term; the rest from the point nearest to the centre, which keeps the digits
        // that a squared distance of the origin would lose.
        let middle = -origin.dot(direction);
        let height = (origin + middle * direction).length_squared();
        if !(height <= 1.0 && middle.is_finite()) {
            return None;
        }
        let half = (1.0 - height).sqrt();
        let way = Way { origin: -middle, entry: middle - half, length };
        let [point, exit] = [middle - half, middle + half].map(|t| origin + t * direction);
        (middle + half >= 0.0).then_some(Entry { direction, point, exit, way })
    }

    /// Where a ray is to be looked up.
    #[inline]
    fn aim(&self, ray: &Ray) -> Option<Aim> {
        let entry = self.entry(ray)?;
        Some(Aim { at: self.at(self.points.nearest(entry.point), entry.direction), way: entry.way })
    }

    #[inline]
    fn read(&self, aim: &Aim) -> Option<f32> {
        aim.way.to(self.distance(&aim.at)? + aim.at.offset)
    }

    /// The texel of a direction in the map of a point.
    #[inline]
    fn at(&self, point: u32, direction: Vec3) -> At {
        let position = self.points.positions()[point as usize];
        let local = Frame::at(position).local_from_object(direction);
        let texel = self.directions.texel(local) as usize;
        let place = point as usize * self.directions.count() as usize + texel;
        At { point, place, cosine: local.z, offset: position.dot(direction) }
    }

    /// Distance from a sample point in units of the radius.
    #[inline]
    fn distance(&self, &At { point, place, cosine, .. }: &At) -> Option<f32> {
        match &self.maps.distances {
            Distances::Byte(codes) => match codes[place] {
                BYTE_MISS => None,
                code => Some(f32::from(code) * (2.0 / BYTE_STEPS)),
            },
            Distances::Float(values) => (values[place] < 1.0).then_some(2.0 * values[place]),
            Distances::Bit { words, depths } => {
                let met = words[place / 32] >> (place % 32) & 1 == 1;
                // The mean depth is that of a plane; no ray leaves the sphere on its way there.
                met.then(|| (2.0 * depths[point as usize] / cosine).clamp(0.0, 2.0 * cosine.max(0.0)))
            }
        }
    }
}

/// A texel of a map, and how the ray lies there.
struct At {
    point: u32,
    /// Number of the texel among those of all maps.
    place: usize,
    /// Of the ray with the point's inward normal.
    cosine: f32,
    /// Where the point lies along the ray, from the centre.
    offset: f32,
}

/// Places along a ray, from the point nearest to the centre if not said otherwise.
struct Way {
    origin: f32,
    /// From the origin, where the ray enters the sphere.
    entry: f32,
    /// Length that the direction had.
    length: f32,
}

/// All that is needed to look a ray up in one map.
struct Aim {
    at: At,
    way: Way,
}

impl Way {
    /// The distance from the origin to a place, in lengths of the ray's first direction; `None` behind.
    #[inline]
    fn to(&self, place: f32) -> Option<f32> {
        let distance = (place - self.origin).max(self.entry);
        (distance >= 0.0).then_some(distance / self.length)
    }
}

#[cfg(test)]
mod tests;
