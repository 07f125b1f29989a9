//! Keyframes of one property and what lies between them.

use glam::{Quat, Vec3, Vec4};

/// What lies between two keyframes; glTF 2.0, appendix C.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The earlier key's value.
    Step,
    /// The straight line; for rotations the shorter arc.
    #[default]
    Linear,
    /// A cubic Hermite spline with a tangent on either side of each key, per second.
    CubicSpline,
}

/// What a track changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Property {
    Translation,
    Rotation,
    Scale,
    /// Factors of morph targets.
    Weights,
    /// A factor on a light's strength.
    Brightness,
}

/// Keyframes of one property. Before the first and after the last key their values hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    pub(crate) property: Property,
    interpolation: Interpolation,
    /// Seconds: finite, not negative, not falling.
    times: Vec<f32>,
    /// Per key `width` numbers; for splines the tangent before, the value and the tangent after.
    values: Vec<f32>,
    pub(crate) width: usize,
}

/// Seconds and value of the keys that are finite, in the order of their times.
fn sorted<T>(
    keys: impl IntoIterator<Item = (f32, T)>,
    numbers: impl Fn(&T) -> Vec<f32>,
) -> (Vec<f32>, Vec<f32>) {
    let mut all: Vec<(f32, Vec<f32>)> = keys.into_iter().map(|(t, v)| (t, numbers(&v))).collect();
    all.retain(|(t, v)| t.is_finite() && *t >= 0.0 && v.iter().all(|n| n.is_finite()));
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let times = all.iter().map(|k| k.0).collect();
    (times, all.into_iter().flat_map(|k| k.1).collect())
}

impl Track {
    /// Where a node stands within its parent: (seconds, metres). Linear between the keys, like all constructors here;
    /// keys with numbers that are not finite or negative times are left out.
    pub fn translation(keys: impl IntoIterator<Item = (f32, Vec3)>) -> Self {
        Self::vectors(Property::Translation, keys)
    }

    /// How a node is turned within its parent: (seconds, unit quaternion).
    pub fn rotation(keys: impl IntoIterator<Item = (f32, Quat)>) -> Self {
        let unit = |q: &Quat| Vec4::from(*q).normalize_or(Vec4::W).to_array().to_vec();
        let (times, values) = sorted(keys, unit);
        Self { property: Property::Rotation, interpolation: Interpolation::Linear, times, values, width: 4 }
    }

    /// How a node is scaled within its parent: (seconds, factor per axis).
    pub fn scale(keys: impl IntoIterator<Item = (f32, Vec3)>) -> Self {
        Self::vectors(Property::Scale, keys)
    }

    /// A factor on a light's strength: (seconds, factor); negative ones count as zero.
    pub fn brightness(keys: impl IntoIterator<Item = (f32, f32)>) -> Self {
        let (times, values) = sorted(keys, |v| vec![*v]);
        Self { property: Property::Brightness, interpolation: Interpolation::Linear, times, values, width: 1 }
    }

    /// A whole turn about an axis in so many seconds, the other way round if they are negative.
    pub fn spin(axis: Vec3, seconds_per_turn: f32) -> Self {
        let axis = axis.normalize_or(Vec3::Y);
        let sign = seconds_per_turn.signum();
        // A quarter at a time: the shorter arc is then never in doubt, and slerp turns evenly.
        Self::rotation((0..=4u8).map(|i| {
            let quarter = f32::from(i) * 0.25;
            let angle = sign * quarter * std::f32::consts::TAU;
            (quarter * seconds_per_turn.abs(), Quat::from_axis_angle(axis, angle))
        }))
    }

    fn vectors(property: Property, keys: impl IntoIterator<Item = (f32, Vec3)>) -> Self {
        let (times, values) = sorted(keys, |v| v.to_array().to_vec());
        Self { property, interpolation: Interpolation::Linear, times, values, width: 3 }
    }

    /// A track as a file states it, or what is wrong with it.
    pub(crate) fn checked(
        property: Property,
        interpolation: Interpolation,
        times: Vec<f32>,
        mut values: Vec<f32>,
    ) -> Result<Self, String> {
        if times.is_empty() {
            return Err("no keys".to_owned());
        }
        if let Some(t) = times.iter().find(|t| !t.is_finite() || **t < 0.0) {
            return Err(format!("a key at {t} seconds"));
        }
        if let Some(w) = times.windows(2).find(|w| w[1] < w[0]) {
            return Err(format!("a key at {} seconds after one at {}", w[1], w[0]));
        }
        if values.iter().any(|v| !v.is_finite()) {
            return Err("a value that is not finite".to_owned());
        }
        let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let keys = times.len() * parts;
        let width = match property {
            Property::Translation | Property::Scale => 3,
            Property::Rotation => 4,
            Property::Brightness => 1,
            Property::Weights => values.len() / keys,
        };
        if width == 0 || values.len() != keys * width {
            return Err(format!("{} numbers for {} keys", values.len(), times.len()));
        }
        if property == Property::Rotation {
            for q in values.chunks_exact_mut(4 * parts).map(|key| &mut key[4 * (parts / 2)..][..4]) {
                let Some(unit) = Vec4::from_slice(q).try_normalize() else {
                    return Err("a rotation without length".to_owned());
                };
                unit.write_to_slice(q);
            }
        }
        Ok(Self { property, interpolation, times, values, width })
    }

    /// The same keys with the earlier one's value between them.
    #[must_use]
    pub fn stepped(self) -> Self {
        match self.interpolation {
            Interpolation::Linear => Self { interpolation: Interpolation::Step, ..self },
            _ => self,
        }
    }

    /// The same keys joined without corners: a cubic spline whose tangents are those of Catmull and Rom. If the last
    /// value is the first one's, the ends join without a corner too.
    #[must_use]
    pub fn smooth(mut self) -> Self {
        let (n, w) = (self.times.len(), self.width);
        if self.interpolation != Interpolation::Linear || n < 2 {
            return self;
        }
        if self.property == Property::Rotation {
            self.align_rotations();
        }
        let value = |i: usize| &self.values[i * w..(i + 1) * w];
        let closed = value(0).iter().zip(value(n - 1)).all(|(a, b)| (a - b).abs() < 1e-6);
        let slope = |i: usize, j: usize, seconds: f32, out: &mut Vec<f32>| {
            let per_second = if seconds > 0.0 { 1.0 / seconds } else { 0.0 };
            out.extend(value(i).iter().zip(value(j)).map(|(a, b)| (b - a) * per_second));
        };
        let mut values = Vec::with_capacity(3 * self.values.len());
        for i in 0..n {
            let mut tangent = Vec::with_capacity(w);
            let t = &self.times;
            if closed && (i == 0 || i == n - 1) {
                slope(n - 2, 1, t[1] - t[0] + t[n - 1] - t[n - 2], &mut tangent);
            } else {
                let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
                slope(a, b, t[b] - t[a], &mut tangent);
            }
            values.extend_from_slice(&tangent);
            values.extend_from_slice(value(i));
            values.extend(tangent);
        }
        Self { interpolation: Interpolation::CubicSpline, values, ..self }
    }

    /// Of the two quaternions that mean a rotation, takes the one nearer to the key before.
    fn align_rotations(&mut self) {
        for i in 4..self.values.len() {
            if i % 4 == 0 {
                let dot: f32 = (0..4).map(|k| self.values[i - 4 + k] * self.values[i + k]).sum();
                if dot < 0.0 {
                    self.values[i..i + 4].iter_mut().for_each(|v| *v = -*v);
                }
            }
        }
    }

    /// Seconds of the last key; zero if there is none.
    pub fn end(&self) -> f32 {
        self.times.last().copied().unwrap_or(0.0)
    }

    pub(crate) fn times(&self) -> &[f32] {
        &self.times
    }

    /// The number of keys.
    pub(crate) fn len(&self) -> usize {
        self.times.len()
    }

    /// Writes the value at a finite time into `out`, of `width` numbers; leaves it alone if there are no keys.
    pub(crate) fn sample(&self, seconds: f32, out: &mut [f32]) {
        let next = self.times.partition_point(|t| *t <= seconds);
        let Some(last) = self.times.len().checked_sub(1) else { return };
        if next == 0 || next > last || self.interpolation == Interpolation::Step {
            out.copy_from_slice(self.part(next.saturating_sub(1), 1));
            return;
        }
        let here = next - 1;
        let span = self.times[next] - self.times[here];
        let u = (seconds - self.times[here]) / span;
        let (a, b) = (self.part(here, 1), self.part(next, 1));
        match (self.interpolation, self.property) {
            (Interpolation::CubicSpline, property) => {
                let (leaving, arriving) = (self.part(here, 2), self.part(next, 0));
                let (u2, u3) = (u * u, u * u * u);
                for i in 0..self.width {
                    out[i] = (2.0 * u3 - 3.0 * u2 + 1.0) * a[i]
                        + span * (u3 - 2.0 * u2 + u) * leaving[i]
                        + (3.0 * u2 - 2.0 * u3) * b[i]
                        + span * (u3 - u2) * arriving[i];
                }
                if property == Property::Rotation {
                    let start = Vec4::from_slice(a);
                    Vec4::from_slice(out).try_normalize().unwrap_or(start).write_to_slice(out);
                }
            }
            (_, Property::Rotation) => {
                let turned = Quat::from_slice(a).slerp(Quat::from_slice(b), u);
                Vec4::from(turned).normalize_or(Vec4::from_slice(a)).write_to_slice(out);
            }
            _ => out.iter_mut().zip(a.iter().zip(b)).for_each(|(o, (a, b))| *o = a * (1.0 - u) + b * u),
        }
        // Tangents may be as large as numbers get.
        if out.iter().any(|v| !v.is_finite()) {
            out.copy_from_slice(a);
        }
    }

    /// The tangent before (0), value (1) or tangent after (2) of a key.
    fn part(&self, key: usize, part: usize) -> &[f32] {
        let w = self.width;
        let start =
            if self.interpolation == Interpolation::CubicSpline { (3 * key + part) * w } else { key * w };
        &self.values[start..start + w]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at<const N: usize>(track: &Track, seconds: f32) -> [f32; N] {
        let mut out = [0.0; N];
        track.sample(seconds, &mut out);
        out
    }

    #[test]
    fn steps_lines_and_what_lies_outside() {
        let line = Track::translation([(3.0, Vec3::X), (1.0, Vec3::Y), (f32::NAN, Vec3::Z), (-1.0, Vec3::Z)]);
        assert_eq!(at(&line, 0.0), [0.0, 1.0, 0.0]);
        assert_eq!(at(&line, 1.5), [0.25, 0.75, 0.0]);
        assert_eq!(at(&line, 9.0), [1.0, 0.0, 0.0]);
        let step = line.stepped();
        assert_eq!(at(&step, 2.9), [0.0, 1.0, 0.0]);
        assert_eq!(at(&step, 3.0), [1.0, 0.0, 0.0]);
        assert_eq!(at(&Track::scale([]), 1.0), [0.0; 3]);
    }

    #[test]
    fn rotations_take_the_shorter_arc() {
        let a = Quat::from_rotation_y(0.2);
        let b = -Quat::from_rotation_y(1.0);
        let track = Track::rotation([(0.0, a), (2.0, b)]);
        let [x, y, z, w] = at(&track, 1.0);
        assert!(Quat::from_xyzw(x, y, z, w).dot(Quat::from_rotation_y(0.6)).abs() > 0.999_999);
    }

    #[test]
    fn a_spin_turns_evenly() {
        let track = Track::spin(Vec3::Z, 2.0);
        for i in 0..40u8 {
            let s = f32::from(i) / 20.0;
            let [x, y, z, w] = at(&track, s);
            let expected = Quat::from_rotation_z(s * std::f32::consts::PI);
            assert!(Quat::from_xyzw(x, y, z, w).dot(expected).abs() > 0.999_999, "{s}");
        }
    }

    #[test]
    fn splines_agree_with_values_by_hand() {
        // v0 = 1, out-tangent 2, v1 = 5, in-tangent -4, over 2 s, in the middle:
        // 0.5 * 1 + 2 * 0.125 * 2 + 0.5 * 5 + 2 * -0.125 * -4 = 4.5
        let values = vec![9.0, 1.0, 2.0, -4.0, 5.0, 9.0];
        let track =
            Track::checked(Property::Brightness, Interpolation::CubicSpline, vec![1.0, 3.0], values).unwrap();
        assert_eq!(at(&track, 2.0), [4.5]);
        // A quarter of the way: (2/64 - 3/16 + 1) 1 + 2 (1/64 - 2/16 + 1/4) 2 + (3/16 - 2/64) 5 + 2 (1/64 - 1/16) (-4)
        assert!((at::<1>(&track, 1.5)[0] - (0.84375 + 0.5625 + 0.78125 + 0.375)).abs() < 1e-6);
        assert_eq!((at(&track, 0.0), at(&track, 3.0)), ([1.0], [5.0]));
        let wild = vec![0.0, 1.0, 3e38, 3e38, 5.0, 0.0];
        let track =
            Track::checked(Property::Brightness, Interpolation::CubicSpline, vec![0.0, 1e38], wild).unwrap();
        assert_eq!(at(&track, 5e37), [1.0]);
    }

    #[test]
    fn smooth_tracks_go_through_their_keys_and_have_no_corners() {
        let keys = [(0.0, 0.0), (1.0, 2.0), (3.0, -1.0), (4.0, 0.0)];
        let track = Track::brightness(keys).smooth();
        for (t, v) in keys {
            assert!((at::<1>(&track, t)[0] - v).abs() < 1e-6);
        }
        let slope = |t: f32| (at::<1>(&track, t + 1e-3)[0] - at::<1>(&track, t)[0]) / 1e-3;
        for t in [1.0, 3.0] {
            assert!((slope(t - 1e-3) - slope(t)).abs() < 2e-2, "{} {}", slope(t - 1e-3), slope(t));
        }
        assert!((slope(0.0) - slope(3.999)).abs() < 3e-2, "the ends of a closed track join");
    }

    #[test]
    fn what_is_wrong_is_said() {
        let make = |times: &[f32], values: &[f32]| {
            let cubic = Interpolation::Linear;
            Track::checked(Property::Rotation, cubic, times.to_vec(), values.to_vec()).unwrap_err()
        };
        assert_eq!(make(&[], &[]), "no keys");
        assert_eq!(make(&[f32::NAN], &[0.0; 4]), "a key at NaN seconds");
        assert_eq!(make(&[2.0, 1.0], &[0.0; 8]), "a key at 1 seconds after one at 2");
        assert_eq!(make(&[1.0], &[0.0; 3]), "3 numbers for 1 keys");
        assert_eq!(make(&[1.0], &[0.0; 4]), "a rotation without length");
        assert_eq!(make(&[1.0], &[0.0, 0.0, f32::INFINITY, 1.0]), "a value that is not finite");
    }
}
