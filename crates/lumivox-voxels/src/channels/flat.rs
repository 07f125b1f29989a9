//! Flat triangles: pieces of surface with one colour and one normal all over, summed in short.

use glam::DVec3;

use super::numbers::{CANCELLED, VALUE_STEPS, WEIGHT_UNITS, fixed, integer, unit};
use super::{Channel, Rule, Source, Values};

/// Whether triangles that are alike all over can be summed by [`Accumulator::add_flat`].
pub(crate) fn takes_flat(channels: &[Channel]) -> bool {
    let takes = |channel: &Channel| {
        channel.rule == Rule::Average
            && match channel.source {
                Source::Albedo | Source::Emission => !channel.unit,
                Source::Normal => channel.unit,
                Source::Area | Source::Custom(_) => false,
            }
    };
    !channels.is_empty() && channels.iter().all(takes)
}

/// Pieces of flat triangles, as sums see them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatPiece {
    /// Areas in steps of weights.
    pub(crate) weight: u64,
    /// Areas times unit normals, in steps of weights times steps of values.
    pub(super) normal: [i64; 3],
}

impl FlatPiece {
    pub(crate) const NOTHING: Self = Self { weight: 0, normal: [0; 3] };

    /// A piece with its area times the unit normal, and anything that points like the normal.
    #[inline(always)]
    pub(crate) fn new(area: f64, area_normal: DVec3, direction: DVec3) -> Self {
        // Room for more digits than the integers of one step have.
        const COARSE: u32 = 5;
        let weight = integer(area * WEIGHT_UNITS);
        if weight <= 0 {
            return Self::dust(direction);
        }
        let steps = area_normal * (WEIGHT_UNITS * VALUE_STEPS / f64::from(1 << COARSE));
        let normal = [steps.x, steps.y, steps.z].map(|v| integer(v) << COARSE);
        Self { weight: weight as u64, normal }
    }

    /// A piece with hardly any area.
    #[cold]
    fn dust(direction: DVec3) -> Self {
        let [x, y, z, _] = fixed(unit(direction).extend(0.0).to_array(), 3);
        Self { weight: 1, normal: [x, y, z] }
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, other: &Self) {
        self.weight += other.weight;
        self.normal.iter_mut().zip(other.normal).for_each(|(a, b)| *a += b);
    }
}

/// Writes cells that hold nothing but pieces of flat triangles with the same colours: what
/// [`Accumulator::take`](super::Accumulator::take) would make of them, brick by brick.
#[derive(Clone, Debug, Default)]
pub(crate) struct FlatWriter {
    numbers: Vec<f32>,
}

impl FlatWriter {
    /// Appends the results of some cells to one list per channel; `colors` as [`fixed`] makes them.
    pub(crate) fn write<'p>(
        &mut self,
        channels: &[Channel],
        colors: &[[i64; 4]],
        pieces: impl Iterator<Item = &'p FlatPiece> + Clone,
        results: &mut [Values],
    ) {
        for ((channel, color), results) in channels.iter().zip(colors).zip(results) {
            self.numbers.clear();
            if matches!(channel.source, Source::Normal) {
                pieces.clone().for_each(|piece| self.numbers.extend(piece.mean_normal()));
            } else {
                // Equal values have exactly their value as mean.
                let color = color.map(|fixed| (fixed as f64 / VALUE_STEPS) as f32);
                let color = &color[..channel.components];
                pieces.clone().for_each(|_| self.numbers.extend_from_slice(color));
            }
            results.push(&self.numbers, channel.range);
        }
    }
}

impl FlatPiece {
    /// The direction of the mean normal; zero where normals cancel.
    #[inline]
    fn mean_normal(&self) -> [f32; 3] {
        let mean = DVec3::from(self.normal.map(|sum| sum as f64 / VALUE_STEPS));
        let length = mean.length();
        if length > CANCELLED * self.weight as f64 { (mean / length).as_vec3().to_array() } else { [0.0; 3] }
    }
}
