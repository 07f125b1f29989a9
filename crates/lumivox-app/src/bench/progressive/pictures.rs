//! Pictures of cells by their normals and ages: Figures 6.5 and 6.9 (dissertation: 68 and 75).

use std::collections::HashMap;

use anyhow::Result;
use glam::{UVec2, UVec3, Vec3};
use image::RgbImage;
use lumivox::core::Grid;
use lumivox::progressive::{BrickCell, CleanupRule};

use super::rig::{Bricks, Rig, orbit, three_channels};
use crate::bench::models::Subject;
use crate::bench::report::Report;
use crate::bench::timing::Timer;
use crate::bench::voxel_picture::voxel_picture;

/// A model's normals as colours, after more and more views.
pub(super) fn normals(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Figures 6.9 and 6.5: normals and ages");
    let (side, steps, size) = if quick { (48, 4, UVec2::splat(192)) } else { (128, 12, UVec2::splat(512)) };
    let grid = subject.grid(side)?;
    let mut rig = Rig::new(timer.gpu, &subject.scene, size)?;
    let mut bricks = Bricks::new(timer.gpu, &rig, grid, &three_channels(), size, CleanupRule::Footprint)?;
    let views = orbit(&subject.bounds, steps);
    let moments = [0, steps / 4, steps / 2, views.len() as u32 - 1];
    let (mut of_normals, mut of_ages) = (Vec::new(), Vec::new());
    for (n, view) in views.iter().enumerate() {
        rig.look(timer.gpu, *view);
        rig.draw(timer)?;
        bricks.step(timer, &rig)?;
        if moments.contains(&(n as u32)) {
            let cells = bricks.voxelizer.read_cells(timer.gpu)?;
            of_normals.push(by_normal(&grid, &cells));
            of_ages.push(by_age_of(&grid, &cells, |_| true));
        }
    }
    let what = format!(
        "{}, {side} cells, after 1, {}, {} and all {} frames of a camera that goes round each axis: normals as colours, and cells of that frame \
         in red, older ones from yellow to blue",
        subject.name,
        moments[1] + 1,
        moments[2] + 1,
        views.len()
    );
    let all: Vec<RgbImage> = of_normals.into_iter().zip(of_ages).flat_map(|(n, a)| [n, a]).collect();
    report.picture("normals", &what, &rows(&all, 2))
}

fn numbered(cells: &[BrickCell]) -> HashMap<UVec3, &BrickCell> {
    cells.iter().map(|c| (c.cell.as_uvec3(), c)).collect()
}

fn by_normal(grid: &Grid, cells: &[BrickCell]) -> RgbImage {
    let cells = numbered(cells);
    voxel_picture(grid, 360, |cell| {
        let normal = cells.get(&cell)?.values.first()?.truncate().normalize_or_zero();
        Some(0.5 + 0.5 * normal)
    })
}

/// A room's cells by age, without the walls towards the viewer and the ceiling.
pub(super) fn by_age(grid: &Grid, cells: &[BrickCell], cut: Vec3) -> RgbImage {
    let top = grid.dims.as_vec3() * cut;
    by_age_of(grid, cells, |cell| cell.as_vec3().cmplt(top).all())
}

fn by_age_of(grid: &Grid, cells: &[BrickCell], shows: impl Fn(UVec3) -> bool) -> RgbImage {
    let cells = numbered(cells);
    voxel_picture(grid, 360, |cell| {
        let age = cells.get(&cell).filter(|_| shows(cell))?.age;
        Some(match age {
            0 => Vec3::new(0.93, 0.16, 0.12),
            1..30 => Vec3::new(0.95, 0.8, 0.25).lerp(Vec3::new(0.2, 0.4, 0.9), age as f32 / 30.0),
            _ => Vec3::splat(0.62),
        })
    })
}

/// Pictures in columns of so many, on the colour of their corners.
fn rows(pictures: &[RgbImage], high: usize) -> RgbImage {
    let paper = pictures.first().map_or(image::Rgb([255; 3]), |p| *p.get_pixel(0, 0));
    let widest = pictures.iter().map(|p| p.width()).max().unwrap_or(1);
    let tallest = pictures.iter().map(|p| p.height()).max().unwrap_or(1);
    let columns = pictures.len().div_ceil(high) as u32;
    let mut sheet = RgbImage::from_pixel(columns * widest, high as u32 * tallest, paper);
    for (n, picture) in pictures.iter().enumerate() {
        let (x, y) = ((n / high) as i64 * i64::from(widest), (n % high) as i64 * i64::from(tallest));
        image::imageops::replace(&mut sheet, picture, x, y);
    }
    sheet
}
