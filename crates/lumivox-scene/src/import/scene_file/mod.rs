//! `NAME.scene.json`: one file that says what is rendered, for this renderer and others.
//!
//! - `camera`: `eye`, `target`, `up` (Y if absent), `fov_y_deg`.
//! - `lights`: `point`, `directional`, `spot`, `rect`, `constant` (a sky); directions are the way the light travels.
//! - `meshes`: a `file` (path relative to the scene file), a `quad` of four corners or a `box`; each with `albedo` and
//!   `emission`, which replace the file's materials, `scale` (a number or three), `rotate_deg` (about X, then Y, then Z),
//!   `translate`, applied in this order, and `smooth`. Of a file only the geometry and materials are taken: cameras and
//!   lights are those that the scene file lists.

mod format;

use std::collections::HashMap;
use std::ops::Range;

use glam::{EulerRot, Mat4, Quat, Vec3, Vec4};

use super::import_meshes;
use super::source::Source;
use super::{DEFAULT_ALBEDO, check_extension};
use crate::mesh::check_limit;
use crate::{AlphaMode, Camera, Instance, Light, Limits, Material, Mesh, Scene, SceneError, SpotFalloff};
use format::{BoxEntry, CameraEntry, File, LightEntry, MeshEntry, Scale};

/// Reads a scene file and all files that it names.
pub(super) fn import(source: &Source, bytes: &[u8], limits: &Limits) -> Result<Scene, SceneError> {
    let text = std::str::from_utf8(bytes).map_err(|_| source.malformed("is not UTF-8 text"))?;
    // A quarter of a megabyte of brackets is no scene; entries are larger in memory than as text.
    let objects = bytes.iter().filter(|b| **b == b'{').count() as u64;
    check_limit(source.name(), "the number of JSON objects", objects, limits.meshes)?;
    let file: File =
        serde_json::from_str(text).map_err(|e| source.malformed(format!("is no valid scene file: {e}")))?;

    let mut loader = Loader { source, limits, scene: Scene::default(), known: HashMap::new(), read: 0 };
    if let Some(entry) = &file.camera {
        let camera = camera(entry).map_err(|why| source.malformed(format!("has a camera {why}")))?;
        loader.scene.cameras.push(camera);
    }
    for (i, entry) in file.lights.iter().enumerate() {
        loader.light(entry).map_err(|why| source.malformed(format!("has lights[{i}] {why}")))?;
    }
    for (i, entry) in file.meshes.iter().enumerate() {
        loader.mesh(i, entry)?;
    }
    Ok(loader.scene)
}

/// A vector whose numbers are finite; JSON can state larger ones than fit.
fn vector(v: [f32; 3], name: &str) -> Result<Vec3, String> {
    let v = Vec3::from(v);
    if v.is_finite() { Ok(v) } else { Err(format!("whose {name} is not finite")) }
}

/// A colour or amount of light: finite and not negative.
fn amount(v: [f32; 3], name: &str) -> Result<Vec3, String> {
    let v = vector(v, name)?;
    if v.min_element() >= 0.0 { Ok(v) } else { Err(format!("whose {name} is negative")) }
}

fn unit(v: [f32; 3], name: &str) -> Result<Vec3, String> {
    vector(v, name)?.try_normalize().ok_or_else(|| format!("whose {name} has no length"))
}

fn camera(entry: &CameraEntry) -> Result<Camera, String> {
    let (eye, target) = (vector(entry.eye, "eye")?, vector(entry.target, "target")?);
    let ahead = unit((target - eye).to_array(), "distance from eye to target")?;
    let up = unit(entry.up, "up")?;
    if ahead.cross(up).length() < 1e-4 {
        return Err("that looks along its up".to_owned());
    }
    if !(entry.fov_y_deg > 0.0 && entry.fov_y_deg < 180.0) {
        return Err(format!("whose fov_y_deg is {}, not between 0 and 180", entry.fov_y_deg));
    }
    Ok(Camera { name: "camera".to_owned(), eye, target, up, fov_y: entry.fov_y_deg.to_radians() })
}

struct Loader<'a> {
    source: &'a Source,
    limits: &'a Limits,
    scene: Scene,
    /// Meshes of files that were read before, by everything that shapes them but their place.
    known: HashMap<String, Vec<Instance>>,
    /// Bytes of all files so far.
    read: u64,
}

impl Loader<'_> {
    fn light(&mut self, entry: &LightEntry) -> Result<(), String> {
        let light = match *entry {
            LightEntry::Constant { radiance } => {
                self.scene.sky += amount(radiance, "radiance")?;
                return Ok(());
            }
            LightEntry::Point { position, intensity } => Light::Point {
                position: vector(position, "position")?,
                intensity: amount(intensity, "intensity")?,
            },
            LightEntry::Directional { direction, irradiance } => Light::Directional {
                direction: unit(direction, "direction")?,
                irradiance: amount(irradiance, "irradiance")?,
            },
            LightEntry::Spot { position, target, intensity, cutoff_deg, beam_deg } => {
                let position = vector(position, "position")?;
                let direction =
                    unit((vector(target, "target")? - position).to_array(), "distance to its target")?;
                let beam_deg = beam_deg.unwrap_or(0.75 * cutoff_deg);
                if !(cutoff_deg > 0.0 && cutoff_deg <= 180.0 && beam_deg >= 0.0 && beam_deg <= cutoff_deg) {
                    return Err("whose angles are not 0 <= beam_deg <= cutoff_deg <= 180".to_owned());
                }
                let cutoff = cutoff_deg.to_radians();
                // A hard edge keeps a sliver of falloff, so that its quotient stays defined.
                let beam = beam_deg.to_radians().min(0.999 * cutoff);
                let intensity = amount(intensity, "intensity")?;
                Light::Spot {
                    position,
                    direction,
                    intensity,
                    beam,
                    cutoff,
                    falloff: SpotFalloff::LinearAngle,
                }
            }
            LightEntry::Rect { origin, u, v, radiance } => {
                let (u, v) = (vector(u, "u")?, vector(v, "v")?);
                if u.cross(v) == Vec3::ZERO {
                    return Err("without an area".to_owned());
                }
                let radiance = amount(radiance, "radiance")?;
                Light::Rect { origin: vector(origin, "origin")?, u, v, radiance }
            }
        };
        self.scene.lights.push(light);
        Ok(())
    }

    fn mesh(&mut self, i: usize, entry: &MeshEntry) -> Result<(), SceneError> {
        let fail = |why: String| self.source.malformed(format!("has meshes[{i}] {why}"));
        let placed = placement(entry).map_err(fail)?;
        let key = format!(
            "{:?} {:?} {:?} {} {:?} {:?}",
            entry.file, entry.quad, entry.block, entry.smooth, entry.albedo, entry.emission
        );
        let instances = match self.known.get(&key) {
            Some(instances) => instances.clone(),
            None => {
                let first = self.scene.meshes.len();
                let instances = match (&entry.file, entry.quad, &entry.block) {
                    (Some(file), None, None) => self.file(i, file, entry)?,
                    (None, Some(corners), None) => self.shape(first, quad(&corners).map_err(fail)?),
                    (None, None, Some(block)) => self.shape(first, cuboid(block).map_err(fail)?),
                    _ => return Err(fail("that is not exactly one of file, quad and box".to_owned())),
                };
                self.paint(first..self.scene.meshes.len(), entry)
                    .map_err(|why| self.source.malformed(format!("has meshes[{i}] {why}")))?;
                self.known.insert(key, instances.clone());
                instances
            }
        };
        for instance in instances {
            let world_from_local = placed * instance.world_from_local;
            if !world_from_local.is_finite() {
                return Err(self.source.malformed(format!("has meshes[{i}] whose placement is not finite")));
            }
            self.scene.instances.push(Instance { world_from_local, ..instance });
        }
        let count = self.scene.instances.len() as u64;
        check_limit(self.source.name(), "the number of instances", count, self.limits.nodes)
    }

    fn shape(&mut self, mesh: usize, shape: Mesh) -> Vec<Instance> {
        let material = self.scene.materials.len();
        self.scene.materials.push(Material::matte("", Vec3::splat(DEFAULT_ALBEDO)));
        self.scene.meshes.push(Mesh { material, ..shape });
        vec![Instance { mesh, world_from_local: Mat4::IDENTITY }]
    }

    /// Reads a file's meshes, materials and textures behind those that are there; returns its instances.
    fn file(&mut self, i: usize, file: &str, entry: &MeshEntry) -> Result<Vec<Instance>, SceneError> {
        let within = |e: SceneError| self.source.malformed(format!("cannot use meshes[{i}]: {e}"));
        check_extension(file).map_err(within)?;
        let beside = self.source.beside(file).map_err(within)?;
        let bytes = beside.read_self(self.limits).map_err(within)?;
        self.read += bytes.len() as u64;
        let total = ("the size of its files in bytes", self.limits.buffer_bytes);
        check_limit(self.source.name(), total.0, self.read, total.1)?;
        let other = import_meshes(&beside, &bytes, self.limits, entry.smooth).map_err(within)?;
        drop(bytes);
        let scene = &mut self.scene;
        let (meshes, materials, textures) = (scene.meshes.len(), scene.materials.len(), scene.textures.len());
        scene.meshes.extend(other.meshes.into_iter().map(|m| Mesh { material: m.material + materials, ..m }));
        scene.materials.extend(other.materials.into_iter().map(|m| Material {
            base_color_texture: m.base_color_texture.map(|t| t + textures),
            emission_texture: m.emission_texture.map(|t| t + textures),
            ..m
        }));
        scene.textures.extend(other.textures);
        scene.report.merge(other.report);
        let triangles = scene.meshes.iter().map(|m| m.indices.len() as u64).sum();
        check_limit(self.source.name(), "the number of triangles", triangles, self.limits.triangles)?;
        let pixels = scene.textures.iter().map(|t| u64::from(t.width) * u64::from(t.height)).sum();
        check_limit(self.source.name(), "the number of texture pixels", pixels, self.limits.texture_pixels)?;
        Ok(other.instances.into_iter().map(|k| Instance { mesh: k.mesh + meshes, ..k }).collect())
    }

    /// Applies `albedo` and `emission` to the meshes just added.
    fn paint(&mut self, meshes: Range<usize>, entry: &MeshEntry) -> Result<(), String> {
        let albedo = entry.albedo.map(|a| amount(a, "albedo")).transpose()?;
        let emission = entry.emission.map(|e| amount(e, "emission")).transpose()?;
        if albedo.is_some_and(|a| a.max_element() > 1.0) {
            return Err("whose albedo is above 1".to_owned());
        }
        if albedo.is_none() && emission.is_none() {
            return Ok(());
        }
        let mut painted = HashMap::new();
        for mesh in &mut self.scene.meshes[meshes] {
            let before = mesh.material;
            if albedo.is_some() {
                mesh.colors.fill([1.0; 4]);
            }
            mesh.material = *painted.entry(before).or_insert_with(|| {
                let mut material = self.scene.materials[before].clone();
                if let Some(albedo) = albedo {
                    material.base_color = albedo.extend(1.0);
                    material.base_color_texture = None;
                    material.alpha = AlphaMode::Opaque;
                    material.emission = Vec3::ZERO;
                    material.emission_texture = None;
                }
                if let Some(emission) = emission {
                    material.emission = emission;
                    material.emission_texture = None;
                }
                self.scene.materials.push(material);
                self.scene.materials.len() - 1
            });
        }
        Ok(())
    }
}

fn placement(entry: &MeshEntry) -> Result<Mat4, String> {
    let scale = match entry.scale {
        None => Vec3::ONE,
        Some(Scale::Uniform(s)) => vector([s; 3], "scale")?,
        Some(Scale::PerAxis(s)) => vector(s, "scale")?,
    };
    let turn = vector(entry.rotate_deg.unwrap_or_default(), "rotate_deg")?;
    let [x, y, z] = turn.to_array().map(f32::to_radians);
    // Z after Y after X, each about the fixed axes.
    let rotation = Quat::from_euler(EulerRot::ZYX, z, y, x);
    let translation = vector(entry.translate.unwrap_or_default(), "translate")?;
    Ok(Mat4::from_scale_rotation_translation(scale, rotation, translation))
}

fn quad(corners: &[[f32; 3]; 4]) -> Result<Mesh, String> {
    for c in corners {
        vector(*c, "quad")?;
    }
    let mut mesh = Mesh::flat("quad", corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], 0);
    let uvs = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    mesh.uvs = [0, 1, 2, 0, 2, 3].map(|i: usize| uvs[i]).to_vec();
    Ok(mesh)
}

fn cuboid(entry: &BoxEntry) -> Result<Mesh, String> {
    let center = vector(entry.center, "center")?;
    let size = amount(entry.size, "size")?;
    let turn = vector([0.0, entry.rot_y_deg, 0.0], "rot_y_deg")?.y.to_radians();
    let turned = Mat4::from_rotation_translation(Quat::from_rotation_y(turn), center);
    let corner = |i: u32| {
        let side = Vec4::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32, 0.0) - 0.5;
        turned.transform_point3(side.truncate() * size).to_array()
    };
    // Counterclockwise from outside: -x, +x, -y, +y, -z, +z.
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Ok(Mesh::flat("box", (0..8).map(corner).collect(), triangles, 0))
}

#[cfg(test)]
mod tests;
