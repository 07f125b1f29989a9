//! Shared shader modules: pure functions and structs, no bindings. A [`Shader`](crate::gpu::Shader) lists
//! those it is joined from.

use glam::{Mat4, UVec2, UVec3, Vec3};
use lumivox_core::{Grid, View};

use crate::progressive::InjectionScale;

/// `GridUniform`, cell indices and positions.
pub const GRID: &str = include_str!("wgsl/grid.wgsl");
/// `ViewUniform`, from texels to the world.
pub const VIEW: &str = include_str!("wgsl/view.wgsl");
/// Points of a view's injection grid; after [`GRID`] and [`VIEW`].
pub const POINT: &str = include_str!("wgsl/point.wgsl");
/// Where a view shows a point, and how far a cell reaches in depth; after [`GRID`] and [`VIEW`].
pub const VISIBILITY: &str = include_str!("wgsl/visibility.wgsl");
/// Four half floats in two words.
pub const PACK: &str = include_str!("wgsl/pack.wgsl");
/// Spherical harmonics of bands 0 and 1.
pub const SH: &str = include_str!("wgsl/sh.wgsl");
/// The six faces of a cell.
pub const FACE: &str = include_str!("wgsl/face.wgsl");
/// Which faces of a cell let light out; after [`FACE`].
pub const TRANSPORT: &str = include_str!("wgsl/transport.wgsl");
/// Directions in two numbers.
pub const OCTAHEDRON: &str = include_str!("wgsl/octahedron.wgsl");
/// The vertex stage of full-screen passes.
pub const FULLSCREEN: &str = include_str!("wgsl/fullscreen.wgsl");

/// The largest half float: volumes and pictures hold no larger number.
pub const HALF_MAX: f32 = 65504.0;

crate::gpu_struct! {
    /// A [`Grid`] as shaders see it.
    pub struct GridUniform {
        /// Lowest corner in metres.
        pub origin: Vec3,
        /// Side of a cell in metres.
        pub cell_size: f32,
        /// Cells along x, y, z.
        pub dims: UVec3,
        /// Their product.
        pub cell_count: u32,
    }
}

impl From<&Grid> for GridUniform {
    fn from(grid: &Grid) -> Self {
        Self {
            origin: grid.origin,
            cell_size: grid.cell_size,
            dims: grid.dims,
            cell_count: grid.cell_count() as u32,
        }
    }
}

crate::gpu_struct! {
    /// A [`View`] as shaders see it, with the sizes of its pictures and the scale of its fixed-point sums.
    pub struct ViewUniform {
        /// World to clip space.
        pub clip_from_world: Mat4,
        /// Clip space to world.
        pub world_from_clip: Mat4,
        /// World to eye space.
        pub eye_from_world: Mat4,
        /// Width and height of the view's textures.
        pub size: UVec2,
        /// Columns and rows of the injection grid.
        pub points: UVec2,
        /// Depth of what has not been drawn.
        pub far_depth: f32,
        /// Largest radiance that injection represents.
        pub radiance_max: f32,
        /// Fixed-point steps per unit of summed normals and albedo; of emission, times `radiance_max`.
        pub unit_steps: f32,
        /// Fixed-point steps per unit of one light's summed radiance.
        pub light_steps: f32,
        /// In which order points are taken: [`InjectionPattern`](crate::progressive::InjectionPattern) as a number.
        pub pattern: u32,
        /// Over how many frames they are split.
        pub split: u32,
        /// The number of this frame among these.
        pub phase: u32,
        /// Nothing.
        pub spare: u32,
    }
}

impl ViewUniform {
    /// A view of `size` texels whose pictures are injected at `points` points.
    ///
    /// Sums are 32-bit fixed point, so that they do not depend on the order of additions. The steps are as fine as
    /// they can be without overflow when all points that are added to the same sums fall into one cell.
    pub fn new(view: &View, size: UVec2, points: UVec2, scale: InjectionScale) -> Self {
        let steps = |points: u32| 2f32.powi(30) / points.max(1) as f32;
        let radiance_max = scale.radiance_max.clamp(1e-6, HALF_MAX);
        Self {
            clip_from_world: view.clip_from_world,
            world_from_clip: view.world_from_clip(),
            eye_from_world: view.eye_from_world,
            size,
            points,
            far_depth: if view.reversed_depth { 0.0 } else { 1.0 },
            radiance_max,
            unit_steps: steps(scale.attribute_points),
            light_steps: steps(scale.light_points) / radiance_max,
            pattern: 0,
            split: 1,
            phase: 0,
            spare: 0,
        }
    }
}

/// Workgroups of 64 for `count` invocations, folded into two dimensions (one holds at most 65,535).
pub fn linear_groups(count: u32) -> [u32; 3] {
    let groups = count.div_ceil(64);
    let columns = groups.clamp(1, 32_768);
    [columns, groups.div_ceil(columns).max(1), 1]
}
