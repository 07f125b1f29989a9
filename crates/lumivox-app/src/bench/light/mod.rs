//! `lumivox bench light`: indirect light by every method against path-traced references: errors, what they cost, and Table 2 of
//! the dissertation (5.6), whose scenes of Figures 53 to 57 are among ours.

mod amortized;
mod cases;
mod curves;
mod errors;
mod finest;
mod furnace;
mod presets;
mod stage;
mod table_2;
mod variants;

use anyhow::Result;
use clap::ValueEnum;
use lumivox::gpu::Gpu;
use lumivox_render::GiMethod;

use super::report::Report;
use crate::args::Size;
use stage::Stage;

/// The methods and their names.
const METHODS: [(&str, GiMethod); 3] =
    [("lpv", GiMethod::Lpv), ("propagation", GiMethod::Propagation), ("gather", GiMethod::Gather)];

/// Propagation steps that a still makes at a time, until its light has settled.
const STEPS: u32 = 64;

/// Pictures, and the time for each reference.
const SIZE: Size = Size(96, 54);
const SECONDS: u32 = 30;
/// The same in a hurry.
const QUICK_SIZE: Size = Size(48, 27);
const QUICK_SECONDS: u32 = 4;

/// The parts of the page, each of which can be had alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Section {
    /// A closed box with a closed form.
    Furnace,
    /// All methods in all scenes, in two grids.
    Errors,
    /// Gathered light in the finest grid.
    Finest,
    /// The presets, with triangles and with views.
    Presets,
    /// Mirrors, a constant albedo, and what holds light back in light propagation volumes.
    Variants,
    /// Errors against steps, rays and milliseconds.
    Curves,
    /// Table 2 of the dissertation.
    Table2,
    /// Light over several frames.
    Amortized,
}

/// Measures these sections, or everything if there are none.
pub(super) fn run(gpu: &Gpu, quick: bool, sections: &[Section], report: &mut Report) -> Result<()> {
    let wanted = |section| sections.is_empty() || sections.contains(&section);
    let (size, seconds) = if quick { (QUICK_SIZE, QUICK_SECONDS) } else { (SIZE, SECONDS) };
    report.say(&format!(
        "Errors are of the irradiance of indirect light at {} x {} pixels against our path tracer, all bounces. *Trimmed* is the \
         root mean square of the pixels' mean channel error over the reference's mean, without the 1 % of pixels with the largest \
         error; *low* the same with both pictures blurred by 1/32 of their height; *mean* is ours over the reference's. *Noise* is \
         the reference's own, whose square is contained in that of the errors.",
        size.0, size.1,
    ));
    if wanted(Section::Furnace) {
        furnace::run(gpu, report)?;
    }
    // What is not compared with a reference needs none.
    let compared = [Section::Errors, Section::Finest, Section::Presets, Section::Variants, Section::Curves];
    let seconds = if compared.into_iter().any(wanted) { seconds } else { 1 };
    // The other sections use a few of the scenes.
    let few: Option<&[&str]> =
        match [Section::Errors, Section::Finest, Section::Table2].into_iter().any(wanted) {
            true => None,
            false => Some(&["test", "cornell", "room", "two rooms"]),
        };
    let mut stages = Vec::new();
    for case in cases::cases(quick)? {
        if few.is_some_and(|few| !few.contains(&case.name)) {
            continue;
        }
        eprintln!("lumivox bench light: {}", case.name);
        stages.push(Stage::new(case, size, seconds)?);
    }
    if wanted(Section::Errors) {
        report.head("Errors");
        errors::run(gpu, &stages, quick, report)?;
    }
    if wanted(Section::Finest) && !quick {
        finest::run(gpu, &stages, report)?;
    }
    // Long runs are sometimes cut short.
    report.write()?;
    if wanted(Section::Presets) {
        presets::run(gpu, &stages, quick, report)?;
    }
    if wanted(Section::Variants) {
        variants::run(gpu, &stages, quick, report)?;
    }
    report.write()?;
    if wanted(Section::Curves) {
        curves::run(gpu, &stages, quick, report)?;
    }
    if wanted(Section::Table2) {
        table_2::run(gpu, &stages, report)?;
    }
    if wanted(Section::Amortized) {
        amortized::run(gpu, &stages, quick, report)?;
    }
    Ok(())
}
