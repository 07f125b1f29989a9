//! The methods side by side, scene by scene, with sheets to look at.

use anyhow::Result;
use lumivox::gpu::Gpu;

use super::stage::{Measured, Stage};
use super::{METHODS, STEPS};
use crate::bench::report::{Report, Row, ms};
use crate::compare::pictures;
use crate::sheet;

/// The columns of a table of errors.
pub(super) const HEADER: [&str; 8] = ["scene", "method", "trimmed", "low", "mean", "noise", "steps", "ms"];

/// The sums of one method's errors over the scenes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    trimmed: f64,
    low: f64,
    ratio: f64,
    scenes: f64,
}

/// A table for each grid with a line for each scene and method, and a sheet for each scene.
pub(super) fn run(gpu: &Gpu, stages: &[Stage], quick: bool, report: &mut Report) -> Result<()> {
    let grids: &[u32] = if quick { &[32] } else { &[32, 64] };
    for (n, &grid) in grids.iter().enumerate() {
        report.say(&format!(
            "{grid} cells along the longest side; milliseconds from the volume to settled light."
        ));
        let mut lines = Vec::new();
        let mut sums = [Sums::default(); METHODS.len()];
        let mut sheets = Vec::new();
        for stage in stages {
            let mut rows = Vec::new();
            for ((name, gi), sums) in METHODS.into_iter().zip(&mut sums) {
                let found = stage.measure(gpu, stage.settings(gi, grid), STEPS)?;
                lines.push(line(stage, name, &found));
                push(report, stage, grid, name, &found);
                sums.add(&found);
                let names = [format!("{}: {name}", stage.case.name), "path tracer".to_owned()];
                rows.push(pictures::compared(&found.pair, &found.comparison, names));
            }
            sheets.push((stage.case.name, sheet::captioned_sheet(&rows)));
        }
        for ((name, _), sums) in METHODS.iter().zip(sums) {
            lines.push(sums.line(name));
        }
        report.table(&HEADER.map(str::to_owned), &lines);
        // The finest grid's pictures tell most.
        if n + 1 == grids.len() {
            for (name, picture) in sheets {
                report.picture(
                    &name.replace(' ', "-"),
                    &format!("{name}: ours, reference, difference"),
                    &picture,
                )?;
            }
        }
    }
    report.say(
        "A star marks scenes with glowing surfaces, where the sum of direct and indirect light is compared. Light propagation volumes \
         know no glowing surfaces: where nothing else shines, as on the staircase, they are black.",
    );
    Ok(())
}

impl Sums {
    pub(super) fn add(&mut self, found: &Measured) {
        let c = &found.comparison;
        if let (Some(trimmed), Some(low), Some(ratio)) = (c.trimmed, c.low_frequency, c.mean_ratio) {
            self.trimmed += trimmed;
            self.low += low;
            self.ratio += ratio;
            self.scenes += 1.0;
        }
    }

    /// Whether anything was added.
    pub(super) fn any(&self) -> bool {
        self.scenes > 0.0
    }

    /// The means as the last line of a table.
    pub(super) fn line(&self, method: &str) -> Vec<String> {
        let numbers = [percent(self.trimmed / self.scenes), percent(self.low / self.scenes)];
        let ratio = format!("{:.2}", self.ratio / self.scenes);
        let cells =
            ["**mean of all**".to_owned(), method.to_owned()].into_iter().chain(numbers).chain([ratio]);
        cells.chain(vec![String::new(); 3]).collect()
    }
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.1} %", 1e2 * share)
}

pub(super) fn line(stage: &Stage, method: &str, found: &Measured) -> Vec<String> {
    let c = &found.comparison;
    let share = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), percent);
    vec![
        format!("{}{}", stage.case.name, if stage.glows { " *" } else { "" }),
        method.to_owned(),
        share(c.trimmed),
        share(c.low_frequency),
        c.mean_ratio.map_or_else(|| "-".to_owned(), |r| format!("{r:.2}")),
        share(c.noise),
        found.steps.to_string(),
        ms(found.light_ms),
    ]
}

pub(super) fn push(report: &mut Report, stage: &Stage, grid: u32, method: &str, found: &Measured) {
    let c = &found.comparison;
    let values = [
        ("trimmed NRMSE", c.trimmed, "share"),
        ("low-frequency NRMSE", c.low_frequency, "share"),
        ("mean ratio", c.mean_ratio, "ratio"),
        ("noise of the reference", c.noise, "share"),
        ("time to settled light", Some(found.light_ms), "ms"),
    ];
    for (metric, value, unit) in values {
        report.push(Row {
            figure: "errors",
            case: format!("{}, {grid} cells", stage.case.name),
            metric: format!("{metric}, {method}"),
            value: value.unwrap_or(f64::NAN),
            unit,
            paper: None,
            note: format!("{} steps, reference of {} samples a pixel", found.steps, stage.samples),
        });
    }
}
