//! `lumivox bench slicemap`: the measurements of *Fast Scene Voxelization and Applications* (Eisemann and Decoret 2006): voxelization rates
//! and Table 1, what slices, triangles, size and tables cost, and what
//! culling shadow volumes saves.

mod curves;
mod glass;
mod leaves;
mod leaves_truth;
mod prepass;
mod rates;
mod rays;
mod table_1;
mod tables;
mod volumes;
mod yard;

use anyhow::Result;

use super::report::{Report, Row};
use super::timing::Timer;

/// Runs all of it.
pub(super) fn run(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.say(
        "The paper's times are those of a GeForce 6800 from 2005; its numbers stand in parentheses. It has 32 slices for each map, three maps in a pass.",
    );
    rates::rates(timer, quick, report)?;
    // Long runs are sometimes cut short.
    report.write()?;
    table_1::table(timer, quick, report)?;
    report.write()?;
    prepass::prepass(timer, quick, report)?;
    leaves::leaves(timer, quick, report)?;
    glass::glass(timer, quick, report)?;
    report.write()?;
    tables::tables(timer, quick, report)?;
    curves::curves(timer, quick, report)?;
    report.write()?;
    volumes::volumes(timer, quick, report)
}

fn row(
    figure: &'static str,
    case: impl Into<String>,
    metric: &str,
    value: f64,
    unit: &'static str,
    paper: Option<f64>,
) -> Row {
    Row { figure, case: case.into(), metric: metric.to_owned(), value, unit, paper, note: String::new() }
}
