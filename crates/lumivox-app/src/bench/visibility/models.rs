//! What is looked at: the papers' models where `LUMIVOX_ASSETS` names a folder with them, else bodies made by code.

use anyhow::{Context, Result};
use glam::{Mat4, Vec3};
use lumivox_field::{Baker, Field, Settings};
use lumivox_scene::{Instance, Material, Mesh, Scene, builtin};

use crate::bench::models::assets;
use crate::clock;
use crate::field::object::Object;

/// A rigid object by its name.
pub(super) struct Model {
    pub(super) name: String,
    pub(super) object: Object,
}

impl Model {
    fn of(name: &str, scene: &Scene) -> Self {
        Self { name: name.to_owned(), object: Object::whole(scene) }
    }

    /// The name with the number of triangles.
    pub(super) fn title(&self) -> String {
        format!("{} ({} triangles)", self.name, self.object.triangles())
    }

    /// Its field, and seconds that the bake took.
    pub(super) fn baked(&self, settings: Settings) -> Result<(Baker, Field, f64)> {
        let baker = Baker::new(self.object.mesh(), settings).with_context(|| self.name.clone())?;
        let start = clock::millis();
        let field = baker.bake(|_| std::ops::ControlFlow::Continue(()))?;
        Ok((baker, field, (clock::millis() - start) / 1e3))
    }
}

/// The models, the papers' bunny or its stand-in first.
pub(super) fn models(quick: bool) -> Result<Vec<Model>> {
    let files: &[(&str, &str)] = &[
        ("Bunny", "bunny.ply"),
        ("Cow", "cow.ply"),
        ("Horse", "horse.ply"),
        ("Elephant", "elephant.ply"),
        ("Dragon", "dragon_res2.ply"),
    ];
    let mut models = Vec::new();
    if let Some(folder) = assets() {
        for (name, file) in if quick { &files[..2] } else { files } {
            let path = folder.join("meshes").join(file);
            if path.is_file() {
                models.push(Model::of(name, &lumivox_scene::load(&path.to_string_lossy())?));
            }
        }
    }
    if models.is_empty() {
        for name in if quick { &["knot", "jack"][..] } else { &["knot", "jack", "stool", "goblet", "arch"] } {
            models.push(body(name, 3)?);
        }
    }
    Ok(models)
}

/// One shape at growing detail: the dragon's scans, or where there are none, a knot.
pub(super) fn detailed(quick: bool) -> Result<Vec<Model>> {
    let files = ["dragon_res4.ply", "dragon_res3.ply", "dragon_res2.ply", "dragon.ply"];
    let paths: Vec<_> =
        assets().iter().flat_map(|folder| files.map(|f| folder.join("meshes").join(f))).collect();
    if paths.is_empty() || !paths.iter().all(|path| path.is_file()) {
        return (0..if quick { 2 } else { 5 }).map(|detail| body("knot", detail)).collect();
    }
    let chosen = &paths[..if quick { 2 } else { 4 }];
    chosen
        .iter()
        .map(|path| Ok(Model::of("Dragon", &lumivox_scene::load(&path.to_string_lossy())?)))
        .collect()
}

/// A body of the built-in scene `falling`.
pub(super) fn body(name: &str, detail: u32) -> Result<Model> {
    let scene = builtin::falling(detail);
    let mesh = scene.meshes.iter().find(|m| m.name == name).context("a body of the built-in scene")?;
    Ok(Model { name: name.to_owned(), object: Object::of_mesh(mesh) })
}

/// A thin rod with a crook, as long as 20 times its thickness.
pub(super) fn cane() -> Model {
    let (around, along) = (24u32, 160u32);
    // Up the rod, then around half a circle.
    let line = |t: f32| {
        let bend = (t - 0.75).max(0.0) / 0.25 * std::f32::consts::PI;
        let straight = Vec3::new(0.0, 3.0 * t.min(0.75) / 0.75 - 2.0, 0.0);
        straight + 0.4 * Vec3::new(1.0 - bend.cos(), bend.sin(), 0.0)
    };
    let point = |i: u32, j: u32| {
        let (t, turn) =
            (i as f32 / along as f32, std::f32::consts::TAU * (j % around) as f32 / around as f32);
        let ahead = (line((t + 0.01).min(1.0)) - line((t - 0.01).max(0.0))).normalize_or(Vec3::Y);
        let side = Vec3::Z;
        (line(t) + 0.1 * (turn.cos() * side + turn.sin() * ahead.cross(side))).to_array()
    };
    let number = |i: u32, j: u32| i * around + j % around;
    let cells = (0..along).flat_map(|i| (0..around).map(move |j| (i, j)));
    let indices = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i, j + 1), number(i + 1, j + 1), number(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    let positions = (0..=along).flat_map(|i| (0..around).map(move |j| point(i, j))).collect();
    let scene = Scene {
        meshes: vec![Mesh::flat("cane", positions, indices.collect(), 0)],
        materials: vec![Material::matte("cane", Vec3::splat(0.7))],
        instances: vec![Instance { mesh: 0, world_from_local: Mat4::IDENTITY }],
        ..Scene::default()
    };
    Model::of("Cane", &scene)
}
