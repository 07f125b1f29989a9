//! The sun, and the clip in which it crosses the sky.

use glam::{Quat, Vec3};

use crate::builtin::builder::SceneBuilder;
use crate::{Clip, Light, Track, Transform};

/// Way of the sunlight while nothing moves, and at the beginning of the clip.
const NOON: Vec3 = Vec3::new(0.27, -1.0, 0.42);
/// Degrees from there to where the sun goes down, and to where it comes up, along the court's length: both about 15
/// degrees over the horizon.
const EVENING: f32 = 58.0;
const MORNING: f32 = -86.0;
/// Seconds of the afternoon; the morning is as long. Between them the sun is out and goes back for [`NIGHT`] seconds.
const AFTERNOON: f32 = 8.0;
const NIGHT: f32 = 2.0;
/// Seconds over which it fades before the night and after it.
const DUSK: f32 = 1.0;
const DURATION: f32 = 2.0 * AFTERNOON + NIGHT;

pub(super) fn add(scene: &mut SceneBuilder) {
    let direction = NOON.normalize_or_zero();
    let node = scene.node(None, Transform::default());
    let irradiance = Vec3::new(14.0, 12.6, 10.5);
    let light = scene.hang_light(Light::Directional { direction, irradiance }, node);
    // Turning about this, the light keeps to the plane that holds it and the long side.
    let axis = direction.cross(Vec3::X).normalize_or(Vec3::Z);
    let turned = |degrees: f32| Quat::from_axis_angle(axis, degrees.to_radians());
    let evening = AFTERNOON;
    let morning = AFTERNOON + NIGHT;
    let path =
        [(0.0, 0.0), (evening, EVENING), (evening + 0.5 * NIGHT, 0.0), (morning, MORNING), (DURATION, 0.0)];
    let shine = [(0.0, 1.0), (evening - DUSK, 1.0), (evening, 0.0), (morning, 0.0), (morning + DUSK, 1.0)];
    let mut clip =
        Clip::new("day").with(node, Track::rotation(path.map(|(t, degrees)| (t, turned(degrees)))));
    clip.push_light(light, Track::brightness(shine));
    scene.clip(clip);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scene, builtin::atrium};

    fn sun(scene: &Scene, seconds: f32) -> (Vec3, f32) {
        match scene.pose(0, seconds).lights[0] {
            Light::Directional { direction, irradiance } => (direction, irradiance.x),
            _ => unreachable!(),
        }
    }

    #[test]
    fn the_sun_begins_where_it_stands_and_moves_without_a_jump_while_it_shines() {
        let scene = atrium(0);
        assert_eq!((scene.clips().len(), scene.clips()[0].duration), (1, DURATION));
        let Light::Directional { direction, irradiance } = scene.lights[0] else { unreachable!() };
        assert_eq!((direction, irradiance), (NOON.normalize_or_zero(), Vec3::new(14.0, 12.6, 10.5)));
        let step = DURATION / 720.0;
        for i in 0..720 {
            let [(a, before), (b, after)] = [0.0, 1.0].map(|d| sun(&scene, step * (i as f32 + d)));
            assert!(a.y < -0.25 && a.is_normalized(), "it never sets: {a}");
            assert!((after - before).abs() < 14.0 * step / DUSK * 1.01);
            assert!(before == 0.0 || a.angle_between(b) < 0.01, "{i}");
        }
        assert!(sun(&scene, 6.0).0.x > 0.75 && sun(&scene, 12.0).0.x < -0.4);
        assert_eq!(sun(&scene, AFTERNOON + 0.5 * NIGHT).1, 0.0);
    }
}
