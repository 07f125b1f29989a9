//! Directions over the hemisphere that looks inwards from a sample point (dissertation 4.4.4), one per texel of a
//! square map, each mapping with its inverse.
//!
//! Directions are local: z points inwards along the normal, x and y are those of [`Frame`]. Texel `(s, t)` stands for
//! the direction of its centre. No inverse leaves the map: a direction below the horizon is taken at the horizon.

mod concentric;
mod frame;
mod rejection;
mod uniform;

use glam::{Vec2, Vec3};

use crate::FieldError;
pub use frame::Frame;

/// The sides of maps there are, in texels.
pub const MAP_SIDES: [u32; 4] = [32, 64, 128, 256];

/// How the texels of a map are spread over the hemisphere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mapping {
    /// Even steps of both spherical angles: dense around the normal (Figure 32a).
    Uniform,
    /// Points of a square lifted to the hemisphere above them (Malley), where the disk covers them: the density goes
    /// with the cosine, and the corners of the map, 21.5 % of it, stay unused (Figure 32b).
    Rejection,
    /// The whole square mapped to the disk by Shirley and Chiu, then lifted by Malley (Figure 32c). The text's choice,
    /// and ours.
    #[default]
    Concentric,
}

impl Mapping {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Uniform, Self::Rejection, Self::Concentric];

    /// The name that [`Mapping::from_str`](std::str::FromStr::from_str) takes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Rejection => "rejection",
            Self::Concentric => "concentric",
        }
    }
}

impl std::str::FromStr for Mapping {
    type Err = FieldError;

    fn from_str(name: &str) -> Result<Self, FieldError> {
        Self::ALL.into_iter().find(|m| m.name() == name).ok_or_else(|| FieldError::Unsupported {
            what: "mapping of directions",
            given: name.to_owned(),
            allowed: "uniform, rejection and concentric",
        })
    }
}

/// A square map of directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Directions {
    mapping: Mapping,
    side: u32,
}

impl Directions {
    /// A map of `side` x `side` directions.
    ///
    /// # Errors
    /// [`FieldError::Unsupported`] for a side that is not one of [`MAP_SIDES`].
    pub fn new(mapping: Mapping, side: u32) -> Result<Self, FieldError> {
        if !MAP_SIDES.contains(&side) {
            return Err(FieldError::Unsupported {
                what: "number of directions along a side",
                given: side.to_string(),
                allowed: "32, 64, 128 and 256",
            });
        }
        Ok(Self { mapping, side })
    }

    /// How texels are spread.
    pub fn mapping(&self) -> Mapping {
        self.mapping
    }

    /// Texels along a side.
    pub fn side(&self) -> u32 {
        self.side
    }

    /// Texels of a map.
    pub fn count(&self) -> u32 {
        self.side * self.side
    }

    /// The local direction of texel `(s, t)`, a unit vector with z > 0; `None` where the mapping leaves it unused.
    pub fn direction(&self, s: u32, t: u32) -> Option<Vec3> {
        let unit = (Vec2::new(s as f32, t as f32) + 0.5) / self.side as f32;
        match self.mapping {
            Mapping::Uniform => Some(uniform::direction(unit)),
            Mapping::Rejection => rejection::direction(unit),
            Mapping::Concentric => Some(concentric::direction(unit)),
        }
    }

    /// Number `s + side * t` of the texel that a local unit direction falls in; always one that is in use.
    #[inline(always)]
    pub fn texel(&self, local: Vec3) -> u32 {
        let unit = match self.mapping {
            Mapping::Uniform => uniform::inverse(local),
            Mapping::Rejection => rejection::inverse(local, self.side),
            Mapping::Concentric => concentric::inverse(local),
        };
        // A conversion to integers saturates, and takes what is no number as 0.
        let at = |v: f32| ((v * self.side as f32) as u32).min(self.side - 1);
        at(unit.x) + self.side * at(unit.y)
    }
}

/// A point of the unit disk lifted to the unit hemisphere above it (Malley).
fn lifted(disk: Vec2) -> Vec3 {
    disk.extend((1.0 - disk.length_squared()).max(0.0).sqrt())
}

/// A direction's point in the unit disk; on its rim for one below the horizon.
#[inline(always)]
fn flattened(local: Vec3) -> Vec2 {
    let disk = local.truncate();
    if local.z > 0.0 { disk } else { disk / disk.length().max(f32::MIN_POSITIVE) }
}

#[cfg(test)]
mod tests;
