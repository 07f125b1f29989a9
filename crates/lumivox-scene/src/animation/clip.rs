//! Named motions.

use super::{NodeId, Track};

/// Seconds of a clip whose keys are all at zero: such a clip is a still pose, but time must go somewhere.
const STILL_SECONDS: f32 = 1.0;

/// A named motion of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Name in the file; may be empty.
    pub name: String,
    /// Seconds after which it begins anew: above zero, finite.
    pub duration: f32,
    pub(crate) channels: Vec<Channel>,
}

/// A track and what it moves.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Channel {
    pub(crate) target: Target,
    pub(crate) track: Track,
    /// Seconds after which the track begins anew within the clip.
    pub(crate) period: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    Node(usize),
    Light(usize),
}

impl Clip {
    /// A clip in which nothing moves yet.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), duration: STILL_SECONDS, channels: Vec::new() }
    }

    /// Adds a track of a node. The clip lasts until the last key of its longest track.
    #[must_use]
    pub fn with(mut self, node: NodeId, track: Track) -> Self {
        self.push(node, track);
        self
    }

    /// Adds a track of a node, as [`Clip::with`].
    pub fn push(&mut self, node: NodeId, track: Track) {
        self.add(Channel { target: Target::Node(node.0), track, period: None });
    }

    /// Adds a track of a node that begins anew after its own last key for as long as the clip lasts.
    pub fn push_looped(&mut self, node: NodeId, track: Track) {
        let period = Some(track.end()).filter(|p| *p > 0.0);
        self.add(Channel { target: Target::Node(node.0), track, period });
    }

    /// Adds a [`Track::brightness`] of a light of the scene. The light must hang on a node, moving or not.
    pub fn push_light(&mut self, light: usize, track: Track) {
        self.add(Channel { target: Target::Light(light), track, period: None });
    }

    /// Sets the duration; one that is not above zero or not finite is ignored.
    #[must_use]
    pub fn lasting(mut self, seconds: f32) -> Self {
        if seconds > 0.0 && seconds.is_finite() {
            self.duration = seconds;
        }
        self
    }

    pub(crate) fn add(&mut self, channel: Channel) {
        self.channels.push(channel);
        let end = self.channels.iter().map(|c| c.track.end()).fold(0.0, f32::max);
        self.duration = if end > 0.0 { end } else { STILL_SECONDS };
    }

    /// Any time as one within the clip; what is no number is the beginning.
    pub(super) fn wrapped(&self, seconds: f32) -> f32 {
        let t = seconds.rem_euclid(self.duration);
        // Rounding may give the whole duration for small negative times.
        if t < self.duration { t } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_time_lies_within_the_clip() {
        let clip = Clip::new("c").lasting(3.5);
        for t in [0.0, -0.0, 3.5, -1e-20, 1e30, -1e30, f32::MAX, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let wrapped = clip.wrapped(t);
            assert!((0.0..3.5).contains(&wrapped), "{t} {wrapped}");
        }
        assert_eq!(clip.wrapped(4.0), 0.5);
        assert_eq!(clip.wrapped(-1.0), 2.5);
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(Clip::new("c").lasting(bad).duration, STILL_SECONDS);
        }
    }
}
