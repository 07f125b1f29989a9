//! What the presets are worth, with the surfaces of triangles and with those that views bring in the first frame.

use anyhow::Result;
use lumivox::gather::{GatherSettings, Quality};
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Settings, VoxelSource};

use super::errors::{self, HEADER};
use super::stage::Stage;
use crate::bench::report::Report;

/// Scenes that presets are measured in: a box, two bounces, and a wall between light and dark.
const SCENES: [&str; 3] = ["cornell", "room", "two rooms"];
const PRESETS: [(&str, Quality); 4] = [
    ("low", Quality::Low),
    ("medium", Quality::Medium),
    ("high", Quality::High),
    ("reference", Quality::Reference),
];
const SOURCES: [(&str, VoxelSource); 2] =
    [("triangles", VoxelSource::Triangles), ("progressive", VoxelSource::Progressive)];

pub(super) fn run(gpu: &Gpu, stages: &[Stage], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Presets");
    report.say(
        "Gathered light, settled, with all surfels in every frame. With views the surfaces are those that one frame of the camera and \
         of the lights shows.",
    );
    let mut lines = Vec::new();
    for stage in stages.iter().filter(|s| SCENES.contains(&s.case.name)) {
        for (name, quality) in if quick { &PRESETS[..1] } else { &PRESETS[..] } {
            for (source, voxels) in SOURCES {
                let preset = Settings::of(*quality);
                let settings = Settings {
                    gather: GatherSettings { frames: 1.0, ..preset.gather },
                    area_maps: preset.area_maps,
                    voxels,
                    ..stage.settings(GiMethod::Gather, preset.grid)
                };
                let found = stage.measure(gpu, settings, 0)?;
                let name = format!("{name}, {source}");
                lines.push(errors::line(stage, &name, &found));
                errors::push(report, stage, preset.grid, &name, &found);
            }
        }
    }
    report.table(&HEADER.map(|h| if h == "method" { "preset" } else { h }.to_owned()), &lines);
    Ok(())
}
