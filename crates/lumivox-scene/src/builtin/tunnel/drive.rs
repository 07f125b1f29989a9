//! How the tank moves: forth and back through the tunnel, wheels rolling, turret searching.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec3};

use super::tank::{GUN_TILT, Rig, WHEEL};
use super::{LAMP, START};
use crate::builtin::builder::SceneBuilder;
use crate::{Clip, Light, SpotFalloff, Track};

/// Seconds of one way, of the stop at either end, and of both ways and stops.
const WAY: f32 = 5.5;
const STOP: f32 = 0.5;
pub(super) const DURATION: f32 = 2.0 * (WAY + STOP);
/// Metres from the start to where the tank stops before the camera.
const DISTANCE: f32 = 11.0;
/// Keys per second.
const RATE: f32 = 20.0;

/// Metres from the start after so many seconds; it speeds up and slows down gently.
fn distance(seconds: f32) -> f32 {
    let way = |t: f32| 0.5 - 0.5 * (PI * (t / WAY).clamp(0.0, 1.0)).cos();
    let t = seconds.rem_euclid(DURATION);
    DISTANCE * if t < WAY + STOP { way(t) } else { 1.0 - way(t - WAY - STOP) }
}

/// Hangs the lamp on the tank and lets it drive.
pub(super) fn add(scene: &mut SceneBuilder, rig: &Rig) {
    let lamp = LAMP + START * Vec3::Z;
    let spot = Light::Spot {
        position: lamp,
        direction: (Vec3::new(0.9, 0.9, START - 0.6) - lamp).normalize_or_zero(),
        intensity: Vec3::new(120.0, 104.0, 80.0),
        beam: 34f32.to_radians(),
        cutoff: 52f32.to_radians(),
        falloff: SpotFalloff::LinearAngle,
    };
    scene.hang_light(spot, rig.tank);

    let count = (DURATION * RATE).round() as u32;
    let keys = |count: u32| (0..=count).map(move |i| DURATION * i as f32 / count as f32);
    let mut clip = Clip::new("drive");
    clip.push(rig.tank, Track::translation(keys(count).map(|t| (t, (START + distance(t)) * Vec3::Z))));
    for &wheel in &rig.wheels {
        let turned = |t| Quat::from_rotation_x(distance(t) / WHEEL);
        clip.push(wheel, Track::rotation(keys(count).map(|t| (t, turned(t)))));
    }
    let swing = |t: f32| Quat::from_rotation_y(0.32 * (TAU * t / DURATION).sin());
    clip.push(rig.turret, Track::rotation(keys(48).map(|t| (t, swing(t)))).smooth());
    let tilt = |t: f32| Quat::from_rotation_x(GUN_TILT + 0.05 * (2.0 * TAU * t / DURATION).sin());
    clip.push(rig.gun, Track::rotation(keys(48).map(|t| (t, tilt(t)))).smooth());
    scene.clip(clip);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::tunnel;

    #[test]
    fn the_tank_and_its_lamp_drive_towards_the_camera_and_back_without_a_jump() {
        let scene = tunnel(0);
        assert_eq!(scene.clips().len(), 1);
        assert_eq!(scene.clips()[0].duration, DURATION);
        let hull = scene.instances.iter().position(|i| scene.meshes[i.mesh].name == "tank hull").unwrap();
        let z = |t| scene.pose(0, t).world_from_local[hull].w_axis.z;
        let lamp = |t| match scene.pose(0, t).lights[0] {
            Light::Spot { position, .. } => position.z,
            _ => unreachable!(),
        };
        assert!(z(WAY) - z(0.0) > 10.5 && scene.cameras[0].eye.z > z(WAY) + 4.0);
        for i in 0..240 {
            let t = DURATION * i as f32 / 240.0;
            assert!((lamp(t) - z(t) - LAMP.z).abs() < 1e-3);
            assert!((z(t + DURATION / 240.0) - z(t)).abs() < 4.0 * DURATION / 240.0, "at most 4 m/s");
        }
        let end = scene.pose(0, DURATION - 1e-4);
        for (a, b) in end.world_from_local.iter().zip(&scene.pose(0, 0.0).world_from_local) {
            assert!(a.abs_diff_eq(*b, 1e-3));
        }
    }

    #[test]
    fn the_wheels_roll_and_stay_on_their_axles() {
        let scene = tunnel(0);
        let wheel = scene.instances.iter().position(|i| scene.meshes[i.mesh].name == "tank wheel").unwrap();
        let hull = scene.instances.iter().position(|i| scene.meshes[i.mesh].name == "tank hull").unwrap();
        let at = |t: f32| scene.pose(0, t).world_from_local;
        let axle = |t: f32| (at(t)[wheel].w_axis - at(t)[hull].w_axis).truncate();
        let up = |t: f32| at(t)[wheel].y_axis.truncate();
        for i in 0..100 {
            let (t, dt) = (DURATION * i as f32 / 100.0, 0.01);
            assert!(axle(t).abs_diff_eq(axle(0.0), 1e-4));
            // The ground under a rolling wheel does not slip: it turns by distance over radius.
            let turned = up(t).angle_between(up(t + dt));
            let moved = (at(t + dt)[hull].w_axis.z - at(t)[hull].w_axis.z).abs();
            assert!((turned - moved / WHEEL).abs() < 0.01, "{t}: {turned} {moved}");
        }
    }
}
