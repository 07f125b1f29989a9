//! One random path: how much light a surface point gets, kept apart by the number of bounces.
//!
//! The irradiance at a point is `E = E_direct + integral of L(w) cos dw` over what it sees; a Lambertian surface there
//! sends `L = emission + albedo / pi * E`. So one random direction with density `cos / pi` continues the path, and the
//! irradiance found at its end counts times the albedo there. Emission that it meets is weighted against [`emitted`].
//! From the fourth bounce on the path goes on with a probability of its weight, at most 95 %, and is scaled up: its
//! mean is that of endless paths. The first steps are taken by evenly spread numbers ([`super::sequence`]), the others by
//! random ones.

use glam::{Vec2, Vec3};
use std::f32::consts::PI;

use super::geometry::lifted;
use super::lights::{emitted, punctual, share};
use super::random::{Random, cosine_direction};
use super::sequence::FirstSteps;
use super::world::{Surface, World};

/// Irradiance at a point in W/m2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gathered {
    /// Straight from emitters and the sky.
    pub(crate) direct: Vec3,
    /// After one reflection.
    pub(crate) first_bounce: Vec3,
    /// After one or more reflections.
    pub(crate) indirect: Vec3,
}

const ROULETTE_FROM: u32 = 3;
const ROULETTE_MOST: f32 = 0.95;

/// Where paths begin, with what does not depend on chance there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    pub(crate) surface: Surface,
    punctual: Vec3,
}

impl Start {
    pub(crate) fn new(world: &World<'_>, surface: Surface) -> Self {
        Self { surface, punctual: punctual(world, &surface) }
    }
}

/// A sample of the light that reaches `start` after at most `bounces` reflections (`None`: any number).
pub(crate) fn gather(
    world: &World<'_>,
    start: &Start,
    bounces: Option<u32>,
    first: &FirstSteps,
    random: &mut Random,
) -> Gathered {
    let mut gathered = Gathered::default();
    let mut surface = start.surface;
    let mut weight = Vec3::ONE;
    for bounce in 0.. {
        let (lamps, light, direction) = match bounce {
            0 => (start.punctual, first.light, first.direction),
            _ => (punctual(world, &surface), random.cube(), random.square()),
        };
        let mut irradiance = lamps + emitted(world, &surface, light);
        let is_last = bounces.is_some_and(|most| bounce >= most);
        let next = follow(world, &surface, direction, is_last);
        irradiance += match &next {
            Next::Nothing => Vec3::ZERO,
            Next::Sky(direction) => PI * world.sky(*direction),
            Next::Surface { light, .. } => PI * *light,
        };
        match bounce {
            0 => gathered.direct += irradiance,
            1 => gathered.first_bounce += weight * irradiance,
            _ => {}
        }
        if bounce > 0 {
            gathered.indirect += weight * irradiance;
        }
        let Next::Surface { surface: reached, .. } = next else { break };
        if is_last {
            break;
        }
        surface = reached;
        weight *= surface.albedo;
        if bounce >= ROULETTE_FROM {
            let chance = weight.max_element().min(ROULETTE_MOST);
            if random.unit() >= chance {
                break;
            }
            weight /= chance;
        }
        if weight == Vec3::ZERO {
            break;
        }
    }
    gathered
}

/// What lies in a random direction from a surface.
enum Next {
    /// Nothing that matters: the direction runs into the surface itself, where the interpolated normal leans too far, or
    /// at the end of a path into one that sends no light.
    Nothing,
    /// The sky, in this direction.
    Sky(Vec3),
    Surface {
        surface: Surface,
        /// Its emission, weighted against light sampling.
        light: Vec3,
    },
}

fn follow(world: &World<'_>, from: &Surface, sample: Vec2, is_last: bool) -> Next {
    let direction = cosine_direction(sample, from.normal);
    if from.face.dot(direction) <= 0.0 {
        return Next::Nothing;
    }
    if is_last && world.emitters.is_empty() {
        // Whatever is met is dark, so any surface will do, and without a sky it need not be looked for.
        let is_open = world.has_sky() && world.sees(from, direction, f32::INFINITY, None);
        return if is_open { Next::Sky(direction) } else { Next::Nothing };
    }
    let Some(surface) = world.trace(lifted(from.position, from.face), direction, true) else {
        return Next::Sky(direction);
    };
    let mut light = surface.emission;
    if light != Vec3::ZERO {
        let distance2 = (surface.position - from.position).length_squared();
        let facing = surface.face.dot(direction).abs().max(f32::MIN_POSITIVE);
        let by_light = surface.light_density * distance2 / facing;
        light *= share(from.normal.dot(direction) / PI, by_light);
    }
    Next::Surface { surface, light }
}
