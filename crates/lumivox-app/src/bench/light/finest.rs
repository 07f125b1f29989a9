//! The finest grid. Gathered light has fewer rays there, so that the surfels find room in a binding of the core tier. Propagation takes
//! minutes on a software driver, so that it and light propagation volumes are shown in few scenes.

use anyhow::Result;
use lumivox::gather::GatherSettings;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Settings};

use super::errors::{self, Sums};
use super::stage::Stage;
use super::{METHODS, STEPS};
use crate::bench::report::Report;

const GRID: u32 = 128;
/// 128 MiB hold so many rays of 349,000 surfels.
const RAYS: u32 = 96;
/// Scenes with the other methods.
const WITH_ALL: [&str; 2] = ["two rooms", "Sponza"];

pub(super) fn run(gpu: &Gpu, stages: &[Stage], report: &mut Report) -> Result<()> {
    report.say(&format!(
        "{GRID} cells along the longest side, gathered light with {RAYS} rays a surfel; the other methods in {}.",
        WITH_ALL.join(" and "),
    ));
    let mut lines = Vec::new();
    let mut sums = Sums::default();
    for stage in stages {
        eprintln!("lumivox bench light: {}, {GRID} cells", stage.case.name);
        for (name, gi) in METHODS.into_iter().filter(|(_, gi)| *gi != GiMethod::Gather) {
            if WITH_ALL.contains(&stage.case.name) {
                let found = stage.measure(gpu, stage.settings(gi, GRID), STEPS)?;
                lines.push(errors::line(stage, name, &found).into_iter().chain([String::new()]).collect());
                errors::push(report, stage, GRID, name, &found);
            }
        }
        let settings = stage.settings(GiMethod::Gather, GRID);
        let gather = GatherSettings { rays: RAYS, ..settings.gather };
        let found = stage.measure(gpu, Settings { gather, ..settings }, 0)?;
        let surfels = found.surfels.map_or_else(String::new, |s| {
            let refused =
                if s.refused > 0 { format!(", {} more find no room", s.refused) } else { String::new() };
            format!("{}{refused}", s.used)
        });
        lines.push(errors::line(stage, "gather", &found).into_iter().chain([surfels]).collect());
        errors::push(report, stage, GRID, "gather", &found);
        sums.add(&found);
    }
    lines.push(sums.line("gather"));
    let header = errors::HEADER.into_iter().chain(["surfels"]).map(str::to_owned);
    report.table(&header.collect::<Vec<_>>(), &lines);
    Ok(())
}
