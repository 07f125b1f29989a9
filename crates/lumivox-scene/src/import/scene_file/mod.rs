//! `NAME.scene.json`: one file that says what is rendered, for this renderer and others.
//!
//! The format is described in `docs/scene_file.md` and, for programs, in [`SCHEMA`].

mod format;
mod glass;
mod light;
mod motion;
mod place;
mod shape;
mod sky;

use std::collections::HashMap;
use std::ops::Range;

use glam::{Mat4, Vec3};
use lumivox_core::Bounds;

use super::import_meshes;
use super::source::Source;
use super::{DEFAULT_ALBEDO, DEFAULT_MATERIAL, check_extension};
use crate::animation::deform::{Binding, Body, Skin};
use crate::animation::rig::HungInstance;
use crate::mesh::check_limit;
use crate::{AlphaMode, Animation, Instance, Limits, Material, Mesh, Scene, SceneError};
use format::{ClipName, File, LightEntry, LightMotion, MeshEntry};
use motion::Motions;
use shape::{cuboid, quad};

/// The JSON Schema (draft 2020-12) of scene files, for editors and for programs that write them.
pub const SCHEMA: &str = include_str!("../../../scene.schema.json");

/// Reads a scene file and all files that it names.
pub(super) fn import(source: &Source, bytes: &[u8], limits: &Limits) -> Result<Scene, SceneError> {
    let text = std::str::from_utf8(bytes).map_err(|_| source.malformed("is not UTF-8 text"))?;
    // A quarter of a megabyte of brackets is no scene; entries are larger in memory than as text.
    let objects = bytes.iter().filter(|b| **b == b'{').count() as u64;
    check_limit(source.name(), "the number of JSON objects", objects, limits.meshes)?;
    let file: File =
        serde_json::from_str(text).map_err(|e| source.malformed(format!("is no valid scene file: {e}")))?;

    let (scene, motions) = (Scene::default(), Motions::default());
    let mut loader =
        Loader { source, limits, scene, motions, known: HashMap::new(), middles: HashMap::new(), read: 0 };
    if let Some(entry) = &file.camera {
        let camera = light::camera(entry).map_err(|why| source.malformed(format!("has a camera {why}")))?;
        loader.scene.cameras.push(camera);
        if let Some(path) = &entry.path {
            let moved = loader.motions.path(path, &mut loader.scene);
            moved.map_err(|why| source.malformed(format!("has a camera with a path {why}")))?;
        }
    }
    if let Some(entry) = &file.sky {
        let map =
            sky::sky(entry, source, limits).map_err(|why| source.malformed(format!("has a sky {why}")))?;
        loader.scene.sky_map = Some(map);
    }
    for (i, entry) in file.lights.iter().enumerate() {
        loader.light(entry).map_err(|why| source.malformed(format!("has lights[{i}] {why}")))?;
    }
    for (i, entry) in file.meshes.iter().enumerate() {
        loader.mesh(i, entry)?;
    }
    loader.check_motion()?;
    loader.motions.finish(&mut loader.scene);
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

struct Loader<'a> {
    source: &'a Source,
    limits: &'a Limits,
    scene: Scene,
    motions: Motions,
    /// Meshes of files that were read before, by everything that shapes them but their place.
    known: HashMap<String, Vec<Part>>,
    /// The middle of each of them that was asked for.
    middles: HashMap<String, Vec3>,
    /// Bytes of all files so far.
    read: u64,
}

/// One mesh of an entry.
#[derive(Clone, Debug)]
struct Part {
    /// Where it stands within its file.
    instance: Instance,
    /// The node of its file that it hangs on, if its file moves.
    node: Option<usize>,
    node_from_local: Mat4,
}

impl Loader<'_> {
    fn check_motion(&self) -> Result<(), SceneError> {
        check_limit(self.source.name(), "the number of keyframes", self.motions.keys, self.limits.keyframes)
    }

    fn light(&mut self, entry: &LightEntry) -> Result<(), String> {
        if let LightEntry::Constant { radiance } = entry {
            self.scene.sky += amount(*radiance, "radiance")?;
            return Ok(());
        }
        let Some((light, motion, place)) = light::light(entry)? else { return Ok(()) };
        self.scene.lights.push(light);
        if let Some(motion) = motion {
            let LightMotion { keyframes, spin, orbit, .. } = motion;
            if keyframes.is_empty() && spin.is_none() && orbit.is_none() {
                return Err("with a motion that moves nothing".to_owned());
            }
            self.motions.light(self.scene.lights.len() - 1, motion, place, &mut self.scene)?;
        }
        Ok(())
    }

    fn mesh(&mut self, i: usize, entry: &MeshEntry) -> Result<(), SceneError> {
        let fail = |why: String| self.source.malformed(format!("has meshes[{i}] {why}"));
        let placement = place::placement(entry).map_err(fail)?;
        let clip = entry.motion.as_ref().and_then(|m| m.clip.as_ref());
        let key = format!(
            "{:?} {:?} {:?} {} {:?} {:?} {:?} {:?} {} {clip:?}",
            entry.file,
            entry.quad,
            entry.block,
            entry.smooth,
            entry.albedo,
            entry.emission,
            entry.glass,
            entry.absorber,
            entry.close_holes
        );
        let parts = match self.known.get(&key) {
            Some(parts) => parts.clone(),
            None => {
                let first = self.scene.meshes.len();
                let parts = match (&entry.file, entry.quad, &entry.block) {
                    (Some(file), None, None) => self.file(i, file, clip, entry.smooth)?,
                    (None, Some(corners), None) => self.shape(first, quad(&corners).map_err(fail)?),
                    (None, None, Some(block)) => self.shape(first, cuboid(block).map_err(fail)?),
                    _ => return Err(fail("that is not exactly one of file, quad and box".to_owned())),
                };
                self.paint(first..self.scene.meshes.len(), i, entry)
                    .map_err(|why| self.source.malformed(format!("has meshes[{i}] {why}")))?;
                if entry.close_holes {
                    self.close_holes(first);
                }
                self.known.insert(key.clone(), parts.clone());
                parts
            }
        };
        let first = self.scene.instances.len();
        for part in &parts {
            let world_from_local = placement.matrix * part.instance.world_from_local;
            if !world_from_local.is_finite() {
                return Err(self.source.malformed(format!("has meshes[{i}] whose placement is not finite")));
            }
            self.scene.instances.push(Instance { world_from_local, ..part.instance });
        }
        let count = self.scene.instances.len() as u64;
        check_limit(self.source.name(), "the number of instances", count, self.limits.nodes)?;
        if entry.motion.is_some() {
            self.hang(entry, &placement, first, &parts, key)
                .map_err(|why| self.source.malformed(format!("has meshes[{i}] {why}")))?;
        }
        self.check_motion()
    }

    /// Hangs the instances from `first` on, which are the `parts` of an entry, on nodes that move as it says.
    fn hang(
        &mut self,
        entry: &MeshEntry,
        placement: &place::Placement,
        first: usize,
        parts: &[Part],
        key: String,
    ) -> Result<(), String> {
        let motion = entry.motion.as_ref();
        if motion.is_some_and(|m| {
            m.clip.is_none() && m.keyframes.is_empty() && m.spin.is_none() && m.orbit.is_none()
        }) {
            return Err("with a motion that moves nothing".to_owned());
        }
        if entry.file.is_none() && motion.is_some_and(|m| m.clip.is_some()) {
            return Err("with a clip, which only files have".to_owned());
        }
        let middle = *self.middles.entry(key).or_insert_with(|| {
            let around = parts.iter().fold(Bounds::EMPTY, |sum, p| {
                let points = self.scene.meshes[p.instance.mesh].positions.iter();
                let place = p.instance.world_from_local;
                sum.union(&Bounds::of_points(points.map(|&v| place.transform_point3(v.into()))))
            });
            if around.is_empty() { Vec3::ZERO } else { around.center() }
        });
        let outer = self.motions.mesh(motion, placement, middle, &mut self.scene.animation)?;
        for (i, part) in parts.iter().enumerate() {
            let instance = first + i;
            self.scene.animation.instances.push(HungInstance {
                instance,
                outer: Some(outer.0),
                node: part.node,
                node_from_local: part.node_from_local,
                rest: self.scene.instances[instance].world_from_local,
            });
        }
        Ok(())
    }

    fn shape(&mut self, mesh: usize, shape: Mesh) -> Vec<Part> {
        let material = self.scene.materials.len();
        self.scene.materials.push(Material::matte("", Vec3::splat(DEFAULT_ALBEDO)));
        self.scene.meshes.push(Mesh { material, ..shape });
        let instance = Instance { mesh, world_from_local: Mat4::IDENTITY };
        vec![Part { instance, node: None, node_from_local: Mat4::IDENTITY }]
    }

    /// Reads a file's meshes, materials and textures behind those that are there, and the nodes that its clip moves.
    fn file(
        &mut self,
        i: usize,
        file: &str,
        clip: Option<&ClipName>,
        smooth: bool,
    ) -> Result<Vec<Part>, SceneError> {
        let within = |e: SceneError| self.source.malformed(format!("cannot use meshes[{i}]: {e}"));
        check_extension(file).map_err(within)?;
        let beside = self.source.beside(file).map_err(within)?;
        let bytes = beside.read_self(self.limits).map_err(within)?;
        self.read += bytes.len() as u64;
        let total = ("the size of its files in bytes", self.limits.buffer_bytes);
        check_limit(self.source.name(), total.0, self.read, total.1)?;
        let mut other = import_meshes(&beside, &bytes, self.limits, smooth).map_err(within)?;
        drop(bytes);
        let parts = self.animate(&mut other, clip);
        let parts = parts.map_err(|why| self.source.malformed(format!("has meshes[{i}] {why}")))?;
        let scene = &mut self.scene;
        let (materials, textures) = (scene.materials.len(), scene.textures.len());
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
        Ok(parts)
    }

    /// Takes over the nodes of a file, if one of its clips is to be played, and lists its instances as parts.
    fn animate(&mut self, other: &mut Scene, clip: Option<&ClipName>) -> Result<Vec<Part>, String> {
        let meshes = self.scene.meshes.len();
        let mut parts: Vec<Part> = other
            .instances
            .iter()
            .map(|k| Instance { mesh: k.mesh + meshes, ..*k })
            .map(|instance| Part { instance, node: None, node_from_local: instance.world_from_local })
            .collect();
        let Some(clip) = clip else { return Ok(parts) };
        let names: Vec<&str> = other.clips().iter().map(|c| c.name.as_str()).collect();
        let known = match clip {
            ClipName::Number(n) => other.clips().get(*n),
            ClipName::Name(name) => other.clips().iter().find(|c| c.name == *name),
        };
        let Some(known) = known else {
            return Err(format!(
                "whose file has no such clip; it has {} ({})",
                names.len(),
                names.join(", ")
            ));
        };
        let (nodes, skins) = (self.scene.animation.node_count(), self.scene.animation.skins.len());
        self.motions.add_clip(known, nodes);
        let Animation { instances, skins: other_skins, bodies, .. } = &mut other.animation;
        for hung in instances.drain(..) {
            if let Some(part) = parts.get_mut(hung.instance) {
                part.node = hung.node.map(|n| n + nodes);
                part.node_from_local = hung.node_from_local;
            }
        }
        let animation = &mut self.scene.animation;
        animation.skins.extend(
            other_skins
                .drain(..)
                .map(|s| Skin { joints: s.joints.into_iter().map(|j| j + nodes).collect(), ..s }),
        );
        animation.bodies.extend(bodies.drain(..).map(|b| Body {
            mesh: b.mesh + meshes,
            node: b.node + nodes,
            binding: b.binding.map(|k| Binding { skin: k.skin + skins, ..k }),
            ..b
        }));
        animation.append_nodes(&other.animation);
        Ok(parts)
    }

    /// Puts lids on the holes of the meshes from `first` on.
    fn close_holes(&mut self, first: usize) {
        for mesh in self.scene.meshes.iter_mut().skip(first) {
            let left = mesh.close_holes();
            if left > 0 {
                let name = &mesh.name;
                self.scene.report.warn(format!("mesh '{name}': {left} edges stay open after close_holes"));
            }
        }
    }

    /// Applies `albedo`, `emission`, `glass` and `absorber` to the meshes just added.
    fn paint(&mut self, meshes: Range<usize>, i: usize, entry: &MeshEntry) -> Result<(), String> {
        let albedo = entry.albedo.map(|a| amount(a, "albedo")).transpose()?;
        let emission = entry.emission.map(|e| amount(e, "emission")).transpose()?;
        if albedo.is_some_and(|a| a.max_element() > 1.0) {
            return Err("whose albedo is above 1".to_owned());
        }
        let glass = entry.glass.as_ref().map(glass::glass).transpose()?;
        let absorber = entry.absorber.map(|a| amount(a, "absorber")).transpose()?;
        if absorber.is_some_and(|a| a.max_element() > 1.0) {
            return Err("whose absorber is above 1".to_owned());
        }
        if albedo.is_none() && emission.is_none() && glass.is_none() && absorber.is_none() {
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
                if material.name.is_empty() || material.name == DEFAULT_MATERIAL {
                    material.name = format!("meshes[{i}]");
                }
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
                material.glass = glass.or(material.glass);
                material.absorber = absorber.or(material.absorber);
                self.scene.materials.push(material);
                self.scene.materials.len() - 1
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod schema_tests;
#[cfg(test)]
mod tests;
