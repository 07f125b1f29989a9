//! A volume from a scene's triangles, on the CPU: for stills, where every surface should count, seen or not.
//!
//! Each triangle is cut into small ones of less than half a cell, sampled in their middles, so that the cells it passes through get at least
//! one sample, and cells take the area-weighted means of what falls in. Coverage is *sampled*: all marked cells overlap
//! the surface, and a corner that a triangle only just cuts may stay empty. A surface on a cell boundary marks the cell
//! behind its normal, as a view of that side would.

use glam::{Mat3, Vec2, Vec3, Vec4};
use lumivox::core::Grid;
use lumivox::progressive::SURFACE_SHIFT;
use lumivox_scene::{AlphaMode, Material, Mesh, Scene, Texture, Wrap};

/// Lattice steps per cell along the longest edge.
const SAMPLES_PER_CELL: f32 = 2.5;
/// No triangle gets a finer lattice than this; a grid has at most 2048 cells a side.
const MAX_STEPS: u32 = 8192;

/// Channels of a volume, one entry per cell.
#[derive(Debug)]
pub struct TriangleVolume {
    /// Mean normal and occupancy.
    pub normal: Vec<Vec4>,
    /// Mean reflectance.
    pub albedo: Vec<Vec4>,
    /// Mean emitted radiance.
    pub emission: Vec<Vec4>,
}

/// Voxelizes every instance of the scenes.
pub fn voxelize(scenes: &[&Scene], grid: &Grid) -> TriangleVolume {
    let cells = grid.cell_count() as usize;
    let mut volume = TriangleVolume {
        normal: vec![Vec4::ZERO; cells],
        albedo: vec![Vec4::ZERO; cells],
        emission: vec![Vec4::ZERO; cells],
    };
    for (scene, instance) in scenes.iter().flat_map(|s| s.instances.iter().map(move |i| (*s, i))) {
        let mesh = &scene.meshes[instance.mesh];
        let surface = Surface { scene, mesh, material: &scene.materials[mesh.material] };
        let turn = Mat3::from_mat4(instance.world_from_local);
        for triangle in &mesh.indices {
            let corners = triangle
                .map(|i| instance.world_from_local.transform_point3(mesh.positions[i as usize].into()));
            let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            // The file's normals say which side is meant; the face says how the surface lies.
            let shading = turn * Vec3::from(mesh.normals[triangle[0] as usize]);
            let side = if face.dot(shading) < 0.0 { -1.0 } else { 1.0 };
            if let Some(normal) = (side * face).try_normalize() {
                add_triangle(&surface, grid, &mut volume, *triangle, corners, normal);
            }
        }
    }
    for i in 0..cells {
        // `albedo.w` gathers the weights.
        let weight = volume.albedo[i].w;
        if weight > 0.0 {
            volume.normal[i] = (volume.normal[i].truncate() / weight).extend(1.0);
            volume.albedo[i] = (volume.albedo[i].truncate() / weight).extend(0.0);
            volume.emission[i] /= weight;
        }
    }
    volume
}

fn add_triangle(
    surface: &Surface<'_>,
    grid: &Grid,
    volume: &mut TriangleVolume,
    indices: [u32; 3],
    corners: [Vec3; 3],
    normal: Vec3,
) {
    let longest = (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3])).fold(0.0, f32::max);
    let steps = ((SAMPLES_PER_CELL * longest / grid.cell_size).ceil() as u32).clamp(1, MAX_STEPS);
    let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
    let weight = area / (steps * steps) as f32;
    let shift = SURFACE_SHIFT as f32 * grid.cell_size * normal;
    // The lattice cuts the triangle into steps x steps alike small ones; each is sampled in its middle.
    for row in 0..steps {
        for column in 0..2 * (steps - row) - 1 {
            let (u, v) = small_triangle_middle(row, column, steps);
            let barycentric = Vec3::new(1.0 - u - v, u, v);
            let point = (0..3).map(|i| barycentric[i] * corners[i]).sum::<Vec3>();
            let Some(cell) = grid.cell_from_world(point - shift).map(|c| grid.index(c)) else { continue };
            let Some((albedo, emission)) = surface.sample(indices, barycentric) else { continue };
            volume.normal[cell] += (weight * normal).extend(0.0);
            volume.albedo[cell] += weight * albedo.extend(1.0);
            volume.emission[cell] += (weight * emission).extend(0.0);
        }
    }
}

/// Barycentric middle of a small triangle: even columns point up, odd ones down.
fn small_triangle_middle(row: u32, column: u32, steps: u32) -> (f32, f32) {
    let third = if column.is_multiple_of(2) { 1.0 / 3.0 } else { 2.0 / 3.0 };
    ((((column / 2) as f32) + third) / steps as f32, (row as f32 + third) / steps as f32)
}

struct Surface<'a> {
    scene: &'a Scene,
    mesh: &'a Mesh,
    material: &'a Material,
}

impl Surface<'_> {
    /// Albedo and emission at a point of a triangle; none in the holes of a mask.
    fn sample(&self, indices: [u32; 3], barycentric: Vec3) -> Option<(Vec3, Vec3)> {
        let uv: Vec2 = (0..3).map(|i| barycentric[i] * Vec2::from(self.mesh.uvs[indices[i] as usize])).sum();
        let color: Vec4 =
            (0..3).map(|i| barycentric[i] * Vec4::from(self.mesh.colors[indices[i] as usize])).sum();
        let texture = |t: Option<usize>| t.map_or(Vec4::ONE, |t| texel(&self.scene.textures[t], uv));
        let base = self.material.base_color * texture(self.material.base_color_texture) * color;
        let cutoff = match self.material.alpha {
            AlphaMode::Opaque => -1.0,
            AlphaMode::Mask { cutoff } => cutoff,
            AlphaMode::Blend => 0.5,
        };
        let emission = self.material.emission * texture(self.material.emission_texture).truncate();
        (base.w >= cutoff).then(|| (base.truncate().clamp(Vec3::ZERO, Vec3::ONE), emission))
    }
}

/// The nearest texel, linear.
pub(crate) fn texel(texture: &Texture, uv: Vec2) -> Vec4 {
    let index = |t: f32, size: u32, wrap: Wrap| {
        let t = match wrap {
            Wrap::Repeat => t - t.floor(),
            Wrap::Mirror => 1.0 - (t.rem_euclid(2.0) - 1.0).abs(),
            Wrap::Clamp => t.clamp(0.0, 1.0),
        };
        ((t * size as f32) as u32).min(size - 1)
    };
    let x = index(uv.x, texture.width, texture.wrap[0]);
    let y = index(uv.y, texture.height, texture.wrap[1]);
    let at = (4 * (y * texture.width + x)) as usize;
    let linear = |c: usize| {
        let value = f32::from(texture.pixels[at + c]) / 255.0;
        if !texture.srgb || c == 3 {
            value
        } else if value <= 0.040_45 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    };
    Vec4::new(linear(0), linear(1), linear(2), linear(3))
}
