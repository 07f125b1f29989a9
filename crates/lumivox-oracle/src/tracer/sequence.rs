//! Points that fill the unit square and cube more evenly than random ones, for the first steps of a path.
//!
//! Sobol's sequence, scrambled as Owen (1995) says by a hash (Laine and Karras 2011, with the constants of Vegdahl 2021),
//! with its order scrambled too, so that groups of two and three numbers can be put side by side (Burley, *Practical
//! Hash-based Owen Scrambling*, 2020). Each point alone is uniform, so means are unbiased; together they leave no gaps,
//! so the error of a mean over a shadow's edge falls with about the power 3/4 of their number instead of 1/2.
//!
//! Samples of one sequence depend on each other, and their variance says nothing of the error of their mean. So paths take turns
//! with [`REPLICATES`] sequences, each scrambled by itself, and the error is that of the mean of their means.

use glam::{Vec2, Vec3};

use super::random::mix;

/// Sequences that take turns. Each has an eighth of the samples, and evens out only these; fewer would be smoother
/// and would say less about their error.
pub(crate) const REPLICATES: u32 = 8;

/// Numbers in 0..1 for the first steps of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FirstSteps {
    /// Where in its pixel it begins.
    pub(crate) pixel: Vec2,
    /// Which emitter it asks, and which point of it.
    pub(crate) light: Vec3,
    /// Which way it goes on from the first surface.
    pub(crate) direction: Vec2,
}

/// The sequences of one pixel or point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sequences(u64);

impl Sequences {
    /// Number `stream` of a seed.
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        Self(mix(mix(seed ^ 0x6a09_e667_f3bc_c908).wrapping_add(mix(!stream))))
    }

    /// The numbers of path `n`, which belongs to sequence `n % REPLICATES`.
    pub(crate) fn first_steps(self, n: u32) -> FirstSteps {
        let (replicate, n) = (n % REPLICATES, n / REPLICATES);
        let group = |g: u32| Group { key: mix(self.0 ^ u64::from(4 * replicate + g)), n };
        let [pixel, light, direction] = [group(0), group(1), group(2)].map(Group::order);
        FirstSteps {
            pixel: Vec2::new(pixel.at(0), pixel.at(1)),
            light: Vec3::new(light.at(0), light.at(1), light.at(2)),
            direction: Vec2::new(direction.at(0), direction.at(1)),
        }
    }
}

/// Numbers that are evenly spread together.
#[derive(Clone, Copy)]
struct Group {
    key: u64,
    n: u32,
}

impl Group {
    /// Takes the points in another order, in which any 2^k of them from the start are still a whole net.
    fn order(self) -> Self {
        Self { n: scrambled(self.n, mix(self.key.wrapping_add(0x100))), ..self }
    }

    fn at(self, dimension: usize) -> f32 {
        let bits = scrambled(sobol(self.n, dimension), mix(self.key.wrapping_add(dimension as u64)));
        (bits >> 8) as f32 * (1.0 / (1 << 24) as f32)
    }
}

const DIMENSIONS: usize = 3;

/// Direction numbers: those of van der Corput's sequence, and of the primitive polynomials `x + 1` and `x2 + x + 1` (Joe and
/// Kuo 2008).
const DIRECTIONS: [[u32; 32]; DIMENSIONS] = {
    let mut v = [[0; 32]; DIMENSIONS];
    let mut i = 0;
    while i < 32 {
        v[0][i] = 1 << (31 - i);
        v[1][i] = if i == 0 { 1 << 31 } else { v[1][i - 1] ^ (v[1][i - 1] >> 1) };
        v[2][i] = match i {
            0 => 1 << 31,
            1 => 3 << 30,
            _ => v[2][i - 1] ^ v[2][i - 2] ^ (v[2][i - 2] >> 2),
        };
        i += 1;
    }
    v
};

fn sobol(n: u32, dimension: usize) -> u32 {
    let directions = &DIRECTIONS[dimension];
    let (mut rest, mut value) = (n, 0);
    while rest != 0 {
        value ^= directions[rest.trailing_zeros() as usize];
        rest &= rest - 1;
    }
    value
}

/// Owen's scrambling: each bit is flipped or not by all bits above it.
fn scrambled(bits: u32, key: u64) -> u32 {
    let (seed, flips) = (key as u32, (key >> 32) as u32);
    let mut x = bits.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    // What makes each value uniform by itself, however good the hash is.
    x.reverse_bits() ^ flips
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(replicate: u32, count: u32) -> impl Iterator<Item = FirstSteps> {
        let sequences = Sequences::new(5, 77);
        (0..count).map(move |n| sequences.first_steps(REPLICATES * n + replicate))
    }

    /// 256 points: one in each of the 256 boxes of every shape of 2^i by 2^j.
    #[test]
    fn pairs_fill_every_elementary_box_once() {
        type Pair = fn(&FirstSteps) -> Vec2;
        let pairs: [Pair; 3] = [|p| p.pixel, |p| p.direction, |p| Vec2::new(p.light.x, p.light.y)];
        for pair in pairs {
            for (columns, rows) in [(256, 1), (64, 4), (16, 16), (2, 128), (1, 256)] {
                let mut filled = vec![0; 256];
                for p in points(3, 256).map(|p| pair(&p)) {
                    assert!(p.min_element() >= 0.0 && p.max_element() < 1.0);
                    let cell = (p * Vec2::new(columns as f32, rows as f32)).as_uvec2();
                    filled[(cell.y * columns + cell.x) as usize] += 1;
                }
                assert!(filled.iter().all(|&n| n == 1), "{columns} x {rows}");
            }
        }
    }

    #[test]
    fn triples_are_even_too_and_groups_do_not_know_of_each_other() {
        let mut eighths = [0u32; 8];
        let mut both = [0u32; 16];
        for p in points(0, 1024) {
            let cell = (2.0 * p.light).as_uvec3();
            eighths[(4 * cell.z + 2 * cell.y + cell.x) as usize] += 1;
            let (a, b) = ((4.0 * p.pixel.x) as usize, (4.0 * p.direction.x) as usize);
            both[4 * a + b] += 1;
        }
        assert_eq!(eighths, [128; 8]);
        // 64 each; random ones have a standard deviation of 7.7.
        assert!(both.iter().all(|n| n.abs_diff(64) < 35), "{both:?}");
    }

    #[test]
    fn one_point_is_uniform_over_all_seeds() {
        let mut sums = [0.0f64; 3];
        let mut low = 0;
        for seed in 0..20_000 {
            let p = Sequences::new(seed, 1).first_steps(9);
            sums[0] += f64::from(p.direction.x);
            sums[1] += f64::from(p.direction.y);
            sums[2] += f64::from(p.light.z * p.direction.x);
            low += u32::from(p.pixel.x < 0.125);
        }
        // Four standard errors are 0.008, 0.008, 0.0063 and 187.
        let means = sums.map(|sum| sum / 20_000.0);
        assert!((means[0] - 0.5).abs() < 0.008 && (means[1] - 0.5).abs() < 0.008, "{means:?}");
        assert!((means[2] - 0.25).abs() < 0.0063 && low.abs_diff(2500) < 187, "{means:?} {low}");
    }
}
