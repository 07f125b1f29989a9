//! Gathered light over several frames (the dissertation's 5.7): what a frame costs when surfels take turns, how late a switched light
//! is, how large the steps are that a picture shows, and whether a budget holds.

use anyhow::Result;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings};
use lumivox_scene::Light;

use super::stage::Stage;
use crate::bench::report::{Report, Row, ms};
use crate::clock;

/// Frames of a round of turns, or from one update to the next.
const ROUNDS: [u32; 3] = [1, 4, 8];
/// Frames after the lights change in which the picture is watched, for each frame of a round.
const WATCHED: u32 = 4;
/// Parts of a whole frame's cost that budgets ask for.
const BUDGETS: [f64; 3] = [0.5, 0.25, 0.125];
/// Frames before budgets are judged, and those that they are judged by.
const SETTLING: usize = 30;
const JUDGED: usize = 60;
/// Lights change to this part.
const DIMMED: f32 = 0.25;

/// What a way of spreading light over frames does.
struct Spread {
    /// Median cost of a frame, milliseconds, and the largest.
    middle: f64,
    most: f64,
    /// Frames until the mean of the picture has gone nine tenths of its way.
    late: usize,
    /// The largest change from one frame to the next, as part of the whole change.
    step: f64,
}

pub(super) fn run(gpu: &Gpu, stages: &[Stage], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Light over several frames");
    let usual = |s: &&Stage| !s.scene.lights.is_empty() && (quick || s.case.name == "room");
    let Some(stage) = stages.iter().find(usual) else { return Ok(()) };
    // Shadow views small, since they are not what is measured.
    let settings = stage.settings(GiMethod::Gather, 32);
    let settings = Settings { layer: Layer::Indirect, shadow_size: 256, rsm_size: 128, ..settings };
    report.say(&format!(
        "{}, 32 cells, {} rays, {} bounces a frame; milliseconds of the stages that ask views, trace rays and bounce. All lights drop \
         to a quarter at once; *late* are the frames until the mean of the indirect picture has gone nine tenths of its way, *step* is \
         the largest change of that mean from one frame to the next, as a part of the whole change: 1 is a jump.",
        stage.case.name, settings.gather.rays, settings.bounces,
    ));
    let mut lines = Vec::new();
    let mut whole = f64::INFINITY;
    for &rounds in if quick { &ROUNDS[..2] } else { &ROUNDS[..] } {
        for nth in [false, true] {
            if nth && rounds == 1 {
                continue;
            }
            let spread = spread(gpu, stage, settings, rounds, nth)?;
            whole = if rounds == 1 { spread.middle } else { whole };
            let name = match (rounds, nth) {
                (1, _) => "all in every frame".to_owned(),
                (n, false) => format!("turns, rounds of {n}"),
                (n, true) => format!("every {n}. frame"),
            };
            for (metric, value, unit) in [
                ("frame", spread.middle, "ms"),
                ("late", spread.late as f64, "frames"),
                ("step", spread.step, ""),
            ] {
                report.push(row(&name, metric, value, unit));
            }
            let cells =
                [ms(spread.middle), ms(spread.most), spread.late.to_string(), format!("{:.2}", spread.step)];
            lines.push(std::iter::once(name).chain(cells).collect());
        }
    }
    report.table(&["light", "median ms", "most ms", "late", "step"].map(str::to_owned), &lines);
    budgets(gpu, stage, settings, (whole, quick), report)
}

fn row(case: &str, metric: &str, value: f64, unit: &'static str) -> Row {
    let (case, metric) = (case.to_owned(), metric.to_owned());
    Row { figure: "Amortized", case, metric, value, unit, paper: None, note: String::new() }
}

fn spread(gpu: &Gpu, stage: &Stage, settings: Settings, rounds: u32, nth: bool) -> Result<Spread> {
    let gather =
        lumivox::gather::GatherSettings { frames: if nth { 1.0 } else { rounds as f32 }, ..settings.gather };
    let light_every = if nth { rounds } else { 1 };
    let mut renderer = renderer(gpu, stage, Settings { gather, light_every, ..settings })?;
    for _ in 0..6 * rounds {
        renderer.frame(None)?;
    }
    let before = mean(&renderer)?;
    renderer.set_lights(&stage.scene.lights.iter().map(dimmed).collect::<Vec<_>>());
    let (mut costs, mut means) = (Vec::new(), vec![before]);
    for _ in 0..WATCHED * rounds + 8 {
        costs.push(frame_cost(gpu, &mut renderer)?);
        means.push(mean(&renderer)?);
    }
    let after = means.last().copied().unwrap_or(before);
    let way = (before - after).abs().max(f64::MIN_POSITIVE);
    let late = means.iter().position(|m| (m - after).abs() < 0.1 * way).unwrap_or(means.len());
    let step = means.windows(2).map(|w| (w[1] - w[0]).abs() / way).fold(0.0, f64::max);
    costs.sort_by(f64::total_cmp);
    Ok(Spread { middle: costs[costs.len() / 2], most: costs[costs.len() - 1], late, step })
}

fn budgets(
    gpu: &Gpu,
    stage: &Stage,
    settings: Settings,
    (whole, quick): (f64, bool),
    report: &mut Report,
) -> Result<()> {
    report.say(&format!(
        "A budget in place of a number of frames: after {SETTLING} frames, the median and the 95th percentile of {JUDGED} frames as parts \
         of the budget."
    ));
    let mut lines = Vec::new();
    for &part in if quick { &BUDGETS[..1] } else { &BUDGETS[..] } {
        let budget = part * whole;
        let mut renderer = renderer(gpu, stage, Settings { light_budget: Some(budget), ..settings })?;
        let mut costs = Vec::new();
        for _ in 0..SETTLING + JUDGED {
            costs.push(frame_cost(gpu, &mut renderer)? / budget);
        }
        let judged = &mut costs[SETTLING..];
        judged.sort_by(f64::total_cmp);
        let at = |q: f64| judged[(q * (judged.len() - 1) as f64) as usize];
        let case = format!("budget {part} of a whole frame");
        report.push(row(&case, "median", at(0.5), "of the budget"));
        report.push(row(&case, "95th percentile", at(0.95), "of the budget"));
        lines.push(vec![ms(budget), format!("{:.2}", at(0.5)), format!("{:.2}", at(0.95))]);
    }
    report.table(&["budget ms", "median", "95th percentile"].map(str::to_owned), &lines);
    Ok(())
}

fn renderer(gpu: &Gpu, stage: &Stage, settings: Settings) -> Result<Renderer> {
    let mut renderer = Renderer::new(gpu, &stage.scene, settings)?;
    renderer.set_camera(&stage.camera);
    Ok(renderer)
}

/// What a frame's gathering took.
fn frame_cost(gpu: &Gpu, renderer: &mut Renderer) -> Result<f64> {
    gpu.wait()?;
    let stages = renderer.frame(Some(clock::millis))?.stages;
    let paced = stages.iter().filter(|s| Renderer::PACED_STAGES.contains(&s.stage));
    // Not the sum of nothing, which is -0.
    Ok(paced.map(|s| s.millis).fold(0.0, |sum, ms| sum + ms))
}

fn mean(renderer: &Renderer) -> Result<f64> {
    let picture = renderer.read_picture()?;
    Ok(picture.iter().map(|p| f64::from(p.element_sum())).sum::<f64>() / picture.len().max(1) as f64)
}

fn dimmed(light: &Light) -> Light {
    let mut light = *light;
    match &mut light {
        Light::Directional { irradiance: power, .. }
        | Light::Point { intensity: power, .. }
        | Light::Spot { intensity: power, .. }
        | Light::Rect { radiance: power, .. } => *power *= DIMMED,
    }
    light
}
