//! Cleanup and injection within a budget (dissertation 7.10): turns that follow what the last frames took.

use anyhow::Result;
use glam::UVec2;
use lumivox::gather::LightBudget;
use lumivox::progressive::{CleanupRule, InjectionPattern};

use super::rig::{Bricks, Rig, orbit, three_channels};
use crate::bench::models::Subject;
use crate::bench::report::{Report, Row, ms};
use crate::bench::timing::Timer;
use crate::clock;

/// The share of a whole frame's time that there is.
const SHARE: f64 = 0.5;

/// A camera that goes round a model, with all work in each frame and then within half the time.
pub(super) fn run(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Within a budget");
    let (side, frames, size) = if quick { (64, 12, 256) } else { (128, 96, 512) };
    let grid = subject.grid(side)?;
    let mut rig = Rig::new(timer.gpu, &subject.scene, UVec2::splat(size))?;
    let rule = CleanupRule::Footprint;
    let bricks = Bricks::new(timer.gpu, &rig, grid, &three_channels(), UVec2::splat(size), rule)?;
    let mut bricks = bricks.with_pattern(InjectionPattern::Stippled);
    let views = orbit(&subject.bounds, frames / 3);
    let mut round = |budget: Option<&mut LightBudget>| -> Result<Vec<f64>> {
        let mut budget = budget;
        let mut times = Vec::new();
        for view in &views {
            rig.look(timer.gpu, *view);
            rig.draw(timer)?;
            bricks.set_turns(budget.as_ref().map_or(1.0, |b| b.frames()));
            let start = clock::millis();
            bricks.step(timer, &rig)?;
            let took = clock::millis() - start;
            if let Some(budget) = budget.as_deref_mut() {
                budget.measured(took);
            }
            times.push(took);
        }
        times.sort_by(f64::total_cmp);
        Ok(times)
    };
    let percentile = |times: &[f64], part: f64| times[(part * (times.len() - 1) as f64).round() as usize];
    // Once for the drivers.
    round(None)?;
    let whole = round(None)?;
    let budget_ms = SHARE * percentile(&whole, 0.5);
    let mut budget = LightBudget::new(budget_ms);
    round(Some(&mut budget))?;
    let within = round(Some(&mut budget))?;
    let [of_whole, of_budget] =
        [&whole, &within].map(|times| [0.5, 0.95].map(|part| percentile(times, part)));
    let overshoot = of_budget[1] / budget_ms - 1.0;
    let case = format!("{}, {side}", subject.name);
    for (metric, value, unit) in [
        ("whole frames, median", of_whole[0], "ms"),
        ("whole frames, 95th percentile", of_whole[1], "ms"),
        ("budget", budget_ms, "ms"),
        ("within the budget, median", of_budget[0], "ms"),
        ("within the budget, 95th percentile", of_budget[1], "ms"),
        ("overshoot of the 95th percentile", overshoot, "1"),
    ] {
        report.push(Row {
            figure: "budget",
            case: case.clone(),
            metric: metric.to_owned(),
            value,
            unit,
            paper: None,
            note: format!("{frames} frames"),
        });
    }
    report.say(&format!(
        "{} at {side} cells, a camera that goes round once in {frames} frames with {size} x {size} texels. With all bricks cleaned and all points \
         injected in each frame it takes {} ms in the middle and {} ms in the 95th percentile. With turns that follow what the last frames took, for a budget of \
         {} ms: {} and {} ms, {:.0} % over the budget. What else the machine does is in these times.",
        subject.name,
        ms(of_whole[0]),
        ms(of_whole[1]),
        ms(budget_ms),
        ms(of_budget[0]),
        ms(of_budget[1]),
        100.0 * overshoot
    ));
    Ok(())
}
