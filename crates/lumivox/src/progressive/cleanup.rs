//! Cleanup (6.2.1, Listing 6.1; dissertation 7.4.1): what a depth image proves empty is cleared, by one of three
//! rules.
//!
//! **`center`**, the papers': the cell's centre is projected into the view. With `p` its distance along the view direction and
//! `z` the distance of what the depth image shows at that texel, the cell is cleared when `p < z - b`. The bias `b` is half
//! the cell's extent along the view's depth axis, `cell / 2 * (|dx| + |dy| + |dz|)` for the view direction `d`: 0.5 to 0.87
//! cell, the "radius clamped by the voxel boundaries" of the text. The printed listing takes the distance between two
//! opposite corners moved by a radius instead, up to 3 cells, and leaves that much stale.
//! Centres outside the view's frustum are kept.
//!
//! **`footprint`**, ours: the cell's corners are projected, and the cell is cleared when the nearest depth in the
//! rectangle of texels around them lies behind the farthest corner. The cell is taken larger by [`SURFACE_SHIFT`] a side, so that
//! no view clears a cell that it injects a point into. Cells that reach out of the picture, before the near plane or
//! behind the eye are kept: what is proven empty is proven by this view alone, and as a whole. A rectangle wider than 8
//! texels is looked at in blocks of 2, one wider than 16 in blocks of 4, and so on, which widens it by an eighth at
//! most. Depths are compared as the view writes them, so any projection will do: standard or reversed, with a far plane
//! or without, jittered, orthographic.
//!
//! **`rays`**, ours: as `footprint`, but each texel is held against the depth at which the ray through it leaves the cell. The
//! farthest corner lies behind a floor that passes below a cell or beside it, so `footprint` keeps what has been left there;
//! the rays leave the cell before they meet the floor. A surface within the cell, or up to 1/64 cell around it, keeps it.
//!
//! A texel on which nothing was drawn shows the far plane: what lies before it is empty, by every rule.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, PACK, VIEW, VISIBILITY, linear_groups};

use super::nearest::NearestDepth;
use super::{SURFACE_SHIFT, ViewInput};

const PASS: &str = include_str!("cleanup.wgsl");
/// The rules' texts: `proven_empty` of a cell.
pub(super) const CENTER: &str = include_str!("center.wgsl");
pub(super) const FOOTPRINT: &str = include_str!("footprint.wgsl");

pub(super) const BY_CENTER: Shader =
    Shader { name: "progressive/cleanup by center", parts: &[GRID, VIEW, VISIBILITY, PACK, CENTER, PASS] };
pub(super) const BY_FOOTPRINT: Shader =
    Shader { name: "progressive/cleanup by footprint", parts: &[GRID, VIEW, PACK, FOOTPRINT, PASS] };

/// Whether a rule follows rays, for the shader.
pub(super) fn by_rays(rule: CleanupRule) -> (&'static str, f64) {
    ("BY_RAYS", if rule == CleanupRule::Rays { 1.0 } else { 0.0 })
}

/// What a view must show for a cell to be cleared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CleanupRule {
    /// The papers': something farther than the cell, at the texel of its centre. Clears stale cells eagerly, and
    /// with them good ones at silhouettes and grazing angles: some 10 % of the seen cells in each frame of an orbit.
    Center,
    /// Something farther than the whole cell, at every texel that the cell touches. Keeps what is there; a stale cell that
    /// stands against a silhouette or reaches out of the picture goes when a view sees it whole.
    #[default]
    Footprint,
    /// Something farther, at every texel that the cell touches, than where the ray through it leaves the cell. More of what is stale
    /// beside a floor or a wall goes. Where cells are smaller than two texels, more good ones at silhouettes go too: of a model that
    /// stands still 0.7 % of the cells in a frame of an orbit at 256 cells a side, where [`Self::Footprint`] loses 0.09 %. Costs some six
    /// planes a texel.
    Rays,
}

#[derive(Debug)]
pub(super) struct Cleanup {
    pass: ComputePass,
    nearest: Option<NearestDepth>,
}

impl Cleanup {
    pub(super) fn new(gpu: &Gpu, rule: CleanupRule) -> Self {
        match rule {
            CleanupRule::Center => Self { pass: ComputePass::new(gpu, &BY_CENTER, &[]), nearest: None },
            CleanupRule::Footprint | CleanupRule::Rays => Self {
                pass: ComputePass::new(
                    gpu,
                    &BY_FOOTPRINT,
                    &[("SURFACE_SHIFT", SURFACE_SHIFT), by_rays(rule)],
                ),
                nearest: Some(NearestDepth::new(gpu)),
            },
        }
    }

    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        let levels = self
            .nearest
            .as_mut()
            .map(|n| n.record(gpu, encoder, (&view.uniform, &view.textures.depth)))
            .transpose()?;
        let groups = linear_groups(volume.grid().cell_count() as u32);
        let (grid, mut channels) = volume.ping_pong();
        let [normal, albedo, emission] = channels.as_mut_slice() else {
            return Err(super::resolve::wrong_channels(self.pass.name()));
        };
        let mut bindings = Bindings::new()
            .read("grid", grid)
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal_in", normal.0)
            .read("albedo_in", albedo.0)
            .read("emission_in", emission.0)
            .write("normal_out", normal.1)
            .write("albedo_out", albedo.1)
            .write("emission_out", emission.1);
        if let Some(levels) = levels {
            bindings = bindings.read("levels", levels);
        }
        self.pass.record(gpu, encoder, &bindings, groups)?;
        volume.swap();
        Ok(())
    }
}
