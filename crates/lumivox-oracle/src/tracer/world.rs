//! A scene made ready for rays: what a ray meets, and what the surface there is like.

use glam::{Vec3, Vec4};

use super::geometry::{Geometry, Hit, lifted};
use super::lights::Emitters;
use super::texture::Sampler;
use crate::scene::{Light, Material, Scene, SceneError};

/// A point of a surface, seen from one side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) position: Vec3,
    /// Unit normal of the triangle on the side it is seen from.
    pub(crate) face: Vec3,
    /// Unit normal that light is reflected with.
    pub(crate) normal: Vec3,
    /// Reflectance.
    pub(crate) albedo: Vec3,
    /// Radiance that leaves towards where it is seen from.
    pub(crate) emission: Vec3,
    /// How likely light sampling picks this point, per m2.
    pub(crate) light_density: f32,
}

/// A rectangular light is two black triangles behind the scene's own.
#[derive(Clone, Copy, Debug)]
struct RectTriangle {
    corners: [Vec3; 3],
    radiance: Vec3,
}

/// A scene with its tree, its textures and its emitters.
pub(crate) struct World<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) emitters: Emitters,
    /// Sum of all constant lights, W/(m2 sr).
    constant_sky: Vec3,
    geometry: Geometry,
    samplers: Vec<Sampler<'a>>,
    rects: Vec<RectTriangle>,
}

impl<'a> World<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Result<Self, SceneError> {
        scene.check()?;
        let mut rects = Vec::new();
        let mut sky = Vec3::ZERO;
        for light in &scene.lights {
            match *light {
                Light::Rect { origin: a, u, v, radiance } => {
                    let triangles = [[a, a + u, a + u + v], [a, a + u + v, a + v]];
                    rects.extend(triangles.map(|corners| RectTriangle { corners, radiance }));
                }
                Light::Constant { radiance } => sky += radiance,
                _ => {}
            }
        }
        let corners = scene.triangles.iter().map(|t| t.positions).chain(rects.iter().map(|r| r.corners));
        let strengths = scene
            .triangles
            .iter()
            .map(|t| scene.materials[t.material as usize].emission.max_element())
            .chain(rects.iter().map(|r| r.radiance.max_element()));
        let emitters = Emitters::new(corners.clone().zip(strengths));
        let samplers = scene.textures.iter().map(Sampler::new).collect();
        Ok(Self { scene, emitters, constant_sky: sky, geometry: Geometry::new(corners), samplers, rects })
    }

    /// What comes from the sky in a direction, W/(m2 sr).
    pub(crate) fn sky(&self, direction: Vec3) -> Vec3 {
        let environment = self.scene.environment.as_ref();
        self.constant_sky + environment.map_or(Vec3::ZERO, |e| e.radiance(direction))
    }

    pub(crate) fn has_sky(&self) -> bool {
        self.constant_sky != Vec3::ZERO || self.scene.environment.is_some()
    }

    /// Corners of a triangle, of the scene or of a rectangular light.
    pub(crate) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        match self.rect(triangle) {
            Some(rect) => rect.corners,
            None => self.scene.triangles[triangle].positions,
        }
    }

    fn rect(&self, triangle: usize) -> Option<&RectTriangle> {
        triangle.checked_sub(self.scene.triangles.len()).map(|n| &self.rects[n])
    }

    fn material(&self, triangle: usize) -> &Material {
        &self.scene.materials[self.scene.triangles[triangle].material as usize]
    }

    /// The nearest surface along a ray; `sees_rects` is false for the camera's own rays.
    pub(crate) fn trace(&self, origin: Vec3, direction: Vec3, sees_rects: bool) -> Option<Surface> {
        let keeps = |hit: Hit| (sees_rects || self.rect(hit.triangle).is_none()) && self.is_there(hit);
        let hit = self.geometry.nearest(origin, direction, f32::INFINITY, keeps)?;
        Some(self.surface(hit, direction))
    }

    /// Whether light gets from a surface to an offset from it, not counting the triangle `target` itself.
    pub(crate) fn sees(&self, from: &Surface, offset: Vec3, reach: f32, target: Option<usize>) -> bool {
        let origin = lifted(from.position, from.face);
        let keeps = |hit: Hit| Some(hit.triangle) != target && self.is_there(hit);
        !self.geometry.is_blocked(origin, offset, reach, keeps)
    }

    /// Whether the alpha mask leaves a surface here.
    pub(crate) fn is_there(&self, hit: Hit) -> bool {
        if self.rect(hit.triangle).is_some() {
            return true;
        }
        match self.material(hit.triangle).alpha_cutoff {
            Some(cutoff) => self.color(hit).w >= cutoff,
            None => true,
        }
    }

    /// Reflectance and opacity.
    fn color(&self, hit: Hit) -> Vec4 {
        let material = self.material(hit.triangle);
        let colors = self.scene.triangles[hit.triangle].colors;
        let w = hit.weights;
        let color = material.albedo * (w.x * colors[0] + w.y * colors[1] + w.z * colors[2]);
        color * self.texel(material.albedo_texture, hit)
    }

    fn texel(&self, texture: Option<u32>, hit: Hit) -> Vec4 {
        let Some(texture) = texture else { return Vec4::ONE };
        let uvs = self.scene.triangles[hit.triangle].uvs;
        let w = hit.weights;
        self.samplers[texture as usize].at(w.x * uvs[0] + w.y * uvs[1] + w.z * uvs[2])
    }

    /// Radiance that leaves a point towards the side that the triangle's winding makes its front, or the other.
    pub(crate) fn emission(&self, hit: Hit, from_front: bool) -> Vec3 {
        match self.rect(hit.triangle) {
            Some(rect) => {
                if from_front {
                    rect.radiance
                } else {
                    Vec3::ZERO
                }
            }
            None => {
                let material = self.material(hit.triangle);
                if material.emission == Vec3::ZERO {
                    return Vec3::ZERO;
                }
                material.emission * self.texel(material.emission_texture, hit).truncate()
            }
        }
    }

    fn surface(&self, hit: Hit, direction: Vec3) -> Surface {
        let [a, b, c] = self.corners(hit.triangle);
        let w = hit.weights;
        let front = unit_normal([a, b, c]);
        let from_front = front.dot(direction) < 0.0;
        let side = if from_front { 1.0 } else { -1.0 };
        let mut surface = Surface {
            position: w.x * a + w.y * b + w.z * c,
            face: side * front,
            normal: side * front,
            albedo: Vec3::ZERO,
            emission: self.emission(hit, from_front),
            light_density: self.emitters.density(hit.triangle),
        };
        if self.rect(hit.triangle).is_none() {
            surface.albedo = self.color(hit).truncate().min(Vec3::ONE);
            if let Some(n) = self.scene.triangles[hit.triangle].normals {
                let normal = (w.x * n[0] + w.y * n[1] + w.z * n[2]).normalize_or(front);
                // The file's normals may run against the winding; they reflect on the side that is seen.
                surface.normal = if normal.dot(surface.face) < 0.0 { -normal } else { normal };
            }
        }
        surface
    }
}

/// Unit normal by winding; zero without area.
pub(crate) fn unit_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    // In f64: edges of a millimetre make an area near the square of f32's last bit.
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}
