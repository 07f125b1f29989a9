//! A volume with its sub-cells from a scene's triangles, for gathered light.
//!
//! Cells have every surface that touches them (`exact`), with area-weighted means of its values; sub-cells, four times as fine, are
//! `thin`: no ray gets through, and nothing stands farther out than half a sub-cell.

use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};
use lumivox::core::{Grid, TriangleView};
use lumivox::progressive::SURFACE_SHIFT;
use lumivox_scene::{AlphaMode, Instance, Scene};
use lumivox_voxels::{
    Channel, Coverage, Format, GridSpec, Material, MaterialOf, MeshView, Model, TextureFn, VoxelizeError,
    VoxelizeOptions, voxelize,
};

use crate::triangles::texel;

/// Sub-cells along an axis of a cell.
const SUBCELLS: u32 = 4;

/// A volume's channels, one entry for each cell, and its sub-cells.
#[derive(Debug)]
pub(crate) struct FineVolume {
    pub(crate) normal: Vec<Vec4>,
    pub(crate) albedo: Vec<Vec4>,
    pub(crate) emission: Vec<Vec4>,
    pub(crate) subcells: Vec<u64>,
}

/// The triangles of one instance in the world, one behind the other.
struct Soup {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
    uvs: Vec<[f32; 2]>,
    colors: Vec<[f32; 4]>,
    material: usize,
}

/// Voxelizes every instance of the scenes.
pub(crate) fn voxelize_scenes(scenes: &[&Scene], grid: &Grid) -> Result<FineVolume, VoxelizeError> {
    let fine_grid = Grid { cell_size: grid.cell_size / SUBCELLS as f32, dims: grid.dims * SUBCELLS, ..*grid };
    let cells = grid.cell_count() as usize;
    let mut volume = FineVolume {
        normal: vec![Vec4::ZERO; cells],
        albedo: vec![Vec4::ZERO; cells],
        emission: vec![Vec4::ZERO; cells],
        subcells: vec![0; cells],
    };
    let shift = SURFACE_SHIFT as f32 * grid.cell_size;
    let soups: Vec<(usize, Vec<Soup>)> = scenes
        .iter()
        .enumerate()
        .map(|(n, scene)| (n, scene.instances.iter().map(|i| soup(scene, i, shift)).collect()))
        .collect();
    let textures: Vec<Vec<Box<TextureFn<'_>>>> = scenes
        .iter()
        .map(|scene| scene.textures.iter().map(|t| Box::new(move |uv: Vec2, _| texel(t, uv)) as _).collect())
        .collect();
    let mut model = Model::default();
    for (n, soups) in &soups {
        let scene = scenes[*n];
        let first = model.materials.len();
        model.materials.extend(scene.materials.iter().map(|m| Material {
            base_color: m.base_color,
            base_color_texture: m.base_color_texture.map(|t| &*textures[*n][t]),
            emission: m.emission,
            emission_texture: m.emission_texture.map(|t| &*textures[*n][t]),
            alpha_cutoff: match m.alpha {
                AlphaMode::Opaque => None,
                AlphaMode::Mask { cutoff } => Some(cutoff),
                AlphaMode::Blend => Some(0.5),
            },
        }));
        model.meshes.extend(soups.iter().map(|soup| MeshView {
            uvs: Some(&soup.uvs),
            colors: Some(&soup.colors),
            material: MaterialOf::Mesh(first + soup.material),
            ..MeshView::new(TriangleView { positions: &soup.positions, indices: &soup.indices })
        }));
    }
    let fine = voxelize(
        &model,
        &VoxelizeOptions {
            grid: GridSpec::Grid(fine_grid),
            coverage: Coverage::Thin,
            ..VoxelizeOptions::default()
        },
    )?;
    for subcell in fine.cells() {
        let place = subcell % SUBCELLS;
        volume.subcells[grid.index(subcell / SUBCELLS)] |=
            1 << (place.x + SUBCELLS * (place.y + SUBCELLS * place.z));
    }
    let channels = vec![
        Channel::normal().unit(false).format(Format::F32),
        Channel::albedo().format(Format::F32),
        Channel::emission().format(Format::F32),
    ];
    let coarse = voxelize(
        &model,
        &VoxelizeOptions { grid: GridSpec::Grid(*grid), channels, ..VoxelizeOptions::default() },
    )?;
    for (cell, slot) in coarse.entries() {
        let (index, Some(slot)) = (grid.index(cell), slot) else { continue };
        let value = |name: &str| coarse.channel(name).map_or(Vec4::ZERO, |c| c.value(slot));
        volume.normal[index] = value("normal").truncate().extend(1.0);
        volume.albedo[index] = value("albedo").truncate().clamp(Vec3::ZERO, Vec3::ONE).extend(0.0);
        volume.emission[index] = value("emission").truncate().extend(0.0);
    }
    Ok(volume)
}

/// The triangles of an instance, moved a little behind the side that they show: a surface on a boundary between cells belongs to
/// the cell behind.
fn soup(scene: &Scene, instance: &Instance, shift: f32) -> Soup {
    let mesh = &scene.meshes[instance.mesh];
    let world_from_local: Mat4 = instance.world_from_local;
    let turn = Mat3::from_mat4(world_from_local);
    let corners = 3 * mesh.indices.len();
    let mut soup = Soup {
        positions: Vec::with_capacity(corners),
        indices: Vec::with_capacity(mesh.indices.len()),
        uvs: Vec::with_capacity(corners),
        colors: Vec::with_capacity(corners),
        material: mesh.material,
    };
    for triangle in &mesh.indices {
        let places = triangle.map(|i| world_from_local.transform_point3(mesh.positions[i as usize].into()));
        let face = (places[1] - places[0]).cross(places[2] - places[0]).normalize_or_zero();
        // The file's normals say which side is meant; the face says how the surface lies.
        let flipped = face.dot(turn * Vec3::from(mesh.normals[triangle[0] as usize])) < 0.0;
        let behind = if flipped { shift * face } else { -shift * face };
        let first = soup.positions.len() as u32;
        // Wound as it is meant, so that the face's normal is that of the visible side.
        let order = if flipped { [0, 2, 1] } else { [0, 1, 2] };
        for corner in order {
            soup.positions.push((places[corner] + behind).to_array());
            soup.uvs.push(mesh.uvs[triangle[corner] as usize]);
            soup.colors.push(mesh.colors[triangle[corner] as usize]);
        }
        soup.indices.push([first, first + 1, first + 2]);
    }
    soup
}
