//! `lumivox bench light`: indirect light by every method against path-traced references: errors, what they cost, and Table 2 of
//! the dissertation (5.6), whose scenes of Figures 53 to 57 are among ours.

mod amortized;
mod cases;
mod curves;
mod errors;
mod finest;
mod furnace;
mod stage;
mod table_2;

use anyhow::Result;
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

/// Measures everything.
pub(super) fn run(gpu: &Gpu, quick: bool, report: &mut Report) -> Result<()> {
    let (size, seconds) = if quick { (QUICK_SIZE, QUICK_SECONDS) } else { (SIZE, SECONDS) };
    report.say(&format!(
        "Errors are of the irradiance of indirect light at {} x {} pixels against our path tracer, all bounces. *Trimmed* is the \
         root mean square of the pixels' mean channel error over the reference's mean, without the 1 % of pixels with the largest \
         error; *low* the same with both pictures blurred by 1/32 of their height; *mean* is ours over the reference's. *Noise* is \
         the reference's own, whose square is contained in that of the errors.",
        size.0, size.1,
    ));
    furnace::run(gpu, report)?;
    let mut stages = Vec::new();
    report.head("Errors");
    for case in cases::cases(quick)? {
        eprintln!("lumivox bench light: {}", case.name);
        stages.push(Stage::new(case, size, seconds)?);
    }
    errors::run(gpu, &stages, quick, report)?;
    if !quick {
        finest::run(gpu, &stages, report)?;
    }
    // Long runs are sometimes cut short.
    report.write()?;
    curves::run(gpu, &stages, quick, report)?;
    table_2::run(gpu, &stages, report)?;
    amortized::run(gpu, &stages, quick, report)
}
