//! Contact sheets: pictures in rows and columns with their names.

use font8x8::UnicodeFonts;
use image::{Rgb, RgbImage};

const MARGIN: u32 = 12;
const HEADER: u32 = 22;
const PAPER: Rgb<u8> = Rgb([24, 24, 27]);
const INK: Rgb<u8> = Rgb([232, 230, 225]);

/// Pictures of one size, row by row; each row has a name, each column a title.
pub(crate) fn contact_sheet(rows: &[(&str, Vec<RgbImage>)], titles: &[&str]) -> RgbImage {
    let (width, height) = rows.first().and_then(|r| r.1.first()).map_or((1, 1), RgbImage::dimensions);
    let columns = titles.len() as u32;
    let sheet_width = MARGIN + columns * (width + MARGIN);
    let sheet_height = MARGIN + rows.len() as u32 * (HEADER + height + MARGIN);
    let mut sheet = RgbImage::from_pixel(sheet_width, sheet_height, PAPER);
    for (r, (name, pictures)) in rows.iter().enumerate() {
        let top = MARGIN + r as u32 * (HEADER + height + MARGIN);
        for (c, (picture, title)) in pictures.iter().zip(titles).enumerate() {
            let left = MARGIN + c as u32 * (width + MARGIN);
            write_text(&mut sheet, &format!("{name}: {title}"), left, top + 4, 1);
            image::imageops::replace(&mut sheet, picture, left.into(), (top + HEADER).into());
        }
    }
    sheet
}

/// Pictures of one size, row by row, each with two lines of its own above it.
pub(crate) fn captioned_sheet(rows: &[Vec<([String; 2], RgbImage)>]) -> RgbImage {
    let (width, height) = rows.first().and_then(|r| r.first()).map_or((1, 1), |(_, p)| p.dimensions());
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0) as u32;
    let tile = (width + MARGIN, height + 2 * HEADER);
    let size = (MARGIN + columns * tile.0, rows.len() as u32 * tile.1 + MARGIN);
    let mut sheet = RgbImage::from_pixel(size.0, size.1, PAPER);
    for (r, row) in rows.iter().enumerate() {
        for (c, (captions, picture)) in row.iter().enumerate() {
            let (left, top) = (MARGIN + c as u32 * tile.0, r as u32 * tile.1);
            for (line, caption) in captions.iter().enumerate() {
                write_text(&mut sheet, caption, left, top + 16 + 12 * line as u32, 1);
            }
            image::imageops::replace(&mut sheet, picture, left.into(), (top + 2 * HEADER).into());
        }
    }
    sheet
}

/// Two pictures side by side with their names on them.
pub(crate) fn side_by_side(left: (&str, &RgbImage), right: (&str, &RgbImage)) -> RgbImage {
    let (width, height) = left.1.dimensions();
    let mut both = RgbImage::from_pixel(2 * width + 4, height + HEADER, PAPER);
    for (n, (name, picture)) in [left, right].into_iter().enumerate() {
        let x = n as u32 * (width + 4);
        write_text(&mut both, name, x + 6, 7, 1);
        image::imageops::replace(&mut both, picture, x.into(), HEADER.into());
    }
    both
}

/// Writes in an 8 x 8 font; what does not fit is cut off.
fn write_text(image: &mut RgbImage, text: &str, left: u32, top: u32, scale: u32) {
    for (n, letter) in text.chars().enumerate() {
        let Some(rows) = font8x8::BASIC_FONTS.get(letter) else { continue };
        for (y, bits) in rows.iter().enumerate() {
            for x in 0..8 * scale {
                let column = left + n as u32 * 8 * scale + x;
                if bits & (1 << (x / scale)) == 0 || column >= image.width() {
                    continue;
                }
                for line in 0..scale {
                    let row = top + y as u32 * scale + line;
                    if row < image.height() {
                        image.put_pixel(column, row, INK);
                    }
                }
            }
        }
    }
}
