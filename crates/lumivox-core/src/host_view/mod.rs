//! A [`View`] from the matrices of a host, by the host's own conventions.

use glam::{DMat3, DMat4, DVec3, DVec4, Mat4};

use crate::{Projection, View};

#[cfg(test)]
mod tests;

/// Which way a host's eye space looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LooksAlong {
    /// Along -z, as right-handed eye spaces with y up do (OpenGL, glTF, Bevy).
    #[default]
    NegativeZ,
    /// Along +z, as left-handed ones do (Direct3D, Unreal, Unity's transforms).
    PositiveZ,
}

/// What a host's projection makes of depth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ClipDepth {
    /// 0 to 1: wgpu, Vulkan, Direct3D and Metal. The depth texture holds it as it is.
    #[default]
    ZeroToOne,
    /// -1 to 1: OpenGL. The depth texture holds half of it plus a half, as OpenGL's viewport makes it and hosts on wgpu do by a
    /// matrix of their own; if a host's projection has that matrix in it, it is [`Self::ZeroToOne`].
    MinusOneToOne,
}

/// How a host's matrices are meant. The default is wgpu's way with a right-handed eye space and standard depth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MatrixConventions {
    /// Which way its eye space looks.
    pub looks_along: LooksAlong,
    /// What its projection makes of depth.
    pub clip_depth: ClipDepth,
    /// Whether near things have larger depths than far ones.
    pub reversed_depth: bool,
}

/// Why two matrices are no view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewError {
    /// A number in one of them is infinite or none.
    NotFinite,
    /// The world's matrix is no affine one: its last row is not 0, 0, 0, 1. That of a host with row vectors must be transposed.
    NotAffine,
    /// The world's matrix scales or shears. It may turn, mirror and move.
    NotRigid,
    /// The projection cannot be undone, or not in 32-bit floats.
    Singular,
    /// What the view looks at would lie behind the eye: it looks along the other direction.
    LooksTheOtherWay,
    /// Depth runs the other way than was said; of a parallel projection it may also be that it looks the other way.
    DepthRunsTheOtherWay,
    /// The picture does not stand across the direction that the view looks along.
    Slanted,
}

impl std::fmt::Display for ViewError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a matrix of the view holds a number that is not finite",
            Self::NotAffine => {
                "the view's matrix from the world is not affine: its last row must be 0, 0, 0, 1 (transpose it if it is meant for row vectors)"
            }
            Self::NotRigid => "the view's matrix from the world scales or shears: it may only turn, mirror and move",
            Self::Singular => "the view's projection cannot be undone",
            Self::LooksTheOtherWay => "the view looks along the other direction of z than was said",
            Self::DepthRunsTheOtherWay => {
                "the view's depth runs the other way than was said (or a parallel view looks along the other direction of z)"
            }
            Self::Slanted => "the view's picture does not stand across the direction that it looks along",
        })
    }
}

impl std::error::Error for ViewError {}

/// How far rows may be from unit length and right angles, and how slanted a picture may be.
const TOLERANCE: f64 = 1e-3;
/// The sine of the angle between the picture's axes below which they are one.
const SMALLEST_ANGLE: f64 = 1e-6;

impl View {
    /// A view from a host's own matrices: from its world to its eye space, and from there to its clip space. Vectors are columns, as in
    /// glam and WGSL; those of hosts with row vectors are transposed first. x runs right and y up in clip space, and row 0 of the
    /// pictures is on top, which is what wgpu draws.
    ///
    /// The projection may be perspective or parallel, with an infinite far plane, off its axis, jittered, or with an oblique near
    /// plane; the eye may even be moved by it, as of stereo pairs. What is said of it ([`MatrixConventions`]) is checked where it can be: whether
    /// [`ClipDepth`] is right cannot. Depths must fill the whole range of the viewport, as is usual.
    ///
    /// The view has the same picture and the depths of the host's depth texture. Its eye space looks along -z whatever the host's does,
    /// with distances in metres; where the host's world is left-handed, eye space mirrors it. Matrices are multiplied in double precision.
    /// Far from the origin the product loses digits all the same: a host that draws relative to its camera gives that world, moved.
    ///
    /// # Errors
    /// [`ViewError`] says what is wrong.
    pub fn from_matrices(
        eye_from_world: Mat4,
        clip_from_eye: Mat4,
        conventions: MatrixConventions,
    ) -> Result<Self, ViewError> {
        let (eye, clip) = (eye_from_world.as_dmat4(), clip_from_eye.as_dmat4());
        if !eye.is_finite() || !clip.is_finite() {
            return Err(ViewError::NotFinite);
        }
        check_rigid(eye)?;
        let turn = match conventions.looks_along {
            LooksAlong::NegativeZ => DMat4::IDENTITY,
            LooksAlong::PositiveZ => DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)),
        };
        let depth = match conventions.clip_depth {
            ClipDepth::ZeroToOne => DMat4::IDENTITY,
            ClipDepth::MinusOneToOne => {
                DMat4::from_translation(DVec3::new(0.0, 0.0, 0.5))
                    * DMat4::from_scale(DVec3::new(1.0, 1.0, 0.5))
            }
        };
        let is_reversed = conventions.reversed_depth;
        let (projection, apex, clip) = projected(depth * clip * turn, is_reversed)?;
        let view = Self {
            clip_from_world: (clip * turn * eye).as_mat4(),
            eye_from_world: (DMat4::from_translation(-apex) * turn * eye).as_mat4(),
            projection,
            reversed_depth: is_reversed,
        };
        if !view.clip_from_world.is_finite() || !view.eye_from_world.is_finite() {
            return Err(ViewError::NotFinite);
        }
        if view.world_from_clip().is_finite() { Ok(view) } else { Err(ViewError::Singular) }
    }
}

fn check_rigid(eye: DMat4) -> Result<(), ViewError> {
    if eye.row(3).abs_diff_eq(DVec4::W, TOLERANCE) {
        let turn = DMat3::from_mat4(eye);
        let is_rigid = (turn * turn.transpose()).abs_diff_eq(DMat3::IDENTITY, TOLERANCE);
        return if is_rigid { Ok(()) } else { Err(ViewError::NotRigid) };
    }
    Err(ViewError::NotAffine)
}

/// How a projection of an eye space that looks along -z projects, where its eye is in that space, and the same projection with w as
/// distance from the eye, or 1.
fn projected(clip: DMat4, is_reversed: bool) -> Result<(Projection, DVec3, DMat4), ViewError> {
    let last = clip.row(3);
    let is_parallel = last.truncate().abs().max_element() <= TOLERANCE * TOLERANCE * last.w.abs();
    let scale = if is_parallel { last.w } else { -last.z };
    if scale == 0.0 {
        return Err(if last.truncate() == DVec3::ZERO { ViewError::Singular } else { ViewError::Slanted });
    }
    if scale < 0.0 {
        return Err(ViewError::LooksTheOtherWay);
    }
    let clip = clip * (1.0 / scale);
    let [across, up, depth, last] = [0, 1, 2, 3].map(|n| clip.row(n));
    let (x, y) = (across.truncate().truncate(), up.truncate().truncate());
    // Written so that no number fails too.
    let has_area = x.perp_dot(y).abs() > SMALLEST_ANGLE * x.length() * y.length();
    if !has_area {
        return Err(ViewError::Singular);
    }
    // Parallel rays run along -z; or the picture's plane stands across it.
    let slant = if is_parallel {
        (across.z / x.length()).abs().max((up.z / y.length()).abs())
    } else {
        last.x.abs().max(last.y.abs())
    };
    if slant > TOLERANCE {
        return Err(ViewError::Slanted);
    }
    let near = if is_reversed { 1.0 } else { 0.0 };
    // Where all rays meet; or the middle of the near plane. And what grows with distance from there.
    let (projection, apex, growth) = if is_parallel {
        let apex = clip.inverse().project_point3(DVec3::new(0.0, 0.0, near));
        (Projection::Orthographic, apex, -depth.z)
    } else {
        let rows = DMat3::from_cols(across.truncate(), up.truncate(), last.truncate()).transpose();
        let apex = -(rows.inverse() * DVec3::new(across.w, up.w, last.w));
        (Projection::Perspective, apex, -depth.dot(apex.extend(1.0)))
    };
    if growth == 0.0 || !growth.is_finite() || !apex.is_finite() {
        return Err(ViewError::Singular);
    }
    if (growth > 0.0) == is_reversed {
        return Err(ViewError::DepthRunsTheOtherWay);
    }
    Ok((projection, apex, clip))
}
