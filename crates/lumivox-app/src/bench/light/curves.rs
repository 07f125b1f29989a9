//! Error against steps, rays and milliseconds.

use anyhow::Result;
use lumivox::gather::GatherSettings;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Settings};

use super::errors;
use super::stage::Stage;
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, Row, ms};

/// Scenes that the curves are drawn for.
const SCENES: [&str; 2] = ["cornell", "room"];

/// One line of the plots: what is varied, and how.
struct Sweep {
    name: &'static str,
    varied: &'static str,
    values: &'static [u32],
    gi: GiMethod,
    apply: fn(Settings, u32) -> Settings,
}

const SWEEPS: [Sweep; 3] = [
    Sweep {
        name: "lpv",
        varied: "steps",
        values: &[4, 8, 16, 32, 64, 128],
        gi: GiMethod::Lpv,
        apply: |settings, iterations| Settings { iterations, ..settings },
    },
    Sweep {
        name: "propagation",
        varied: "steps",
        values: &[4, 8, 16, 32, 64, 128, 256],
        gi: GiMethod::Propagation,
        apply: |settings, iterations| Settings { iterations, ..settings },
    },
    Sweep {
        name: "gather",
        varied: "rays",
        values: &[8, 16, 32, 64, 128, 256, 512],
        gi: GiMethod::Gather,
        apply: |settings, rays| Settings { gather: GatherSettings { rays, ..settings.gather }, ..settings },
    },
];

/// Two plots for each scene.
pub(super) fn run(gpu: &Gpu, stages: &[Stage], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Error against work");
    let grid = if quick { 32 } else { 64 };
    report.say(&format!(
        "{grid} cells. Propagation and light propagation volumes stop after so many steps; gathered light has so many rays for each surfel and settles."
    ));
    for stage in stages.iter().filter(|s| SCENES.contains(&s.case.name)) {
        let (mut by_work, mut by_time) = (Vec::new(), Vec::new());
        let mut lines = Vec::new();
        for sweep in &SWEEPS {
            let (mut work, mut time) = (Vec::new(), Vec::new());
            let values = if quick { &sweep.values[1..4] } else { sweep.values };
            for &value in values {
                let settings = (sweep.apply)(stage.settings(sweep.gi, grid), value);
                let found = stage.measure(gpu, settings, 0)?;
                let Some(trimmed) = found.comparison.trimmed else { continue };
                let low = found.comparison.low_frequency.map_or_else(|| "-".to_owned(), errors::percent);
                let what = format!("{}, {value} {}", sweep.name, sweep.varied);
                lines.push(vec![what, errors::percent(trimmed), low, ms(found.light_ms)]);
                work.push((f64::from(value), 1e2 * trimmed));
                time.push((found.light_ms, 1e2 * trimmed));
                report.push(Row {
                    figure: "error against work",
                    case: format!("{}, {grid} cells, {value} {}", stage.case.name, sweep.varied),
                    metric: format!("trimmed NRMSE, {}", sweep.name),
                    value: trimmed,
                    unit: "share",
                    paper: None,
                    note: format!("{:.0} ms", found.light_ms),
                });
            }
            by_work.push(Series { name: format!("{}, {}", sweep.name, sweep.varied), points: work });
            by_time.push(Series { name: sweep.name.to_owned(), points: time });
        }
        let name = stage.case.name;
        report.table(&[name, "trimmed", "low", "ms"].map(str::to_owned), &lines);
        let plot =
            |x, series| Plot { title: format!("{name}, {grid} cells"), x, y: "trimmed NRMSE, %", series };
        report.plot(&format!("work-{name}"), &plot("steps or rays", by_work))?;
        report.plot(&format!("time-{name}"), &plot("milliseconds", by_time))?;
    }
    Ok(())
}
