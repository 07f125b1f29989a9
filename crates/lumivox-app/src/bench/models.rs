//! What is voxelized: the papers' models where `LUMIVOX_ASSETS` names a folder with them, and shapes made by code elsewhere.

use std::path::{Path, PathBuf};

use anyhow::Result;
use glam::{Mat4, Vec3};
use lumivox::core::{Bounds, Grid};
use lumivox::gpu::{Buffer, Gpu};
use lumivox::voxelize::{IndexView, Material, Mesh, MeshDescriptor, VertexView};
use lumivox::wgpu::{self, BufferUsages, IndexFormat, VertexFormat};
use lumivox_core::TriangleView;
use lumivox_scene::Scene;
use lumivox_voxels::{MeshView, Model};

use super::report::Report;

/// A model on both sides.
#[derive(Debug)]
pub(super) struct Subject {
    pub(super) name: String,
    /// The box that grids are fitted to.
    pub(super) bounds: Bounds,
    pub(super) scene: Scene,
    pub(super) meshes: Vec<Mesh>,
}

impl Subject {
    pub(super) fn new(gpu: &Gpu, name: &str, scene: Scene) -> Result<Self> {
        let mut meshes = Vec::new();
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            let upload = |bytes: &[u8]| {
                let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
                let buffer = Buffer::with_usage(gpu, "bench", bytes.len() as u64, usage);
                gpu.queue.write_buffer(&buffer.raw, 0, bytes);
                buffer.raw
            };
            let positions = upload(lumivox::bytemuck::cast_slice(&mesh.positions));
            let normals = upload(lumivox::bytemuck::cast_slice(&mesh.normals));
            let indices = upload(lumivox::bytemuck::cast_slice(&mesh.indices));
            let vertices =
                |buffer| VertexView { buffer, offset: 0, stride: 12, format: VertexFormat::Float32x3 };
            let material = scene.materials.get(mesh.material);
            meshes.push(Mesh::new(
                gpu,
                &MeshDescriptor {
                    indices: Some(IndexView {
                        buffer: &indices,
                        offset: 0,
                        format: IndexFormat::Uint32,
                        count: 3 * mesh.indices.len() as u32,
                    }),
                    normals: Some(vertices(&normals)),
                    world_from_local: instance.world_from_local,
                    material: Material {
                        base_color: material.map_or(glam::Vec4::ONE, |m| m.base_color),
                        ..Material::default()
                    },
                    ..MeshDescriptor::new(vertices(&positions), mesh.positions.len() as u32)
                },
            )?);
        }
        gpu.queue.submit(std::iter::empty::<wgpu::CommandBuffer>());
        Ok(Self { name: name.to_owned(), bounds: scene.bounds(), scene, meshes })
    }

    pub(super) fn grid(&self, side: u32) -> Result<Grid> {
        Ok(Grid::fit(&self.bounds, side)?)
    }

    /// The model as the CPU's voxelizer takes it.
    pub(super) fn model(&self) -> Model<'_> {
        let meshes = self.scene.instances.iter().map(|instance| {
            let mesh = &self.scene.meshes[instance.mesh];
            let triangles = TriangleView { positions: &mesh.positions, indices: &mesh.indices };
            MeshView { world_from_local: instance.world_from_local, ..MeshView::new(triangles) }
        });
        Model { meshes: meshes.collect(), materials: Vec::new() }
    }

    /// The model's name with its triangles.
    pub(super) fn title(&self) -> String {
        format!("{} ({} triangles)", self.name, self.scene.triangle_count())
    }
}

/// The folder of models, if there is one.
pub(super) fn assets() -> Option<PathBuf> {
    std::env::var_os("LUMIVOX_ASSETS").map(PathBuf::from).filter(|folder| folder.is_dir())
}

/// A file of the folder of models. One that is not there is told in the report.
pub(super) fn asset(file: &str, report: &mut Report) -> Option<PathBuf> {
    let found = assets().map(|folder| folder.join(file)).filter(|path| path.is_file());
    if found.is_none() {
        report.say(&format!(
            "**Left out:** `{file}`, which the folder that `LUMIVOX_ASSETS` names does not have."
        ));
        tracing::warn!("{file} is left out: LUMIVOX_ASSETS names no folder that has it");
    }
    found
}

fn loaded(gpu: &Gpu, folder: &Path, name: &str, file: &str) -> Result<Option<Subject>> {
    let path = folder.join(file);
    if !path.is_file() {
        return Ok(None);
    }
    let mut subject = Subject::new(gpu, name, lumivox_scene::load(&path.to_string_lossy())?)?;
    if matches!(name, "Bunny" | "Dragon") {
        // The papers' grids of 53 x 64 x 41 and 64 x 62 x 29 cells are those of boxes that stand on the ground.
        subject.bounds.min.y = 0.0;
    }
    Ok(Some(subject))
}

/// The subjects, the papers' bunny or its stand-in first.
pub(super) fn subjects(gpu: &Gpu, quick: bool) -> Result<Vec<Subject>> {
    let files: &[(&str, &str)] = &[
        ("Bunny", "meshes/bunny.ply"),
        ("Sponza", "scenes/sponza_dabrovic/sponza.glb"),
        ("Dragon", "meshes/dragon.ply"),
        ("Conference", "scenes/conference/conference.ply"),
        ("Kitchen", "scenes/country_kitchen/kitchen.glb"),
    ];
    let wanted = if quick { &files[..2] } else { files };
    let mut subjects = Vec::new();
    if let Some(folder) = assets() {
        for (name, file) in wanted {
            subjects.extend(loaded(gpu, &folder, name, file)?);
        }
    }
    if subjects.first().is_none_or(|first| first.name != "Bunny") {
        subjects.insert(0, Subject::new(gpu, "Bumpy ball", ball(69_451))?);
        subjects.push(Subject::new(gpu, "builtin:atrium", lumivox_scene::builtin::atrium(1))?);
    }
    Ok(subjects)
}

/// Triangles of a ball that become one mesh: no buffer of it may outgrow a binding.
const BAND: u32 = 2_000_000;

/// A bumpy ball of about so many triangles of about one size.
pub(super) fn ball(triangles: u32) -> Scene {
    let rows = ((f64::from(triangles) / 4.0).sqrt() as u32).max(3);
    let columns = 2 * rows;
    let point = |row: u32, column: u32| {
        let latitude = std::f32::consts::PI * row as f32 / rows as f32;
        let longitude = std::f32::consts::TAU * (column % columns) as f32 / columns as f32;
        let direction =
            Vec3::new(latitude.sin() * longitude.cos(), latitude.cos(), latitude.sin() * longitude.sin());
        (direction * (1.0 + 0.07 * (5.0 * longitude).sin() * (7.0 * latitude).sin())).to_array()
    };
    let band = |from: u32, to: u32| {
        let positions = (from..=to).flat_map(|row| (0..columns).map(move |column| point(row, column)));
        let number = |row: u32, column: u32| row * columns + column % columns;
        let indices = (0..to - from).flat_map(|row| {
            (0..columns).flat_map(move |column| {
                let corners = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(r, c)| number(row + r, column + c));
                [[corners[0], corners[1], corners[2]], [corners[1], corners[3], corners[2]]]
            })
        });
        lumivox_scene::Mesh::flat("ball", positions.collect(), indices.collect(), 0)
    };
    let per_band = (BAND / (2 * columns)).max(1);
    let starts = (0..rows).step_by(per_band as usize);
    let meshes: Vec<_> = starts.map(|from| band(from, rows.min(from + per_band))).collect();
    let instance = |mesh| lumivox_scene::Instance { mesh, world_from_local: Mat4::IDENTITY };
    Scene {
        instances: (0..meshes.len()).map(instance).collect(),
        meshes,
        materials: vec![lumivox_scene::Material::matte("ball", Vec3::splat(0.7))],
        ..Scene::default()
    }
}
