//! Bit arithmetic beside the paper's look-up tables.

use anyhow::Result;
use glam::UVec2;
use lumivox::slicemap::{SlicemapSettings, Slicing};
use lumivox_render::LeafShadowSettings;

use super::rates::measure;
use super::row;
use super::table_1::{Case, stages, sum};
use crate::bench::models::{Subject, ball};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

pub(super) fn tables(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Bits or tables");
    report.say(
        "Milliseconds by instructions and by the paper's tables: *cellmask* gives a fragment its bit, *summask* the ones of a byte.",
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
    report.table(&["", "instructions", "tables"].map(str::to_owned), &lines);
    Ok(())
}
