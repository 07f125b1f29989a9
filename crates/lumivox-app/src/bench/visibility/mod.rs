//! `lumivox bench visibility`: Table 1 and Figures 33 to 48 of the dissertation's chapter 4, and what look-ups cost beside true rays.

mod atrium;
mod baking;
mod corner;
mod culling;
mod elongated;
mod lobe;
mod models;
mod occlusion;
mod own;
mod rates;
mod reflections;
mod several;
mod shadows;
mod surface;
mod traced;
mod tracer;

use anyhow::{Context, Result};

use super::report::Report;
use super::timing::Timer;

/// Runs all of it.
pub(super) fn run(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let models = models::models(quick)?;
    let first = models.first().context("a model")?;
    report.say(
        "The papers' CPU times are those of an Intel Xeon at 3 GHz and a Pentium 4 from before 2010, those on a device of a GeForce 8800 GTS; \
         their numbers stand in parentheses.",
    );
    if first.name != "Bunny" {
        report.say("`LUMIVOX_ASSETS` names no folder with the papers' models: bodies of the built-in scene `falling` stand in for them.");
    }
    baking::baking(quick, report)?;
    corner::errors(first, quick, report)?;
    corner::table(&models, quick, report)?;
    several::several(&models, quick, report)?;
    rates::rates(timer, &models, quick, report)?;
    rates::triangles(timer, quick, report)?;
    occlusion::occlusion(timer, first, quick, report)?;
    own::own(timer, &models, quick, report)?;
    atrium::atrium(timer, quick, report)?;
    culling::culling(timer, first, quick, report)?;
    shadows::shadows(timer, &models, quick, report)?;
    reflections::reflections(timer, &models, quick, report)?;
    traced::traced(&models, quick, report)?;
    elongated::elongated(timer, quick, report)
}
