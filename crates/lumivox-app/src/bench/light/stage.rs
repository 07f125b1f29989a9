//! One scene with its reference: what every method is measured on.

use anyhow::{Context, Result};
use lumivox::gather::SurfelCount;
use lumivox::gpu::Gpu;
use lumivox_oracle::metrics;
use lumivox_oracle::tracer::{PixelFilter, Rendering};
use lumivox_render::{GiMethod, Layer, Settings};
use lumivox_scene::{Camera, Scene};

use super::cases::Case;
use crate::args::Size;
use crate::compare::measure::{self, Comparison, Masks, Pair, traced_pairs};
use crate::compare::oracle_scene;
use crate::compare::ours::{self, Ours, Pixels};
use crate::compare::reference::{self, Budget};
use crate::motion::Motion;
use crate::{lighting, render};

/// Noise of the reference from which on more samples tell nothing new: its square adds to an error's.
const QUIET: f64 = 0.01;

/// A scene, a camera, and the light that there should be.
pub(super) struct Stage {
    pub(super) case: Case,
    pub(super) scene: Scene,
    pub(super) camera: Camera,
    /// Whether surfaces shine: then only direct and indirect light together can be compared.
    pub(super) glows: bool,
    pub(super) rendering: Rendering,
    pub(super) samples: u32,
    size: Size,
}

/// What a method made of it.
pub(super) struct Measured {
    pub(super) pair: Pair,
    pub(super) comparison: Comparison,
    /// Milliseconds from the volume to settled light: all stages of the method but the look-up at pixels.
    pub(super) light_ms: f64,
    /// Propagation steps or bounces.
    pub(super) steps: u32,
    pub(super) surfels: Option<SurfelCount>,
}

impl Stage {
    /// Loads the scene and traces its reference.
    pub(super) fn new(case: Case, size: Size, seconds: u32) -> Result<Self> {
        let mut scene = render::load(&case.shot)?;
        let (_, camera) = Motion::new(&scene, &case.shot, false)?.pose(&mut scene, 0.0);
        lighting::light_scene(&mut scene, &case.shot, &camera);
        let oracle_scene = oracle_scene::oracle_scene(&scene);
        let budget = Budget {
            size,
            seed: 0,
            filter: PixelFilter::Center,
            bounces: None,
            max_samples: 1 << 18,
            max_seconds: seconds,
        };
        let traced = reference::trace(&oracle_scene, &oracle_scene::oracle_camera(&camera), &budget, |r| {
            let light = &r.indirect;
            metrics::noise(&light.irradiance_error, &light.irradiance, &r.foreground())
                .is_ok_and(|noise| noise < QUIET)
        })?;
        let glows = scene.materials.iter().any(|m| m.emission.max_element() > 0.0);
        Ok(Self { case, scene, camera, glows, rendering: traced.rendering, samples: traced.samples, size })
    }

    /// Settings of a still of this scene.
    pub(super) fn settings(&self, gi: GiMethod, grid: u32) -> Settings {
        let settings = render::settings(&self.case.shot, &self.scene, self.size, Layer::Direct, true);
        // Direct light is measured elsewhere; here it counts where it cannot be told from indirect.
        let area_samples = if self.glows { 256 } else { settings.area_samples.min(4) };
        Settings { gi, grid, area_samples, ..settings }
    }

    /// Settles the light, `steps` of propagation at a time, or as many as the settings say if that is 0.
    pub(super) fn measure(&self, gpu: &Gpu, settings: Settings, steps: u32) -> Result<Measured> {
        self.measure_in(gpu, settings, (Pixels::Mean(1), steps))
    }

    /// As [`measure`](Self::measure), of pixels that come of a finer picture.
    pub(super) fn measure_in(
        &self,
        gpu: &Gpu,
        settings: Settings,
        (pixels, steps): (Pixels, u32),
    ) -> Result<Measured> {
        let ours = ours::render(gpu, &self.scene, settings, (pixels, steps), &self.camera)?;
        let pair = self.pair(&ours)?;
        let is_light = |stage: &str| {
            let of_method = ["gather/", "light/", "lpv/"].iter().any(|method| stage.starts_with(method));
            of_method && stage != "light/reconstruction"
        };
        let light_ms = ours.work.stages.iter().filter(|s| is_light(s.stage)).map(|s| s.ms).sum();
        Ok(Measured {
            comparison: pair.compare(),
            pair,
            light_ms,
            steps: ours.work.iterations.max(settings.iterations),
            surfels: ours.renderer.surfels()?,
        })
    }

    /// Irradiance of indirect light, or of all light where surfaces glow.
    fn pair(&self, ours: &Ours) -> Result<Pair> {
        let masks = Masks::new(&ours.drawn, &self.rendering.foreground(), &[&ours.albedo]);
        let pairs = traced_pairs(ours, &self.rendering, &masks);
        if self.glows {
            return measure::total(&pairs, "irradiance").context("the comparison lacks a layer");
        }
        let indirect = pairs.into_iter().find(|p| p.layer == "indirect" && p.quantity == "irradiance");
        indirect.context("the comparison lacks a layer")
    }
}
