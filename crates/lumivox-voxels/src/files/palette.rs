//! 255 colours for all: median cut (Heckbert 1982) over colours of six bits a component.

use glam::Vec3;

/// Bits of a component that tell colours apart.
const BITS: u32 = 6;

/// A linear colour as sRGB bytes.
pub fn srgb_from_linear(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|v| {
        let v = v.clamp(0.0, 1.0);
        let encoded = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (255.0 * encoded).round() as u8
    })
}

fn bin([r, g, b]: [u8; 3]) -> usize {
    let part = |v: u8| usize::from(v >> (8 - BITS));
    part(r) << (2 * BITS) | part(g) << BITS | part(b)
}

/// How often colours come, and what they are on average within a bin.
pub(super) struct Histogram {
    bins: Vec<(u64, [u64; 3])>,
}

/// Colours that go together.
struct Cluster {
    bins: Vec<usize>,
    count: u64,
}

impl Histogram {
    pub(super) fn new() -> Self {
        Self { bins: vec![(0, [0; 3]); 1 << (3 * BITS)] }
    }

    pub(super) fn add(&mut self, color: [u8; 3]) {
        let (count, sums) = &mut self.bins[bin(color)];
        *count += 1;
        sums.iter_mut().zip(color).for_each(|(sum, v)| *sum += u64::from(v));
    }

    fn mean(&self, bin: usize) -> [u64; 3] {
        let (count, sums) = self.bins[bin];
        sums.map(|sum| (sum + count / 2) / count.max(1))
    }

    /// At most `size` colours, and which of them each colour takes.
    pub(super) fn palette(&self, size: usize) -> Palette {
        let used: Vec<usize> = (0..self.bins.len()).filter(|&n| self.bins[n].0 > 0).collect();
        let count = used.iter().map(|&n| self.bins[n].0).sum();
        let mut clusters = vec![Cluster { bins: used, count }];
        while clusters.len() < size {
            // Split where most is wrong: the widest spread, and of those that tie the most cells.
            let Some((at, axis, _)) = clusters
                .iter()
                .enumerate()
                .filter(|(_, cluster)| cluster.bins.len() > 1)
                .map(|(at, cluster)| {
                    let (axis, spread) = self.widest(cluster);
                    (at, axis, (spread, cluster.count))
                })
                .max_by_key(|(_, _, key)| *key)
            else {
                break;
            };
            let (a, b) = self.split(clusters.swap_remove(at), axis);
            clusters.extend([a, b]);
        }
        let mut palette = Palette { colors: Vec::new(), places: vec![0; self.bins.len()] };
        for cluster in clusters.iter().filter(|cluster| cluster.count > 0) {
            cluster.bins.iter().for_each(|&bin| palette.places[bin] = palette.colors.len() as u8);
            let total = |axis: usize| cluster.bins.iter().map(|&bin| self.bins[bin].1[axis]).sum::<u64>();
            palette
                .colors
                .push([0, 1, 2].map(|axis| ((total(axis) + cluster.count / 2) / cluster.count) as u8));
        }
        palette
    }

    fn widest(&self, cluster: &Cluster) -> (usize, u64) {
        let spread = |axis: usize| {
            let values = cluster.bins.iter().map(|&bin| self.mean(bin)[axis]);
            let (low, high) = values.fold((u64::MAX, 0), |(low, high), v| (low.min(v), high.max(v)));
            high - low
        };
        (0..3).map(|axis| (axis, spread(axis))).max_by_key(|(_, spread)| *spread).unwrap_or((0, 0))
    }

    /// In two along an axis, with about as many cells in each.
    fn split(&self, mut cluster: Cluster, axis: usize) -> (Cluster, Cluster) {
        cluster.bins.sort_unstable_by_key(|&bin| (self.mean(bin)[axis], bin));
        let mut below = 0;
        let middle = cluster.bins.iter().position(|&bin| {
            below += self.bins[bin].0;
            2 * below >= cluster.count
        });
        let at = middle.map_or(1, |n| n + 1).clamp(1, cluster.bins.len() - 1);
        let upper = cluster.bins.split_off(at);
        let count = upper.iter().map(|&bin| self.bins[bin].0).sum();
        (Cluster { count: cluster.count - count, ..cluster }, Cluster { bins: upper, count })
    }
}

/// A few colours.
pub(super) struct Palette {
    /// sRGB.
    pub(super) colors: Vec<[u8; 3]>,
    places: Vec<u8>,
}

impl Palette {
    /// The place of a colour that the histogram has seen.
    pub(super) fn place(&self, color: [u8; 3]) -> u8 {
        self.places[bin(color)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(colors: &[[u8; 3]], size: usize) -> (usize, u8) {
        let mut histogram = Histogram::new();
        colors.iter().for_each(|&c| histogram.add(c));
        let palette = histogram.palette(size);
        let error = |c: &[u8; 3]| {
            let found = palette.colors[usize::from(palette.place(*c))];
            (0..3).map(|i| found[i].abs_diff(c[i])).max().unwrap()
        };
        (palette.colors.len(), colors.iter().map(error).max().unwrap())
    }

    #[test]
    fn few_colours_stay_as_they_are_and_many_come_near() {
        let few: Vec<[u8; 3]> = (0..255u32).map(|n| [(n % 16 * 16) as u8, (n / 16 * 16) as u8, 77]).collect();
        assert_eq!(worst(&few, 255), (255, 0));
        let many: Vec<[u8; 3]> = (0..32768u32)
            .map(|n| [(n % 32 * 8) as u8, (n / 32 % 32 * 8) as u8, (n / 1024 * 8) as u8])
            .collect();
        let (count, error) = worst(&many, 255);
        assert!(count == 255 && error <= 32, "{count} {error}");
        assert_eq!(worst(&[[9, 9, 9]], 255), (1, 0));
    }

    #[test]
    fn srgb_has_its_known_points() {
        assert_eq!(srgb_from_linear(Vec3::new(0.0, 0.214_041_14, 1.0)), [0, 128, 255]);
        assert_eq!(srgb_from_linear(Vec3::new(-1.0, f32::NAN, 7.0)), [0, 0, 255]);
    }
}
