//! The numbers of a run of maps, as they are kept in memory and in files.

use glam::{Vec2, Vec3};

use crate::settings::{Settings, Storage};

/// The code of a byte for a direction that meets nothing.
pub const BYTE_MISS: u8 = 255;
/// Distances over 2 R are kept in so many steps.
pub(crate) const BYTE_STEPS: f32 = 254.0;

/// The distances of some maps, one after the other; within a map texel `(s, t)` is number `s + side * t`.
#[derive(Clone, Debug, PartialEq)]
pub enum Distances {
    /// [`Storage::Byte`].
    Byte(Vec<u8>),
    /// [`Storage::Float`].
    Float(Vec<f32>),
    /// [`Storage::Bit`].
    Bit {
        /// Texel `n` of a map is bit `n % 32` of its word `n / 32`; set where something is met.
        words: Vec<u32>,
        /// Per map: the mean depth over 2 R, along the normal, of what it meets; 0 if nothing.
        depths: Vec<f32>,
    },
}

/// The numbers of some maps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Maps {
    pub(crate) distances: Distances,
    /// Octahedral normals, one pair per texel, zero where nothing is met; empty without normals.
    pub(crate) normals: Vec<[i8; 2]>,
}

impl Maps {
    pub(crate) fn empty(settings: &Settings) -> Self {
        let distances = match settings.storage {
            Storage::Byte => Distances::Byte(Vec::new()),
            Storage::Float => Distances::Float(Vec::new()),
            Storage::Bit => Distances::Bit { words: Vec::new(), depths: Vec::new() },
        };
        Self { distances, normals: Vec::new() }
    }

    /// Makes room for all maps at once; `None` if there is not enough memory.
    pub(crate) fn reserve(&mut self, settings: &Settings) -> Option<()> {
        let maps = settings.points as usize;
        let texels = maps.checked_mul(usize::try_from(settings.texels()).ok()?)?;
        match &mut self.distances {
            Distances::Byte(codes) => codes.try_reserve_exact(texels).ok()?,
            Distances::Float(values) => values.try_reserve_exact(texels).ok()?,
            Distances::Bit { words, depths } => {
                words.try_reserve_exact(texels / 32).ok()?;
                depths.try_reserve_exact(maps).ok()?;
            }
        }
        if settings.normals { self.normals.try_reserve_exact(texels).ok() } else { Some(()) }
    }

    /// One map from the distances over 2 R of its texels (1 or more: nothing is met), with the cosine of each
    /// direction and its octahedral normal.
    pub(crate) fn of_one(
        storage: Storage,
        distances: &[f32],
        cosines: &[f32],
        normals: Vec<[i8; 2]>,
    ) -> Self {
        let distances = match storage {
            Storage::Byte => Distances::Byte(distances.iter().map(|&d| byte(d)).collect()),
            Storage::Float => Distances::Float(distances.to_vec()),
            Storage::Bit => {
                let word = |texels: &[f32]| {
                    texels.iter().enumerate().fold(0, |word, (n, &d)| word | u32::from(d < 1.0) << n)
                };
                let met = || distances.iter().zip(cosines).filter(|(d, _)| **d < 1.0);
                let sum: f64 = met().map(|(d, cosine)| f64::from(d * cosine)).sum();
                let depth = sum / met().count().max(1) as f64;
                Distances::Bit { words: distances.chunks(32).map(word).collect(), depths: vec![depth as f32] }
            }
        };
        Self { distances, normals }
    }

    pub(crate) fn append(&mut self, mut other: Self) {
        match (&mut self.distances, &mut other.distances) {
            (Distances::Byte(all), Distances::Byte(more)) => all.append(more),
            (Distances::Float(all), Distances::Float(more)) => all.append(more),
            (Distances::Bit { words, depths }, Distances::Bit { words: more, depths: deeper }) => {
                words.append(more);
                depths.append(deeper);
            }
            _ => debug_assert!(false, "maps of one field have one storage"),
        }
        self.normals.append(&mut other.normals);
    }

    /// A run of maps by number.
    pub(crate) fn slice(&self, settings: &Settings, maps: std::ops::Range<usize>) -> Self {
        let texels = settings.texels() as usize;
        let part = |per_map: usize| maps.start * per_map..maps.end * per_map;
        let distances = match &self.distances {
            Distances::Byte(codes) => Distances::Byte(codes[part(texels)].to_vec()),
            Distances::Float(values) => Distances::Float(values[part(texels)].to_vec()),
            Distances::Bit { words, depths } => Distances::Bit {
                words: words[part(texels / 32)].to_vec(),
                depths: depths[maps.clone()].to_vec(),
            },
        };
        let normals = if settings.normals { self.normals[part(texels)].to_vec() } else { Vec::new() };
        Self { distances, normals }
    }

    /// Little-endian: the distances, the depths if any, then the normals if any.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>();
        let mut bytes = match &self.distances {
            Distances::Byte(codes) => codes.clone(),
            Distances::Float(values) => floats(values),
            Distances::Bit { words, depths } => {
                let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
                bytes.extend(floats(depths));
                bytes
            }
        };
        bytes.extend_from_slice(bytemuck::cast_slice(&self.normals));
        bytes
    }

    /// The inverse of [`Maps::to_bytes`] for `count` maps; `None` for another number of bytes, and for values that no
    /// bake writes.
    pub(crate) fn from_bytes(settings: &Settings, count: usize, bytes: &[u8]) -> Option<Self> {
        if bytes.len() as u64 != count as u64 * settings.map_bytes() {
            return None;
        }
        let texels = count * settings.texels() as usize;
        let floats = |bytes: &[u8]| -> Vec<f32> {
            bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect()
        };
        let (distances, rest) = match settings.storage {
            Storage::Byte => {
                let (codes, rest) = bytes.split_at(texels);
                (Distances::Byte(codes.to_vec()), rest)
            }
            Storage::Float => {
                let (values, rest) = bytes.split_at(4 * texels);
                (Distances::Float(floats(values)), rest)
            }
            Storage::Bit => {
                let (words, rest) = bytes.split_at(texels / 8);
                let (depths, rest) = rest.split_at(4 * count);
                let words = words.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
                (Distances::Bit { words, depths: floats(depths) }, rest)
            }
        };
        let sound = match &distances {
            Distances::Byte(_) => true,
            Distances::Float(values) | Distances::Bit { depths: values, .. } => {
                values.iter().all(|v| (0.0..=1.0).contains(v))
            }
        };
        sound.then(|| Self { distances, normals: bytemuck::cast_slice(rest).to_vec() })
    }
}

/// The code of a distance over 2 R.
fn byte(distance: f32) -> u8 {
    if distance < 1.0 { (distance * BYTE_STEPS).round() as u8 } else { BYTE_MISS }
}

/// The largest of the steps that a unit vector's coordinates are kept in.
const NORMAL_STEPS: f32 = 127.0;

/// A unit vector folded onto an octahedron and laid flat, in signed steps of 1/127.
pub(crate) fn octahedral(normal: Vec3) -> [i8; 2] {
    let flat = normal.truncate() / normal.abs().element_sum();
    let flat = if normal.z >= 0.0 { flat } else { folded(flat) };
    flat.to_array().map(|v| (v * NORMAL_STEPS).round() as i8)
}

/// The inverse of [`octahedral`], to about a degree.
pub(crate) fn from_octahedral(steps: [i8; 2]) -> Vec3 {
    let flat = Vec2::from(steps.map(f32::from)) / NORMAL_STEPS;
    let height = 1.0 - flat.x.abs() - flat.y.abs();
    let around = if height >= 0.0 { flat } else { folded(flat) };
    around.extend(height).normalize_or(Vec3::Z)
}

fn folded(flat: Vec2) -> Vec2 {
    (1.0 - Vec2::new(flat.y, flat.x).abs()) * Vec2::ONE.copysign(flat)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_is_off_by_half_a_step_at_most_and_a_hit_is_never_a_miss() {
        for n in 0..10_000 {
            let distance = n as f32 / 10_000.0;
            let code = byte(distance);
            assert!(code < BYTE_MISS);
            assert!((f32::from(code) / BYTE_STEPS - distance).abs() <= 0.5 / BYTE_STEPS + 1e-6);
        }
        assert_eq!((byte(1f32.next_down()), byte(1.0), byte(f32::INFINITY)), (254, BYTE_MISS, BYTE_MISS));
    }

    #[test]
    fn normals_come_back_within_a_degree_and_axes_exactly() {
        for n in 0..50_000u32 {
            let (z, turn) = (1.0 - n as f32 / 25_000.0, 2.4 * n as f32);
            let r = (1.0 - z * z).max(0.0).sqrt();
            let normal = Vec3::new(r * turn.cos(), r * turn.sin(), z).normalize_or(Vec3::Z);
            let apart = from_octahedral(octahedral(normal)).angle_between(normal).to_degrees();
            assert!(apart < 1.0, "{apart} at {normal}");
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            assert_eq!(from_octahedral(octahedral(axis)), axis);
            assert_eq!(from_octahedral(octahedral(-axis)), -axis);
        }
        for a in i8::MIN..=i8::MAX {
            for b in i8::MIN..=i8::MAX {
                assert!((from_octahedral([a, b]).length() - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn bytes_come_back_as_they_were_and_others_are_refused() {
        let cosines = [0.5; 1024];
        let distances: Vec<f32> = (0..1024).map(|n| n as f32 / 1000.0).collect();
        for storage in Storage::ALL {
            for normals in [false, true] {
                let settings = Settings { directions: 32, storage, normals, ..Settings::default() };
                let kept = if normals { vec![[3, -4]; 1024] } else { Vec::new() };
                let mut maps = Maps::of_one(storage, &distances, &cosines, kept);
                maps.append(maps.clone());
                let bytes = maps.to_bytes();
                assert_eq!(Maps::from_bytes(&settings, 2, &bytes).as_ref(), storage_sound(&maps, storage));
                assert_eq!(maps.slice(&settings, 0..2), maps);
                assert!(Maps::from_bytes(&settings, 2, &bytes[1..]).is_none());
                assert!(Maps::from_bytes(&settings, 3, &bytes).is_none());
            }
        }
    }

    /// Floats above 1 are none that a bake writes.
    fn storage_sound(maps: &Maps, storage: Storage) -> Option<&Maps> {
        (storage != Storage::Float).then_some(maps)
    }

    #[test]
    fn the_mean_depth_is_that_of_the_hits() {
        let distances = [[0.4, 0.8].as_slice(), &[1.0; 1022]].concat();
        let cosines = [[0.5, 1.0].as_slice(), &[1.0; 1022]].concat();
        let maps = Maps::of_one(Storage::Bit, &distances, &cosines, Vec::new());
        let Distances::Bit { words, depths } = maps.distances else { unreachable!() };
        assert_eq!((words.len(), words[0], words[1]), (32, 0b11, 0));
        assert!((depths[0] - 0.5).abs() < 1e-6);
    }
}
