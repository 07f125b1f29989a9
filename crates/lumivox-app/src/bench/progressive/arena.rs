//! What one frame's views know of the arena, beside what is kept after a walk, and the light of both: Figures 6.4 and 6.5
//! (dissertation: 68).

use anyhow::Result;
use glam::{UVec2, Vec3};
use image::RgbImage;
use lumivox::core::Grid;
use lumivox::gather::Quality;
use lumivox::progressive::CleanupRule;
use lumivox_render::{Layer, Renderer, Settings, VoxelSource, tone};
use lumivox_scene::{Camera, builtin};

use super::moving::view_from;
use super::pictures::by_age;
use super::rig::{Bricks, Rig, three_channels};
use crate::bench::report::Report;
use crate::bench::timing::Timer;
use crate::output::Picture;
use crate::sheet;

/// Texels a side of the pictures that are injected.
const SIZE: u32 = 384;
/// Cells along each axis that pictures show, in parts: the walls towards the viewer would hide the court.
const CUT: Vec3 = Vec3::new(0.9, 1.0, 0.93);
/// Where the walk goes by, and looks to; it ends in the scene's first camera.
const PLACES: [[[f32; 3]; 2]; 3] = [
    [[7.5, 1.7, 1.5], [14.0, 2.1, -0.8]],
    [[4.0, 1.8, 4.5], [-10.0, 2.0, 8.0]],
    [[-3.0, 2.0, -3.0], [4.0, 2.0, -9.0]],
];

/// Draws the sheet.
pub(super) fn run(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let scene = builtin::arena(if quick { 0 } else { 1 });
    let (side, steps) = if quick { (32, 2) } else { (64, 6) };
    let Some(last) = scene.cameras.first() else { return Ok(()) };
    let walk = walk(last, steps);
    let bounds = scene.bounds();
    let grid = Grid::fit(&bounds, side)?;
    let (gpu, size) = (timer.gpu, UVec2::splat(SIZE));
    let mut rig = Rig::new(gpu, &scene, size)?;
    let bricks = |rig: &Rig| Bricks::new(gpu, rig, grid, &three_channels(), size, CleanupRule::Footprint);
    let (mut kept, mut single) = (bricks(&rig)?, bricks(&rig)?);
    for camera in &walk {
        rig.look(gpu, view_from(camera, bounds.size().length()));
        rig.draw(timer)?;
        kept.step(timer, &rig)?;
    }
    single.step(timer, &rig)?;

    let cells = [&single, &kept]
        .map(|bricks| Ok(by_age(&grid, &bricks.voxelizer.read_cells(gpu)?, CUT)))
        .into_iter()
        .collect::<Result<Vec<RgbImage>>>()?;
    let size = cells.first().map_or(UVec2::ONE, |c| UVec2::from(c.dimensions()));
    let mut settings = Settings { size, grid: side, rsm_size: 256, ..Settings::of(Quality::Medium) };
    settings.gather.frames = 1.0;
    let mut lights = Vec::new();
    for voxels in [VoxelSource::SingleFrame, VoxelSource::Progressive] {
        let light = |layer| -> Result<Vec<Vec3>> {
            let mut renderer = Renderer::new(gpu, &scene, Settings { voxels, layer, ..settings })?;
            // A few frames more at the end, so that all bounces are there.
            for camera in walk.iter().chain(std::iter::repeat_n(last, 6)) {
                renderer.set_camera(camera);
                renderer.frame(None)?;
            }
            Ok(renderer.read_picture()?)
        };
        lights.push([light(Layer::Indirect)?, light(Layer::Final)?]);
    }
    let exposures = [0, 1].map(|n| {
        let both = lights.iter().flat_map(|l| l[n].iter().copied());
        tone::auto_exposure(&both.collect::<Vec<_>>())
    });
    let names = ["last frame", "kept"];
    let rows: Vec<_> = names
        .into_iter()
        .zip(cells)
        .zip(lights)
        .map(|((name, cells), lights)| {
            let shown = lights.into_iter().zip(exposures).map(|(pixels, exposure_ev)| {
                Picture { width: size.x, height: size.y, pixels }.srgb(Layer::Final, exposure_ev)
            });
            (name, std::iter::once(cells).chain(shown).collect())
        })
        .collect();
    let sheet = sheet::contact_sheet(&rows, &["cells", "indirect light", "final"]);
    let what = format!(
        "Figures 6.4 and 6.5: the arena, {side} cells, after a walk of {} frames. Above what the last frame's views alone know, below what is kept of \
         all; cells that the camera injects in that frame in red, older ones from yellow to blue. For light the sun's view injects too.",
        walk.len(),
    );
    report.picture("arena", &what, &sheet)
}

/// Cameras from place to place, so many for each way.
fn walk(last: &Camera, steps: u32) -> Vec<Camera> {
    let stops: Vec<[Vec3; 2]> =
        PLACES.iter().map(|p| p.map(Vec3::from)).chain([[last.eye, last.target]]).collect();
    let ways = stops.windows(2).flat_map(|way| {
        (0..steps).map(move |n| {
            let part = n as f32 / steps as f32;
            let [eye, target] = [0, 1].map(|i| way[0][i].lerp(way[1][i], part));
            Camera { eye, target, ..last.clone() }
        })
    });
    ways.chain([last.clone()]).collect()
}
