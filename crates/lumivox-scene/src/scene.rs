//! The scene and its parts, as importers make them and renderers read them.

use glam::{Mat4, Vec3, Vec4};
use lumivox_core::Bounds;

use crate::{Animation, ImportReport, Mesh, SkyMap};

/// Everything that is rendered. Indices between the lists are always in range.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Triangle meshes in their own space.
    pub meshes: Vec<Mesh>,
    /// Surface descriptions; at least one if there are meshes.
    pub materials: Vec<Material>,
    /// Decoded images.
    pub textures: Vec<Texture>,
    /// Where meshes stand.
    pub instances: Vec<Instance>,
    /// Lights in world space.
    pub lights: Vec<Light>,
    /// Cameras in world space.
    pub cameras: Vec<Camera>,
    /// Radiance of a constant sky in W/(m2 sr); zero if there is none.
    pub sky: Vec3,
    /// What a gradient or a picture adds to the constant sky.
    pub sky_map: Option<SkyMap>,
    /// What moves, and how.
    pub animation: Animation,
    /// What was left out on the way in.
    pub report: ImportReport,
}

impl Scene {
    /// The world box around all instances; empty for a scene without any.
    pub fn bounds(&self) -> Bounds {
        self.instances.iter().fold(Bounds::EMPTY, |sum, i| {
            let points = self.meshes[i.mesh].positions.iter();
            sum.union(&Bounds::of_points(points.map(|&p| i.world_from_local.transform_point3(p.into()))))
        })
    }

    /// Radiance of the sky in a unit direction, W/(m2 sr).
    pub fn sky_radiance(&self, direction: Vec3) -> Vec3 {
        self.sky + self.sky_map.as_ref().map_or(Vec3::ZERO, |map| map.radiance(direction))
    }

    /// Whether light comes from the sky.
    pub fn has_sky(&self) -> bool {
        self.sky != Vec3::ZERO
            || self.sky_map.as_ref().is_some_and(|m| m.pixels.iter().any(|p| *p != Vec3::ZERO))
    }

    /// The scene with all glass shrunk to nothing: the same meshes and instances by number, but those of glass have a triangle without
    /// area. None if there is no glass.
    pub fn without_glass(&self) -> Option<Self> {
        let is_glass = |mesh: &Mesh| self.materials.get(mesh.material).is_some_and(|m| m.glass.is_some());
        self.meshes.iter().any(is_glass).then(|| {
            let mut rest = self.clone();
            for (mesh, whole) in rest.meshes.iter_mut().zip(&self.meshes) {
                if is_glass(whole) && !whole.indices.is_empty() {
                    mesh.indices = vec![[0; 3]];
                }
            }
            rest
        })
    }

    /// Triangles over all instances.
    pub fn triangle_count(&self) -> u64 {
        self.instances.iter().map(|i| self.meshes[i.mesh].indices.len() as u64).sum()
    }
}

/// One placement of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// The mesh's space to the world; always finite, not always invertible.
    pub world_from_local: Mat4,
}

/// A Lambertian surface that reflects on both sides and may emit.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file; may be empty.
    pub name: String,
    /// Linear albedo (rgb) and opacity (a); multiplies the texture and the vertex colour.
    pub base_color: Vec4,
    /// Index into [`Scene::textures`].
    pub base_color_texture: Option<usize>,
    /// Emitted radiance in W/(m2 sr): factor times strength; multiplies the texture.
    pub emission: Vec3,
    /// Index into [`Scene::textures`].
    pub emission_texture: Option<usize>,
    /// What opacity means.
    pub alpha: AlphaMode,
    /// What it is like if it is seen through; renderers without refraction show the surface.
    pub glass: Option<Glass>,
    /// The part of light, 0 to 1 in each colour, that one surface lets through, if it is a thin absorber such as a leaf.
    pub absorber: Option<Vec3>,
}

/// A material that is seen through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Index of refraction, 1 and up.
    pub ior: f32,
    /// The part of light that [`Self::distance`] metres of it leave, 0 to 1.
    pub color: Vec3,
    /// Metres; infinite for clear glass.
    pub distance: f32,
    /// Roughness of its surface, 0 to 1.
    pub roughness: f32,
    /// Radians by which a metre of it blurs what is behind.
    pub frost: f32,
    /// How strongly it bends light for each metre of thickness, as many times the bend at its first surface; a guess from its size if
    /// there is none.
    pub bend: Option<f32>,
    /// Radiance of what is lost in it, W/(m2 sr).
    pub body: Vec3,
    /// Whether it has no thickness, as a pane.
    pub is_thin: bool,
}

impl Default for Glass {
    /// Clear window glass of some thickness.
    fn default() -> Self {
        Self {
            ior: 1.5,
            color: Vec3::ONE,
            distance: f32::INFINITY,
            roughness: 0.0,
            frost: 0.0,
            bend: None,
            body: Vec3::ZERO,
            is_thin: false,
        }
    }
}

impl Glass {
    /// The part of light that a metre leaves.
    pub fn through_metre(&self) -> Vec3 {
        if self.distance.is_finite() && self.distance > 0.0 {
            self.color.clamp(Vec3::ZERO, Vec3::ONE).powf(1.0 / self.distance)
        } else {
            Vec3::ONE
        }
    }
}

impl Material {
    /// An opaque surface of one linear albedo.
    pub fn matte(name: impl Into<String>, albedo: Vec3) -> Self {
        Self { name: name.into(), base_color: albedo.extend(1.0), ..Self::default() }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            emission: Vec3::ZERO,
            emission_texture: None,
            alpha: AlphaMode::Opaque,
            glass: None,
            absorber: None,
        }
    }
}

/// What a material's opacity means, as in glTF.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Opacity is ignored.
    #[default]
    Opaque,
    /// Fully there where opacity is at least `cutoff`, else not there at all.
    Mask {
        /// Smallest opacity that is kept.
        cutoff: f32,
    },
    /// Mixed with what is behind.
    Blend,
}

/// A decoded image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Name or path in the file; may be empty.
    pub name: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Whether rgb is sRGB-encoded; alpha never is.
    pub srgb: bool,
    /// RGBA8, rows from the top; `4 * width * height` bytes.
    pub pixels: Vec<u8>,
    /// What lies beyond 0..1 in u and v.
    pub wrap: [Wrap; 2],
}

/// How a texture continues beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Tiles.
    #[default]
    Repeat,
    /// Tiles, every other one mirrored.
    Mirror,
    /// The last pixel goes on.
    Clamp,
}

/// A light in world space. Directions are the way the light travels, of unit length; angles are radians from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Parallel light from far away, such as the sun.
    Directional {
        /// Way of the light.
        direction: Vec3,
        /// W/m2 on a surface that faces the light.
        irradiance: Vec3,
    },
    /// The same intensity all round.
    Point {
        /// Where it is.
        position: Vec3,
        /// W/sr.
        intensity: Vec3,
    },
    /// A cone, full inside `beam`, nothing beyond `cutoff`.
    Spot {
        /// Where it is.
        position: Vec3,
        /// Axis of the cone.
        direction: Vec3,
        /// W/sr on the axis.
        intensity: Vec3,
        /// Angle up to which the intensity is full.
        beam: f32,
        /// Angle from which on there is none; larger than `beam`.
        cutoff: f32,
        /// What happens in between.
        falloff: SpotFalloff,
    },
    /// A one-sided parallelogram `origin + s u + t v`, `s, t` in 0..1, that emits along `u x v`.
    Rect {
        /// A corner.
        origin: Vec3,
        /// First edge.
        u: Vec3,
        /// Second edge.
        v: Vec3,
        /// W/(m2 sr).
        radiance: Vec3,
    },
}

/// How a spot fades between beam and cutoff.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpotFalloff {
    /// `(cutoff - angle) / (cutoff - beam)`: the scene file's.
    #[default]
    LinearAngle,
    /// Squared, linear in the cosine: `saturate((cos angle - cos cutoff) / (cos beam - cos cutoff))^2`, that of
    /// `KHR_lights_punctual`.
    Gltf,
}

/// A pinhole camera in world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name in the file; may be empty.
    pub name: String,
    /// Where it is.
    pub eye: Vec3,
    /// What is in the middle of its picture.
    pub target: Vec3,
    /// Roughly up in its picture; never along the viewing direction.
    pub up: Vec3,
    /// Full vertical angle in radians.
    pub fov_y: f32,
}

impl Camera {
    /// A camera with Y up; `fov_y` in degrees.
    pub fn look(name: &str, eye: Vec3, target: Vec3, fov_y_degrees: f32) -> Self {
        Self { name: name.to_owned(), eye, target, up: Vec3::Y, fov_y: fov_y_degrees.to_radians() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_without_glass_has_the_same_numbers() {
        let knot = crate::builtin::knot_glass(0);
        let rest = knot.without_glass().unwrap();
        assert_eq!(rest.instances, knot.instances);
        assert_eq!(rest.triangle_count(), knot.triangle_count() - knot.meshes[0].indices.len() as u64 + 1);
        assert!(rest.without_glass().is_some() && crate::builtin::cornell(0).without_glass().is_none());
        let glass = Glass { color: Vec3::new(0.25, 1.0, 0.5), distance: 0.5, ..Glass::default() };
        assert!((glass.through_metre() - Vec3::new(0.0625, 1.0, 0.25)).abs().max_element() < 1e-6);
        assert_eq!(Glass::default().through_metre(), Vec3::ONE);
    }

    #[test]
    fn bounds_and_count_go_over_instances() {
        let mut scene = Scene::default();
        assert!(scene.bounds().is_empty());
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        scene.meshes.push(Mesh::flat("m", positions, vec![[0, 1, 2]], 0));
        for x in [0.0, 5.0] {
            let world_from_local = Mat4::from_translation(Vec3::new(x, 0.0, 0.0));
            scene.instances.push(Instance { mesh: 0, world_from_local });
        }
        assert_eq!(scene.triangle_count(), 2);
        assert_eq!(scene.bounds(), Bounds::new(Vec3::ZERO, Vec3::new(6.0, 1.0, 0.0)));
    }
}
