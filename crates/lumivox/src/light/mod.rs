//! Volume-based indirect light: direct light leaves surface cells, travels through empty ones, is reflected where it meets
//! occupied ones, and is gathered by the pixels of a G-buffer.
//!
//! Source: dissertation chapter 5, *Interactive volume-based indirect illumination of dynamic scenes*; section 6.3 of the
//! progressive voxelization paper for its use with views.
//!
//! | stage | does |
//! | --- | --- |
//! | `transport` | for each cell: occupied or empty, open faces, normal, albedo |
//! | `seed` | direct and emitted light of occupied cells becomes flux; sky enters at the grid's boundary |
//! | `propagation` | one step: every cell gathers from its six neighbours (equation 11) |
//! | `reconstruction` | irradiance at a pixel from the occupied cells around it (equations 12 to 15) |
//!
//! **Energy.** The flux that leaves a cell is split over its six faces in shares that sum to one, an occupied cell returns
//! its albedo's part of what it receives, and what leaves the grid is gone: what is under way, what was absorbed and what left
//! always add up to what was sent out. Every stage is linear in light. The price of linearity with four coefficients is that
//! a share can be negative (-0.31 of a cell's flux goes back at the default persistence; none below 0.33): the *sums* are
//! right, but next to a small bright patch some cells receive too much and others less than nothing. In a black room with
//! one lit cell the walls receive 119 % and the cell itself -19 %. Only the picture cuts negative light off at zero.
//!
//! **Where the text leaves room.**
//!
//! - *Normalisation.* The 90-degree cones are scaled by 1.138, so that six of them share a cell's flux exactly.
//! - *Direction.* What a cell receives through a face leaves as a lobe about the same direction. A cosine lobe, as light
//!   propagation volumes use, keeps 57 % of its direction in a step (and 37 % in theirs), so most light diffuses back to where it came from: in
//!   the sunlit Sponza atrium indirect light was 1.35 times too strong with a low-frequency error of 96 %.
//!   [`LightSettings::persistence`] says how much is kept.
//! - *Surfaces.* Light leaves occupied cells through their open faces only, shared by the stored normal, instead of into the
//!   neighbouring cells of the same wall. Into the empty cell it enters with the lobe that sends nothing straight back.
//! - *Reflection* is Lambertian about the stored normal, on the side that the light came from, times the stored albedo. The
//!   text's mirrors and its constant albedo can be had instead ([`Reflection`], [`LightSettings::bounce_albedo`]).
//! - *Transmission.* A cell whose occupancy is below one lets the rest of the light through.
//!
//! **Mirrors.** The text mirrors what arrives at an occupied cell about the plane of its normal, by a rotation into the
//! normal's frame, a change of sign and the rotation back, and for speed on the voxel's boundary instead, where one
//! coefficient changes its sign. Bands 0 and 1 of a function are a number and a vector `v`. The number does not change under
//! rotation and mirroring, and the vector does as any vector: the first becomes `v - 2 (v.n) n`, the second `v - 2 (v.f) f` with
//! the face's direction `f`. Here light arrives through a face as a lobe about an axis, `v = r f`, so the second sends
//! it back the way it came. Since the text moves light in empty space only, from boundary to boundary, a mirror stands at the shared face: what
//! an empty cell sends into an occupied one comes back to it in the same step, times albedo. As from any surface the lobe is
//! one that sends nothing straight back, `1/6 (1 + d.f) >= 0` through the face `f` for a lobe about `d`.
//! A mirrored lobe about a slanted normal may look into the next cell of its own surface, and is reflected, and darkened, once more there. Turned boxes show it as
//! faint stripes. Beside the path tracer the three kinds are alike: 33 to 34 % in the Cornell box at 32 cells, and 47 to
//! 50 % on average over four scenes.
//!
//! **Transmission.** Let a cell of occupancy `o` and albedo `a` receive the flux `F` through a face. Of this `(1 - o) F` goes on as
//! through empty space, `o a F` is reflected, and `o (1 - a) F` is absorbed: together `F`. The cell's incident
//! light is that of `F`, since irradiance does not depend on what it falls on; its own light, direct and emitted, counts
//! `o` times. Both parts leave as one distribution, through all faces, so that a part of a curtain's light goes along
//! it, which the text's single volume does too. Occupancy is kept in 255 steps, of which the last stops light.
//! The voxelizers of triangles write it with [`SeeThrough::Opacity`](crate::voxelize::SeeThrough): masks and veils are as opaque as they
//! are on average over a cell, everything else wholly, however little of a cell it fills. Views fill cells wholly.
//! Through a screen across a room that is half open comes 0.45 to 0.5 of the light: what goes through it aslant meets it in two cells.
//!
//! **Flow.** Light of a frame is a pulse that is followed until it has died down: `k` bounces across N cells take `k N` steps, in
//! every frame. Since every stage is linear and the same in each step, sources that send out a pulse in each step make each cell
//! receive, in one step, what it receives of one pulse in all: `sum over s of P^s seed`. So a few steps a frame
//! ([`IndirectLight::record_flow`]) amortize what 5.7 leaves to the host's choice of frames: at rest all bounces are there, and a
//! change runs through the volume as a front of one cell a step, with no frame in which all of it appears.
//!
//! **Limits.** Four coefficients blur directions: there are no sharp indirect shadows. Walls along the axes must be one cell thick or more to hold
//! light back; slanted ones let 1 to 2.4 % through with 1 to 2 cells, as it seems where a cell has open faces on one side alone and sends out
//! there what it got on the other; and a cell whose two sides are lit differently mixes both at its edges. 140 cells a side on the core
//! tier (48 bytes of incident light per cell), and 137 where views bring the light (52 bytes of their sums).

mod free_space;
mod propagation;
mod reconstruction;
mod seed;
mod transport;

use glam::Vec3;

use crate::gpu::{Buffer, Gpu, GpuError, Shader, Texture, Uniform, read_buffer};
use crate::irradiance::FromCells;
use crate::progressive::{DirectLight, ViewInput};
use crate::volume::{VolumeBuffer, check_grid};
use crate::wgsl::HALF_MAX;

pub use reconstruction::IRRADIANCE_FORMAT;

/// Bytes of a cell's propagation state: three bands of four half floats.
const STATE_BYTES: u64 = 24;
/// Bytes of a cell's transport properties.
const TRANSPORT_BYTES: u64 = 16;
/// Bytes of a cell's incident light: three bands of four floats. Half floats would lose the small contributions of
/// late iterations against the sum of the early ones.
const INCIDENT_BYTES: u64 = 48;

/// Flux through one face of an empty cell per unit of the linear coefficient along it: the projection of a 90-degree cone,
/// `Y1 * pi / 2`, scaled by 1.138 so that six faces share the whole.
pub(crate) const FACE_FLUX1: f32 = 0.873_53;

/// How light propagates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSettings {
    /// How much of its direction light keeps in one step through an empty cell, 0 to 1. Low values diffuse: light stays near the
    /// surfaces it left (0.57 is the cosine lobe of light propagation volumes). High values carry it across a
    /// room; at 1 a step conserves energy and momentum. Above 0.33 shares can be negative, which ripples around small
    /// bright patches.
    pub persistence: f32,
    /// Radiance that enters the grid from outside, W/(m2 sr), at most 65504.
    pub sky: Vec3,
    /// Albedo of all surfaces after the first bounce, 0 to 1, in place of the stored one: the text takes 0.5 (5.6). From the
    /// next [`IndirectLight::record_transport`] on.
    pub bounce_albedo: Option<f32>,
}

/// What becomes of light that meets an occupied cell (5.5.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reflection {
    /// It leaves through the open faces on its side, shared by the stored normal.
    #[default]
    Lambertian,
    /// It goes back through the face that it came by: the text's mirror on the voxel boundary.
    AxisMirror,
    /// It is mirrored about the stored normal: the mirror that the text leaves out for speed.
    NormalMirror,
}

impl Default for LightSettings {
    fn default() -> Self {
        Self { persistence: 0.95, sky: Vec3::ZERO, bounce_albedo: None }
    }
}

crate::gpu_struct! {
    /// [`LightSettings`] as shaders see it.
    pub struct PropagationUniform {
        /// Radiance of the sky.
        pub sky: Vec3,
        /// Band-1 to band-0 ratio of the lobes that empty cells pass on.
        pub lobe_ratio: f32,
        /// Albedo of all surfaces after the first bounce; below zero where the stored one counts.
        pub bounce_albedo: f32,
        /// What light that is the same from all sides is multiplied by in free space.
        pub free_space_gain: f32,
        /// Unused.
        pub reserved_1: f32,
        /// Unused.
        pub reserved_2: f32,
    }
}

impl From<&LightSettings> for PropagationUniform {
    fn from(settings: &LightSettings) -> Self {
        // A lobe of unit flux with ratio r carries 2 * FACE_FLUX1 * Y0 * r of net flux through opposite faces.
        const NET_FLUX_PER_RATIO: f32 = 2.0 * FACE_FLUX1 * lumivox_core::sh::Y0;
        let sky = settings.sky.min(Vec3::splat(HALF_MAX));
        let persistence = settings.persistence.clamp(0.0, 1.0);
        Self {
            sky,
            lobe_ratio: persistence / NET_FLUX_PER_RATIO,
            bounce_albedo: settings.bounce_albedo.map_or(-1.0, |albedo| albedo.clamp(0.0, 1.0)),
            free_space_gain: free_space::gain(persistence),
            reserved_1: 0.0,
            reserved_2: 0.0,
        }
    }
}

/// The light of one volume: its stages and what they keep.
#[derive(Debug)]
pub struct IndirectLight {
    transport_pass: transport::Transport,
    seed_pass: seed::Seed,
    renewal_pass: seed::Seed,
    propagation_pass: propagation::Propagation,
    flow_pass: propagation::Propagation,
    reconstruction_pass: reconstruction::Reconstruction,
    free_space: Option<FromCells>,
    reflection: Reflection,
    settings: Uniform<PropagationUniform>,
    transport: Buffer,
    incident: Buffer,
    state: Buffer,
    next_state: Buffer,
}

impl IndirectLight {
    /// Compiles the stages and makes room for the light of `volume`'s cells: 112 bytes each.
    pub fn new(gpu: &Gpu, volume: &VolumeBuffer) -> Result<Self, GpuError> {
        Self::with_reflection(gpu, volume, Reflection::default())
    }

    /// As [`Self::new`], with surfaces that reflect in another way.
    pub fn with_reflection(
        gpu: &Gpu,
        volume: &VolumeBuffer,
        reflection: Reflection,
    ) -> Result<Self, GpuError> {
        check_grid(gpu, "the incident light of a volume", volume.grid(), INCIDENT_BYTES)?;
        let cells = volume.grid().cell_count();
        Ok(Self {
            transport_pass: transport::Transport::new(gpu),
            seed_pass: seed::Seed::new(gpu, false),
            renewal_pass: seed::Seed::new(gpu, true),
            propagation_pass: propagation::Propagation::new(gpu, reflection, true, false),
            flow_pass: propagation::Propagation::new(gpu, reflection, false, false),
            reconstruction_pass: reconstruction::Reconstruction::new(gpu),
            free_space: None,
            reflection,
            settings: Uniform::new(gpu, "light/settings", &(&LightSettings::default()).into()),
            transport: Buffer::storage(gpu, "light/transport", cells * TRANSPORT_BYTES)?,
            incident: Buffer::storage(gpu, "light/incident", cells * INCIDENT_BYTES)?,
            state: Buffer::storage(gpu, "light/state", cells * STATE_BYTES)?,
            next_state: Buffer::storage(gpu, "light/next state", cells * STATE_BYTES)?,
        })
    }

    /// Changes the settings, from the next submission on.
    pub fn update(&self, gpu: &Gpu, settings: &LightSettings) {
        self.settings.write(gpu, &settings.into());
    }

    /// Reads from the volume what propagation needs of each cell. After every change of the volume.
    pub fn record_transport(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.transport_pass.record(gpu, encoder, (volume, &self.settings), &mut self.transport)
    }

    /// Starts anew from the light that leaves surfaces and the sky: no incident light yet.
    pub fn record_seed(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        direct: &DirectLight,
    ) -> Result<(), GpuError> {
        encoder.clear_buffer(&self.incident.raw, 0, None);
        let lit = seed::Lit { volume, direct, transport: &self.transport, settings: &self.settings };
        self.seed_pass.record(gpu, encoder, &lit, &mut self.state)
    }

    /// Propagates `iterations` more steps. Light moves at most one cell a step: `k` bounces across a grid of N cells need about
    /// `k * N` steps (5.6). May be called again to go on, in the same frame or a later one.
    pub fn record_propagation(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        iterations: u32,
    ) -> Result<(), GpuError> {
        for _ in 0..iterations {
            let media = propagation::Media { volume, transport: &self.transport, settings: &self.settings };
            self.propagation_pass.record(
                gpu,
                encoder,
                &media,
                &self.state,
                (&mut self.next_state, &mut self.incident),
            )?;
            std::mem::swap(&mut self.state, &mut self.next_state);
        }
        Ok(())
    }

    /// Goes on with light that flows, by `steps` more: in place of [`record_seed`](Self::record_seed) and
    /// [`record_propagation`](Self::record_propagation), a few steps in every frame. Surfaces and the sky send out their light anew in each
    /// step, and incident light is what the last one brought. When nothing changes that comes to the sum of all bounces, and it
    /// costs no more than its steps; what changes spreads by one cell a step. Begins in the dark.
    pub fn record_flow(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        direct: &DirectLight,
        steps: u32,
    ) -> Result<(), GpuError> {
        for _ in 0..steps {
            let lit = seed::Lit { volume, direct, transport: &self.transport, settings: &self.settings };
            self.renewal_pass.record(gpu, encoder, &lit, &mut self.state)?;
            let media = propagation::Media { volume, transport: &self.transport, settings: &self.settings };
            let next = (&mut self.next_state, &mut self.incident);
            self.flow_pass.record(gpu, encoder, &media, &self.state, next)?;
            std::mem::swap(&mut self.state, &mut self.next_state);
        }
        Ok(())
    }

    /// Irradiance in W/m2 at every pixel of a G-buffer, into a target of [`IRRADIANCE_FORMAT`]. Black where nothing
    /// was drawn, and where no occupied cell is near.
    pub fn record_reconstruction(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        let incident = (&self.incident, &self.transport);
        self.reconstruction_pass.record(gpu, encoder, volume, incident, view, target)
    }

    /// Flux still under way, summed over cells and colour bands, in units of W/m2 times cell faces. Falls towards zero as light
    /// settles. Reads back and waits; not for use inside a frame.
    pub fn flux_under_way(&self, gpu: &Gpu) -> Result<f64, GpuError> {
        let state: Vec<[half::f16; 4]> = read_buffer(gpu, &self.state)?;
        let flux_per_constant = (4.0 * std::f64::consts::PI).sqrt();
        Ok(state.iter().map(|band| band[0].to_f64() * flux_per_constant).sum())
    }

    /// Incident light of each cell, three bands of four coefficients. Waits; not for use inside a frame.
    pub fn read_incident(&self, gpu: &Gpu) -> Result<Vec<[[f32; 4]; 3]>, GpuError> {
        read_buffer(gpu, &self.incident)
    }
}

pub(crate) fn shaders() -> Vec<Shader> {
    vec![transport::SHADER, seed::SHADER, propagation::SHADER, reconstruction::SHADER]
}
