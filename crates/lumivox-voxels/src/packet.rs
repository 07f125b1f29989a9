//! Finished bricks on their way to the volume.

use crate::channels::Values;
use crate::job::Job;
use crate::sparse::{Mask, count};

/// Bricks, by their index in the grid, with the values of their cells one after the other.
pub(crate) struct Packet {
    pub(crate) bricks: Vec<u32>,
    pub(crate) masks: Vec<Mask>,
    /// Of each channel.
    pub(crate) values: Vec<Values>,
}

impl Packet {
    pub(crate) fn new(job: &Job<'_>) -> Self {
        let values = job.channels.iter().map(|channel| Values::new(channel.format)).collect();
        Self { bricks: Vec::new(), masks: Vec::new(), values }
    }

    /// Appends bricks that all come after those that are there.
    pub(crate) fn append(&mut self, other: Self) {
        self.bricks.extend_from_slice(&other.bricks);
        self.masks.extend_from_slice(&other.masks);
        self.values.iter_mut().zip(other.values).for_each(|(to, from)| to.append(from));
    }

    /// Appends bricks of several packets, in the order of their index.
    pub(crate) fn append_in_order(&mut self, packets: Vec<Self>) {
        let mut all: Vec<(u32, u32, u32, usize)> =
            Vec::with_capacity(packets.iter().map(|p| p.bricks.len()).sum());
        let mut cells = 0;
        for (n, packet) in packets.iter().enumerate() {
            let mut first = 0;
            for (place, (&brick, mask)) in packet.bricks.iter().zip(&packet.masks).enumerate() {
                all.push((brick, n as u32, place as u32, first));
                first += count(mask) as usize;
            }
            cells += first;
        }
        all.sort_unstable_by_key(|entry| entry.0);
        self.bricks.extend(all.iter().map(|entry| entry.0));
        self.masks.extend(all.iter().map(|&(_, n, place, _)| packets[n as usize].masks[place as usize]));
        for (channel, values) in self.values.iter_mut().enumerate() {
            let numbers: usize = packets.iter().map(|packet| packet.values[channel].len()).sum();
            let per_cell = numbers / cells.max(1);
            values.reserve(numbers);
            for &(_, n, place, first) in &all {
                let packet = &packets[n as usize];
                let end = first + count(&packet.masks[place as usize]) as usize;
                values.extend_from(&packet.values[channel], per_cell * first..per_cell * end);
            }
        }
    }

    pub(crate) fn bytes(&self) -> u64 {
        let values: usize = self.values.iter().map(|v| v.as_bytes().len()).sum();
        (self.bricks.len() * (size_of::<u32>() + size_of::<Mask>()) + values) as u64
    }
}
