//! How light is gathered.

use glam::Vec3;

/// How light is gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherSettings {
    /// Rays of a surfel, 1 to 1024. More mean less grain: the largest difference between a surfel of a room and its mirror image's falls
    /// from 24 % with 64 rays to 4.5 % with 1024. Memory is 4 bytes a ray.
    pub rays: u32,
    /// Frames in which all surfels have a turn: their direct light, rays and bounces. 1 and up, and not always whole:
    /// [`LightBudget`](super::LightBudget) finds the number that fits into a frame's time. With more a frame costs less, and light
    /// follows what moves later, in even steps: what a lamp lights is seen whole after three times as many frames at most, one round
    /// until it is asked for, one until others look, and one until that is shown.
    pub frames: f32,
    /// Points of a surfel at which a view is asked for light, 1 to 64. More resolve the edges of shadows.
    pub light_points: u32,
    /// Room for surfels. Without it two for each cell, or as many as fit into a binding, if that is less, and six in grids of up
    /// to 10,000 cells: at 64 cells a side a room needs one to five cells, a palace of arches nine to ten. Those that find no
    /// room are dark, and counted.
    pub surfels: Option<u32>,
    /// Radiance of the sky, that rays meet which leave the grid, W/(m2 sr);
    /// [`GatheredLight::set_sky`](super::GatheredLight::set_sky) takes one that is not the same everywhere.
    pub sky: Vec3,
    /// Whether the host lights its pixels from the sky by itself. Then irradiance at pixels leaves out what comes straight from it, and
    /// holds what surfaces reflect of it.
    pub sky_apart: bool,
}

impl GatherSettings {
    /// The knobs of a preset, under a black sky.
    pub const fn of(quality: Quality) -> Self {
        let (rays, frames, light_points) = match quality {
            Quality::Low => (32, 3.0, 4),
            Quality::Medium => (64, 2.0, 16),
            Quality::High => (256, 1.0, 16),
            Quality::Reference => (192, 1.0, 64),
        };
        Self { rays, frames, light_points, surfels: None, sky: Vec3::ZERO, sky_apart: false }
    }
}

impl Default for GatherSettings {
    /// Between [`Quality::Medium`] and [`Quality::High`]: all rays in every frame, and 128 of them.
    fn default() -> Self {
        Self { rays: 128, frames: 1.0, light_points: 16, surfels: None, sky: Vec3::ZERO, sky_apart: false }
    }
}

/// Presets of [`GatherSettings`]. The cost of a frame is mostly its rays and its bounces, the error mostly that of the grid, which
/// the host chooses.
///
/// | preset | rays of a surfel | frames of a round | points asked for light | bytes of a surfel |
/// | --- | ---: | ---: | ---: | ---: |
/// | low | 32 | 3 | 4 | 228 |
/// | medium | 64 | 2 | 16 | 356 |
/// | high | 256 | 1 | 16 | 1124 |
/// | reference | 192 | 1 | 64 | 868 |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// For weak devices: in the Cornell box at 64 cells an error of 3 % in the large and about 8 % with grain; and what moves lights others
    /// up to nine frames later.
    Low,
    /// For motion.
    Medium,
    /// For pictures that stand still, or strong devices.
    High,
    /// For finer grids: fewer rays leave room for more surfels, in the 128 MiB that a binding of the core tier has.
    Reference,
}

crate::gpu_struct! {
    /// [`GatherSettings`] of one frame as shaders see it.
    pub struct GatherUniform {
        /// Rays of a surfel.
        pub rays: u32,
        /// Room for surfels.
        pub capacity: u32,
        /// Points of a surfel at which a view is asked.
        pub light_points: u32,
        /// Whether irradiance at pixels leaves out the sky.
        pub sky_apart: u32,
        /// The part of all surfels whose turn it is, in units of 2^-32; `u32::MAX` is all.
        pub share: u32,
        /// Where on the circle of turns it begins.
        pub phase: u32,
        /// Frames until the next turn of all surfels, where they take turns together; else 0.
        pub frames_left: u32,
        /// Unused.
        pub reserved: u32,
    }
}
