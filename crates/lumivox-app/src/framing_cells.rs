//! The surface of a scene in coarse cells, for choosing a camera: sampled, which is as much as that needs.
//!
//! Each triangle is cut into small ones of less than half a cell, sampled in their middles. A surface on a cell boundary marks the cell
//! behind its normal.

use glam::{Mat3, Vec2, Vec3, Vec4};
use lumivox::core::Grid;
use lumivox::progressive::SURFACE_SHIFT;
use lumivox_scene::{AlphaMode, Material, Mesh, Scene, Texture, Wrap};

/// Lattice steps per cell along the longest edge.
const SAMPLES_PER_CELL: f32 = 2.5;
/// No triangle gets a finer lattice than this.
const MAX_STEPS: u32 = 8192;

/// For each cell the mean normal of the surface in it, and 1 where there is any.
pub(crate) fn normals(scene: &Scene, grid: &Grid) -> Vec<Vec4> {
    let mut cells = vec![Vec4::ZERO; grid.cell_count() as usize];
    for instance in &scene.instances {
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
                add_triangle(&surface, grid, &mut cells, *triangle, corners, normal);
            }
        }
    }
    for cell in cells.iter_mut().filter(|cell| cell.w > 0.0) {
        *cell /= cell.w;
    }
    cells
}

fn add_triangle(
    surface: &Surface<'_>,
    grid: &Grid,
    cells: &mut [Vec4],
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
            if surface.is_solid(indices, barycentric) {
                cells[cell] += weight * normal.extend(1.0);
            }
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
    /// Whether there is something at a point of a triangle, and no hole of a mask.
    fn is_solid(&self, indices: [u32; 3], barycentric: Vec3) -> bool {
        let cutoff = match self.material.alpha {
            AlphaMode::Opaque => return true,
            AlphaMode::Mask { cutoff } => cutoff,
            AlphaMode::Blend => 0.5,
        };
        let uv: Vec2 = (0..3).map(|i| barycentric[i] * Vec2::from(self.mesh.uvs[indices[i] as usize])).sum();
        let tint: f32 = (0..3).map(|i| barycentric[i] * self.mesh.colors[indices[i] as usize][3]).sum();
        let texture = self.material.base_color_texture.map(|t| opacity(&self.scene.textures[t], uv));
        self.material.base_color.w * texture.unwrap_or(1.0) * tint >= cutoff
    }
}

/// Of the nearest texel.
fn opacity(texture: &Texture, uv: Vec2) -> f32 {
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
    f32::from(texture.pixels[(4 * (y * texture.width + x)) as usize + 3]) / 255.0
}
