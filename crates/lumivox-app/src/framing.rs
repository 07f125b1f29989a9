//! A camera for scenes that bring none: from inside or outside, whichever sees more.

use std::collections::HashMap;

use glam::{Vec2, Vec3, Vec4};
use lumivox::core::{Bounds, Grid, GridError, View};
use lumivox_scene::{Camera, Scene};

use crate::framing_cells;

/// Cells a side of the volume that candidates are judged in.
const GRID: u32 = 48;
/// The name of cameras that look at a scene from outside, and their vertical angle in degrees.
const OUTSIDE: &str = "outside";
const OUTSIDE_FOV: f32 = 40.0;
/// Rays per candidate.
const RAYS: [u32; 2] = [64, 36];

/// A scene of which this share can be seen from outside is looked at from outside, one of less than the second from inside.
/// Between them the number of cells seen decides.
const SHARES_SEEN: [f32; 2] = [0.6, 0.45];
/// Inside is where less than this share of all directions leads out of the scene.
const ENCLOSED: f32 = 0.25;
/// And where what is in the way is further away than this part of the scene's diagonal: the crown of a tree is no room.
const ROOMY: f32 = 0.1;

/// The candidate that sees the most surface, its right side first.
pub(crate) fn best_camera(scene: &Scene, bounds: &Bounds) -> Result<Camera, GridError> {
    let (grid, cells) = cells(scene, bounds)?;
    let share = share_seen_from_outside(&grid, &cells);
    let fits = |c: &Camera| match c.name.as_str() {
        OUTSIDE => share >= SHARES_SEEN[1],
        _ if share < SHARES_SEEN[0] => {
            let around = surroundings_in(&grid, &cells, c.eye, 100);
            around.openness < ENCLOSED && around.distance > ROOMY * bounds.size().length()
        }
        _ => false,
    };
    // An open tangle, such as a tree, can neither be entered nor seen whole.
    let candidates = candidates(bounds);
    let fitting: Vec<Camera> = candidates.iter().filter(|c| fits(c)).cloned().collect();
    let candidates = if fitting.is_empty() {
        candidates.into_iter().filter(|c| c.name == OUTSIDE).collect()
    } else {
        fitting
    };
    let scored = candidates.into_iter().map(|c| (score(&c, &grid, &cells), c));
    let best = scored.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, camera)| camera).ok_or(GridError::BadBounds(*bounds))
}

/// How a point stands in a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surroundings {
    /// The share of all directions in which nothing is in the way.
    pub(crate) openness: f32,
    /// Mean distance of what is in the way, in metres.
    pub(crate) distance: f32,
}

/// What there is around an eye.
pub(crate) fn surroundings(scene: &Scene, bounds: &Bounds, eye: Vec3) -> Option<Surroundings> {
    let (grid, cells) = cells(scene, bounds).ok()?;
    Some(surroundings_in(&grid, &cells, eye, 600))
}

fn surroundings_in(grid: &Grid, cells: &[Vec4], eye: Vec3, directions: u32) -> Surroundings {
    let hits: Vec<f32> = sphere(directions)
        .filter_map(|direction| first_hit(eye, direction, grid, cells))
        .map(|index| grid.center(grid.cell(index)).distance(eye))
        .collect();
    Surroundings {
        openness: 1.0 - hits.len() as f32 / directions as f32,
        distance: hits.iter().sum::<f32>() / hits.len().max(1) as f32,
    }
}

fn cells(scene: &Scene, bounds: &Bounds) -> Result<(Grid, Vec<Vec4>), GridError> {
    let grid = Grid::fit_with_margin(bounds, GRID)?;
    let normals = framing_cells::normals(scene, &grid);
    Ok((grid, normals))
}

/// Directions spread over the sphere.
fn sphere(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |n| {
        let y = 1.0 - (2.0 * n as f32 + 1.0) / count as f32;
        let (sin, cos) = (n as f32 * 2.399_963_2).sin_cos();
        let radius = (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(radius * cos, y, radius * sin)
    })
}

/// The share of occupied cells that parallel rays from 14 sides meet first, and from their right side.
fn share_seen_from_outside(grid: &Grid, cells: &[Vec4]) -> f32 {
    let occupied = cells.iter().filter(|c| c.w > 0.0).count();
    let (center, reach) = (grid.bounds().center(), 0.5 * grid.bounds().size().length());
    let rays = (2.0 * reach / grid.cell_size).ceil() as i32;
    let mut seen = std::collections::HashSet::new();
    for direction in sphere(14) {
        let (right, up) = direction.any_orthonormal_pair();
        for (x, y) in (0..rays).flat_map(|y| (0..rays).map(move |x| (x, y))) {
            let at = (Vec2::new(x as f32, y as f32) + 0.5) * grid.cell_size - reach;
            let start = center + at.x * right + at.y * up - reach * direction;
            let hit = first_hit(start, direction, grid, cells);
            seen.extend(hit.filter(|&index| cells[index].truncate().dot(direction) <= 0.0));
        }
    }
    seen.len() as f32 / occupied.max(1) as f32
}

/// Three-quarter views from outside, and views along the floor plan from inside at several places and heights.
fn candidates(bounds: &Bounds) -> Vec<Camera> {
    let (center, size) = (bounds.center(), bounds.size());
    let outside = [(0.6, 0.35, 1.0), (-0.6, 0.35, 1.0), (0.6, 0.35, -1.0)].map(|(x, y, z)| {
        let backward = Vec3::new(x, y, z).normalize_or_zero();
        camera(OUTSIDE, center + filling_distance(bounds, backward) * backward, center, OUTSIDE_FOV)
    });
    let (along, across) = if size.x > size.z { (Vec3::X, Vec3::Z) } else { (Vec3::Z, Vec3::X) };
    let mut cameras = outside.to_vec();
    for height in [0.15, 0.3, 0.5, 0.7] {
        for side in [-0.25, 0.0, 0.25] {
            for place in [-0.4, -0.25, 0.0, 0.25, 0.4] {
                let flat = center + size * (place * along + side * across);
                let eye = Vec3::new(flat.x, bounds.min.y + height * size.y, flat.z);
                for toward in [along, -along] {
                    cameras.push(camera("inside", eye, eye + toward + Vec3::new(0.0, 0.06, 0.0), 65.0));
                }
            }
        }
    }
    cameras
}

/// How far from the middle of a box a camera must stand to fill nine tenths of a picture of 4:3 with it.
fn filling_distance(bounds: &Bounds, backward: Vec3) -> f32 {
    let right = Vec3::Y.cross(backward).normalize_or_zero();
    let up = backward.cross(right);
    let slope = 0.9 * (0.5 * OUTSIDE_FOV.to_radians()).tan();
    let center = bounds.center();
    let needed = |corner: &Vec3| {
        let p = *corner - center;
        (p.dot(up).abs() / slope).max(p.dot(right).abs() / (slope * 4.0 / 3.0)) + p.dot(backward)
    };
    bounds.corners().iter().map(needed).fold(0.0, f32::max)
}

fn camera(name: &str, eye: Vec3, target: Vec3, fov_y_deg: f32) -> Camera {
    Camera { name: name.to_owned(), eye, target, up: Vec3::Y, fov_y: fov_y_deg.to_radians() }
}

/// Number of cells seen. Those seen from behind count a quarter, so that rooms are entered and objects are not; those
/// right before the eye hardly count.
fn score(camera: &Camera, grid: &Grid, cells: &[Vec4]) -> f32 {
    let aspect = RAYS[0] as f32 / RAYS[1] as f32;
    let view = View::perspective(camera.eye, camera.target, camera.up, camera.fov_y, aspect, 0.01, 1.0);
    let reach = grid.bounds().size().length();
    let mut seen = HashMap::new();
    for (x, y) in (0..RAYS[1]).flat_map(|y| (0..RAYS[0]).map(move |x| (x, y))) {
        let uv = (Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(RAYS[0] as f32, RAYS[1] as f32);
        let Some(direction) = (view.world_from_uv(uv, 0.5) - camera.eye).try_normalize() else { continue };
        if let Some(index) = first_hit(camera.eye, direction, grid, cells) {
            let away = cells[index].truncate().dot(direction) > 0.0;
            let distance = grid.center(grid.cell(index)).distance(camera.eye);
            let weight = if away { 0.25 } else { 1.0 } * (distance / (0.1 * reach)).min(1.0);
            seen.insert(index, weight);
        }
    }
    seen.values().sum()
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

    fn best(scene: &Scene) -> Camera {
        best_camera(scene, &scene.bounds()).unwrap()
    }

    #[test]
    fn rooms_are_entered_and_objects_are_not() {
        for (name, expected) in [("builtin:furnace", "inside"), ("builtin:atrium:1", "inside")] {
            assert_eq!(best(&lumivox_scene::load(name).unwrap()).name, expected, "{name}");
        }
        let mut cube = lumivox_scene::load("builtin:furnace").unwrap();
        for mesh in &mut cube.meshes {
            mesh.normals.iter_mut().for_each(|n| *n = n.map(|c| -c));
        }
        assert_eq!(best(&cube).name, "outside");
    }
}
