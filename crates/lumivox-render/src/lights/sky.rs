//! The sky as a light.

use glam::Vec3;
use lumivox_scene::{Scene, SkyMap};

/// Radiance from all directions: a constant, and what a map adds.
#[derive(Clone, Debug, Default)]
pub struct Sky {
    /// The same everywhere, W/(m2 sr).
    pub constant: Vec3,
    /// What is not.
    pub map: Option<SkyMap>,
}

impl Sky {
    /// A scene's.
    pub fn of(scene: &Scene) -> Self {
        Self { constant: scene.sky, map: scene.sky_map.clone() }
    }

    /// Whether no light comes from it.
    pub fn is_black(&self) -> bool {
        let black = |map: &SkyMap| map.pixels.iter().all(|p| *p == Vec3::ZERO);
        self.constant == Vec3::ZERO && self.map.as_ref().is_none_or(black)
    }

    /// Radiance from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.constant + self.map.as_ref().map_or(Vec3::ZERO, |map| map.radiance(direction))
    }

    /// The same light with details no finer than `count` samples over the sphere can show.
    pub fn blurred(&self, count: u32) -> Self {
        // Twice as many columns as rows.
        let rows = (0.5 * f64::from(count)).sqrt().ceil() as u32;
        Self { constant: self.constant, map: self.map.as_ref().map(|map| map.shrunk(rows)) }
    }

    /// The mean over all directions.
    pub fn mean(&self) -> Vec3 {
        let map = self.map.as_ref().map(|map| {
            let power = |(n, p): (usize, &Vec3)| map.solid_angle(n as u32 / map.width) * *p;
            map.pixels.iter().enumerate().map(power).sum::<Vec3>() / (4.0 * std::f32::consts::PI)
        });
        self.constant + map.unwrap_or_default()
    }
}
