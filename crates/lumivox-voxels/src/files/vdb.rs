//! OpenVDB, file version 224: `density` (1 where occupied) and a grid per channel under its name, floats or vectors of
//! three. Two components become three, and four become a vector and a float grid `NAME_w`.
//!
//! The usual tree: a root, nodes of 32^3 and 16^3, and leaves of 8^3, which are the bricks of the volume. Background is
//! zero, only active values are stored, and nothing is compressed further. Each grid maps index `(i, j, k)` to the middle
//! of that cell in the world; the metadata `lumivox_origin`, `lumivox_cell_size` and `lumivox_axis_order` repeat the
//! grid as text.
//!
//! Memory: 16 bytes per brick while writing.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

use glam::{DVec3, UVec3, Vec4};

use super::{FileError, FileReport, Place, create};
use crate::sparse::{Mask, SIDE};
use crate::{ChannelData, SparseVolume};

const MAGIC: u64 = 0x5644_4220;
const FILE_VERSION: u32 = 224;
/// The library whose output this is like.
const LIBRARY: [u32; 2] = [10, 0];
/// Values are left out where the mask says inactive.
const COMPRESS_ACTIVE_MASK: u32 = 2;
/// Inactive values are the background's.
const ONLY_ACTIVE: u8 = 0;
/// Logarithms of the sides of nodes: in bricks, and in nodes of 16 bricks.
const LOWER: u32 = 4;
const UPPER: u32 = 5;

pub(super) fn write(
    place: &mut dyn Place,
    path: &Path,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    let mut grids = vec![Field { name: "density".to_owned(), values: None, first: 0, count: 1 }];
    for channel in volume.channels() {
        let name = channel.name().to_owned();
        let count = if channel.components() == 1 { 1 } else { 3 };
        grids.push(Field { name: name.clone(), values: Some(channel), first: 0, count });
        if channel.components() == 4 {
            grids.push(Field { name: format!("{name}_w"), values: Some(channel), first: 3, count: 1 });
        }
    }
    create(place, path, |out| {
        out.write_all(&MAGIC.to_le_bytes())?;
        for word in [FILE_VERSION, LIBRARY[0], LIBRARY[1]] {
            out.write_all(&word.to_le_bytes())?;
        }
        // Grids may be sought by their offsets; an identity that says nothing; no metadata.
        out.write_all(&[1])?;
        out.write_all(b"00000000-0000-4000-8000-000000000000")?;
        out.write_all(&0u32.to_le_bytes())?;
        out.write_all(&(grids.len() as u32).to_le_bytes())?;
        grids.iter().try_for_each(|field| field.write(volume, out))
    })?;
    Ok(FileReport { files: vec![path.to_owned()], ..FileReport::default() })
}

/// What becomes one grid.
struct Field<'a> {
    name: String,
    /// The channel; occupancy if there is none.
    values: Option<&'a ChannelData>,
    first: usize,
    count: usize,
}

impl Field<'_> {
    fn write<W: Write + Seek>(&self, volume: &SparseVolume, out: &mut W) -> io::Result<()> {
        let kind = if self.count == 1 { "Tree_float_5_4_3" } else { "Tree_vec3s_5_4_3" };
        text(out, &self.name)?;
        text(out, kind)?;
        text(out, "")?;
        let places = out.stream_position()?;
        out.write_all(&[0; 24])?;
        let start = out.stream_position()?;
        out.write_all(&COMPRESS_ACTIVE_MASK.to_le_bytes())?;
        self.metadata(volume, out)?;
        transform(volume, out)?;
        let nodes = Nodes::new(volume, self.values.is_some());
        self.topology(&nodes, out)?;
        let blocks = out.stream_position()?;
        for (brick, mask) in nodes.leaves() {
            out.write_all(bytemuck::bytes_of(&turned(mask).map(u64::to_le)))?;
            out.write_all(&[ONLY_ACTIVE])?;
            self.leaf(volume, *brick, mask, out)?;
        }
        let end = out.stream_position()?;
        out.seek(SeekFrom::Start(places))?;
        for place in [start, blocks, end] {
            out.write_all(&place.to_le_bytes())?;
        }
        out.seek(SeekFrom::Start(end))?;
        Ok(())
    }

    fn metadata(&self, volume: &SparseVolume, out: &mut impl Write) -> io::Result<()> {
        let grid = volume.grid();
        let [x, y, z] = grid.origin.to_array();
        let class = if self.values.is_none() { "fog volume" } else { "unknown" };
        let entries = [
            ("class", class.to_owned()),
            ("creator", concat!("lumivox ", env!("CARGO_PKG_VERSION")).to_owned()),
            ("lumivox_axis_order", "xyz".to_owned()),
            ("lumivox_cell_size", format!("{:?}", grid.cell_size)),
            ("lumivox_origin", format!("{x:?} {y:?} {z:?}")),
            ("name", self.name.clone()),
        ];
        out.write_all(&(entries.len() as u32).to_le_bytes())?;
        entries.iter().try_for_each(|(key, value)| {
            text(out, key)?;
            text(out, "string")?;
            text(out, value)
        })
    }

    /// Root and nodes: masks of children, no values of their own.
    fn topology(&self, nodes: &Nodes<'_>, out: &mut impl Write) -> io::Result<()> {
        // Buffers per leaf; background; tiles and children of the root.
        out.write_all(&1u32.to_le_bytes())?;
        out.write_all(&[0; 12][..4 * self.count])?;
        let has_child = u32::from(!nodes.leaves.is_empty());
        out.write_all(&0u32.to_le_bytes())?;
        out.write_all(&has_child.to_le_bytes())?;
        if has_child == 0 {
            return Ok(());
        }
        // A node of 4096 cells at the origin holds every grid of at most 2048.
        out.write_all(&[0; 12])?;
        node(out, UPPER, nodes.groups().map(|group| group[0].0))?;
        for group in nodes.groups() {
            node(out, LOWER, group.iter().map(|leaf| leaf.1))?;
            for (_, _, (_, mask)) in group {
                out.write_all(bytemuck::bytes_of(&turned(mask).map(u64::to_le)))?;
            }
        }
        Ok(())
    }

    /// The values of a leaf's active cells, z fastest.
    fn leaf(&self, volume: &SparseVolume, brick: UVec3, mask: &Mask, out: &mut impl Write) -> io::Result<()> {
        for (x, word) in turned(mask).into_iter().enumerate() {
            let mut word = word;
            while word != 0 {
                let bit = word.trailing_zeros();
                word &= word - 1;
                let cell = SIDE * brick + UVec3::new(x as u32, bit / SIDE, bit % SIDE);
                let value = match self.values {
                    None => Vec4::ONE,
                    Some(channel) => volume.slot(cell).map_or(Vec4::ZERO, |slot| channel.value(slot)),
                };
                for number in &value.to_array()[self.first..self.first + self.count] {
                    out.write_all(&number.to_le_bytes())?;
                }
            }
        }
        Ok(())
    }
}

/// A leaf's place in its node's parent, in its node, and the brick itself.
type Leaf<'a> = (u32, u32, (UVec3, &'a Mask));

/// Bricks in the order of the tree.
struct Nodes<'a> {
    leaves: Vec<Leaf<'a>>,
}

impl<'a> Nodes<'a> {
    fn new(volume: &'a SparseVolume, surface_only: bool) -> Self {
        let place = |v: UVec3, log: u32| v.x << (2 * log) | v.y << log | v.z;
        let leaf = |(brick, mask): (UVec3, &'a Mask)| {
            (place(brick >> LOWER, UPPER), place(brick & ((1 << LOWER) - 1), LOWER), (brick, mask))
        };
        let mut leaves: Vec<Leaf<'a>> = if surface_only {
            volume.surface_bricks().map(leaf).collect()
        } else {
            volume.bricks().map(leaf).collect()
        };
        leaves.sort_unstable_by_key(|leaf| (leaf.0, leaf.1));
        Self { leaves }
    }

    /// Leaves of one node each.
    fn groups(&self) -> impl Iterator<Item = &[Leaf<'a>]> {
        self.leaves.chunk_by(|a, b| a.0 == b.0)
    }

    fn leaves(&self) -> impl Iterator<Item = &(UVec3, &'a Mask)> {
        self.leaves.iter().map(|leaf| &leaf.2)
    }
}

/// An inner node: which children it has, that it has no active tiles, and so no values.
fn node(out: &mut impl Write, log: u32, children: impl Iterator<Item = u32>) -> io::Result<()> {
    let bytes = 1usize << (3 * log - 3);
    let mut mask = vec![0u8; bytes];
    children.for_each(|child| mask[child as usize / 8] |= 1 << (child % 8));
    out.write_all(&mask)?;
    out.write_all(&vec![0; bytes])?;
    out.write_all(&[ONLY_ACTIVE])
}

/// A brick's bits in the order of a leaf: word x, bit `8 y + z`.
fn turned(mask: &Mask) -> Mask {
    let mut turned = [0; SIDE as usize];
    for (z, &layer) in mask.iter().enumerate() {
        let mut layer = layer;
        while layer != 0 {
            let bit = layer.trailing_zeros();
            layer &= layer - 1;
            turned[(bit % SIDE) as usize] |= 1 << (SIDE * (bit / SIDE) + z as u32);
        }
    }
    turned
}

/// From cells to the world: scale, then translation to the middle of the first cell.
fn transform(volume: &SparseVolume, out: &mut impl Write) -> io::Result<()> {
    let grid = volume.grid();
    let side = DVec3::splat(f64::from(grid.cell_size));
    let translation = grid.origin.as_dvec3() + 0.5 * side;
    text(out, "UniformScaleTranslateMap")?;
    // Translation, scale, size of a cell, and what the map has worked out beforehand.
    for vector in [translation, side, side, 1.0 / side, 1.0 / (side * side), 0.5 / side] {
        for number in vector.to_array() {
            out.write_all(&number.to_le_bytes())?;
        }
    }
    Ok(())
}

fn text(out: &mut impl Write, text: &str) -> io::Result<()> {
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(text.as_bytes())
}
