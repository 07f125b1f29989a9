//! What it costs: all of its parts, and against triangles.

use anyhow::Result;
use glam::{UVec2, Vec3};
use lumivox::core::{Grid, View};
use lumivox::progressive::CleanupRule;

use super::forms::measure_bricks;
use super::rig::{Rig, orbit, three_channels};
use super::{grids, storage, table};
use crate::bench::models::{Subject, ball};
use crate::bench::report::{Report, Row, ms};
use crate::bench::timing::Timer;

/// Runs all of it.
pub(super) fn run(
    timer: &Timer<'_>,
    bodies: &[Subject],
    others: &[Subject],
    quick: bool,
    report: &mut Report,
) -> Result<()> {
    if let Some(body) = bodies.last() {
        grids::run(timer, body, quick, report)?;
        report.write()?;
    }
    if let Some(hall) = others.iter().find(|s| s.name == "Sponza" || s.name == "builtin:atrium") {
        storage::figure_6_8(timer, hall, quick, report)?;
        report.write()?;
    }
    let of_table: Vec<_> =
        bodies.iter().chain(others).filter(|s| s.name != "Sponza" && (quick || s.name != "Bunny")).collect();
    table::run(timer, &of_table, quick, report)?;
    report.write()?;
    triangles(timer, quick, report)
}

pub(super) fn row(
    figure: &'static str,
    case: String,
    metric: &str,
    value: f64,
    unit: &'static str,
    note: &str,
) -> Row {
    Row { figure, case, metric: metric.to_owned(), value, unit, paper: None, note: note.to_owned() }
}

/// A view that shows most of a model, from within where it is a building.
pub(super) fn view_of(subject: &Subject) -> View {
    if subject.name == "Sponza" {
        let (eye, target) = (Vec3::new(-11.0, 1.8, 0.6), Vec3::new(6.0, 4.2, -1.2));
        return View::perspective(eye, target, Vec3::Y, 1.05, 1.0, 0.1, 60.0).with_reversed_depth();
    }
    match subject.scene.cameras.first() {
        Some(c) => {
            View::perspective(c.eye, c.target, c.up, c.fov_y, 1.0, 0.05, 1.5 * subject.bounds.size().length())
                .with_reversed_depth()
        }
        None => orbit(&subject.bounds, 5)[0],
    }
}

/// The same view of a ball of more and more triangles.
fn triangles(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Cost against triangles");
    let (side, size) = (128, UVec2::splat(512));
    report.say(&format!(
        "A bumpy ball of more and more triangles at {side} cells, one view of {} x {} texels, all injected, three channels; milliseconds \
         of cleanup and injection in bricks, without the G-buffer.",
        size.x, size.y
    ));
    let counts: &[u32] = if quick { &[10_000, 40_000] } else { &[10_000, 100_000, 1_000_000, 10_000_000] };
    let mut lines = Vec::new();
    for &count in counts {
        let scene = ball(count);
        let bounds = scene.bounds();
        let mut rig = Rig::new(timer.gpu, &scene, size)?;
        rig.look(timer.gpu, orbit(&bounds, 5)[0]);
        let grid = Grid::fit(&bounds, side)?;
        let rule = CleanupRule::Footprint;
        let (time, happened) = measure_bricks(timer, &mut rig, grid, &three_channels(), size, rule, &[])?;
        let case = scene.triangle_count().to_string();
        report.push(row("triangles", case.clone(), "progressive", time, "ms", ""));
        lines.push(vec![case, ms(time), happened.occupied.to_string()]);
    }
    report.table(&["triangles", "ms", "occupied"].map(str::to_owned), &lines);
    Ok(())
}
