//! `lumivox bench progressive`: Tables 6.1 and 6.2, Figures 6.8 and 6.10 of *Progressive Screen-Space Multichannel Surface Voxelization*
//! (dissertation: Tables 8 and 9, Figures 73, 74 and 76), and what they do not measure: missing cells, strays, cells lost again.

mod arena;
mod budget;
mod cost;
mod curves;
mod forms;
mod frames;
mod grids;
mod lighting;
mod moving;
mod pictures;
mod proof;
mod quality;
mod rig;
mod runs;
mod slabs;
mod storage;
mod table;
mod tunnel;

use anyhow::Result;
use clap::ValueEnum;

use super::models::subjects;
use super::report::Report;
use super::timing::Timer;

/// The parts of the page, each of which can be had alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Section {
    /// Cells against the mesh from frame to frame.
    Cells,
    /// Scenes that move.
    Moving,
    /// Cells by their normals and ages.
    Pictures,
    /// Turns that follow a budget.
    Budget,
    /// Light from frame to frame.
    Light,
    /// Light where a tank drives.
    Tunnel,
    /// What it costs, by grids, storage and triangles.
    Cost,
}

/// Runs these sections, or all if there are none.
pub(super) fn run(timer: &Timer<'_>, quick: bool, sections: &[Section], report: &mut Report) -> Result<()> {
    let wanted = |section| sections.is_empty() || sections.contains(&section);
    let subjects = subjects(timer.gpu, quick)?;
    let is_body = |name: &str| ["Bunny", "Dragon", "Bumpy ball"].contains(&name);
    let (bodies, others): (Vec<_>, Vec<_>) = subjects.into_iter().partition(|s| is_body(&s.name));
    report.say(
        "The papers' times are those of a GeForce GTX 285 from 2009; their numbers stand in parentheses.",
    );
    if wanted(Section::Cells) {
        quality::table(timer, &bodies, quick, report)?;
    }
    // Long runs are sometimes cut short.
    report.write()?;
    if wanted(Section::Moving) {
        moving::run(timer, quick, report)?;
    }
    if let Some(body) = bodies.last() {
        if wanted(Section::Pictures) {
            pictures::normals(timer, body, quick, report)?;
            arena::run(timer, quick, report)?;
        }
        if wanted(Section::Budget) {
            budget::run(timer, body, quick, report)?;
        }
    }
    report.write()?;
    if wanted(Section::Light) {
        lighting::run(timer, quick, report)?;
        report.write()?;
    }
    if wanted(Section::Tunnel) {
        tunnel::run(timer, quick, report)?;
        report.write()?;
    }
    if wanted(Section::Cost) {
        cost::run(timer, &bodies, &others, quick, report)?;
    }
    Ok(())
}
