//! What glass is like, and how well it is drawn.

use glam::{UVec2, Vec3};

use super::thickness::Evaluation;
use crate::slicemap::MAX_KINDS;

/// A kind of glass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Index of refraction, 1 for none; 1.5 for glass.
    pub ior: f32,
    /// How much of the refraction at the first surface a metre of glass makes: what is `1 / bend` metres thick bends as much as one
    /// surface does, what is thicker more. 0 bends nothing.
    pub bend: f32,
    /// The part of light that a metre of glass leaves, 0 to 1 in each colour; `t` metres leave its power of `t`.
    pub through: Vec3,
    /// What its surface leaves, 0 to 1.
    pub tint: Vec3,
    /// The radiance of light that is lost on the way, W/(m2 sr): what very thick glass looks like. Black but for gas and milk.
    pub body: Vec3,
    /// Radians by which a metre of glass blurs: frosted glass, gas.
    pub frost: f32,
    /// Radians by which its surface blurs, however thick it is.
    pub roughness: f32,
    /// How much of what it would mirror by Fresnel's law it mirrors, 0 to 1.
    pub gloss: f32,
    /// Whether it has no thickness: for things that are not closed, such as a window of one quad. It is in no column, however far away it
    /// stands.
    pub is_thin: bool,
}

impl Default for Glass {
    /// Clear glass of things about half a metre large.
    fn default() -> Self {
        Self {
            ior: 1.5,
            bend: 3.0,
            through: Vec3::ONE,
            tint: Vec3::ONE,
            body: Vec3::ZERO,
            frost: 0.0,
            roughness: 0.0,
            gloss: 1.0,
            is_thin: false,
        }
    }
}

/// How well glass is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefractionSettings {
    /// Pixels of the picture.
    pub size: UVec2,
    /// Columns of the slicemap: as many as pixels, or fewer.
    pub columns: UVec2,
    /// Slices of a column. The paper's 32 lie between the nearest and the farthest surface of each column.
    pub slices: u32,
    /// Kinds of glass, 1 to [`MAX_KINDS`].
    pub kinds: u32,
    /// How inner cells are counted.
    pub evaluation: Evaluation,
    /// Whether the picture of what is behind is looked into before the environment.
    pub uses_picture: bool,
    /// Whether the view's depth is reversed.
    pub reversed_depth: bool,
}

impl RefractionSettings {
    /// A column for each pixel, 32 slices, all kinds.
    pub fn new(size: UVec2) -> Self {
        Self {
            size,
            columns: size,
            slices: 32,
            kinds: MAX_KINDS,
            evaluation: Evaluation::Bits,
            uses_picture: true,
            reversed_depth: false,
        }
    }
}

crate::gpu_struct! {
    /// A [`Glass`] as shaders see it.
    pub struct GlassUniform {
        /// What a metre leaves.
        pub through: Vec3,
        /// Index of refraction.
        pub ior: f32,
        /// What the surface leaves.
        pub tint: Vec3,
        /// Of a metre.
        pub bend: f32,
        /// What is seen of light that is lost.
        pub body: Vec3,
        /// Radians of a metre.
        pub frost: f32,
        /// Radians.
        pub roughness: f32,
        /// The part of Fresnel's reflection.
        pub gloss: f32,
        /// 1 where there is no thickness.
        pub is_thin: u32,
        /// Unused.
        pub reserved: u32,
    }
}

crate::gpu_struct! {
    /// All kinds of glass, and where they look.
    pub struct RefractionUniform {
        /// The kinds.
        pub kinds: [GlassUniform; MAX_KINDS as usize],
        /// Radians of a pixel in the middle of the picture.
        pub pixel_angle: f32,
        /// Whether the picture behind is looked into.
        pub uses_picture: u32,
        /// Kinds that have a thickness.
        pub kind_count: u32,
        /// Unused.
        pub reserved: u32,
    }
}

impl From<&Glass> for GlassUniform {
    fn from(glass: &Glass) -> Self {
        let share = |v: Vec3| v.clamp(Vec3::ZERO, Vec3::ONE);
        Self {
            through: share(glass.through),
            ior: glass.ior.clamp(1.0, 4.0),
            tint: share(glass.tint),
            bend: glass.bend.max(0.0),
            body: glass.body.max(Vec3::ZERO),
            frost: glass.frost.max(0.0),
            roughness: glass.roughness.max(0.0),
            gloss: glass.gloss.clamp(0.0, 1.0),
            is_thin: u32::from(glass.is_thin),
            reserved: 0,
        }
    }
}
