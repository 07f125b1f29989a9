//! Small pictures of cells, from above at a corner, without a device.

use glam::{UVec3, Vec3};
use image::{Rgb, RgbImage};
use lumivox::core::Grid;

const PAPER: [f32; 3] = [0.97, 0.97, 0.96];
/// How light a face is that looks along x, y and z.
const SHADES: [f32; 3] = [0.72, 1.0, 0.52];

/// A picture of the cells that have a colour (in numbers for a screen, 0 to 1).
pub(super) fn voxel_picture(grid: &Grid, side: u32, color: impl Fn(UVec3) -> Option<Vec3>) -> RgbImage {
    let dims = grid.dims.as_vec3();
    let forward = Vec3::new(-0.52, -0.42, -0.74).normalize_or_zero();
    let right = forward.cross(Vec3::Y).normalize_or_zero();
    let up = right.cross(forward);
    // The grid's corners as the picture sees them.
    let corners =
        (0..8).map(|n| Vec3::new((n & 1) as f32, (n >> 1 & 1) as f32, (n >> 2) as f32) * dims - 0.5 * dims);
    let (wide, high) =
        corners.fold((0f32, 0f32), |(w, h), c| (w.max(c.dot(right).abs()), h.max(c.dot(up).abs())));
    let scale = 2.06 * wide.max(high) / side as f32;
    let rows = ((side as f32 * high / wide.max(high)) as u32).max(1);
    let columns = ((side as f32 * wide / wide.max(high)) as u32).max(1);
    RgbImage::from_fn(columns, rows, |x, y| {
        let across = (x as f32 + 0.5 - 0.5 * columns as f32) * scale;
        let along = (0.5 * rows as f32 - y as f32 - 0.5) * scale;
        let start = 0.5 * dims + right * across + up * along - forward * dims.length();
        let seen = first_cell(grid.dims, start, forward, &color);
        Rgb(seen.unwrap_or(Vec3::from(PAPER)).to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8))
    })
}

/// The shaded colour of the first cell along a ray; steps from cell to cell.
fn first_cell(
    dims: UVec3,
    start: Vec3,
    direction: Vec3,
    color: impl Fn(UVec3) -> Option<Vec3>,
) -> Option<Vec3> {
    let inverse = direction.recip();
    let (a, b) = (-start * inverse, (dims.as_vec3() - start) * inverse);
    let (near, far) = (a.min(b), a.max(b));
    let (enter, leave) = (near.max_element(), far.min_element());
    if enter >= leave {
        return None;
    }
    let mut axis = near.max_position();
    let point = start + direction * enter;
    let mut cell = point.floor().as_ivec3().clamp(glam::IVec3::ZERO, dims.as_ivec3() - 1);
    let step = direction.signum().as_ivec3();
    let boundary = cell.as_vec3() + direction.signum().max(Vec3::ZERO);
    let mut next = (boundary - start) * inverse;
    for _ in 0..dims.element_sum() + 3 {
        if cell.min_element() < 0 || cell.cmpge(dims.as_ivec3()).any() {
            return None;
        }
        if let Some(color) = color(cell.as_uvec3()) {
            return Some(color * SHADES[axis]);
        }
        axis = next.min_position();
        cell[axis] += step[axis];
        next[axis] += inverse[axis].abs();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_cells_hide_those_behind() {
        let grid = Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::splat(4) };
        let picture =
            voxel_picture(&grid, 64, |cell| Some(if cell == UVec3::splat(3) { Vec3::X } else { Vec3::Y }));
        // The corner cell that looks at the viewer is in the middle, and all around are its neighbours.
        let (w, h) = picture.dimensions();
        let middle = picture.get_pixel(w / 2, h / 2).0;
        assert!(middle[0] > 100 && middle[1] == 0, "{middle:?}");
        let red = picture.pixels().filter(|p| p.0[0] > 100 && p.0[1] == 0).count();
        let green = picture.pixels().filter(|p| p.0[1] > 100 && p.0[0] == 0).count();
        assert!((10..20).contains(&(green / red)), "three of 48 faces are red: {red} and {green} pixels");
        assert!(voxel_picture(&grid, 8, |_| None).pixels().all(|p| p.0[0] > 240));
    }
}
