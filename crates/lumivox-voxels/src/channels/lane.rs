//! The sums of one channel, by its rule.

use std::cmp::Ordering;

use super::{Channel, Rule};
use crate::sparse::CELLS;

/// The sums of one channel.
#[derive(Clone, Debug)]
pub(super) enum Lane {
    Average(Vec<i128>),
    Sum(Vec<i128>),
    Maximum(Vec<f32>),
    Nearest(Vec<(f32, [f32; 4])>),
}

pub(super) const FARTHEST: (f32, [f32; 4]) = (f32::INFINITY, [f32::NEG_INFINITY; 4]);

impl Lane {
    pub(super) fn new(channel: &Channel) -> Self {
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
pub(super) fn goes_before(a: &(f32, [f32; 4]), b: &(f32, [f32; 4])) -> bool {
    let by_values = || (0..4).map(|i| b.1[i].total_cmp(&a.1[i])).find(|o| o.is_ne());
    a.0.total_cmp(&b.0).then_with(|| by_values().unwrap_or(Ordering::Equal)).is_lt()
}
