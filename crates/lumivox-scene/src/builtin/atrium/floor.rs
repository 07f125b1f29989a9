//! The tiled floor: a bordered checkerboard in the court, plain flags with inlays under the arcades.

use glam::Vec3;

use super::{COURT, Detail, Palette, WALL, shade};
use crate::builtin::builder::{Builder, SceneBuilder};

pub(super) fn add(scene: &mut SceneBuilder, palette: &Palette, detail: &Detail) {
    let size = detail.pick([1.2, 0.6, 0.6, 0.6, 0.6f32]);
    let steps = detail.pick([1, 1, 1, 2, 3]);
    let (nx, nz) = ((2.0 * WALL[0] / size).round() as i32, (2.0 * WALL[1] / size).round() as i32);
    let mut tiles: [Builder; 3] = Default::default();
    for j in 0..nz {
        for i in 0..nx {
            let corner = Vec3::new(i as f32 * size - WALL[0], 0.0, j as f32 * size - WALL[1]);
            let kind = kind_at(corner + Vec3::new(0.5 * size, 0.0, 0.5 * size), i, j);
            let color = shade((j * nx + i) as u32, 0.16);
            tiles[kind].grid(corner, size * Vec3::Z, size * Vec3::X, [steps; 2], color);
        }
    }
    let kinds = [("light", palette.tile_light), ("warm", palette.tile_warm), ("dark", palette.tile_dark)];
    for (tiles, (name, material)) in tiles.into_iter().zip(kinds) {
        scene.add(&format!("floor, {name}"), tiles, material);
    }
}

/// 0 light, 1 warm, 2 dark, for the tile in column `i` and row `j` whose middle is at `p`.
fn kind_at(p: Vec3, i: i32, j: i32) -> usize {
    // How far inside the line of columns; negative under the arcades.
    let inside = (COURT[0] - p.x.abs()).min(COURT[1] - p.z.abs());
    match inside {
        d if d < -0.6 => usize::from(i % 4 == 1 && j % 4 == 1),
        d if d < 0.6 => 2,
        d if d < 1.2 => 1,
        _ => usize::from((i + j) % 2 == 0),
    }
}
