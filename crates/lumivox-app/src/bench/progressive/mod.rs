//! `lumivox bench progressive`: Tables 6.1 and 6.2, Figures 6.8 and 6.10 of *Progressive Screen-Space Multichannel Surface Voxelization*
//! (dissertation: Tables 8 and 9, Figures 73, 74 and 76), and what they do not measure: missing cells, strays, cells lost again.

mod budget;
mod cost;
mod curves;
mod forms;
mod lighting;
mod quality;
mod rig;
mod scenes;
mod storage;

use anyhow::Result;

use super::models::subjects;
use super::report::Report;
use super::timing::Timer;

/// Runs all of it.
pub(super) fn run(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let subjects = subjects(timer.gpu, quick)?;
    let is_body = |name: &str| ["Bunny", "Dragon", "Bumpy ball"].contains(&name);
    let (bodies, others): (Vec<_>, Vec<_>) = subjects.into_iter().partition(|s| is_body(&s.name));
    report.say(
        "The papers' times are those of a GeForce GTX 285 from 2009; their numbers stand in parentheses.",
    );
    quality::table(timer, &bodies, quick, report)?;
    // Long runs are sometimes cut short.
    report.write()?;
    scenes::moving(timer, quick, report)?;
    if let Some(body) = bodies.last() {
        scenes::normals(timer, body, quick, report)?;
        budget::run(timer, body, quick, report)?;
    }
    report.write()?;
    lighting::run(timer, quick, report)?;
    report.write()?;
    cost::run(timer, &bodies, &others, quick, report)
}
