//! How light is gathered.

use glam::Vec3;

/// How light is gathered: six knobs, each with what more of it brings and costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherSettings {
    /// Rays of a surfel, 1 to 1024. More mean less grain: the largest difference between a surfel of a room and its mirror image's falls
    /// from 24 % with 64 rays to 4.5 % with 1024. They cost memory, 4 bytes a ray, and time in proportion: of tracing, and of every
    /// bounce, which is a sum over them.
    pub rays: u32,
    /// Frames in which all surfels have a turn: their direct light, rays and bounces. 1 and up, and not always whole:
    /// [`LightBudget`](super::LightBudget) finds the number that fits into a frame's time. With twice as many a frame costs about half
    /// (rounds of 8 frames a tenth), and light follows what moves later, in even steps: what a lamp lights is seen whole after three times
    /// as many frames at most, one round until it is asked for, one until others look, and one until that is shown.
    pub frames: f32,
    /// Points of a surfel at which a view is asked for light, 1 to 64. More resolve the edges of shadows. They cost no memory, and a look
    /// into each view of each light for every point of the surfels in turn.
    pub light_points: u32,
    /// Room for surfels. Without it two for each cell, or as many as fit into a binding, if that is less, and six in grids of up
    /// to 10,000 cells: at 64 cells a side a room needs one to five cells, a palace of arches nine to ten. Those that find no
    /// room are dark, and counted. More cost memory alone, 108 bytes and their rays each, whether they are used or not.
    pub surfels: Option<u32>,
    /// Radiance of the sky, that rays meet which leave the grid, W/(m2 sr);
    /// [`GatheredLight::set_sky`](super::GatheredLight::set_sky) takes one that is not the same everywhere. Its
    /// light comes with the rays, at no further cost.
    pub sky: Vec3,
    /// Whether the host lights its pixels from the sky by itself. Then irradiance at pixels leaves out what comes straight from it, and
    /// holds what surfaces reflect of it: sky light as sharp as the host's own, at the host's cost.
    pub sky_apart: bool,
}

impl GatherSettings {
    /// The knobs of a preset, under a black sky.
    pub const fn of(quality: Quality) -> Self {
        let (rays, frames, light_points) = match quality {
            Quality::Low => (32, 2.0, 4),
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
/// | low | 32 | 2 | 4 | 236 |
/// | medium | 64 | 2 | 16 | 364 |
/// | high | 256 | 1 | 16 | 1132 |
/// | reference | 192 | 1 | 64 | 876 |
///
/// What they are worth, with the grids that our own renderer gives them (32, 64, 64 and 96 cells along the longest side): milliseconds to
/// settled light in parts of those of `medium`, all surfels in every frame; and the trimmed error of irradiance beside a path tracer; both
/// over the Cornell box, a room, and two rooms (`docs/benchmarks/light.md`, Presets), with voxels from triangles and from one frame of
/// views alone.
///
/// | preset | time, triangles | time, views | error, triangles | error, views |
/// | --- | ---: | ---: | ---: | ---: |
/// | low | 0.2 | 0.2 | 12.3 % | 14.4 % |
/// | medium | 1 | 1 | 8.4 % | 13.7 % |
/// | high | 3.1 | 3.4 | 6.6 % | 12.6 % |
/// | reference | 6.2 | 6.8 | 5.4 % | 15.3 % |
///
/// A frame of a series costs less than these ratios say where rounds take two frames: about half for `low` and `medium`. Rounds of three
/// would cost two thirds of that, and be too late: in a closed box of albedo 0.6 they have 0.83 of a lamp's light in the eighth frame,
/// all bounces counted. With views alone a finer grid is not always better, since it has more holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// For weak devices: in the Cornell box at 64 cells an error of 3 % in the large and about 8 % with grain; and what moves lights others
    /// up to six frames later.
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
