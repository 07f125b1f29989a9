//! glTF 2.0 and GLB.
//!
//! Read: triangles, strips and fans, indexed or not, of any component type, sparse too; node transforms; base colour,
//! emission and alpha of materials; `KHR_materials_transmission`, `_volume` and `_ior` as [`Glass`](crate::Glass), without their textures; vertex colours; perspective cameras; `KHR_lights_punctual`, whose candela and lux
//! are taken as W/sr and W/m2; skins, morph targets and all animations; `KHR_texture_transform`, baked into the texture
//! coordinates. Extensions that are not read are counted and named in a warning.
//!
//! The `gltf` crate parses the JSON and knows the defaults; vertices are read by [`accessor`], which believes nothing.

mod accessor;
mod check;
mod clip;
mod container;
mod material;
mod node;
mod primitive;
mod skin;
mod texture_transform;

use crate::import::guard::fenced;
use crate::import::source::Source;
use crate::mesh::{RawMesh, Shading};
use crate::{Animation, Limits, Material, Scene, SceneError};
use accessor::Reader;
use primitive::Budget;
use skin::Shapes;

/// Reads an asset.
pub(super) fn import(
    source: &Source,
    bytes: &[u8],
    limits: &Limits,
    shading: Shading,
) -> Result<Scene, SceneError> {
    fenced(source.name(), "glTF", || read(source, bytes, limits, shading))
}

fn read(source: &Source, bytes: &[u8], limits: &Limits, shading: Shading) -> Result<Scene, SceneError> {
    let chunks = container::split(source, bytes)?;
    let mut scene = Scene::default();
    let root = check::parse(source, chunks.json, limits, &mut scene.report)?;
    check::check(source, &root, limits, &mut scene.report)?;
    let buffers = container::buffers(source, &root, chunks.bin, limits)?;
    let document = gltf::Document::from_json_without_validation(root.clone());
    let reader = Reader { source, root: &root, buffers: &buffers };

    let uv_sources = material::read(&reader, &document, limits, &mut scene)?;
    let mut budget = Budget::new(source.name(), limits);
    let mut shapes = Shapes::default();
    let mut default_material = None;
    for mesh in &root.meshes {
        let first = scene.meshes.len();
        for primitive in &mesh.primitives {
            let material = match primitive.material {
                Some(m) => m.value(),
                None => *default_material.get_or_insert_with(|| {
                    scene.materials.push(Material::default());
                    scene.materials.len() - 1
                }),
            };
            let uv_source = uv_sources.get(material).copied().unwrap_or_default();
            let name = mesh.name.clone().unwrap_or_default();
            let report = &mut scene.report;
            match primitive::read(&reader, primitive, uv_source, &mut budget, report)? {
                Some(mut primitive) => {
                    primitive.raw = RawMesh { name, material, ..primitive.raw };
                    primitive.raw.check(source.name(), limits)?;
                    let (mesh, deform) = skin::finish(primitive, shading, report);
                    scene.meshes.push(mesh);
                    shapes.deforms.push(deform);
                }
                None => report.skipped_primitives += 1,
            }
        }
        shapes.ranges.push(first..scene.meshes.len());
    }
    let mut tree = node::read(source, &document, limits, &mut scene)?;
    let skins = skin::read(&reader, &tree, limits, &mut scene)?;
    node::place(&reader, &document, &mut tree, &shapes, &skins, &mut budget, &mut scene)?;
    scene.animation.clips = clip::read(&reader, &tree, limits, &mut scene.report)?;
    if !scene.animation.bodies.is_empty() {
        let rest = scene.pose(usize::MAX, 0.0);
        scene.apply(&rest);
    }
    if scene.animation.clips.is_empty() {
        scene.animation = Animation::default();
    }
    Ok(scene)
}

#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod tests;
