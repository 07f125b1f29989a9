//! Sums over the surfaces in the cells of one brick, the same whatever the order they come in.
//!
//! An average is `sum(w v) / sum(w)` over integers: `w` counts in 2^-22 of a cell face, `v` in 2^-32, and the products
//! are exact in 128 bits, so that equal values have exactly their value as mean. Overflow would take 2^40 surfaces.

use std::cmp::Ordering;

use glam::Vec3;

use super::{Channel, Rule, Source, Values};
use crate::sparse::CELLS;

/// Units of weight in one cell face.
const WEIGHT_UNITS: f64 = (1u64 << 22) as f64;
/// Steps of a value in one.
const VALUE_STEPS: f64 = (1u64 << 32) as f64;
/// The largest value that sums and averages see.
const VALUE_LIMIT: f64 = (1u64 << 30) as f64;

/// What has to be known of a fragment, so that nobody computes the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Parts {
    /// Its area.
    pub(crate) area: bool,
    /// A point on it.
    pub(crate) point: bool,
}

impl Parts {
    /// What `channels` need, leaving aside that albedo, normal and emission may vary over a triangle.
    pub(crate) fn of(channels: &[Channel]) -> Self {
        let own = channels.iter().any(|c| matches!(c.source, Source::Custom(_) | Source::Area));
        Self {
            area: own || channels.iter().any(|c| c.rule == Rule::Average),
            point: own || channels.iter().any(|c| c.rule == Rule::Nearest),
        }
    }
}

/// One piece of surface in one cell, and its values in each channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fragment<'a> {
    /// Cell within the brick, `x + 8 (y + 8 z)`.
    pub(crate) cell: usize,
    /// Area in cell faces.
    pub(crate) area: f64,
    /// Squared distance to the cell's centre, in cells.
    pub(crate) distance: f32,
    /// Values per channel.
    pub(crate) values: &'a [[f32; 4]],
    /// The same as [`fixed`] makes them.
    pub(crate) fixed: &'a [[i64; 4]],
}

/// The first components in fixed point.
#[inline]
pub(crate) fn fixed(values: [f32; 4], components: usize) -> [i64; 4] {
    let mut fixed = [0; 4];
    for (fixed, &value) in fixed.iter_mut().zip(&values).take(components) {
        // `as` takes NaN to zero.
        *fixed = (f64::from(value).clamp(-VALUE_LIMIT, VALUE_LIMIT) * VALUE_STEPS) as i64;
    }
    fixed
}

/// The sums of one channel.
#[derive(Clone, Debug)]
enum Lane {
    Average(Vec<i128>),
    Sum(Vec<i128>),
    Maximum(Vec<f32>),
    Nearest(Vec<(f32, [f32; 4])>),
}

const FARTHEST: (f32, [f32; 4]) = (f32::INFINITY, [f32::NEG_INFINITY; 4]);

impl Lane {
    fn new(channel: &Channel) -> Self {
        let numbers = CELLS * channel.components;
        match channel.rule {
            Rule::Average => Self::Average(vec![0; numbers]),
            Rule::Sum => Self::Sum(vec![0; numbers]),
            Rule::Maximum => Self::Maximum(vec![f32::NEG_INFINITY; numbers]),
            Rule::Nearest => Self::Nearest(vec![FARTHEST; CELLS]),
        }
    }
}

/// Whether `a` goes before `b`: nearer, or as near and larger.
fn goes_before(a: &(f32, [f32; 4]), b: &(f32, [f32; 4])) -> bool {
    let by_values = || (0..4).map(|i| b.1[i].total_cmp(&a.1[i])).find(|o| o.is_ne());
    a.0.total_cmp(&b.0).then_with(|| by_values().unwrap_or(Ordering::Equal)).is_lt()
}

/// The sums of all channels in the cells of one brick.
#[derive(Clone, Debug)]
pub(crate) struct Accumulator<'a> {
    channels: &'a [Channel],
    weights: Vec<u64>,
    lanes: Vec<Lane>,
}

impl<'a> Accumulator<'a> {
    pub(crate) fn new(channels: &'a [Channel]) -> Self {
        Self { channels, weights: vec![0; CELLS], lanes: channels.iter().map(Lane::new).collect() }
    }

    #[inline]
    pub(crate) fn add(&mut self, fragment: &Fragment<'_>) {
        let cell = fragment.cell;
        let weight = ((fragment.area * WEIGHT_UNITS + 0.5) as u64).max(1);
        self.weights[cell] = self.weights[cell].wrapping_add(weight);
        for (n, (lane, channel)) in self.lanes.iter_mut().zip(self.channels).enumerate() {
            let components = channel.components;
            let numbers = cell * components..(cell + 1) * components;
            match lane {
                Lane::Average(sums) => {
                    for (sum, &value) in sums[numbers].iter_mut().zip(&fragment.fixed[n]) {
                        *sum = sum.wrapping_add(i128::from(weight as i64) * i128::from(value));
                    }
                }
                Lane::Sum(sums) => {
                    for (sum, &value) in sums[numbers].iter_mut().zip(&fragment.fixed[n]) {
                        *sum = sum.wrapping_add(i128::from(value));
                    }
                }
                Lane::Maximum(largest) => {
                    for (largest, &value) in largest[numbers].iter_mut().zip(&fragment.values[n]) {
                        // Adding zero makes -0 and 0 the same bits; `max` passes NaN by.
                        *largest = largest.max(value + 0.0);
                    }
                }
                Lane::Nearest(nearest) => {
                    let new = (fragment.distance, fragment.values[n]);
                    if goes_before(&new, &nearest[cell]) {
                        nearest[cell] = new;
                    }
                }
            }
        }
    }

    /// Adds the sums of another part of the same brick.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.weights.iter_mut().zip(&other.weights).for_each(|(a, b)| *a = a.wrapping_add(*b));
        for lanes in self.lanes.iter_mut().zip(&other.lanes) {
            match lanes {
                (Lane::Average(a), Lane::Average(b)) | (Lane::Sum(a), Lane::Sum(b)) => {
                    a.iter_mut().zip(b).for_each(|(a, b)| *a = a.wrapping_add(*b));
                }
                (Lane::Maximum(a), Lane::Maximum(b)) => {
                    a.iter_mut().zip(b).for_each(|(a, b)| *a = a.max(*b));
                }
                (Lane::Nearest(a), Lane::Nearest(b)) => {
                    a.iter_mut().zip(b).filter(|(a, b)| goes_before(b, a)).for_each(|(a, b)| *a = *b);
                }
                _ => {}
            }
        }
    }

    /// Appends a cell's results to one list per channel and forgets its sums.
    pub(crate) fn take(&mut self, cell: usize, results: &mut [Values]) {
        let weight = std::mem::take(&mut self.weights[cell]) as f64;
        for ((lane, channel), results) in self.lanes.iter_mut().zip(self.channels).zip(results) {
            let numbers = cell * channel.components..(cell + 1) * channel.components;
            let mut values = [0.0f32; 4];
            match lane {
                Lane::Average(sums) => {
                    for (value, sum) in values.iter_mut().zip(&mut sums[numbers]) {
                        *value = (to_f64(std::mem::take(sum)) / weight / VALUE_STEPS) as f32;
                    }
                }
                Lane::Sum(sums) => {
                    for (value, sum) in values.iter_mut().zip(&mut sums[numbers]) {
                        *value = (to_f64(std::mem::take(sum)) / VALUE_STEPS) as f32;
                    }
                }
                Lane::Maximum(largest) => {
                    for (value, largest) in values.iter_mut().zip(&mut largest[numbers]) {
                        *value = std::mem::replace(largest, f32::NEG_INFINITY);
                    }
                }
                Lane::Nearest(nearest) => values = std::mem::replace(&mut nearest[cell], FARTHEST).1,
            }
            if channel.unit {
                let unit = Vec3::new(values[0], values[1], values[2]).normalize_or_zero();
                values[..3].copy_from_slice(&unit.to_array());
            }
            for value in &values[..channel.components] {
                results.push(if value.is_finite() { *value } else { 0.0 }, channel.range);
            }
        }
    }
}

/// Most sums fit into 64 bits, whose conversion is an instruction and not a call.
fn to_f64(sum: i128) -> f64 {
    i64::try_from(sum).map_or_else(|_| sum as f64, |sum| sum as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Format;

    fn channels() -> Vec<Channel> {
        [Rule::Average, Rule::Sum, Rule::Maximum, Rule::Nearest]
            .map(|rule| Channel::custom("c", 2, |_| [0.0; 4]).rule(rule).format(Format::F32))
            .to_vec()
    }

    fn add(sums: &mut Accumulator<'_>, cell: usize, area: f64, distance: f32, value: [f32; 2]) {
        let values = [[value[0], value[1], 0.0, 0.0]; 4];
        sums.add(&Fragment { cell, area, distance, values: &values, fixed: &values.map(|v| fixed(v, 2)) });
    }

    fn results(sums: &mut Accumulator<'_>, cell: usize) -> Vec<[f32; 2]> {
        let mut values = vec![Values::new(Format::F32); 4];
        sums.take(cell, &mut values);
        values.iter().map(|v| [v.get(0, [0.0, 1.0]), v.get(1, [0.0, 1.0])]).collect()
    }

    #[test]
    fn each_rule_does_what_it_says() {
        let channels = channels();
        let mut sums = Accumulator::new(&channels);
        add(&mut sums, 511, 1.0, 0.5, [1.0, -2.0]);
        add(&mut sums, 511, 0.5, 0.1, [4.0, -8.0]);
        let expected = [[2.0, -4.0], [5.0, -10.0], [4.0, -2.0], [4.0, -8.0]];
        assert_eq!(results(&mut sums, 511), expected);
        assert_eq!(results(&mut sums, 511)[1..3], [[0.0; 2]; 2], "forgotten");
    }

    #[test]
    fn neither_order_nor_parts_matter_for_any_bit() {
        let channels = channels();
        let pieces: Vec<(f64, f32, [f32; 2])> = (0..200u32)
            .map(|n| {
                let x = (n * 7919 % 613) as f32 / 613.0;
                (f64::from(x * x) * 1e-3, (x - 0.5).abs(), [x * 1e6, -1.0 / (x + 1e-7)])
            })
            .collect();
        let mut forwards = Accumulator::new(&channels);
        pieces.iter().for_each(|&(a, d, v)| add(&mut forwards, 3, a, d, v));
        let (mut even, mut odd) = (Accumulator::new(&channels), Accumulator::new(&channels));
        for (n, &(a, d, v)) in pieces.iter().enumerate().rev() {
            add(if n % 2 == 0 { &mut even } else { &mut odd }, 3, a, d, v);
        }
        even.merge(&odd);
        assert_eq!(results(&mut forwards, 3), results(&mut even, 3));
    }

    #[test]
    fn equal_values_have_exactly_their_value_as_mean_even_without_area() {
        let channels = channels();
        let mut sums = Accumulator::new(&channels);
        (0..9).for_each(|n| add(&mut sums, 0, 1e-12 * f64::from(n), 0.0, [0.7, -0.3]));
        assert_eq!(results(&mut sums, 0)[0], [0.7, -0.3]);
        add(&mut sums, 0, 1.0, 0.0, [f32::NAN, f32::INFINITY]);
        assert!(results(&mut sums, 0).iter().flatten().all(|v| v.is_finite()));
    }
}
