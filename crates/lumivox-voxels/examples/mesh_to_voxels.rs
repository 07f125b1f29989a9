//! A mesh file to a voxel file: `mesh_to_voxels MESH OUTPUT [RESOLUTION]`, for example `bunny.ply bunny.vox 128`.

use std::path::Path;

use lumivox_core::TriangleView;
use lumivox_scene::Scene;
use lumivox_voxels::files::{self, FileFormat};
use lumivox_voxels::{Channel, Material, MaterialOf, MeshView, Model, VoxelizeOptions, voxelize};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let [_, input, output, rest @ ..] = args.as_slice() else {
        return Err("MESH OUTPUT [RESOLUTION]".into());
    };
    let cells = rest.first().map_or(Ok(128), |text| text.parse())?;
    let channels = vec![Channel::albedo(), Channel::normal()];
    let options = VoxelizeOptions { channels, ..VoxelizeOptions::resolution(cells) };
    let volume = voxelize(&model(&lumivox_scene::load(input)?), &options)?;
    let format = FileFormat::of_path(Path::new(output)).ok_or("no such format")?;
    files::write(Path::new(output), format, &volume)?;
    Ok(())
}

/// Meshes where they stand, with the colours of their materials.
fn model(scene: &Scene) -> Model<'_> {
    let meshes = scene.instances.iter().map(|instance| {
        let mesh = &scene.meshes[instance.mesh];
        // Colours of vertices are looked up at every piece of surface; white ones need not be.
        let is_tinted = mesh.colors.iter().any(|color| *color != [1.0; 4]);
        MeshView {
            normals: Some(&mesh.normals),
            uvs: Some(&mesh.uvs),
            colors: is_tinted.then_some(&mesh.colors),
            material: MaterialOf::Mesh(mesh.material),
            world_from_local: instance.world_from_local,
            ..MeshView::new(TriangleView { positions: &mesh.positions, indices: &mesh.indices })
        }
    });
    let materials = scene.materials.iter().map(|material| Material {
        base_color: material.base_color,
        emission: material.emission,
        ..Material::default()
    });
    Model { meshes: meshes.collect(), materials: materials.collect() }
}
