//! Sums over the surfaces in the cells of one brick, the same whatever the order they come in.
//!
//! An average is `sum(w v) / sum(w)` over integers: `w` counts in 2^-22 of a cell face, `v` in 2^-32, and the products
//! are exact in 128 bits, so that equal values have exactly their value as mean. Overflow would take 2^40 surfaces.
//!
//! Most triangles have one colour and one normal all over. Of their colour only the weights are summed, and multiplied
//! with it when another colour comes or the cell is taken, which gives the same sums. Of their normal only the direction
//! of the mean counts, so that area and normal need not be taken apart: half the product of two edges is both.

use glam::{DVec3, Vec3};

use super::flat::FlatPiece;
use super::lane::{FARTHEST, Lane, goes_before};
use super::numbers::{CANCELLED, VALUE_STEPS, WEIGHT_UNITS, to_f64};
use super::{Channel, Rule, Source, Values};
use crate::sparse::{CELLS, Mask, SIDE};

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
    /// The same as [`fixed`](super::fixed) makes them.
    pub(crate) fixed: &'a [[i64; 4]],
}

/// The sums of all channels in the cells of one brick.
#[derive(Clone, Debug)]
pub(crate) struct Accumulator<'a> {
    channels: &'a [Channel],
    weights: Vec<u64>,
    lanes: Vec<Lane>,
    /// Cells whose averages hold something.
    summed: Mask,
    /// Weights that are still to be multiplied with `flat`, and the cells that have some.
    owed: Vec<u64>,
    owing: Mask,
    /// Values of flat triangles per channel.
    flat: Vec<[i64; 4]>,
    /// Which lanes hold normals.
    normal_lanes: Vec<usize>,
}

impl<'a> Accumulator<'a> {
    pub(crate) fn new(channels: &'a [Channel]) -> Self {
        Self {
            channels,
            weights: vec![0; CELLS],
            lanes: channels.iter().map(Lane::new).collect(),
            summed: [0; SIDE as usize],
            owed: vec![0; CELLS],
            owing: [0; SIDE as usize],
            flat: vec![[0; 4]; channels.len()],
            normal_lanes: (0..channels.len())
                .filter(|&n| matches!(channels[n].source, Source::Normal))
                .collect(),
        }
    }

    /// The values of flat triangles from now on, as [`fixed`](super::fixed) makes them; normals aside.
    pub(crate) fn set_flat(&mut self, values: &[[i64; 4]]) {
        self.settle();
        self.flat.copy_from_slice(values);
    }

    /// Adds pieces of flat triangles.
    #[inline(always)]
    pub(crate) fn add_flat(&mut self, cell: usize, piece: &FlatPiece) {
        self.weights[cell] = self.weights[cell].wrapping_add(piece.weight());
        self.owed[cell] = self.owed[cell].wrapping_add(piece.weight());
        self.owing[cell >> 6] |= 1 << (cell & 63);
        for lane in &self.normal_lanes {
            if let Some(Lane::Average(sums)) = self.lanes.get_mut(*lane) {
                for (sum, value) in sums[3 * cell..3 * cell + 3].iter_mut().zip(piece.normal()) {
                    *sum = sum.wrapping_add(i128::from(value));
                }
            }
        }
    }

    /// Multiplies what is still to be multiplied.
    pub(crate) fn settle(&mut self) {
        for z in 0..self.owing.len() {
            let mut word = std::mem::take(&mut self.owing[z]);
            self.summed[z] |= word;
            while word != 0 {
                let cell = 64 * z + word.trailing_zeros() as usize;
                word &= word - 1;
                self.settle_cell(cell);
            }
        }
    }

    fn settle_cell(&mut self, cell: usize) {
        let owed = std::mem::take(&mut self.owed[cell]);
        for ((lane, channel), flat) in self.lanes.iter_mut().zip(self.channels).zip(&self.flat) {
            if let (Lane::Average(sums), false) = (lane, matches!(channel.source, Source::Normal)) {
                let numbers = cell * channel.components..(cell + 1) * channel.components;
                for (sum, &value) in sums[numbers].iter_mut().zip(flat) {
                    *sum = sum.wrapping_add(i128::from(owed) * i128::from(value));
                }
            }
        }
    }

    #[inline]
    pub(crate) fn add(&mut self, fragment: &Fragment<'_>) {
        let cell = fragment.cell;
        let weight = ((fragment.area * WEIGHT_UNITS + 0.5) as u64).max(1);
        self.summed[cell >> 6] |= 1 << (cell & 63);
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

    /// Adds the sums of another part of the same brick; both are settled.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.summed.iter_mut().zip(other.summed).for_each(|(a, b)| *a |= b);
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
        let (z, bit) = (cell >> 6, 1u64 << (cell & 63));
        let (owing, summed) = (self.owing[z] & bit != 0, self.summed[z] & bit != 0);
        // Equal values have exactly their value as mean.
        let is_flat = owing && !summed;
        if owing && summed {
            self.settle_cell(cell);
        }
        self.owing[z] &= !bit;
        self.summed[z] &= !bit;
        self.owed[cell] = 0;
        let weight = std::mem::take(&mut self.weights[cell]) as f64;
        for (n, results) in results.iter_mut().enumerate() {
            let channel = &self.channels[n];
            let numbers = cell * channel.components..(cell + 1) * channel.components;
            let mut values = [0.0f32; 4];
            match &mut self.lanes[n] {
                Lane::Average(sums) if channel.unit => {
                    let mean = |sum: &mut i128| to_f64(std::mem::take(sum)) / VALUE_STEPS;
                    let mut means = sums[numbers].iter_mut().map(mean);
                    let mut next = || means.next().unwrap_or(0.0);
                    let mean = DVec3::new(next(), next(), next());
                    values[3] = (next() / weight) as f32;
                    let length = mean.length();
                    if length > CANCELLED * weight {
                        values[..3].copy_from_slice(&(mean / length).as_vec3().to_array());
                    }
                }
                Lane::Average(_) if is_flat => {
                    for (value, fixed) in values.iter_mut().zip(self.flat[n]) {
                        *value = (fixed as f64 / VALUE_STEPS) as f32;
                    }
                }
                Lane::Average(sums) => {
                    let per_weight = 1.0 / (weight * VALUE_STEPS);
                    for (value, sum) in values.iter_mut().zip(&mut sums[numbers]) {
                        *value = (to_f64(std::mem::take(sum)) * per_weight) as f32;
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
            if channel.unit && channel.rule != Rule::Average {
                let unit = Vec3::new(values[0], values[1], values[2]).normalize_or_zero();
                values[..3].copy_from_slice(&unit.to_array());
            }
            for value in &mut values {
                *value = if value.is_finite() { *value } else { 0.0 };
            }
            results.push(&values[..channel.components], channel.range);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::{Format, fixed};

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
