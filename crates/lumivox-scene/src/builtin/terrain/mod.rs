//! Open land with a palace on a stone podium, in the manner of Knossos: hills, steps, flat roofs on red columns, trees.
//!
//! ```text
//!            hills
//!     +-----------------------+ z = -9     x -28..28, z -28..28
//!     | hall       |   wing   |            podium x -11..11, top at 0 m, the land before it at -1.8 m
//!     |~~portico~~~  court    |            hall with a portico to the court, and a second storey behind
//!     +---------steps---------+ z = 5      the sun comes from +z and -x
//!            land, trees
//! ```

mod land;
mod palace;
mod plants;

use glam::Vec3;

use super::builder::{SceneBuilder, pick};
use crate::{Camera, Light, Material, Scene};

/// Open hilly ground, steps, low buildings with openings, columns and trees under sun and sky, after the Knossos model in
/// figures 49 and 57 of Gaitatzes' dissertation (2012).
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 17 696 | 26 876 | 48 916 | 110 948 | 229 012 |
pub fn terrain(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let palette = Palette::new(&mut scene);
    let cuts = Cuts {
        land: pick(detail, [28, 48, 80, 140, 220]),
        longest: pick(detail, [f32::INFINITY, 3.0, 1.2, 0.7, 0.45]),
        steps: pick(detail, [1, 1, 2, 4, 6]),
        sides: pick(detail, [6, 9, 14, 22, 32]),
    };
    land::add(&mut scene, &palette, &cuts);
    palace::add(&mut scene, &palette, &cuts);
    plants::add(&mut scene, &palette, &cuts);
    scene.light(Light::Directional {
        direction: Vec3::new(0.56, -0.66, -0.50).normalize_or_zero(),
        irradiance: Vec3::new(14.0, 12.4, 10.0),
    });
    scene.sky(Vec3::new(0.32, 0.46, 0.70));
    scene.camera(Camera::look("palace", Vec3::new(10.5, 2.4, 17.5), Vec3::new(-1.2, 1.6, -2.5), 52.0));
    scene.camera(Camera::look("portico", Vec3::new(3.2, 1.7, 2.6), Vec3::new(-5.0, 1.6, -0.6), 62.0));
    scene.camera(Camera::look("hill", Vec3::new(-20.0, 9.5, 15.0), Vec3::new(0.5, 0.5, -2.0), 46.0));
    scene.finish()
}

/// How finely things are cut.
struct Cuts {
    /// Cells of the ground along each side.
    land: u32,
    longest: f32,
    steps: u32,
    sides: u32,
}

/// Material indices.
struct Palette {
    grass: usize,
    podium: usize,
    plaster: usize,
    ochre: usize,
    red: usize,
    black: usize,
    blue: usize,
    paving: usize,
    pale: usize,
    wood: usize,
    cypress: usize,
    olive: usize,
    bark: usize,
    rock: usize,
    clay: usize,
}

impl Palette {
    fn new(scene: &mut SceneBuilder) -> Self {
        let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
        Self {
            grass: matte("dry grass", 0.44, 0.42, 0.18),
            podium: matte("podium stone", 0.60, 0.54, 0.44),
            plaster: matte("plaster", 0.76, 0.69, 0.56),
            ochre: matte("ochre plaster", 0.70, 0.46, 0.20),
            red: matte("red paint", 0.58, 0.09, 0.06),
            black: matte("black paint", 0.08, 0.075, 0.07),
            blue: matte("blue paint", 0.10, 0.24, 0.52),
            paving: matte("paving", 0.66, 0.60, 0.50),
            pale: matte("pale stone", 0.76, 0.73, 0.66),
            wood: matte("wood", 0.30, 0.18, 0.10),
            cypress: matte("cypress", 0.09, 0.20, 0.07),
            olive: matte("olive leaves", 0.24, 0.33, 0.16),
            bark: matte("bark", 0.25, 0.18, 0.12),
            rock: matte("rock", 0.52, 0.48, 0.42),
            clay: matte("clay", 0.60, 0.30, 0.16),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn triangles_are_as_documented_and_all_is_closed() {
        assert_eq!(
            [0, 1, 2, 3, 4].map(|d| terrain(d).triangle_count()),
            [17696, 26876, 48916, 110948, 229012]
        );
        for detail in [0, 2] {
            assert_eq!(checks::open_edges(&checks::world_triangles(&terrain(detail), |_| true)), 0);
        }
    }

    #[test]
    fn cameras_stand_above_the_land_and_clear_of_everything() {
        let scene = terrain(2);
        let triangles = checks::world_triangles(&scene, |_| true);
        for camera in &scene.cameras {
            for way in checks::directions(500) {
                let free = checks::hit(&triangles, camera.eye, way);
                assert!(free.is_none_or(|d| d > 0.5), "{}: {free:?}", camera.name);
            }
            assert!(checks::hit(&triangles, camera.eye, Vec3::NEG_Y).is_some(), "{}", camera.name);
        }
    }
}
