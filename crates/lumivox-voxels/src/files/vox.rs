//! MagicaVoxel: models of up to 256 cells a side, placed so that they make up the grid, and a palette of 255 colours.
//!
//! MagicaVoxel has z up: `(x, y, z)` here is `(x, -z, y)` there, and the grid's middle is its origin. Colours are those
//! of `albedo`, in sRGB, by median cut; without that channel, and in filled cells, light grey. Attributes of the root node
//! carry the grid's `_origin`, `_cell_size` and `_axis_order`.
//!
//! Grids of more than 2000 cells a side lie beyond what the program can place.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

use glam::{IVec3, UVec3};

use super::palette::{Histogram, Palette};
use super::{FileError, FileFormat, FileReport, Place, create, left_out, srgb_from_linear};
use crate::SparseVolume;
use crate::sparse::SIDE;

/// Cells of a model along each axis.
const MODEL: u32 = 256;
/// Cells of the world along each axis.
pub(super) const WORLD: u32 = 2000;
/// Colours; the first place of the palette stands for no cell.
const COLORS: usize = 255;
/// sRGB of cells without a colour.
const GREY: [u8; 3] = [204; 3];

pub(super) fn write(
    place: &mut dyn Place,
    path: &Path,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    let n = volume.grid().dims;
    let mut histogram = Histogram::new();
    volume.entries().for_each(|(_, slot)| histogram.add(color(volume, slot)));
    let palette = histogram.palette(COLORS);
    let mut error = 0;
    create(place, path, |out| {
        out.write_all(b"VOX ")?;
        out.write_all(&200u32.to_le_bytes())?;
        chunk(out, b"MAIN", true, |out| {
            let mut placed = Vec::new();
            for low in models(n) {
                if let Some(size) = model(out, volume, &palette, low, &mut error)? {
                    placed.push(placement(n, low, size));
                }
            }
            scene(out, volume, &placed)?;
            chunk(out, b"RGBA", false, |out| {
                let mut rest = palette.colors.iter().copied().chain(std::iter::repeat([0; 3]));
                (0..256).try_for_each(|_| {
                    let [r, g, b] = rest.next().unwrap_or_default();
                    out.write_all(&[r, g, b, 255])
                })
            })
        })
    })?;
    Ok(FileReport {
        files: vec![path.to_owned()],
        left_out: left_out(FileFormat::Vox, volume),
        color_error: Some(error),
    })
}

fn color(volume: &SparseVolume, slot: Option<usize>) -> [u8; 3] {
    match (volume.channel("albedo"), slot) {
        (Some(albedo), Some(slot)) => srgb_from_linear(albedo.value(slot).truncate()),
        _ => GREY,
    }
}

/// A chunk, whose length is filled in when it is known.
fn chunk<W: Write + Seek>(
    out: &mut W,
    name: &[u8; 4],
    has_children: bool,
    body: impl FnOnce(&mut W) -> io::Result<()>,
) -> io::Result<()> {
    out.write_all(name)?;
    let at = out.stream_position()?;
    out.write_all(&[0; 8])?;
    body(out)?;
    let end = out.stream_position()?;
    let length = u32::try_from(end - at - 8).map_err(|_| {
        io::Error::new(io::ErrorKind::FileTooLarge, "more cells than a .vox file can hold (4 GiB)")
    })?;
    out.seek(SeekFrom::Start(at + if has_children { 4 } else { 0 }))?;
    out.write_all(&length.to_le_bytes())?;
    out.seek(SeekFrom::Start(end))?;
    Ok(())
}

/// Lower corners of all models.
fn models(n: UVec3) -> impl Iterator<Item = UVec3> {
    let count = (n + MODEL - 1) / MODEL;
    (0..count.element_product())
        .map(move |m| MODEL * UVec3::new(m % count.x, m / count.x % count.y, m / (count.x * count.y)))
}

/// Writes the cells of one model, unless there are none; returns its size here.
fn model<W: Write + Seek>(
    out: &mut W,
    volume: &SparseVolume,
    palette: &Palette,
    low: UVec3,
    error: &mut u8,
) -> io::Result<Option<UVec3>> {
    let size = (volume.grid().dims - low).min(UVec3::splat(MODEL));
    let bricks = || {
        let (first, last) = (low / SIDE, (low + size - 1) / SIDE);
        volume.bricks().filter(move |(brick, _)| brick.cmpge(first).all() && brick.cmple(last).all())
    };
    let count: u32 = bricks().map(|(_, mask)| mask.iter().map(|word| word.count_ones()).sum::<u32>()).sum();
    if count == 0 {
        return Ok(None);
    }
    chunk(out, b"SIZE", false, |out| {
        [size.x, size.z, size.y].into_iter().try_for_each(|n| out.write_all(&n.to_le_bytes()))
    })?;
    chunk(out, b"XYZI", false, |out| {
        out.write_all(&count.to_le_bytes())?;
        for (brick, mask) in bricks() {
            for (z, &word) in mask.iter().enumerate() {
                let mut word = word;
                while word != 0 {
                    let bit = word.trailing_zeros();
                    word &= word - 1;
                    let cell = SIDE * brick + UVec3::new(bit % SIDE, bit / SIDE, z as u32);
                    let color = color(volume, volume.slot(cell));
                    let place = palette.place(color);
                    let found = palette.colors[usize::from(place)];
                    *error = (0..3).map(|i| found[i].abs_diff(color[i])).fold(*error, u8::max);
                    let local = cell - low;
                    out.write_all(&[local.x as u8, (size.z - 1 - local.z) as u8, local.y as u8, place + 1])?;
                }
            }
        }
        Ok(())
    })?;
    Ok(Some(size))
}

/// Where the program wants a model: its own middle, rounded down, from the middle of the grid.
fn placement(n: UVec3, low: UVec3, size: UVec3) -> IVec3 {
    let turned = |v: UVec3| IVec3::new(v.x as i32, v.z as i32, v.y as i32);
    let (n, low, size) = (turned(n), turned(low), turned(size));
    // Along y the model starts where z here ends.
    let start = IVec3::new(low.x, n.y - low.y - size.y, low.z);
    start + size / 2 - n / 2
}

/// The scene graph: a root, a group, and a transform with a shape for each model.
fn scene<W: Write + Seek>(out: &mut W, volume: &SparseVolume, placed: &[IVec3]) -> io::Result<()> {
    let grid = volume.grid();
    let [x, y, z] = grid.origin.to_array();
    let attributes = [
        ("_name", "lumivox".to_owned()),
        ("_origin", format!("{x:?} {y:?} {z:?}")),
        ("_cell_size", format!("{:?}", grid.cell_size)),
        ("_axis_order", "x -z y".to_owned()),
    ];
    transform(out, 0, &attributes, 1, None)?;
    chunk(out, b"nGRP", false, |out| {
        words(out, &[1, 0, placed.len() as i32])?;
        (0..placed.len() as i32).try_for_each(|n| words(out, &[2 + 2 * n]))
    })?;
    for (n, place) in placed.iter().enumerate() {
        let n = n as i32;
        transform(out, 2 + 2 * n, &[], 3 + 2 * n, Some(*place))?;
        chunk(out, b"nSHP", false, |out| words(out, &[3 + 2 * n, 0, 1, n, 0]))?;
    }
    Ok(())
}

fn transform<W: Write + Seek>(
    out: &mut W,
    id: i32,
    attributes: &[(&str, String)],
    child: i32,
    place: Option<IVec3>,
) -> io::Result<()> {
    chunk(out, b"nTRN", false, |out| {
        words(out, &[id])?;
        dictionary(out, attributes)?;
        // The child, a reserved word, the layer, and one frame.
        words(out, &[child, -1, 0, 1])?;
        match place {
            Some(place) => dictionary(out, &[("_t", format!("{} {} {}", place.x, place.y, place.z))]),
            None => dictionary(out, &[]),
        }
    })
}

fn dictionary(out: &mut impl Write, pairs: &[(&str, String)]) -> io::Result<()> {
    words(out, &[pairs.len() as i32])?;
    for (key, value) in pairs {
        for text in [key.as_bytes(), value.as_bytes()] {
            words(out, &[text.len() as i32])?;
            out.write_all(text)?;
        }
    }
    Ok(())
}

fn words(out: &mut impl Write, numbers: &[i32]) -> io::Result<()> {
    numbers.iter().try_for_each(|n| out.write_all(&n.to_le_bytes()))
}
