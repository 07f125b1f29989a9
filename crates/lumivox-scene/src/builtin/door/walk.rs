//! The figure's walk: to and fro behind the door, with feet that stand still while they carry.
//!
//! Steps follow each other without a break. In each, one foot swings to where the body will be in the middle of the next
//! step, so it carries the body from half a step ahead of it to half a step behind. Turns are made of steps too. Legs
//! are solved from hip and ankle; everything is baked into keys.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Mat3, Quat, Vec3};

use super::figure::{ANKLE, Figure, HEEL, HIP, SHIN, THIGH, TOES};
use crate::{Clip, Track};

/// Steps of one way and of one turn, and their seconds.
const WAY_STEPS: u32 = 6;
const TURN_STEPS: u32 = 4;
const WAY_STEP: f32 = 0.55;
const TURN_STEP: f32 = 0.4;
/// Seconds of one way with its turn, and of both.
const HALF_CYCLE: f32 = WAY_STEPS as f32 * WAY_STEP + TURN_STEPS as f32 * TURN_STEP;
pub(super) const DURATION: f32 = 2.0 * HALF_CYCLE;
/// Seconds of the clip before the figure sets out; a whole number of keys.
const DELAY: f32 = 0.7;
/// The body goes from minus to plus this in x, along this z.
const REACH: f32 = 1.5;
pub(super) const LINE: f32 = -1.75;
/// Most that a leg is stretched, and the greatest height of the hips: a walker's knees are never quite straight.
const STRETCH: f32 = THIGH + SHIN - 0.003;
const HIPS: f32 = 0.915;
/// How sharply, per metre, the lowest of the heights that legs allow decides.
const SHARPNESS: f32 = 60.0;
/// Soles keep this above the floor: more than what the straight way between keys takes from a curve.
const CLEARANCE: f32 = 0.004;
/// Keys per second.
const RATE: f32 = 40.0;

/// The middle of the body over the ground and where it looks (radians about y, zero is +z).
#[derive(Clone, Copy, Debug)]
struct Place {
    position: Vec3,
    yaw: f32,
}

impl Place {
    fn ahead(&self) -> Vec3 {
        Vec3::new(self.yaw.sin(), 0.0, self.yaw.cos())
    }

    /// `side` metres to the left.
    fn aside(&self, side: f32) -> Vec3 {
        self.position + side * Vec3::new(self.yaw.cos(), 0.0, -self.yaw.sin())
    }
}

/// The body at a time: there, turn, back, turn; it faces the door while it turns.
fn body(seconds: f32) -> Place {
    let t = seconds.rem_euclid(DURATION);
    let (t, sign) = if t < HALF_CYCLE { (t, 1.0) } else { (t - HALF_CYCLE, -1.0) };
    let way = WAY_STEPS as f32 * WAY_STEP;
    // Speeds up over the first step and slows down over the last.
    let a = 1.0 / WAY_STEPS as f32;
    let eased = |s: f32| s * s / (2.0 * a * (1.0 - a));
    let walked = match (t / way).min(1.0) {
        s if s < a => eased(s),
        s if s > 1.0 - a => 1.0 - eased(1.0 - s),
        s => (s - 0.5 * a) / (1.0 - a),
    };
    let turned = ((t - way) / (HALF_CYCLE - way)).clamp(0.0, 1.0);
    let turned = turned * turned * (3.0 - 2.0 * turned);
    Place {
        position: Vec3::new(sign * REACH * (2.0 * walked - 1.0), 0.0, LINE),
        yaw: sign * FRAC_PI_2 * (1.0 - 2.0 * turned),
    }
}

/// When step `k` begins; steps count on over the end of the cycle.
fn step_start(k: i32) -> f32 {
    let per_half = (WAY_STEPS + TURN_STEPS) as i32;
    let (half, within) = (k.div_euclid(per_half), k.rem_euclid(per_half) as f32);
    let way = WAY_STEPS as f32;
    HALF_CYCLE * half as f32 + WAY_STEP * within.min(way) + TURN_STEP * (within - way).max(0.0)
}

/// The step at a time within the cycle, and how much of it is over.
pub(super) fn step_at(seconds: f32) -> (i32, f32) {
    let k = (0..2 * (WAY_STEPS + TURN_STEPS) as i32).rev().find(|&k| step_start(k) <= seconds).unwrap_or(0);
    (k, ((seconds - step_start(k)) / (step_start(k + 1) - step_start(k))).clamp(0.0, 1.0))
}

/// A foot: its ankle, where its toes point, and how far they point down.
#[derive(Clone, Copy, Debug)]
struct Foot {
    ankle: Vec3,
    yaw: f32,
    pitch: f32,
}

/// Where the foot that swings in step `k` comes down: under where the body will be in the middle of the next step.
fn landing(k: i32, side: f32) -> Foot {
    let place = body(0.5 * (step_start(k + 1) + step_start(k + 2)));
    Foot { ankle: place.aside(side * HIP) + (ANKLE + CLEARANCE) * Vec3::Y, yaw: place.yaw, pitch: 0.0 }
}

/// A foot (0 left, 1 right) at a time within the cycle. Even steps are the left foot's.
fn foot(which: usize, seconds: f32) -> Foot {
    let side = [1.0, -1.0][which];
    let (k, u) = step_at(seconds);
    if k.rem_euclid(2) != which as i32 {
        return landing(k - 1, side);
    }
    let (from, to) = (landing(k - 2, side), landing(k, side));
    let eased = u * u * (3.0 - 2.0 * u);
    // Toes down when it leaves the floor, up before it arrives; the lift makes room for whichever end is lower.
    let stride = (to.ankle - from.ankle).length();
    let pitch = 0.45 * stride * (TAU * u).sin();
    let room = pitch.abs().sin() * if pitch > 0.0 { TOES } else { HEEL };
    let lift = room + (0.03 + 0.05 * stride) * (PI * u).sin().powi(2);
    let ankle = from.ankle.lerp(to.ankle, eased) + lift * Vec3::Y;
    Foot { ankle, yaw: from.yaw + (to.yaw - from.yaw) * eased, pitch }
}

/// Height of the hips: as high as both legs allow, by a smooth minimum, so that the body swings over the leg that carries.
fn hips(seconds: f32) -> f32 {
    let place = body(seconds);
    let allowed = [0, 1].map(|which| {
        let ankle = foot(which, seconds).ankle;
        let aside = (ankle - place.aside([HIP, -HIP][which])).with_y(0.0).length();
        ankle.y + (STRETCH * STRETCH - aside * aside).max(0.0).sqrt()
    });
    let sum: f32 = [HIPS, allowed[0], allowed[1]].iter().map(|h| (-SHARPNESS * (h - HIPS)).exp()).sum();
    HIPS - sum.ln() / SHARPNESS
}

/// Rotations of a leg's parts in the world.
struct Leg {
    thigh: Quat,
    shin: Quat,
    foot: Quat,
}

fn solve_leg(hip: Vec3, foot: &Foot, ahead: Vec3) -> Leg {
    let way = foot.ankle - hip;
    let reach = way.length().clamp(0.1, THIGH + SHIN - 1e-4);
    let down = way.normalize_or(Vec3::NEG_Y);
    let front = (ahead - down * down.dot(ahead)).normalize_or(Vec3::Z);
    let along = (THIGH * THIGH - SHIN * SHIN + reach * reach) / (2.0 * reach);
    let out = (THIGH * THIGH - along * along).max(0.0).sqrt();
    let knee = along * down + out * front;
    let left = (-down).cross(front);
    let turn = |bone: Vec3| {
        let up = -bone.normalize_or(Vec3::NEG_Y);
        Quat::from_mat3(&Mat3::from_cols(left, up, left.cross(up))).normalize()
    };
    let foot_turn = Quat::from_rotation_y(foot.yaw) * Quat::from_rotation_x(foot.pitch);
    Leg { thigh: turn(knee), shin: turn(reach * down - knee), foot: foot_turn }
}

/// Adds the walk to a clip.
pub(super) fn add(clip: &mut Clip, figure: &Figure) {
    let count = (DURATION * RATE).round() as u32;
    let times: Vec<f32> = (0..=count).map(|i| DURATION * i as f32 / count as f32).collect();
    let rotations =
        |turn: &dyn Fn(f32) -> Quat| Track::rotation(times.iter().map(|&t| (t, turn(wrapped(t)))));
    let root = |t: f32| body(t).position + hips(t) * Vec3::Y;
    let yaw = |t: f32| Quat::from_rotation_y(body(t).yaw);
    clip.push(figure.root, Track::translation(times.iter().map(|&t| (t, root(wrapped(t))))));
    clip.push(figure.root, rotations(&yaw));
    for which in [0, 1] {
        let leg = |t: f32| {
            let side = [1.0, -1.0][which];
            let hip = root(t) + yaw(t) * (side * HIP * Vec3::X);
            solve_leg(hip, &foot(which, t), body(t).ahead())
        };
        clip.push(figure.thighs[which], rotations(&|t| yaw(t).inverse() * leg(t).thigh));
        clip.push(figure.shins[which], rotations(&|t| leg(t).thigh.inverse() * leg(t).shin));
        clip.push(figure.feet[which], rotations(&|t| leg(t).shin.inverse() * leg(t).foot));
        // An arm goes forward with the other leg.
        let swing = |t: f32| {
            let place = body(t);
            1.5 * (foot(1 - which, t).ankle - place.position).dot(place.ahead())
        };
        let outwards = [0.07, -0.07][which];
        clip.push(
            figure.arms[which],
            rotations(&|t| Quat::from_rotation_z(outwards) * Quat::from_rotation_x(0.08 - swing(t))),
        );
        clip.push(
            figure.forearms[which],
            rotations(&|t| Quat::from_rotation_x(-0.35 - 0.7 * swing(t).max(0.0))),
        );
    }
    // Shoulders turn against the hips, and the head stays with the way.
    let twist = |t: f32| {
        let place = body(t);
        let [left, right] = [0, 1].map(|f| (foot(f, t).ankle - place.position).dot(place.ahead()));
        0.25 * (left - right)
    };
    clip.push(figure.torso, rotations(&|t| Quat::from_rotation_y(twist(t)) * Quat::from_rotation_x(0.04)));
    clip.push(figure.head, rotations(&|t| Quat::from_rotation_y(-twist(t))));
}

/// The moment of the walk at one of the clip; the clip's end is its beginning, to the bit.
pub(super) fn wrapped(t: f32) -> f32 {
    let t = if t >= DURATION { 0.0 } else { t };
    (t - DELAY).rem_euclid(DURATION)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_cover_the_cycle() {
        assert_eq!(step_at(0.0), (0, 0.0));
        assert!((step_start(2 * (WAY_STEPS + TURN_STEPS) as i32) - DURATION).abs() < 1e-5);
        for k in -3..25 {
            let length = step_start(k + 1) - step_start(k);
            assert!(((length - WAY_STEP).abs().min((length - TURN_STEP).abs())) < 1e-5, "{k}");
        }
    }

    #[test]
    fn legs_reach_the_ground_at_every_moment() {
        for i in 0..2000 {
            let t = DURATION * i as f32 / 2000.0;
            let place = body(t);
            for (which, side) in [(0, 1.0), (1, -1.0)] {
                let hip = place.aside(side * HIP) + hips(t) * Vec3::Y;
                let reach = (foot(which, t).ankle - hip).length();
                assert!(reach < THIGH + SHIN - 1e-3 && hip.y > 0.8, "{t}: {reach} from {}", hip.y);
            }
        }
    }
}
