//! PLY with a point in the middle of each occupied cell, binary little-endian.
//!
//! `x y z` in metres; `red green blue` in sRGB bytes if there is an `albedo`; `nx ny nz` if there is a `normal`; other
//! channels as floats, `NAME` or `NAME_0`, `NAME_1`, and so on. The comments `origin`, `cell_size`, `dims` and
//! `axis_order` carry the grid.

use std::io::{self, Write};
use std::path::Path;

use super::{FileError, FileReport, Place, create, srgb_from_linear};
use crate::{ChannelData, SparseVolume};

pub(super) fn write(
    place: &mut dyn Place,
    path: &Path,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    check_count(path, "points", volume.len())?;
    create(place, path, |out| {
        let attributes = Attributes::new(volume);
        writeln!(out, "ply\nformat binary_little_endian 1.0")?;
        grid_comments(out, volume)?;
        writeln!(
            out,
            "element vertex {}\nproperty float x\nproperty float y\nproperty float z",
            volume.len()
        )?;
        attributes.header(out)?;
        writeln!(out, "end_header")?;
        for (cell, slot) in volume.entries() {
            for number in volume.grid().center(cell).to_array() {
                out.write_all(&number.to_le_bytes())?;
            }
            attributes.write(slot, out)?;
        }
        Ok(())
    })?;
    Ok(FileReport { files: vec![path.to_owned()], ..FileReport::default() })
}

/// Readers count in 32 bits with a sign.
pub(super) fn check_count(path: &Path, what: &str, count: u64) -> Result<(), FileError> {
    if count > i32::MAX as u64 {
        let reason = format!("{count} {what}, and PLY readers count to {}", i32::MAX);
        return Err(FileError::Limit { path: path.to_owned(), reason });
    }
    Ok(())
}

pub(super) fn grid_comments(out: &mut impl Write, volume: &SparseVolume) -> io::Result<()> {
    let grid = volume.grid();
    let ([x, y, z], n) = (grid.origin.to_array(), grid.dims);
    writeln!(out, "comment origin {x:?} {y:?} {z:?}\ncomment cell_size {:?}", grid.cell_size)?;
    writeln!(out, "comment dims {} {} {}\ncomment axis_order xyz, x fastest", n.x, n.y, n.z)
}

/// The properties that come from channels.
pub(super) struct Attributes<'a> {
    albedo: Option<&'a ChannelData>,
    normal: Option<&'a ChannelData>,
    others: Vec<&'a ChannelData>,
}

impl<'a> Attributes<'a> {
    pub(super) fn new(volume: &'a SparseVolume) -> Self {
        let vector = |name: &str| volume.channel(name).filter(|channel| channel.components() >= 3);
        let (albedo, normal) = (vector("albedo"), vector("normal"));
        let taken: Vec<&str> = albedo.into_iter().chain(normal).map(ChannelData::name).collect();
        let others = volume.channels().iter().filter(|channel| !taken.contains(&channel.name())).collect();
        Self { albedo, normal, others }
    }

    pub(super) fn header(&self, out: &mut impl Write) -> io::Result<()> {
        if self.albedo.is_some() {
            writeln!(out, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
        }
        if self.normal.is_some() {
            writeln!(out, "property float nx\nproperty float ny\nproperty float nz")?;
        }
        for channel in &self.others {
            // Names end at a space.
            let name = channel.name().replace(char::is_whitespace, "_");
            match channel.components() {
                1 => writeln!(out, "property float {name}")?,
                n => (0..n).try_for_each(|n| writeln!(out, "property float {name}_{n}"))?,
            }
        }
        Ok(())
    }

    pub(super) fn write(&self, slot: Option<usize>, out: &mut impl Write) -> io::Result<()> {
        let value = |channel: &ChannelData| slot.map_or(glam::Vec4::ZERO, |slot| channel.value(slot));
        if let Some(channel) = self.albedo {
            out.write_all(&srgb_from_linear(value(channel).truncate()))?;
        }
        let floats = self.normal.map(|channel| (channel, 3));
        for (channel, count) in floats.into_iter().chain(self.others.iter().map(|c| (*c, c.components()))) {
            for number in &value(channel).to_array()[..count] {
                out.write_all(&number.to_le_bytes())?;
            }
        }
        Ok(())
    }
}
