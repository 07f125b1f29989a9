//! Bit arithmetic beside the paper's look-up tables.

use anyhow::Result;
use glam::{UVec2, Vec3};
use lumivox::core::View;
use lumivox::refraction::{Evaluation, Thickness};
use lumivox::slicemap::{Slicemap, SlicemapSettings, Slicing};
use lumivox_render::LeafShadowSettings;

use super::rates::measure;
use super::row;
use super::table_1::{Case, stages, sum};
use crate::bench::models::{Subject, ball};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

fn knot(timer: &Timer<'_>) -> Result<Subject> {
    let mut scene = lumivox_scene::builtin::knot_glass(3);
    scene.instances.retain(|instance| instance.mesh == 0);
    Subject::new(timer.gpu, "Knot", scene)
}

/// Milliseconds of counting alone, by instructions and by the table.
fn thickness(timer: &Timer<'_>, knot: &Subject, side: u32, slices: u32) -> Result<[f64; 2]> {
    let gpu = timer.gpu;
    let size = UVec2::splat(side);
    let settings = SlicemapSettings { size, slices, splits_faces: true, ..Default::default() };
    let mut map = Slicemap::new(gpu, settings)?;
    let (middle, reach) = (knot.bounds.center(), knot.bounds.size().length());
    let view = View::perspective(middle + 1.3 * reach * Vec3::Z, middle, Vec3::Y, 0.8, 1.0, 0.1, 3.0 * reach);
    map.set_view(gpu, &view, [0.5 * reach, 2.0 * reach]);
    let meshes: Vec<_> = knot.meshes.iter().map(|mesh| (mesh, 0)).collect();
    timer.submit(|e| map.record(gpu, e, &meshes))?;
    let mut times = [0.0; 2];
    for (evaluation, time) in [Evaluation::Bits, Evaluation::Table].into_iter().zip(&mut times) {
        let mut thickness = Thickness::new(gpu, size, evaluation)?;
        *time = timer.median(|| timer.submit(|e| thickness.record(gpu, e, &map, None)))?.ms;
    }
    Ok(times)
}

pub(super) fn tables(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Bits or tables");
    report.say(
        "Milliseconds by instructions and by the paper's tables: *cellmask* gives a fragment its bit, *summask* the ones of a byte, and the table of 256 x 256 \
         entries (*evaluation*) the inner cells of eight slices.",
    );
    let mut lines = Vec::new();
    let mut add = |name: &str, [bits, table]: [f64; 2]| {
        lines.push(vec![name.to_owned(), ms(bits), ms(table)]);
        report.push(row("tables", name, "instructions", bits, "ms", None));
        report.push(row("tables", name, "table", table, "ms", None));
    };
    let side = if quick { 256 } else { 512 };
    let subject = Subject::new(timer.gpu, "Bumpy ball", ball(100_000))?;
    let mut masks = [0.0; 2];
    for (uses_table, time) in [false, true].into_iter().zip(&mut masks) {
        let (size, slicing) = (UVec2::splat(side), Slicing::Uniform);
        let settings = SlicemapSettings { size, slicing, uses_table, ..Default::default() };
        *time = measure(timer, &subject, settings)?.ms;
    }
    add(&format!("cellmask, 100,000 triangles, {side} x {side} x 96"), masks);
    for &slices in if quick { &[96][..] } else { &[96, 512] } {
        let mut times = [0.0; 2];
        for (uses_tables, time) in [false, true].into_iter().zip(&mut times) {
            let leaves = LeafShadowSettings { slices, uses_tables, ..Default::default() };
            let case = Case { name: String::new(), leaves: Some(leaves), paper: None };
            *time = sum(&stages(timer, &case, quick)?.0, &["slicemap/transmittance"]);
        }
        add(&format!("summask, the tree in 512 x 512 pixels, {slices} slices"), times);
    }
    let knot = knot(timer)?;
    for &slices in if quick { &[32][..] } else { &[32, 96] } {
        add(
            &format!("evaluation of a knot, {side} x {side} x {slices}"),
            thickness(timer, &knot, side, slices)?,
        );
    }
    report.table(&["", "instructions", "tables"].map(str::to_owned), &lines);
    Ok(())
}
