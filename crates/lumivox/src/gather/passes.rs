//! The stages of gathered light, made once.

use super::{
    bounce, dark, direct, dispatch, due, fade, given_subcells, glossy, inherit, lattice, mask, own_light,
    reconstruction, sky_light, smooth, surfels, trace, view_subcells,
};
use crate::gpu::Gpu;

/// All of them.
#[derive(Debug)]
pub(super) struct Passes {
    pub(super) whole_cells: mask::Mask,
    pub(super) known_subcells: mask::Mask,
    pub(super) give: surfels::Surfels,
    pub(super) free: surfels::Surfels,
    pub(super) inherit: inherit::Inherit,
    pub(super) over_surfels: dispatch::Dispatch,
    pub(super) due: due::Due,
    pub(super) over_due: dispatch::Dispatch,
    pub(super) dark: dark::Dark,
    pub(super) direct: direct::Direct,
    pub(super) given_subcells: given_subcells::GivenSubcells,
    pub(super) view_subcells: view_subcells::ViewSubcells,
    pub(super) trace: trace::Trace,
    pub(super) sky_light: sky_light::SkyLight,
    pub(super) lattice: lattice::Lattice,
    pub(super) own_light: own_light::OwnLight,
    pub(super) bounce: bounce::Bounce,
    pub(super) smooth: smooth::Smooth,
    pub(super) fade: fade::Fade,
    /// By what is known of sub-cells, as [`super::Subcells`] counts.
    pub(super) reconstruction: [reconstruction::Reconstruction; 3],
    pub(super) leaks: [reconstruction::Reconstruction; 3],
    pub(super) glossy: glossy::Glossy,
}

impl Passes {
    /// Compiles them.
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            whole_cells: mask::Mask::new(gpu, false),
            known_subcells: mask::Mask::new(gpu, true),
            give: surfels::Surfels::new(gpu, false),
            free: surfels::Surfels::new(gpu, true),
            inherit: inherit::Inherit::new(gpu),
            over_surfels: dispatch::Dispatch::over_surfels(gpu),
            due: due::Due::new(gpu),
            over_due: dispatch::Dispatch::over_due(gpu),
            dark: dark::Dark::new(gpu),
            direct: direct::Direct::new(gpu),
            given_subcells: given_subcells::GivenSubcells::new(gpu),
            view_subcells: view_subcells::ViewSubcells::new(gpu),
            trace: trace::Trace::new(gpu),
            sky_light: sky_light::SkyLight::new(gpu),
            lattice: lattice::Lattice::new(gpu),
            own_light: own_light::OwnLight::new(gpu),
            bounce: bounce::Bounce::new(gpu),
            smooth: smooth::Smooth::new(gpu),
            fade: fade::Fade::new(gpu),
            reconstruction: reconstruction::Reconstruction::of_each(gpu, false),
            leaks: reconstruction::Reconstruction::of_each(gpu, true),
            glossy: glossy::Glossy::new(gpu),
        }
    }
}
