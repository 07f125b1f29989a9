//! What the path tracer renders: plain triangles, materials, lights and a camera.
//!
//! Lights are radiometric: W/sr for point and spot, W/m2 (on a surface that faces it) for directional, W/(m2 sr) for
//! emission, rectangles and the sky. Directions are the way the light travels.

use glam::{Vec2, Vec3, Vec4};

/// Everything that is rendered.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Surfaces in world space.
    pub triangles: Vec<Triangle>,
    /// What [`Triangle::material`] points into.
    pub materials: Vec<Material>,
    /// What materials point into.
    pub textures: Vec<Texture>,
    /// All lights; emissive materials are lights too.
    pub lights: Vec<Light>,
    /// A sky that is not the same everywhere; adds to constant lights.
    pub environment: Option<Environment>,
}

/// Radiance from all directions in W/(m2 sr): a latitude-longitude picture, row 0 around +y, its middle towards -z and
/// what is right of the middle towards +x.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row.
    pub pixels: Vec<Vec3>,
}

impl Environment {
    /// Interpolated between the middles of pixels, around the vertical without a seam.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let longitude = direction.x.atan2(-direction.z);
        let colatitude = direction.y.clamp(-1.0, 1.0).acos();
        let x = (longitude / std::f32::consts::TAU + 0.5) * self.width as f32 - 0.5;
        let y = (colatitude / std::f32::consts::PI * self.height as f32 - 0.5)
            .clamp(0.0, (self.height - 1) as f32);
        let column = |offset: i64| (x.floor() as i64 + offset).rem_euclid(i64::from(self.width)) as usize;
        let row = |offset: u32| (y as u32 + offset).min(self.height - 1) as usize;
        let mut sum = Vec3::ZERO;
        for (i, across) in [(0, 1.0 - (x - x.floor())), (1, x - x.floor())] {
            for (j, down) in [(0, 1.0 - y.fract()), (1, y.fract())] {
                sum += across * down * self.pixels[row(j) * self.width as usize + column(i)];
            }
        }
        sum
    }
}

/// A triangle in world space.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Corners in metres.
    pub positions: [Vec3; 3],
    /// Normals at the corners that light is reflected with; `None`: the face's.
    pub normals: Option<[Vec3; 3]>,
    /// Texture coordinates at the corners, v downwards from the texture's top row.
    pub uvs: [Vec2; 3],
    /// Linear colour and opacity at the corners; multiply the material's.
    pub colors: [Vec4; 3],
    /// Index into [`Scene::materials`].
    pub material: u32,
}

impl Triangle {
    /// A white triangle with its face's normal and no texture coordinates.
    pub fn flat(positions: [Vec3; 3], material: u32) -> Self {
        Self { positions, normals: None, uvs: [Vec2::ZERO; 3], colors: [Vec4::ONE; 3], material }
    }
}

/// A Lambertian surface that reflects and emits on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Reflectance (rgb) and opacity (a), linear; multiply the texture.
    pub albedo: Vec4,
    /// Index into [`Scene::textures`].
    pub albedo_texture: Option<u32>,
    /// The surface is there only where opacity is at least this; `None`: everywhere.
    pub alpha_cutoff: Option<f32>,
    /// Emitted radiance on both sides in W/(m2 sr); multiplies the texture.
    pub emission: Vec3,
    /// Index into [`Scene::textures`].
    pub emission_texture: Option<u32>,
}

impl Material {
    /// A surface of one reflectance.
    pub fn matte(albedo: Vec3) -> Self {
        Self {
            albedo: albedo.extend(1.0),
            albedo_texture: None,
            alpha_cutoff: None,
            emission: Vec3::ZERO,
            emission_texture: None,
        }
    }
}

/// An RGBA8 image, looked up with bilinear filtering of linear values and without mip levels.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Whether rgb is sRGB-encoded; alpha never is.
    pub srgb: bool,
    /// `4 * width * height` bytes, rows from the top.
    pub pixels: Vec<u8>,
    /// How it continues beyond 0..1 in u and v.
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

/// A light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Parallel light.
    Directional {
        /// Way of the light, any length.
        direction: Vec3,
        /// W/m2 on a surface that faces it.
        irradiance: Vec3,
    },
    /// The same intensity all round.
    Point {
        /// Where it is.
        position: Vec3,
        /// W/sr.
        intensity: Vec3,
    },
    /// A cone.
    Spot {
        /// Where it is.
        position: Vec3,
        /// Axis, any length.
        direction: Vec3,
        /// W/sr on the axis.
        intensity: Vec3,
        /// How the intensity falls with the angle.
        falloff: SpotFalloff,
    },
    /// The parallelogram `origin + s u + t v`, `s, t` in 0..1: emits along `u x v` only, blocks light on both sides as
    /// black geometry does, and is not seen by the camera.
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
    /// A sky that is the same in all directions. Several add up.
    Constant {
        /// W/(m2 sr).
        radiance: Vec3,
    },
}

/// How a spot fades; angles in radians from its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpotFalloff {
    /// Full inside `beam`, then linear in the angle to zero at `cutoff`.
    LinearAngle {
        /// Up to here full.
        beam: f32,
        /// From here on nothing.
        cutoff: f32,
    },
    /// `saturate((cos angle - cos outer) / (cos inner - cos outer))^2`, as `KHR_lights_punctual`.
    Gltf {
        /// Up to here full.
        inner: f32,
        /// From here on nothing.
        outer: f32,
    },
}

impl SpotFalloff {
    /// Share of the intensity, 0..=1, where the cosine of the angle from the axis is `cos_angle`.
    pub fn at(&self, cos_angle: f32) -> f32 {
        let ramp = |value: f32, zero: f32, one: f32| {
            if value >= one { 1.0 } else { ((value - zero) / (one - zero)).clamp(0.0, 1.0) }
        };
        match *self {
            Self::LinearAngle { beam, cutoff } => ramp(-cos_angle.clamp(-1.0, 1.0).acos(), -cutoff, -beam),
            Self::Gltf { inner, outer } => ramp(cos_angle, outer.cos(), inner.cos()).powi(2),
        }
    }
}

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it is.
    pub eye: Vec3,
    /// What is in the middle of its picture.
    pub target: Vec3,
    /// Roughly up in its picture.
    pub up: Vec3,
    /// Full vertical angle in radians.
    pub fov_y: f32,
}

/// What makes a scene or a camera unusable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// A triangle points to a material that is not there.
    #[error("triangle {triangle} uses material {material} of {count}")]
    NoSuchMaterial {
        /// Which triangle.
        triangle: usize,
        /// Its material.
        material: u32,
        /// Materials there are.
        count: usize,
    },
    /// A material points to a texture that is not there.
    #[error("material {material} uses texture {texture} of {count}")]
    NoSuchTexture {
        /// Which material.
        material: usize,
        /// Its texture.
        texture: u32,
        /// Textures there are.
        count: usize,
    },
    /// A texture has no pixels, or not as many bytes as its size says.
    #[error("texture {0} has the wrong number of bytes for its size")]
    BadTexture(usize),
    /// A coordinate, colour or amount is not finite, or an amount is negative.
    #[error("{what} {index} has a value that is not finite or is negative")]
    BadValue {
        /// Kind of thing.
        what: &'static str,
        /// Which of them.
        index: usize,
    },
    /// A reflectance above one would make light out of nothing.
    #[error("material {0} reflects more light than it gets")]
    AlbedoAboveOne(usize),
    /// The camera has no direction, no angle or a value that is not finite.
    #[error("the camera needs an eye apart from its target and an angle between 0 and 180 degrees")]
    BadCamera,
    /// The environment has no pixels, too few, or some that are negative or not finite.
    #[error("the environment needs width x height pixels that are finite and not negative")]
    BadEnvironment,
    /// The picture has no pixels or no samples.
    #[error("a picture needs at least one pixel and one sample")]
    EmptyPicture,
}

impl Scene {
    /// Checks that indices are in range and numbers are finite.
    ///
    /// # Errors
    /// What is wrong first.
    pub fn check(&self) -> Result<(), SceneError> {
        for (index, texture) in self.textures.iter().enumerate() {
            let bytes = 4 * texture.width as usize * texture.height as usize;
            if bytes == 0 || texture.pixels.len() != bytes {
                return Err(SceneError::BadTexture(index));
            }
        }
        for (index, m) in self.materials.iter().enumerate() {
            let count = self.textures.len();
            for texture in [m.albedo_texture, m.emission_texture].into_iter().flatten() {
                if texture as usize >= count {
                    return Err(SceneError::NoSuchTexture { material: index, texture, count });
                }
            }
            check_amount("material", index, m.albedo.truncate())?;
            check_amount("material", index, m.emission)?;
            if m.albedo.truncate().max_element() > 1.0 {
                return Err(SceneError::AlbedoAboveOne(index));
            }
        }
        for (index, t) in self.triangles.iter().enumerate() {
            let count = self.materials.len();
            if t.material as usize >= count {
                return Err(SceneError::NoSuchMaterial { triangle: index, material: t.material, count });
            }
            let bad = |_| SceneError::BadValue { what: "triangle", index };
            let finite = t.positions.iter().chain(t.normals.iter().flatten()).all(|p| p.is_finite());
            let colors = t.colors.iter().all(|c| c.is_finite() && c.min_element() >= 0.0);
            (finite && colors && t.uvs.iter().all(|uv| uv.is_finite()))
                .then_some(())
                .ok_or(())
                .map_err(bad)?;
        }
        for (index, light) in self.lights.iter().enumerate() {
            let (places, amount): (&[Vec3], Vec3) = match light {
                Light::Directional { direction, irradiance } => (&[*direction], *irradiance),
                Light::Point { position, intensity } => (&[*position], *intensity),
                Light::Spot { position, direction, intensity, .. } => (&[*position, *direction], *intensity),
                Light::Rect { origin, u, v, radiance } => (&[*origin, *u, *v], *radiance),
                Light::Constant { radiance } => (&[], *radiance),
            };
            check_amount("light", index, amount)?;
            if !places.iter().all(|p| p.is_finite()) {
                return Err(SceneError::BadValue { what: "light", index });
            }
        }
        if let Some(Environment { width, height, pixels }) = &self.environment {
            let count = *width as usize * *height as usize;
            if count == 0
                || pixels.len() != count
                || pixels.iter().any(|p| !p.is_finite() || p.min_element() < 0.0)
            {
                return Err(SceneError::BadEnvironment);
            }
        }
        Ok(())
    }
}

fn check_amount(what: &'static str, index: usize, amount: Vec3) -> Result<(), SceneError> {
    let good = amount.is_finite() && amount.min_element() >= 0.0;
    good.then_some(()).ok_or(SceneError::BadValue { what, index })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spots_are_full_inside_and_dark_outside_with_half_between() {
        let (beam, cutoff) = (0.3f32, 0.5f32);
        let linear = SpotFalloff::LinearAngle { beam, cutoff };
        for (angle, share) in [(0.0, 1.0), (0.29, 1.0), (0.4, 0.5), (0.45, 0.25), (0.51, 0.0), (3.0, 0.0)] {
            assert!((linear.at(f32::cos(angle)) - share).abs() < 1e-5, "{angle}");
        }
        let gltf = SpotFalloff::Gltf { inner: beam, outer: cutoff };
        let middle = 0.5 * (beam.cos() + cutoff.cos());
        assert!((gltf.at(middle) - 0.25).abs() < 1e-5);
        assert_eq!((gltf.at(1.0), gltf.at(0.0)), (1.0, 0.0));
        let hard = SpotFalloff::LinearAngle { beam: 0.5, cutoff: 0.5 };
        assert_eq!((hard.at(f32::cos(0.49)), hard.at(f32::cos(0.51))), (1.0, 0.0));
    }

    #[test]
    fn refuses_what_points_nowhere_or_is_no_number() {
        let mut scene = Scene::default();
        scene.triangles.push(Triangle::flat([Vec3::ZERO, Vec3::X, Vec3::Y], 0));
        assert!(matches!(scene.check(), Err(SceneError::NoSuchMaterial { .. })));
        scene.materials.push(Material::matte(Vec3::splat(0.5)));
        assert_eq!(scene.check(), Ok(()));
        scene.materials[0].albedo_texture = Some(0);
        assert!(matches!(scene.check(), Err(SceneError::NoSuchTexture { .. })));
        scene.materials[0] = Material::matte(Vec3::splat(1.5));
        assert_eq!(scene.check(), Err(SceneError::AlbedoAboveOne(0)));
        scene.materials[0] = Material::matte(Vec3::ONE);
        scene.lights.push(Light::Point { position: Vec3::NAN, intensity: Vec3::ONE });
        assert_eq!(scene.check(), Err(SceneError::BadValue { what: "light", index: 0 }));
    }
}
