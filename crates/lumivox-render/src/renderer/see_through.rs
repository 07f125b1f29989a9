//! What is asked of a renderer about what light comes through, or does not: leaves, glass and shadow volumes.

use lumivox::refraction::Glass;

use super::glass::GlassObjects;
use super::{GlassKind, GlassNote, Renderer};

impl Renderer {
    /// Changes the part of the light that a leaf takes, with [`Settings::leaf_shadows`](crate::Settings::leaf_shadows), from the next frame on.
    pub fn set_leaf_sigma(&mut self, sigma: f32) {
        if let Some(leaves) = &mut self.leaves {
            leaves.set_sigma(sigma);
        }
    }

    /// Whether any surface leaves a part of a light, with [`Settings::leaf_shadows`](crate::Settings::leaf_shadows).
    pub fn has_leaf_shadows(&self) -> bool {
        self.leaves.is_some()
    }

    /// Whether any light has shadow volumes, with [`Settings::volume_shadows`](crate::Settings::volume_shadows).
    pub fn has_volume_shadows(&self) -> bool {
        self.volumes.is_some()
    }

    /// The kinds of glass, with [`Settings::glass`](crate::Settings::glass).
    pub fn glass(&self) -> &[GlassKind] {
        self.glass.as_ref().map_or(&[], GlassObjects::kinds)
    }

    /// What of the scene's glass is not shown as it is described, with [`Settings::glass`](crate::Settings::glass).
    pub fn glass_notes(&self) -> &[GlassNote] {
        self.glass.as_ref().map_or(&[], GlassObjects::notes)
    }

    /// Changes a kind of glass by its place in [`Self::glass`], from the next frame on.
    pub fn set_glass(&mut self, kind: usize, glass: Glass) {
        if let Some(objects) = &mut self.glass {
            objects.set_glass(&self.gpu, kind, glass);
        }
    }
}
