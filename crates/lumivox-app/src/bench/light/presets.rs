//! What the presets are worth, with the surfaces of triangles and with those that views bring in the first frame.

use anyhow::Result;
use lumivox::gather::{GatherSettings, Quality};
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Settings, VoxelSource};

use super::errors::{self, HEADER};
use super::stage::Stage;
use crate::bench::report::Report;
use crate::compare::ours::Pixels;

/// Scenes that presets are measured in: a box, two bounces, and a wall between light and dark.
const SCENES: [&str; 3] = ["cornell", "room", "two rooms"];
const PRESETS: [(&str, Quality); 4] = [
    ("low", Quality::Low),
    ("medium", Quality::Medium),
    ("high", Quality::High),
    ("reference", Quality::Reference),
];
/// Where surfaces come from, and how many times as large the picture is that shows them.
const SOURCES: [(&str, VoxelSource, u32); 3] = [
    ("triangles", VoxelSource::Triangles, 1),
    ("progressive", VoxelSource::Progressive, 9),
    ("progressive, small", VoxelSource::Progressive, 1),
];

pub(super) fn run(gpu: &Gpu, stages: &[Stage], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Presets");
    report.say(
        "Gathered light, settled, with all surfels in every frame. With views the surfaces are those that one frame of the camera and \
         of the lights shows. What fills the volume is then a picture of 864 x 486 pixels, about as large as the program's, of which \
         every ninth is compared; *small* is one of 96 x 54, whose points lie farther apart than finer cells are wide.",
    );
    let mut lines = Vec::new();
    for stage in stages.iter().filter(|s| SCENES.contains(&s.case.name)) {
        for (name, quality) in if quick { &PRESETS[..1] } else { &PRESETS[..] } {
            for (source, voxels, finer) in SOURCES {
                let preset = Settings::of(*quality);
                let settings = Settings {
                    gather: GatherSettings { frames: 1.0, ..preset.gather },
                    area_maps: preset.area_maps,
                    voxels,
                    ..stage.settings(GiMethod::Gather, preset.grid)
                };
                let found = stage.measure_in(gpu, settings, (Pixels::Middle(finer), 0))?;
                let name = format!("{name}, {source}");
                lines.push(errors::line(stage, &name, &found));
                errors::push(report, stage, preset.grid, &name, &found);
            }
        }
    }
    report.table(&HEADER.map(|h| if h == "method" { "preset" } else { h }.to_owned()), &lines);
    Ok(())
}
