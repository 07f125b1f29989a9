//! The light that hits of reflections reflect: what a host says of its own, since a field has none.

use glam::Vec3;

/// The most lamps that shine on hits.
pub const MAX_LAMPS: usize = 8;

/// A light without extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HitLamp {
    /// Parallel light.
    Sun {
        /// The way it travels.
        direction: Vec3,
        /// W/m2 on a surface that faces it.
        irradiance: Vec3,
    },
    /// The same intensity all round.
    Point {
        /// Where it is.
        position: Vec3,
        /// W/sr.
        intensity: Vec3,
    },
    /// A cone: full inside `beam`, falling linearly with the angle to nothing at `cutoff`, radians from the axis.
    Spot {
        /// Where it is.
        position: Vec3,
        /// Its axis.
        direction: Vec3,
        /// W/sr on the axis.
        intensity: Vec3,
        /// Where the fall begins.
        beam: f32,
        /// Where it ends.
        cutoff: f32,
    },
    /// A small flat light that shines to one side.
    Panel {
        /// Its middle.
        position: Vec3,
        /// Its normal.
        direction: Vec3,
        /// W/sr along that: radiance times area.
        intensity: Vec3,
    },
}

/// What shines on objects where a reflection meets them.
#[derive(Clone, Debug, PartialEq)]
pub struct HitLight {
    /// Radiance from above, W/(m2 sr). A surface sees it by how far it faces up, whatever stands above it.
    pub above: Vec3,
    /// Radiance from below: what the floor sends back.
    pub below: Vec3,
    /// Lamps; those after the first [`MAX_LAMPS`] are passed over.
    pub lamps: Vec<HitLamp>,
    /// Whether objects throw shadows of these on each other: one look-up per hit and lamp.
    pub shadows: bool,
}

crate::gpu_struct! {
    /// A [`HitLamp`] as shaders see it.
    pub struct HitLampUniform {
        /// Where it stands; the way to a sun.
        pub position: Vec3,
        /// Which kind it is.
        pub kind: u32,
        /// Its strength.
        pub intensity: Vec3,
        /// Where a cone's fall begins.
        pub beam: f32,
        /// Its axis.
        pub direction: Vec3,
        /// Where a cone ends.
        pub cutoff: f32,
    }
}

crate::gpu_struct! {
    /// [`HitLight`] as shaders see it.
    pub struct HitLightUniform {
        /// Radiance from above.
        pub above: Vec3,
        /// Number of lamps.
        pub lamp_count: u32,
        /// Radiance from below.
        pub below: Vec3,
        /// Whether objects throw shadows.
        pub shadows: u32,
        /// The lamps.
        pub lamps: [HitLampUniform; MAX_LAMPS],
    }
}

impl HitLight {
    pub(super) fn uniform(&self) -> HitLightUniform {
        let mut lamps: [HitLampUniform; MAX_LAMPS] = bytemuck::Zeroable::zeroed();
        for (slot, lamp) in lamps.iter_mut().zip(&self.lamps) {
            *slot = lamp.uniform();
        }
        HitLightUniform {
            above: self.above,
            lamp_count: self.lamps.len().min(MAX_LAMPS) as u32,
            below: self.below,
            shadows: u32::from(self.shadows),
            lamps,
        }
    }
}

impl HitLamp {
    fn uniform(&self) -> HitLampUniform {
        let unit = |v: Vec3| v.try_normalize().unwrap_or(Vec3::NEG_Y);
        let mut uniform: HitLampUniform = bytemuck::Zeroable::zeroed();
        match *self {
            Self::Sun { direction, irradiance } => {
                (uniform.position, uniform.intensity) = (-unit(direction), irradiance);
            }
            Self::Point { position, intensity } => {
                (uniform.position, uniform.intensity, uniform.kind) = (position, intensity, 1);
            }
            Self::Spot { position, direction, intensity, beam, cutoff } => {
                (uniform.position, uniform.intensity, uniform.kind) = (position, intensity, 2);
                (uniform.direction, uniform.beam, uniform.cutoff) = (unit(direction), beam, cutoff);
            }
            Self::Panel { position, direction, intensity } => {
                (uniform.position, uniform.intensity, uniform.kind) = (position, intensity, 3);
                uniform.direction = unit(direction);
            }
        }
        uniform
    }
}
