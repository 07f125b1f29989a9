//! The two lighting rules (6.3): what a cell's light is made of, and how long it lasts.
//!
//! **`pulled`**, ours: the light of a frame is made of this frame's samples alone. It is, per light, the *mean* exitant radiance
//! of the samples of that light's map that fall in the cell, summed over the lights. A mean does not grow with the number of
//! points, and what is made afresh in each frame cannot outlive its lamp. Cells that nothing samples are dark.
//!
//! **`stored`**, the papers': a light's samples are virtual point lights, which are blended additively, and cells that nothing
//! samples in a frame keep the light that they have, as long as they are there. So a wall that a view has left goes on shining, and
//! so does one whose lamp has gone out or moved, until a sample falls into it. A virtual point light is a cosine lobe
//! of the flux that its part of the surface reflects, as in light propagation volumes: the share of a cell's face that a
//! point stands for is taken from the depth and the normal of its texel.
//!
//! By both rules the mean of camera samples *replaces* what the lights brought to their cell, since the camera's picture holds
//! all lights at once.
//!
//! The papers inject into a buffer of its own that is cleared in each frame, whose cells then replace those of the volume. Here
//! a mark per cell says whether the frame has reached it: the first samples replace what is stored, later ones are added.
//! That is the same light without a second buffer of 24 bytes a cell.

use super::CleanupRule;

/// How long direct light stays in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightRule {
    /// For this frame: means of samples, summed over lights.
    #[default]
    Pulled,
    /// The papers': until a sample falls into the cell again, or cleanup clears it. Samples of lights add up by the surface that they
    /// stand for. Stale light stays where no view looks. Takes 4 bytes a cell more, and 24 bytes of light to read.
    Stored,
}

impl LightRule {
    /// The rule's text, after the grid: `keeps_light` of a cell.
    pub(super) const PULLED: &str = include_str!("light_pulled.wgsl");
    pub(super) const STORED: &str = include_str!("light_stored.wgsl");

    /// Whether samples of a light are summed up and not averaged.
    pub(super) fn adds_up(self) -> bool {
        self == Self::Stored
    }
}

/// The rules that a volume is kept up by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rules {
    /// What a view must show for a cell to be cleared.
    pub cleanup: CleanupRule,
    /// How long light stays in a cell.
    pub light: LightRule,
}

impl From<CleanupRule> for Rules {
    fn from(cleanup: CleanupRule) -> Self {
        Self { cleanup, ..Self::default() }
    }
}
