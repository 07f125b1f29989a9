//! The methods side by side, scene by scene, with sheets to look at.

use anyhow::Result;
use lumivox::gpu::Gpu;
use lumivox_render::GiMethod;

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
        let mut goals = Goals::default();
        for stage in stages {
            let mut rows = Vec::new();
            let mut errors = Vec::new();
            for ((name, gi), sums) in METHODS.into_iter().zip(&mut sums) {
                let found = stage.measure(gpu, stage.settings(gi, grid), STEPS)?;
                lines.push(line(stage, name, &found));
                push(report, stage, grid, name, &found);
                sums.add(&found);
                errors.push(found.comparison.trimmed.unwrap_or(f64::NAN));
                if gi == GiMethod::Gather {
                    goals.add_gathered(&found);
                }
                let names = [format!("{}: {name}", stage.case.name), "path tracer".to_owned()];
                rows.push(pictures::compared(&found.pair, &found.comparison, names));
            }
            sheets.push((stage.case.name, sheet::captioned_sheet(&rows)));
            goals.add_scene(stage, &errors);
        }
        for ((name, _), sums) in METHODS.iter().zip(sums) {
            lines.push(sums.line(name));
        }
        report.table(&HEADER.map(str::to_owned), &lines);
        report.say(&goals.words());
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

/// What gathered light aims at, scene by scene: trimmed and low-frequency errors, and how far the mean may be off.
const TRIMMED: f64 = 0.20;
const LOW: f64 = 0.14;
const MEAN: f64 = 0.10;
/// Open land and a court; the others are buildings.
const OUTDOORS: [&str; 2] = ["arena", "terrain"];

/// In how many scenes what is aimed at is met.
#[derive(Debug, Default)]
struct Goals {
    scenes: u32,
    /// By gathered light: trimmed, low, mean.
    met: [u32; 3],
    /// Scenes in which gathered light is better than propagation.
    gather_better: u32,
    indoors: u32,
    /// Indoor scenes in which propagation is better than light propagation volumes.
    propagation_better: u32,
}

impl Goals {
    fn add_gathered(&mut self, found: &Measured) {
        let c = &found.comparison;
        let within = |value: Option<f64>, most: f64| u32::from(value.is_some_and(|v| v <= most));
        self.met[0] += within(c.trimmed, TRIMMED);
        self.met[1] += within(c.low_frequency, LOW);
        self.met[2] += within(c.mean_ratio.map(|r| (r - 1.0).abs()), MEAN);
    }

    /// Errors in the order of [`METHODS`].
    fn add_scene(&mut self, stage: &Stage, errors: &[f64]) {
        let &[lpv, propagation, gather] = errors else { return };
        self.scenes += 1;
        self.gather_better += u32::from(gather < propagation);
        if !OUTDOORS.contains(&stage.case.name) {
            self.indoors += 1;
            self.propagation_better += u32::from(propagation < lpv);
        }
    }

    fn words(&self) -> String {
        let Self { scenes, met: [trimmed, low, mean], gather_better, indoors, propagation_better } = self;
        format!(
            "Of {scenes} scenes gathered light is off by at most {:.0} % trimmed in {trimmed}, by {:.0} % low in {low}, and its mean within {:.0} % \
             in {mean}. It is better than propagation in {gather_better}; of {indoors} scenes indoors propagation is better than light propagation \
             volumes in {propagation_better}.",
            1e2 * TRIMMED,
            1e2 * LOW,
            1e2 * MEAN,
        )
    }
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
