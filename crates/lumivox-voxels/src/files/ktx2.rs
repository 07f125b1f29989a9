//! KTX 2: a 3D texture without mip levels per file, `NAME.ktx2` with occupancy (`R8_UNORM`, 255 where occupied), and
//! `NAME.CHANNEL.ktx2` for each channel. Channels of three components become four, since hardware has no textures of
//! three; the fourth is occupancy.
//!
//! Texels run x, y, z, x fastest. `KTXorientation` is `ruo`: x to the right, y upwards, z out towards the viewer. The
//! keys `lumivox.origin` (three numbers in metres, the lower corner of the first texel), `lumivox.cell_size`,
//! `lumivox.channel` and, for bytes, `lumivox.range` are text.

use std::io::{self, Write};
use std::path::Path;

use super::{FileError, FileReport, Place, create, format::beside, layers};
use crate::{ChannelData, Format, SparseVolume};

const MAGIC: [u8; 12] = [0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb, b'\r', b'\n', 0x1a, b'\n'];
/// Header, index and the index of one level.
const HEADER: u32 = 80 + 24;
/// Texels start at a multiple of their size; 16 suits all of them.
const ALIGNMENT: u32 = 16;

pub(super) fn write(
    place: &mut dyn Place,
    path: &Path,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    create(place, path, |out| {
        head(out, volume, None, Format::U8, 1)?;
        layers::occupancy(volume, 255, out)
    })?;
    let mut files = vec![path.to_owned()];
    for channel in volume.channels() {
        let own = beside(path, channel.name(), "ktx2");
        let added = usize::from(channel.components() == 3);
        create(place, &own, |out| {
            let components = channel.components() + added;
            head(out, volume, Some(channel), channel.values().format(), components)?;
            layers::channel(volume, channel, added, out)
        })?;
        files.push(own);
    }
    Ok(FileReport { files, ..FileReport::default() })
}

/// Everything before the texels.
fn head(
    out: &mut impl Write,
    volume: &SparseVolume,
    channel: Option<&ChannelData>,
    format: Format,
    components: usize,
) -> io::Result<()> {
    let grid = volume.grid();
    // VkFormat of one, two and four components.
    let formats = match format {
        Format::U8 => [9, 16, 37],
        Format::F16 => [76, 83, 97],
        Format::F32 => [100, 103, 109],
    };
    let vk_format: u32 = formats[components / 2];
    let width = format.bytes() as u32;
    let descriptor = data_format_descriptor(format, components as u32);
    let pairs = key_values(volume, channel);
    let pairs_at = HEADER + descriptor.len() as u32;
    let texels_at = (pairs_at + pairs.len() as u32).next_multiple_of(ALIGNMENT);
    let texels = grid.cell_count() * u64::from(width) * components as u64;
    out.write_all(&MAGIC)?;
    // Type size; width, height, depth; no array, one face, one level, no supercompression.
    let n = grid.dims;
    let index = [HEADER, descriptor.len() as u32, pairs_at, pairs.len() as u32];
    for word in [vk_format, width, n.x, n.y, n.z, 0, 1, 1, 0].into_iter().chain(index) {
        out.write_all(&word.to_le_bytes())?;
    }
    // No global data; the level.
    for long in [0, 0, u64::from(texels_at), texels, texels] {
        out.write_all(&long.to_le_bytes())?;
    }
    out.write_all(&descriptor)?;
    out.write_all(&pairs)?;
    out.write_all(&vec![0; (texels_at - pairs_at) as usize - pairs.len()])
}

/// The basic descriptor block of the Khronos Data Format Specification, linear, BT.709.
fn data_format_descriptor(format: Format, components: u32) -> Vec<u8> {
    let bits = 8 * format.bytes() as u32;
    let size = 24 + 16 * components;
    // Model RGBSDA, primaries BT.709, transfer linear, straight alpha; texels of one; bytes of the only plane.
    let mut words =
        vec![4 + size, 0, 2 | size << 16, 1 | 1 << 8 | 1 << 16, 0, format.bytes() as u32 * components, 0];
    for component in 0..components {
        let id = if component == 3 { 15 } else { component };
        // Floats are signed, and their range is -1 to 1 as floats; bytes go from 0 to 255.
        let (qualifiers, low, high) = match format {
            Format::U8 => (0, 0, 255),
            Format::F16 | Format::F32 => (0xc0, (-1f32).to_bits(), 1f32.to_bits()),
        };
        words.extend([(component * bits) | ((bits - 1) << 16) | ((id | qualifiers) << 24), 0, low, high]);
    }
    words.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// Keys and values, sorted by key, each padded to four bytes.
fn key_values(volume: &SparseVolume, channel: Option<&ChannelData>) -> Vec<u8> {
    let grid = volume.grid();
    let [x, y, z] = grid.origin.to_array();
    let mut pairs = vec![
        ("KTXorientation", "ruo".to_owned()),
        ("KTXwriter", concat!("lumivox ", env!("CARGO_PKG_VERSION")).to_owned()),
        ("lumivox.cell_size", format!("{:?}", grid.cell_size)),
        ("lumivox.channel", channel.map_or("occupancy", ChannelData::name).to_owned()),
        ("lumivox.origin", format!("{x:?} {y:?} {z:?}")),
    ];
    if let Some(channel) = channel.filter(|channel| channel.values().format() == Format::U8) {
        let [low, high] = channel.range();
        pairs.push(("lumivox.range", format!("{low:?} {high:?}")));
    }
    let mut bytes = Vec::new();
    for (key, value) in pairs {
        let length = key.len() + value.len() + 2;
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend(key.bytes().chain([0]).chain(value.bytes()).chain([0]));
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}
