//! The fields of a scene's objects, for pictures.

use std::ops::ControlFlow;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use lumivox_field::{Baker, Cache, Field, Part, Settings};
use lumivox_render::{Caster, ObjectFields};
use lumivox_scene::Scene;

use super::object::Object;
use crate::render;

/// The most spheres of one object, unless said otherwise.
pub(crate) const MOST_PARTS: usize = 8;

/// Bakes a field for each mesh that casts, or takes it from the cache; elongated ones are cut into parts with a field each.
///
/// Without names these are the meshes of instances that move rigidly; with names, those whose name begins with one of them.
pub(crate) fn fields(scene: &Scene, names: &[String], settings: Settings) -> Result<ObjectFields> {
    let instances = chosen(scene, names)?;
    let mut meshes: Vec<usize> = instances.iter().map(|&i| scene.instances[i].mesh).collect();
    meshes.sort_unstable();
    meshes.dedup();
    let (mut objects, mut keys) = (Vec::new(), Vec::new());
    // Of each mesh, its object.
    let mut number_of = Vec::new();
    for &mesh in &meshes {
        let object = Object::of_mesh(&scene.meshes[mesh]);
        // Copies of a mesh share the fields of the first.
        let key = object.mesh().key();
        if let Some(first) = keys.iter().position(|known| *known == key) {
            number_of.push(first);
            continue;
        }
        number_of.push(keys.len());
        keys.push(key);
        let named = || format!("the mesh {:?}", scene.meshes[mesh].name);
        objects.push(lumivox_field::parts(&object.mesh(), MOST_PARTS).with_context(named)?);
    }
    let count: usize = objects.iter().map(Vec::len).sum();
    let bar = render::progress(u64::from(settings.points) * count as u64, "visibility fields");
    let (mut fields, mut of_object) = (Vec::new(), Vec::new());
    for parts in &objects {
        let first = fields.len();
        for part in parts {
            let done = u64::from(settings.points) * fields.len() as u64;
            let field = field(part, settings, |maps| bar.set_position(done + u64::from(maps)))?;
            fields.push(field.packed().context("the field does not fit a texture")?);
        }
        of_object.push((first..fields.len()).collect::<Vec<_>>());
    }
    bar.finish_and_clear();
    let of =
        |mesh: usize| meshes.binary_search(&mesh).map_or(Vec::new(), |n| of_object[number_of[n]].clone());
    let caster = |&instance: &usize| Caster { instance, fields: of(scene.instances[instance].mesh) };
    Ok(ObjectFields { fields, casters: instances.iter().map(caster).collect() })
}

/// The instances that have fields.
fn chosen(scene: &Scene, names: &[String]) -> Result<Vec<usize>> {
    let name = |instance: usize| scene.meshes[scene.instances[instance].mesh].name.as_str();
    if names.is_empty() {
        let moving = scene.rigid_instances();
        if moving.is_empty() {
            bail!(
                "nothing in the scene moves rigidly; say with --casters which meshes have visibility fields"
            );
        }
        return Ok(moving);
    }
    let all = 0..scene.instances.len();
    for wanted in names {
        if wanted.is_empty() {
            bail!("--casters has an empty name");
        }
        if !all.clone().any(|i| name(i).starts_with(wanted.as_str())) {
            let mut known: Vec<&str> = all.clone().map(name).collect();
            known.sort_unstable();
            known.dedup();
            known.truncate(40);
            bail!("there is no mesh {wanted:?} for --casters; known are {}", known.join(", "));
        }
    }
    Ok(all.filter(|&i| names.iter().any(|wanted| name(i).starts_with(wanted.as_str()))).collect())
}

/// From the cache, if there is a folder for one.
fn field(part: &Part, settings: Settings, mut show: impl FnMut(u32)) -> Result<Field> {
    let observe = |progress: lumivox_field::Progress| {
        show(progress.maps_done);
        ControlFlow::Continue(())
    };
    Ok(match cache_folder() {
        Some(folder) => Cache::new(folder).field(part.mesh(), settings, observe)?.field,
        None => Baker::new(part.mesh(), settings)?.bake(observe)?,
    })
}

/// Where fields are kept: `LUMIVOX_CACHE`, else the user's folder for caches.
fn cache_folder() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let user = || folder("XDG_CACHE_HOME").or_else(|| folder("HOME").map(|home| home.join(".cache")));
    folder("LUMIVOX_CACHE").or_else(|| user().map(|cache| cache.join("lumivox"))).map(|f| f.join("fields"))
}
