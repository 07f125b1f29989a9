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
    // The first frames of the first know nothing of the costs yet.
    let [first, second] = [round(Some(&mut budget))?, round(Some(&mut budget))?];
    let of = |times: &[f64]| [0.5, 0.95].map(|part| percentile(times, part));
    let (of_whole, of_first, of_second) = (of(&whole), of(&first), of(&second));
    let over = |of: [f64; 2]| of[1] / budget_ms - 1.0;
    let case = format!("{}, {side}", subject.name);
    for (metric, value, unit) in [
        ("whole frames, median", of_whole[0], "ms"),
        ("whole frames, 95th percentile", of_whole[1], "ms"),
        ("budget", budget_ms, "ms"),
        ("first round within the budget, median", of_first[0], "ms"),
        ("first round within the budget, 95th percentile", of_first[1], "ms"),
        ("first round, overshoot of the 95th percentile", over(of_first), "1"),
        ("within the budget, median", of_second[0], "ms"),
        ("within the budget, 95th percentile", of_second[1], "ms"),
        ("overshoot of the 95th percentile", over(of_second), "1"),
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
        "{} at {side} cells, a camera that goes round each axis once in {frames} frames together, with {size} x {size} texels. The *whole* round has all bricks cleaned and all \
         points injected in each frame, after a round before it that is not counted, in which drivers compile. Then turns follow what the last frames took, \
         for a budget of half the median of a whole frame, {} ms: the *first* such round begins with a budget that has measured nothing, the *second* goes on with what it has \
         learnt. What else the machine does is in these times.",
        subject.name,
        ms(budget_ms),
    ));
    let line = |name: &str, of: [f64; 2], is_within: bool| {
        let over = if is_within { format!("{:.0} %", 100.0 * over(of)) } else { String::new() };
        vec![name.to_owned(), ms(of[0]), ms(of[1]), over]
    };
    let lines = [
        line("whole", of_whole, false),
        line("first within the budget", of_first, true),
        line("second within the budget", of_second, true),
    ];
    report.table(&["round", "median ms", "95th percentile ms", "over the budget"].map(str::to_owned), &lines);
    Ok(())
}
