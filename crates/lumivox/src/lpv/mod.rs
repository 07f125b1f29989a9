//! Light propagation volumes: the method that volume-based indirect light ([`crate::light`]) set out to better, kept as the
//! baseline that it is measured against.
//!
//! Sources: A. Kaplanyan, *Light Propagation Volumes in CryEngine 3*, 2009; A. Kaplanyan and C. Dachsbacher, *Cascaded Light
//! Propagation Volumes for Real-Time Indirect Illumination*, 2010. Of the second, blocking and its bounce, not the cascades.
//!
//! | stage | does |
//! | --- | --- |
//! | `injection` | points of reflective shadow maps become virtual point lights, half a cell before their surface |
//! | `geometry` | with blocking: points of all views become blockers, in a volume half a cell off the grid |
//! | `seed` | the sums of virtual point lights are the first state |
//! | `propagation` | one step: thirty fluxes from six neighbours through a cell's far faces |
//! | `reconstruction` | irradiance at a pixel from the light of all steps |
//!
//! The volume gives its grid and nothing else: neither occupancy nor albedo is asked for.
//!
//! **Units.** A cell's state is the intensity of the light that leaves it next as spherical harmonics, in W/sr for a cell face of
//! one square metre, so that numbers do not depend on the size of the scene. Its integral over the sphere is flux.
//!
//! **Energy.** A virtual point light has the flux that its part of the surface reflects, `pi * radiance * area`. The solid angles of
//! the thirty faces add up to the sphere, and their directions cancel in pairs, so that a step without blockers hands on all
//! of a cell's flux, whatever its four coefficients, until it leaves the grid. Nothing is absorbed: light goes through
//! walls and comes back by diffusion.
//! With blockers a step hands on what is not held back, and [`Blocking::Reflecting`] returns the blocker's albedo's part of
//! the rest.
//!
//! **Where the sources leave room.**
//!
//! - *Negative intensity.* Four coefficients of a cosine lobe are below zero behind it. Cutting it off, as is common, adds up
//!   to an eighth of a lobe's flux in a step; here it stays, and without blockers every
//!   stage is linear in light. Blockers let it pass: held back, it would be light made.
//! - *Irradiance.* The sources take a cell's light as a point light half a cell away, which makes a surface twice as bright
//!   as the light that reaches it. Here irradiance is the flux through a face of the cell before the surface (`reconstruction`).
//! - *Blockers* hold light back that meets the side that was seen. Four coefficients of a full surface's potential reach 0.75:
//!   a quarter of the light that meets it head-on passes.
//! - Damping by the gradient along the normal, which hides light that a surface receives of itself, is left out.
//!
//! **Limits.** One bounce, unless blockers reflect; no emission, no sky but through its views; walls that no view of a lamp or
//! camera shows block nothing. A step keeps 37 % of its light's direction, so light diffuses: it does not reach far, and most of
//! it has not left the grid after the usual number of steps, two for each cell of the longest side. 140 cells a side on the
//! core tier (48 bytes of sums per cell), whatever other stages beside it allow.

mod geometry;
mod injection;
mod propagation;
mod reconstruction;
mod seed;

use crate::gpu::{Buffer, Gpu, GpuError, Shader, Texture, read_buffer};
use crate::irradiance::{FromCells, IrradianceSource, IrradianceVolume, LPV};
use crate::progressive::{LightView, ViewInput};
use crate::volume::{VolumeBuffer, check_grid};

use geometry::Geometry;

pub(crate) use injection::LIGHT_STEPS;

/// The shared shader part of points that stand for an area.
pub(crate) const AREA: &str = include_str!("area.wgsl");
/// The shared shader part of the geometry volume's cells.
const GEOMETRY: &str = include_str!("geometry.wgsl");
/// How far virtual point lights lie before their surface, and the points that pixels ask, in cells.
const HALF_CELL: f64 = 0.5;

/// Bytes of a cell's state: three bands of four half floats.
const STATE_BYTES: u64 = 24;
/// Bytes of a cell's sums of injected light, and of its light of all steps: three bands of four words.
const SUM_BYTES: u64 = 48;

/// What holds light back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Blocking {
    /// Nothing: plain light propagation volumes.
    #[default]
    None,
    /// Surfaces that views show, in part and blurred.
    Fuzzy,
    /// These, and they reflect what they hold back: more bounces.
    Reflecting,
}

/// The light of one volume: its stages and what they keep.
#[derive(Debug)]
pub struct LightPropagationVolume {
    injection_pass: injection::Injection,
    seed_pass: seed::Seed,
    propagation_pass: propagation::Propagation,
    reconstruction_pass: reconstruction::Reconstruction,
    free_space_pass: FromCells,
    geometry: Option<Geometry>,
    no_blockers: Buffer,
    light_sums: Buffer,
    accumulated: Buffer,
    state: Buffer,
    next_state: Buffer,
}

impl LightPropagationVolume {
    /// Compiles the stages and makes room for the light of `volume`'s cells: 144 bytes each, and 44 more with blocking.
    ///
    /// # Errors
    /// A grid that does not fit the device.
    pub fn new(gpu: &Gpu, volume: &VolumeBuffer, blocking: Blocking) -> Result<Self, GpuError> {
        check_grid(gpu, "the light propagation volume", volume.grid(), SUM_BYTES)?;
        let cells = volume.grid().cell_count();
        let make = |name: &str, bytes: u64| Buffer::storage(gpu, &format!("lpv/{name}"), bytes);
        let geometry = (blocking != Blocking::None).then(|| Geometry::new(gpu, volume)).transpose()?;
        Ok(Self {
            injection_pass: injection::Injection::new(gpu),
            seed_pass: seed::Seed::new(gpu),
            propagation_pass: propagation::Propagation::new(gpu, blocking),
            reconstruction_pass: reconstruction::Reconstruction::new(gpu),
            free_space_pass: FromCells::new(gpu, &LPV),
            geometry,
            no_blockers: make("no blockers", 16)?,
            light_sums: make("light sums", cells * SUM_BYTES)?,
            accumulated: make("accumulated", cells * SUM_BYTES)?,
            state: make("state", cells * STATE_BYTES)?,
            next_state: make("next state", cells * STATE_BYTES)?,
        })
    }

    /// Begins a frame: no virtual point lights and no blockers yet.
    pub fn record_begin(&mut self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.light_sums.raw, 0, None);
        if let Some(geometry) = &mut self.geometry {
            geometry.record_clear(encoder);
        }
    }

    /// Adds the virtual point lights of one view: the reflective shadow map of a light, one of the six of a point light, or of
    /// one sample of a large light. Views of one light must not overlap, and a cell that all views of the frame together fill
    /// with more than 62 faces of the largest radiance overflows.
    pub fn record_light<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: impl Into<LightView<'v>>,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.injection_pass.record(gpu, encoder, view.into(), volume, &mut self.light_sums)
    }

    /// Adds the surfaces that a view shows, the camera's or a light's, to the blockers. Does nothing without blocking.
    pub fn record_geometry(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let Some(geometry) = &mut self.geometry else { return Ok(()) };
        geometry.record(gpu, encoder, view, volume)
    }

    /// Starts anew from the virtual point lights: no light has arrived anywhere yet. `view` is any of the frame's views; all were
    /// updated with the same largest radiance.
    pub fn record_seed(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        encoder.clear_buffer(&self.accumulated.raw, 0, None);
        self.seed_pass.record(gpu, encoder, (view, volume), &self.light_sums, &mut self.state)
    }

    /// Propagates `iterations` more steps. May be called again to go on, in the same frame or a later one.
    pub fn record_propagation(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        iterations: u32,
    ) -> Result<(), GpuError> {
        let blockers = self.geometry.as_ref().map_or(&self.no_blockers, |g| &g.blockers);
        for _ in 0..iterations {
            self.propagation_pass.record(
                gpu,
                encoder,
                (volume, blockers),
                &self.state,
                (&mut self.next_state, &mut self.accumulated),
            )?;
            std::mem::swap(&mut self.state, &mut self.next_state);
        }
        Ok(())
    }

    /// Irradiance in W/m2 at every pixel of a G-buffer, into a target of [`IRRADIANCE_FORMAT`](crate::light::IRRADIANCE_FORMAT).
    /// Black where nothing was drawn.
    pub fn record_reconstruction(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        self.reconstruction_pass.record(gpu, encoder, (volume, &self.accumulated), view, target)
    }

    /// Flux still under way, summed over cells and colour bands, in W/m2 times cell faces. Reads back and waits; not for use inside
    /// a frame.
    pub fn flux_under_way(&self, gpu: &Gpu) -> Result<f64, GpuError> {
        let state: Vec<[half::f16; 4]> = read_buffer(gpu, &self.state)?;
        let flux_per_constant = (4.0 * std::f64::consts::PI).sqrt();
        Ok(state.iter().map(|band| band[0].to_f64() * flux_per_constant).sum())
    }

    /// Light of all steps of each cell, three bands of four coefficients. Waits; not for use inside a frame.
    pub fn read_accumulated(&self, gpu: &Gpu) -> Result<Vec<[[f32; 4]; 3]>, GpuError> {
        read_buffer(gpu, &self.accumulated)
    }
}

impl IrradianceSource for LightPropagationVolume {
    fn record_irradiance_volume(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        target: &mut IrradianceVolume,
        part: (u32, u32, u32),
    ) -> Result<(), GpuError> {
        self.free_space_pass.record(gpu, encoder, (volume, &self.accumulated, None), target, part)
    }
}

pub(crate) fn shaders() -> Vec<Shader> {
    vec![
        injection::SHADER,
        geometry::INJECTION,
        geometry::RESOLVE,
        seed::SHADER,
        propagation::SHADER,
        reconstruction::SHADER,
    ]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    /// The numbers that the propagation shader spells out.
    #[test]
    fn solid_angles_are_those_of_the_faces() {
        // A rectangle seen from above its middle: half sides a and b at a distance d.
        let angle = |a: f64, b: f64, d: f64| 4.0 * (a * b / (d * (a * a + b * b + d * d).sqrt())).atan();
        let front = angle(0.5, 0.5, 1.5);
        let side = (angle(0.5, 0.5, 0.5) - front) / 4.0;
        let spelled = |name: &str| -> f64 {
            let text = include_str!("propagation.wgsl");
            let line = text.lines().find_map(|l| l.strip_prefix(&format!("const {name}: f32 = "))).unwrap();
            line.trim_end_matches(';').parse().unwrap()
        };
        assert!((spelled("FRONT_ANGLE") - front).abs() < 1e-7, "{front}");
        assert!((spelled("SIDE_ANGLE") - side).abs() < 1e-7, "{side}");
        assert!((6.0 * front + 24.0 * side - 4.0 * PI).abs() < 1e-12);
        assert!((spelled("SIDE_AHEAD") - 1.0 / 1.25f64.sqrt()).abs() < 1e-7);
        assert!((spelled("SIDE_ACROSS") - 0.5 / 1.25f64.sqrt()).abs() < 1e-7);
    }
}
