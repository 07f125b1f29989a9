//! Table 2 of the dissertation: milliseconds of voxelization and propagation at 32 cells.

use anyhow::Result;
use glam::UVec2;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Renderer, Settings};

use super::stage::Stage;
use crate::bench::report::{Report, Row, ms};
use crate::clock;

/// The paper's picture and grid.
const SIZE: UVec2 = UVec2::splat(512);
const GRID: u32 = 32;
/// Frames that count; one before them does not.
const FRAMES: usize = 3;

/// Means over frames.
#[derive(Clone, Copy, Debug, Default)]
struct Frame {
    voxelization: f64,
    light: f64,
    total: f64,
}

pub(super) fn run(gpu: &Gpu, stages: &[Stage], report: &mut Report) -> Result<()> {
    report.head("Table 2 of the dissertation: what a frame costs");
    report.say(
        "512 x 512 pixels, 32 cells, everything anew in each frame; the paper's (GeForce GTX 285) in parentheses. The paper's numbers of \
         triangles are those of its own models. For gathered light: 64 rays a surfel, all traced anew, and two bounces.",
    );
    let header =
        ["scene", "triangles", "iterations", "voxelization", "propagation", "frame", "gathering", "frame"];
    let mut lines = Vec::new();
    for (stage, paper) in stages.iter().filter_map(|s| Some((s, s.case.paper?))) {
        let measured = |gi| frame(gpu, stage, gi, paper.iterations);
        let (propagated, gathered) = (measured(GiMethod::Propagation)?, measured(GiMethod::Gather)?);
        let beside = |ours: f64, paper: f64| format!("{} ({})", ms(ours), ms(paper));
        lines.push(vec![
            stage.case.name.to_owned(),
            stage.scene.triangle_count().to_string(),
            paper.iterations.to_string(),
            beside(propagated.voxelization, paper.voxelization_ms),
            beside(propagated.light, paper.propagation_ms),
            ms(propagated.total),
            ms(gathered.light),
            ms(gathered.total),
        ]);
        let values = [
            ("voxelization", propagated.voxelization, Some(paper.voxelization_ms)),
            ("propagation", propagated.light, Some(paper.propagation_ms)),
            ("frame with propagation", propagated.total, None),
            ("gathering", gathered.light, None),
            ("frame with gathering", gathered.total, None),
        ];
        for (metric, value, paper) in values {
            report.push(Row {
                figure: "Table 2",
                case: stage.case.name.to_owned(),
                metric: metric.to_owned(),
                value,
                unit: "ms",
                paper,
                note: format!("mean of {FRAMES} frames"),
            });
        }
    }
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}

fn frame(gpu: &Gpu, stage: &Stage, gi: GiMethod, iterations: u32) -> Result<Frame> {
    let settings = stage.settings(gi, GRID);
    let gather = lumivox::gather::GatherSettings { rays: 64, ..settings.gather };
    let settings = Settings { size: SIZE, iterations, gather, shadow_size: 2048, ..settings };
    let mut renderer = Renderer::new(gpu, &stage.scene, settings)?;
    renderer.set_camera(&stage.camera);
    let mut mean = Frame::default();
    for n in 0..=FRAMES {
        gpu.wait()?;
        let start = clock::millis();
        // As if everything had moved.
        renderer.forget_triangles();
        let stages = renderer.frame(Some(clock::millis))?.stages;
        let end = clock::millis();
        if n == 0 {
            continue;
        }
        let is_light = |name: &str| {
            name.starts_with("gather/") || (name.starts_with("light/") && name != "light/reconstruction")
        };
        let sum = |is: &dyn Fn(&str) -> bool| {
            stages.iter().filter(|s| is(s.stage)).map(|s| s.millis).sum::<f64>() / FRAMES as f64
        };
        mean.voxelization += sum(&|name| name == "voxelize/triangles");
        mean.light += sum(&is_light);
        mean.total += (end - start) / FRAMES as f64;
    }
    Ok(mean)
}
