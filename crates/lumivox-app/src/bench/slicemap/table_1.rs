//! Table 1: a tree by standard shadow maps and by transmittance shadow maps.

use anyhow::Result;
use glam::UVec2;
use lumivox::gpu::StageTime;
use lumivox::slicemap::Slicing;
use lumivox_render::{GiMethod, LeafShadowSettings, Renderer, Settings};

use super::row;
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;
use crate::clock;

/// A column of the table: a name, slicemaps if it has them, and the paper's frame rate.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) leaves: Option<LeafShadowSettings>,
    pub(super) paper: Option<f64>,
}

/// What the table has a line for: the stages that it sums, and the paper's milliseconds in the order of the columns.
const LINES: [(&str, &[&str]); 5] = [
    ("shadow map", &["raster/shadow"]),
    ("near and far map", &["slicemap/extents"]),
    ("slicemap", &["slicemap/bits"]),
    ("what slicemaps leave", &["slicemap/transmittance"]),
    ("picture", &["raster/gbuffer", "raster/direct"]),
];

fn cases(quick: bool) -> Vec<Case> {
    let shadow_map = Case { name: "shadow map".to_owned(), leaves: None, paper: Some(128.0) };
    let sizes: &[u32] = if quick { &[96] } else { &[32, 64, 96, 512] };
    let of = |slicing, name: &str, papers: [f64; 3]| -> Vec<Case> {
        let case = |slices: &u32| Case {
            name: format!("{name}, {slices}"),
            leaves: Some(LeafShadowSettings { slices: *slices, slicing, ..LeafShadowSettings::default() }),
            paper: papers.get(*slices as usize / 32 - 1).copied(),
        };
        sizes.iter().map(case).collect()
    };
    let uniform = of(Slicing::Uniform, "uniform", [60.0, 50.0, 40.0]);
    let local = of(Slicing::Local, "local", [37.0, 29.0, 24.0]);
    std::iter::once(shadow_map).chain(uniform).chain(local).collect()
}

/// The renderer's stages over some frames, and the middle frame's milliseconds.
pub(super) fn stages(timer: &Timer<'_>, case: &Case, quick: bool) -> Result<(Vec<StageTime>, f64)> {
    let scene = lumivox_scene::builtin::tree(if quick { 0 } else { 2 });
    let settings = Settings {
        size: UVec2::splat(512),
        gi: GiMethod::Off,
        grid: 16,
        area_samples: 0,
        area_maps: 0,
        shadow_size: 512,
        leaf_shadows: case.leaves,
        ..Settings::default()
    };
    let mut renderer = Renderer::new(timer.gpu, &scene, settings)?;
    if let Some(camera) = scene.cameras.first() {
        renderer.set_camera(camera);
    }
    renderer.frame(None)?;
    let mut frames = Vec::new();
    for _ in 0..if quick { 1 } else { 3 } {
        let stages = renderer.frame(Some(clock::millis))?.stages;
        let total: f64 = stages.iter().map(|s| s.millis).sum();
        frames.push((stages, total));
    }
    frames.sort_by(|a, b| a.1.total_cmp(&b.1));
    Ok(frames.swap_remove(frames.len() / 2))
}

/// Milliseconds of the stages of some names.
pub(super) fn sum(stages: &[StageTime], names: &[&str]) -> f64 {
    stages.iter().filter(|s| names.contains(&s.stage)).map(|s| s.millis).sum()
}

pub(super) fn table(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Table 1: shadows of a tree");
    let triangles = lumivox_scene::builtin::tree(if quick { 0 } else { 2 }).triangle_count();
    report.say(&format!(
        "The built-in tree ({triangles} triangles, leaves cut out by a texture) in a picture of 512 x 512, maps of 512 x 512; milliseconds of the middle of \
         a few frames, each stage by itself, and frames per second of all of them with the paper's rate: its chestnut tree has 160,653 triangles. With slicemaps the \
         shadow map holds wood and ground alone. The paper shades each fragment of each leaf, here each pixel is shaded once."
    ));
    let mut header = vec!["".to_owned()];
    let mut lines: Vec<Vec<String>> = LINES.iter().map(|(name, _)| vec![(*name).to_owned()]).collect();
    let mut rates = vec!["Hz".to_owned()];
    for case in cases(quick) {
        let (stages, total) = self::stages(timer, &case, quick)?;
        for ((name, parts), line) in LINES.iter().zip(&mut lines) {
            let millis = sum(&stages, parts);
            line.push(if millis > 0.0 { ms(millis) } else { "-".to_owned() });
            report.push(row("Table 1", case.name.clone(), name, millis, "ms", None));
        }
        let hz = 1e3 / total;
        rates.push(case.paper.map_or(format!("{hz:.1}"), |paper| format!("{hz:.1} ({paper})")));
        report.push(row("Table 1", case.name.clone(), "rate", hz, "Hz", case.paper));
        header.push(case.name);
    }
    lines.push(rates);
    report.table(&header, &lines);
    Ok(())
}
