//! Figures 6.8, 73 and 74: cleanup and injection against the grid's side and the number of points, and both storages.

use anyhow::Result;
use glam::UVec2;
use lumivox::progressive::{AttributeChannel, AttributeKind, CleanupRule, DirectLight, Storage};

use super::cost::{row, view_of};
use super::forms::{measure_bricks, measure_storage, single_pass};
use super::rig::{Rig, three_channels};
use super::slabs::{Dense, Targets};
use crate::bench::models::Subject;
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

/// One and four channels of four numbers.
fn targets() -> [Vec<AttributeChannel>; 2] {
    let mut four = three_channels();
    four.push(AttributeChannel::new("albedo again", AttributeKind::Color(1.0)));
    [vec![AttributeChannel::new("normal", AttributeKind::Normal)], four]
}

/// Cleanup and injection against the grid's side and the number of points.
pub(super) fn figure_6_8(
    timer: &Timer<'_>,
    subject: &Subject,
    quick: bool,
    report: &mut Report,
) -> Result<()> {
    report.head("Figures 6.8, 73 and 74: cleanup and injection");
    let sides: &[u32] = if quick { &[32, 64] } else { &[32, 64, 96, 128, 192, 256] };
    let size = UVec2::splat(512);
    report.say(&format!(
        "{}, one view of {} x {} texels from within; milliseconds. Cleanup of the dense form by either rule, with the pyramid of depths that \
         footprint needs; injection of fixed numbers of points, of two for each cell along the grid's side, and of all texels, with the sums \
         cleared and made means; all in one by the single pass, with light, by either rule; and a frame in bricks with two points a cell, with \
         one channel and with four.",
        subject.title(),
        size.x,
        size.y
    ));
    let mut rig = Rig::new(timer.gpu, &subject.scene, size)?;
    rig.look(timer.gpu, view_of(subject));
    let mut series: Vec<Series> = Vec::new();
    let mut lines = Vec::new();
    let mut header = vec!["cells".to_owned()];
    for &side in sides {
        let grid = subject.grid(side)?;
        let proportional = UVec2::splat(2 * side).min(size);
        let mut found: Vec<(String, f64)> = Vec::new();
        let mut dense = |points: UVec2, rule| {
            Dense::measure(timer, &mut rig, grid, (points, rule, Targets::Three), &[], None)
        };
        found.push(("cleanup, center".to_owned(), dense(proportional, CleanupRule::Center)?.cleanup));
        let by_footprint = dense(proportional, CleanupRule::Footprint)?;
        found.push(("cleanup, footprint".to_owned(), by_footprint.cleanup));
        for (name, points) in [("64 x 64", UVec2::splat(64)), ("128 x 128", UVec2::splat(128)), ("all", size)]
        {
            let of_points = dense(points, CleanupRule::Center)?;
            found.push((format!("injection, {name}"), of_points.injection + of_points.rest));
        }
        found.push(("injection, 2 a cell".to_owned(), by_footprint.injection + by_footprint.rest));
        found.push(("total, 2 a cell".to_owned(), by_footprint.total()));
        for (name, rule) in
            [("single pass", CleanupRule::Center), ("single pass, footprint", CleanupRule::Footprint)]
        {
            let light = DirectLight::CELL_BYTES * grid.cell_count();
            let has_room = light <= timer.gpu.device.limits().max_storage_buffer_binding_size;
            let time = if has_room { single_pass(timer, &rig, grid, rule)? } else { f64::NAN };
            found.push((name.to_owned(), time));
        }
        let [one, four] = targets();
        for (name, channels) in [("bricks, 1 channel", &one), ("bricks, 4 channels", &four)] {
            let rule = CleanupRule::Footprint;
            found.push((
                name.to_owned(),
                measure_bricks(timer, &mut rig, grid, channels, proportional, rule, &[])?.0,
            ));
        }
        let mut line = vec![side.to_string()];
        for (n, (name, value)) in found.into_iter().enumerate() {
            line.push(if value.is_finite() { ms(value) } else { "no room".to_owned() });
            report.push(row("Figure 6.8", format!("{}, {side}", subject.name), &name, value, "ms", ""));
            if series.len() <= n {
                header.push(name.clone());
                series.push(Series { name, points: Vec::new() });
            }
            if value.is_finite() {
                series[n].points.push((f64::from(side), value));
            }
        }
        lines.push(line);
    }
    report.table(&header, &lines);
    let shown = [
        "cleanup, footprint",
        "injection, 64 x 64",
        "injection, 2 a cell",
        "injection, all",
        "single pass",
        "bricks, 1 channel",
    ];
    let series = series.into_iter().filter(|s| shown.contains(&s.name.as_str())).collect();
    let title = format!("Figure 6.8: {}", subject.name);
    report
        .plot("figure-6-8", &Plot { title, x: "cells along the longest side", y: "milliseconds", series })?;
    storages(timer, &mut rig, subject, (sides, size), report)
}

/// The same volume in 3D textures and in buffers.
fn storages(
    timer: &Timer<'_>,
    rig: &mut Rig,
    subject: &Subject,
    (sides, size): (&[u32], UVec2),
    report: &mut Report,
) -> Result<()> {
    report.head("Figures 6.8 and 74: 3D textures and buffers");
    report.say(&format!(
        "{}, the same view. A volume over all cells of one and of four targets of four numbers, in 3D textures and in the unwrapped form, \
         here packed buffers; cleanup by center and injection of two points for each cell along the side, milliseconds, cleanup / injection. \
         Textures are cleaned from one into the other, buffers in place; sums lie in a buffer with both, and where that does not fit one binding of the device there is no room.",
        subject.title()
    ));
    let names = [("3D", Storage::Textures), ("unwrapped", Storage::Buffers)];
    let mut header = vec!["cells".to_owned()];
    let (mut series, mut lines): (Vec<Series>, Vec<Vec<String>>) = (Vec::new(), Vec::new());
    for &side in sides {
        let grid = subject.grid(side)?;
        let points = UVec2::splat(2 * side).min(size);
        let mut line = vec![side.to_string()];
        let case = format!("{}, {side}", subject.name);
        let forms = targets().into_iter().flat_map(|channels| names.map(|name| (channels.clone(), name)));
        for (n, (channels, (name, storage))) in forms.enumerate() {
            let name = match channels.len() {
                1 => format!("{name}, 1 target"),
                count => format!("{name}, {count} targets"),
            };
            if series.len() <= n {
                header.push(name.clone());
                series.push(Series { name: name.clone(), points: Vec::new() });
            }
            let sums = (16 * channels.len() as u64 + 4) * grid.cell_count();
            if sums > timer.gpu.device.limits().max_storage_buffer_binding_size {
                line.push("no room".to_owned());
                continue;
            }
            let [cleanup, injection] = measure_storage(timer, rig, grid, &channels, points, storage)?;
            for (stage, value) in [("cleanup", cleanup), ("injection", injection)] {
                report.push(row("Figure 74", case.clone(), &format!("{stage}, {name}"), value, "ms", ""));
            }
            line.push(format!("{} / {}", ms(cleanup), ms(injection)));
            series[n].points.push((f64::from(side), cleanup + injection));
        }
        lines.push(line);
    }
    report.table(&header, &lines);
    let title = format!("Figure 74: {}, cleanup and injection", subject.name);
    report.plot("figure-74", &Plot { title, x: "cells along the longest side", y: "milliseconds", series })
}
