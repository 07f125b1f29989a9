//! Dense layers of a sparse volume, one at a time.

use std::io::{self, Write};

use crate::{ChannelData, SparseVolume, Values};

/// A layer of occupancy after the other, a byte of `occupied` or zero per cell, x fastest.
pub(super) fn occupancy(volume: &SparseVolume, occupied: u8, out: &mut impl Write) -> io::Result<()> {
    let n = volume.grid().dims;
    let mut layer = vec![0u8; n.x as usize * n.y as usize];
    for z in 0..n.z {
        layer.fill(0);
        for (cell, _) in volume.entries_of_layers(z..z + 1) {
            layer[(cell.x + n.x * cell.y) as usize] = occupied;
        }
        out.write_all(&layer)?;
    }
    Ok(())
}

/// A layer of a channel after the other: numbers as they are stored, little-endian, x fastest but for components. With
/// `occupancy`, cells have that many numbers more, which say in the channel's format whether they are occupied.
pub(super) fn channel(
    volume: &SparseVolume,
    channel: &ChannelData,
    occupancy: usize,
    out: &mut impl Write,
) -> io::Result<()> {
    let n = volume.grid().dims;
    let width = channel.values().format().bytes();
    let stride = (channel.components() + occupancy) * width;
    let own = channel.components() * width;
    let bytes = little_endian(channel.values());
    let mut layer = vec![0u8; n.x as usize * n.y as usize * stride];
    let one: &[u8] = match channel.values() {
        Values::U8(_) => &[255],
        Values::F16(_) => &[0x00, 0x3c],
        Values::F32(_) => &[0x00, 0x00, 0x80, 0x3f],
    };
    for z in 0..n.z {
        layer.fill(0);
        for (cell, slot) in volume.entries_of_layers(z..z + 1) {
            let at = (cell.x + n.x * cell.y) as usize * stride;
            if let Some(slot) = slot {
                layer[at..at + own].copy_from_slice(&bytes[slot * own..(slot + 1) * own]);
            }
            if occupancy > 0 {
                layer[at + stride - width..at + stride].copy_from_slice(one);
            }
        }
        out.write_all(&layer)?;
    }
    Ok(())
}

/// All numbers of a channel, little-endian; borrowed where this machine is.
fn little_endian(values: &Values) -> std::borrow::Cow<'_, [u8]> {
    if cfg!(target_endian = "little") {
        return values.as_bytes().into();
    }
    let mut bytes = values.as_bytes().to_vec();
    bytes.chunks_exact_mut(values.format().bytes()).for_each(<[u8]>::reverse);
    bytes.into()
}
