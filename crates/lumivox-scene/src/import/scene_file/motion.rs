//! Motion of a scene file: nodes and tracks for what its entries say, in one clip.

use glam::{EulerRot, Quat, Vec3};

use super::format::{
    Between, LightKey, LightMotion, MeshKey, MeshMotion, OrbitEntry, PathEntry, Repeat, SpinEntry,
};
use super::place::{Placement, scale_of};
use super::{unit, vector};
use crate::animation::{Channel, Target};
use crate::{Animation, Clip, NodeId, Scene, Track, Transform};

/// Turns within one step of a rotation by keyframes; between steps the shorter way is taken.
const DEGREES_PER_STEP: f32 = 45.0;

/// Steps of one keyframe at most, which is 125 turns.
const MAX_STEPS: f32 = 1000.0;

/// Steps of a rotation between two keyframes that are joined smoothly.
const SMOOTH_STEPS: f32 = 16.0;

/// Seconds after which motions without a common period begin anew together.
const LONGEST: f32 = 3600.0;

/// The clip that a scene file's motions add up to.
#[derive(Default)]
pub(super) struct Motions {
    channels: Vec<Channel>,
    /// Keyframes so far; the caller compares them with its limit.
    pub(super) keys: u64,
}

impl Motions {
    /// Adds the clip to the scene, if there is any motion.
    pub(super) fn finish(self, scene: &mut Scene) {
        if self.channels.is_empty() {
            return;
        }
        let mut clip = Clip::new("motion");
        let duration = self.duration();
        self.channels.into_iter().for_each(|c| clip.add(c));
        if duration.is_none() {
            let text = format!("the motions have no common period; all begin anew after {LONGEST} seconds");
            scene.report.warn(text);
        }
        scene.animation.add_clip(clip.lasting(duration.unwrap_or(LONGEST)));
    }

    /// The least time after which all that repeats is where it began and all else has ended; `None` beyond an hour.
    fn duration(&self) -> Option<f32> {
        let once =
            self.channels.iter().filter(|c| c.period.is_none()).map(|c| c.track.end()).fold(0.0, f32::max);
        let mut periods: Vec<f32> = self.channels.iter().filter_map(|c| c.period).collect();
        periods.sort_by(f32::total_cmp);
        periods.dedup();
        let common = match periods.as_slice() {
            [] => return Some(once),
            [one] => f64::from(*one),
            several => {
                let mut all = 1u64;
                for p in several {
                    let p = (f64::from(*p) * 1000.0).round().max(1.0) as u64;
                    all = all.checked_mul(p / greatest_common_divisor(all, p))?;
                }
                all as f64 / 1000.0
            }
        };
        let whole = common * (f64::from(once) / common).ceil().max(1.0);
        (periods.len() == 1 || whole <= f64::from(LONGEST)).then_some(whole as f32)
    }

    /// Adds a track that is to repeat or not.
    fn add(&mut self, target: Target, track: Track, repeats: bool) {
        self.keys += track.len() as u64;
        let period = Some(track.end()).filter(|p| repeats && *p > 0.0);
        self.channels.push(Channel { target, track, period });
    }

    /// Adds the channels of a file's clip, whose nodes now start at `first`.
    pub(super) fn add_clip(&mut self, clip: &Clip, first: usize) {
        for channel in &clip.channels {
            if let Target::Node(node) = channel.target {
                self.keys += channel.track.len() as u64;
                let (target, period) = (Target::Node(node + first), Some(clip.duration));
                self.channels.push(Channel { target, period, ..channel.clone() });
            }
        }
    }

    /// Nodes for a mesh: orbit, place by keyframes, spin. Returns the one to hang it on.
    pub(super) fn mesh(
        &mut self,
        motion: Option<&MeshMotion>,
        placement: &Placement,
        middle: Vec3,
        animation: &mut Animation,
    ) -> Result<NodeId, String> {
        let (orbit, spin) = (motion.and_then(|m| m.orbit), motion.and_then(|m| m.spin));
        let above = orbit.map(|o| self.orbit(&o, animation)).transpose()?;
        let node = animation.add_node_matrix(above, placement.matrix, placement.parts.unwrap_or_default());
        if let Some(MeshMotion { keyframes, interpolation, repeat, .. }) = motion
            && !keyframes.is_empty()
        {
            if placement.parts.is_none() {
                return Err("with both a matrix and keyframes".to_owned());
            }
            self.mesh_keys(keyframes, *interpolation, *repeat, node)?;
        }
        spin.map_or(Ok(node), |s| self.spin(&s, middle, node, animation))
    }

    fn mesh_keys(
        &mut self,
        keys: &[MeshKey],
        between: Between,
        repeat: Repeat,
        node: NodeId,
    ) -> Result<(), String> {
        let times = Times::new(keys.iter().map(|k| k.seconds), repeat)?;
        let (mut moves, mut turns, mut scales) = (Vec::new(), Vec::new(), Vec::new());
        for key in keys {
            moves.push(key.translate.map(|v| vector(v, "keyframes' translate")).transpose()?);
            turns.push(key.rotate_deg.map(|v| vector(v, "keyframes' rotate_deg")).transpose()?);
            scales.push(key.scale.map(|s| scale_of(s, "keyframes' scale")).transpose()?);
        }
        let tracks = [
            times.track(&moves, between, Track::translation),
            times.turns(&turns, between),
            times.track(&scales, between, Track::scale),
        ];
        for track in tracks.into_iter().flatten() {
            self.add(Target::Node(node.0), track, repeat != Repeat::Once);
        }
        Ok(())
    }

    /// Nodes and tracks for a light that stands at `place`.
    pub(super) fn light(
        &mut self,
        light: usize,
        motion: &LightMotion,
        place: Vec3,
        scene: &mut Scene,
    ) -> Result<(), String> {
        let LightMotion { keyframes, interpolation, repeat, spin, orbit } = motion;
        let above = orbit.map(|o| self.orbit(&o, &mut scene.animation)).transpose()?;
        let mut node = scene.animation.add_node(above, Transform::at(place));
        if !keyframes.is_empty() {
            let times = Times::new(keyframes.iter().map(|k| k.seconds), *repeat)?;
            let (mut moves, mut turns, mut factors) = (Vec::new(), Vec::new(), Vec::new());
            for LightKey { translate, rotate_deg, brightness, .. } in keyframes {
                moves.push(
                    translate.map(|v| vector(v, "keyframes' translate")).transpose()?.map(|v| place + v),
                );
                turns.push(rotate_deg.map(|v| vector(v, "keyframes' rotate_deg")).transpose()?);
                factors.push(*brightness);
            }
            if factors.iter().flatten().any(|f| !(*f >= 0.0 && f.is_finite())) {
                return Err("whose keyframes' brightness is negative or not finite".to_owned());
            }
            let repeats = *repeat != Repeat::Once;
            let places = [
                times.track(&moves, *interpolation, Track::translation),
                times.turns(&turns, *interpolation),
            ];
            for track in places.into_iter().flatten() {
                self.add(Target::Node(node.0), track, repeats);
            }
            if let Some(track) = times.track(&factors, *interpolation, Track::brightness) {
                self.add(Target::Light(light), track, repeats);
            }
        }
        if let Some(spin) = spin {
            let center = spin.center.map(|c| vector(c, "center")).transpose()?.map(|c| c - place);
            let spin = SpinEntry { center: center.map(|c| c.to_array()), ..*spin };
            node = self.spin(&spin, Vec3::ZERO, node, &mut scene.animation)?;
        }
        scene.hang_light(light, node);
        Ok(())
    }

    /// The path of the first camera, and nodes for its eye and target.
    pub(super) fn path(&mut self, path: &PathEntry, scene: &mut Scene) -> Result<(), String> {
        let PathEntry { keyframes, interpolation, repeat } = path;
        let Some(camera) = scene.cameras.first() else { return Ok(()) };
        let [eye, target] =
            [camera.eye, camera.target].map(|at| scene.animation.add_node(None, Transform::at(at)));
        let times = Times::new(keyframes.iter().map(|k| k.seconds), *repeat)?;
        let (mut eyes, mut targets) = (Vec::new(), Vec::new());
        for key in keyframes {
            eyes.push(Some(vector(key.eye, "path's eye")?));
            targets.push(key.target.map(|t| vector(t, "path's target")).transpose()?);
        }
        for (node, keys) in [(eye, eyes), (target, targets)] {
            if let Some(track) = times.track(&keys, *interpolation, Track::translation) {
                self.add(Target::Node(node.0), track, *repeat != Repeat::Once);
            }
        }
        scene.hang_camera_between(0, eye, target);
        Ok(())
    }

    fn orbit(&mut self, orbit: &OrbitEntry, animation: &mut Animation) -> Result<NodeId, String> {
        let center = vector(orbit.center, "center")?;
        self.turning(orbit.axis, orbit.seconds_per_turn, center, None, animation)
    }

    fn spin(
        &mut self,
        spin: &SpinEntry,
        middle: Vec3,
        parent: NodeId,
        animation: &mut Animation,
    ) -> Result<NodeId, String> {
        let center = spin.center.map_or(Ok(middle), |c| vector(c, "center"))?;
        self.turning(spin.axis, spin.seconds_per_turn, center, Some(parent), animation)
    }

    /// A node that turns about an axis through a point.
    fn turning(
        &mut self,
        axis: [f32; 3],
        seconds: f32,
        center: Vec3,
        parent: Option<NodeId>,
        animation: &mut Animation,
    ) -> Result<NodeId, String> {
        let axis = unit(axis, "axis")?;
        if !seconds.is_normal() {
            return Err(format!("whose seconds_per_turn is {seconds}"));
        }
        let turning = animation.add_node(parent, Transform::at(center));
        self.add(Target::Node(turning.0), Track::spin(axis, seconds), true);
        Ok(animation.add_node(Some(turning), Transform::at(-center)))
    }
}

fn greatest_common_divisor(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The times of a list of keyframes, and what follows after the last.
struct Times {
    seconds: Vec<f32>,
    mirrored: bool,
}

impl Times {
    fn new(seconds: impl Iterator<Item = f32>, repeat: Repeat) -> Result<Self, String> {
        let seconds: Vec<f32> = seconds.collect();
        if seconds.is_empty() {
            return Err("without keyframes".to_owned());
        }
        // Twice the last must still be a number.
        if let Some(s) = seconds.iter().find(|s| !(**s >= 0.0 && **s < 1e30)) {
            return Err(format!("with a keyframe at {s} seconds"));
        }
        if let Some(w) = seconds.windows(2).find(|w| w[1] <= w[0]) {
            return Err(format!("with a keyframe at {} seconds after one at {}", w[1], w[0]));
        }
        Ok(Self { seconds, mirrored: repeat == Repeat::PingPong })
    }

    /// The track through the keys that state a value; `None` if none does.
    fn track<T: Copy>(
        &self,
        values: &[Option<T>],
        between: Between,
        make: impl Fn(Vec<(f32, T)>) -> Track,
    ) -> Option<Track> {
        let mut keys: Vec<(f32, T)> =
            self.seconds.iter().zip(values).filter_map(|(t, v)| Some((*t, (*v)?))).collect();
        let (last, value) = *keys.last()?;
        let end = self.seconds.last().copied().unwrap_or(last);
        if last < end {
            // All tracks of a list last equally long, so that they begin anew together.
            keys.push((end, value));
        }
        if self.mirrored {
            let back: Vec<(f32, T)> = keys.iter().rev().map(|(t, v)| (2.0 * end - t, *v)).collect();
            keys.extend(back.into_iter().skip(1));
        }
        let track = make(keys);
        Some(match between {
            Between::Linear => track,
            Between::Smooth => track.smooth(),
            Between::Step => track.stepped(),
        })
    }

    /// Rotations through angles, which may go round more than once: many small steps on the way.
    fn turns(&self, angles: &[Option<Vec3>], between: Between) -> Option<Track> {
        if between == Between::Step {
            let turns: Vec<Option<Quat>> = angles.iter().map(|a| a.map(rotation)).collect();
            return self.track(&turns, between, Track::rotation);
        }
        // The angles as a track of their own, to be read at every step.
        let line = self.track(angles, between, Track::translation)?;
        let at = |seconds: f32| {
            let mut v = [0.0; 3];
            line.sample(seconds, &mut v);
            Vec3::from(v)
        };
        let mut keys = Vec::new();
        for pair in line.times().windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let angle = (at(to) - at(from)).abs().max_element();
            let least = if between == Between::Smooth { SMOOTH_STEPS } else { 1.0 };
            let steps = (angle / DEGREES_PER_STEP).ceil().clamp(least, MAX_STEPS);
            for i in 0..steps as usize {
                let t = from + (to - from) * (i as f32 / steps);
                keys.push((t, rotation(at(t))));
            }
        }
        keys.push((line.end(), rotation(at(line.end()))));
        Some(Track::rotation(keys))
    }
}

/// About X, then Y, then Z, each the fixed axis.
pub(super) fn rotation(degrees: Vec3) -> Quat {
    let [x, y, z] = degrees.to_array().map(f32::to_radians);
    Quat::from_euler(EulerRot::ZYX, z, y, x)
}
