//! A camera for scenes that bring none: from inside or outside, whichever sees more.

use std::collections::HashSet;

use glam::{Vec3, Vec4};
use lumivox::core::{Bounds, Grid, View};
use lumivox_scene::{Camera, Scene};

/// Cells a side of the volume that candidates are judged in.
const GRID: u32 = 48;
/// Rays per candidate.
const RAYS: [u32; 2] = [64, 36];

/// The candidate from which the most cells are seen.
pub(crate) fn best_camera(scene: &Scene) -> Option<Camera> {
    let bounds = scene.bounds();
    let grid = Grid::fit_with_margin(&bounds, GRID).ok()?;
    let cells = lumivox_render::triangles::voxelize(scene, &grid).normal;
    candidates(&bounds).into_iter().max_by_key(|camera| seen_cells(camera, &grid, &cells))
}

/// Three-quarter views from outside first, then views along the floor plan at eye height.
fn candidates(bounds: &Bounds) -> Vec<Camera> {
    let (center, size) = (bounds.center(), bounds.size());
    let reach = size.length();
    let outside = [(0.6, 0.35, 1.0), (-0.6, 0.35, 1.0), (0.6, 0.35, -1.0)].map(|(x, y, z)| {
        camera("outside", center + 1.15 * reach * Vec3::new(x, y, z).normalize_or_zero(), center, 45.0)
    });
    let along = if size.x > size.z { Vec3::X } else { Vec3::Z };
    let eye_height = bounds.min.y + 0.25 * size.y;
    let inside = [-0.35, -0.2, 0.0, 0.2, 0.35].into_iter().flat_map(|t| {
        let eye = center + t * size * along;
        let eye = Vec3::new(eye.x, eye_height, eye.z);
        let toward = if t > 0.0 { -along } else { along };
        [toward, -toward].map(|d| camera("inside", eye, eye + d + Vec3::new(0.0, 0.08, 0.0), 60.0))
    });
    outside.into_iter().chain(inside).collect()
}

fn camera(name: &str, eye: Vec3, target: Vec3, fov_y_deg: f32) -> Camera {
    Camera { name: name.to_owned(), eye, target, up: Vec3::Y, fov_y: fov_y_deg.to_radians() }
}

fn seen_cells(camera: &Camera, grid: &Grid, cells: &[Vec4]) -> usize {
    let aspect = RAYS[0] as f32 / RAYS[1] as f32;
    let view = View::perspective(camera.eye, camera.target, camera.up, camera.fov_y, aspect, 0.01, 1.0);
    let pixels = (0..RAYS[1]).flat_map(|y| (0..RAYS[0]).map(move |x| (x, y)));
    let seen: HashSet<usize> = pixels
        .filter_map(|(x, y)| {
            let uv =
                (glam::Vec2::new(x as f32, y as f32) + 0.5) / glam::Vec2::new(RAYS[0] as f32, RAYS[1] as f32);
            let direction = (view.world_from_uv(uv, 0.5) - camera.eye).try_normalize()?;
            first_hit(camera.eye, direction, grid, cells)
        })
        .collect();
    seen.len()
}

/// Marches in steps of a third of a cell; the first ones are skipped, so that an eye within a surface still sees.
fn first_hit(eye: Vec3, direction: Vec3, grid: &Grid, cells: &[Vec4]) -> Option<usize> {
    let step = grid.cell_size / 3.0;
    let bounds = grid.bounds();
    let far = bounds.corners().iter().map(|c| c.distance(eye)).fold(0.0, f32::max);
    let count = (far / step) as u32;
    (3..count)
        .filter_map(|n| grid.cell_from_world(eye + n as f32 * step * direction))
        .map(|cell| grid.index(cell))
        .find(|&index| cells[index].w > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rooms_are_seen_from_inside() {
        let room = lumivox_scene::load("builtin:furnace").unwrap();
        assert_eq!(
            best_camera(&room).unwrap().name,
            "outside",
            "a closed box shows most cells from a corner"
        );
        let hall = lumivox_scene::load("builtin:atrium:1").unwrap();
        assert_eq!(best_camera(&hall).unwrap().name, "inside");
    }
}
