//! Flat triangles: pieces of surface with one colour and one normal all over, summed in short.

use glam::DVec3;

use super::numbers::{CANCELLED, VALUE_STEPS, WEIGHT_UNITS, fixed, integer, to_f64, unit};
use super::{Channel, Rule, Source, Values};
use crate::sparse::CELLS;

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

/// Pieces of flat triangles, as sums see them: first their areas in steps of weights, then their areas times unit
/// normals, in steps of weights times steps of values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatPiece(pub(crate) [i64; 4]);

impl FlatPiece {
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
        let [x, y, z] = [steps.x, steps.y, steps.z].map(|v| integer(v) << COARSE);
        Self([weight, x, y, z])
    }

    /// A piece with hardly any area.
    #[cold]
    fn dust(direction: DVec3) -> Self {
        let [x, y, z, _] = fixed(unit(direction).extend(0.0).to_array(), 3);
        Self([1, x, y, z])
    }

    pub(super) fn weight(&self) -> u64 {
        self.0[0] as u64
    }

    pub(super) fn normal(&self) -> [i64; 3] {
        [self.0[1], self.0[2], self.0[3]]
    }
}

/// The sums of pieces of one or several colours in a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MixedCell<'a> {
    /// The number of the first colour.
    pub(crate) color: u32,
    /// Weights, and weights times normals.
    pub(crate) sums: &'a [i128; 4],
    /// Weights times values, per channel, where there are several colours.
    pub(crate) values: Option<&'a [[i128; 4]]>,
}

/// Writes cells that hold nothing but pieces of flat triangles with the same colours: what
/// [`Accumulator::take`](super::Accumulator::take) would make of them, brick by brick.
#[derive(Clone, Debug)]
pub(crate) struct FlatWriter {
    /// The normals of the cells of a brick.
    normals: Vec<f32>,
}

impl FlatWriter {
    pub(crate) fn new() -> Self {
        Self { normals: vec![0.0; 3 * CELLS] }
    }

    /// Appends the results of some cells of a brick to one list per channel; `colors` as [`fixed`] makes them, `sums` the
    /// numbers of pieces.
    pub(crate) fn write(
        &mut self,
        channels: &[Channel],
        colors: &[[i64; 4]],
        sums: impl Iterator<Item = [f64; 4]>,
        results: &mut [Values],
    ) {
        let mut len = 0;
        for (normal, piece) in self.normals.chunks_exact_mut(3).zip(sums) {
            normal.copy_from_slice(&mean_normal(piece));
            len += 1;
        }
        for ((channel, color), results) in channels.iter().zip(colors).zip(results) {
            if matches!(channel.source, Source::Normal) {
                results.push(&self.normals[..3 * len], channel.range);
            } else {
                // Equal values have exactly their value as mean.
                let color = color.map(|fixed| (fixed as f64 / VALUE_STEPS) as f32);
                results.push_copies(&color[..channel.components], len, channel.range);
            }
        }
    }
}

/// Appends the results of some cells in which several colours may meet to one list per channel; `colors` are the values
/// of each.
pub(crate) fn write_mixed<'a>(
    channels: &[Channel],
    colors: &[Vec<[i64; 4]>],
    cells: impl Iterator<Item = MixedCell<'a>>,
    results: &mut [Values],
) {
    for cell in cells {
        let sums = cell.sums.map(to_f64);
        let per_weight = 1.0 / (sums[0] * VALUE_STEPS);
        for (n, (channel, results)) in channels.iter().zip(&mut *results).enumerate() {
            let values = match cell.values {
                _ if matches!(channel.source, Source::Normal) => {
                    let [x, y, z] = mean_normal(sums);
                    [x, y, z, 0.0]
                }
                Some(values) => values[n].map(|sum| (to_f64(sum) * per_weight) as f32),
                // Equal values have exactly their value as mean.
                None => colors[cell.color as usize][n].map(|fixed| (fixed as f64 / VALUE_STEPS) as f32),
            };
            results.push(&values[..channel.components], channel.range);
        }
    }
}

/// The direction of the mean normal; zero where normals cancel.
#[inline]
fn mean_normal([weight, x, y, z]: [f64; 4]) -> [f32; 3] {
    let mean = DVec3::new(x, y, z) / VALUE_STEPS;
    let length = mean.length();
    if length > CANCELLED * weight { (mean / length).as_vec3().to_array() } else { [0.0; 3] }
}
