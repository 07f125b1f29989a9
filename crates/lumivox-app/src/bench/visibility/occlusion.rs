//! Occlusion on a floor, on the device (Figures 37 and 38).

use anyhow::Result;
use lumivox::visibility::OcclusionSettings;
use lumivox_field::Settings;

use super::corner::rms;
use super::floor::{Floor, Placed, TRUE_RAYS, baker_of, row, side, sizes, sky_rays};
use super::models::Model;
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

/// Figure 37: milliseconds and RMS error.
const FIGURE_37: [(u32, u32, [f64; 2]); 6] = [
    (1090, 32, [81.2, 0.59578]),
    (1090, 64, [82.7, 0.58886]),
    (1090, 128, [82.9, 0.58606]),
    (4226, 32, [83.2, 0.45392]),
    (4226, 64, [83.3, 0.42404]),
    (16642, 32, [84.2, 0.42054]),
];

/// Figures 37 and 38.
pub(super) fn occlusion(timer: &Timer<'_>, model: &Model, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Occlusion on the device (Figures 37 and 38)");
    let side = side(quick);
    let rays = if quick { 16 } else { 256 };
    report.say(&format!(
        "{} over a floor that fills a picture of {side} x {side} pixels; {rays} rays per pixel, denoised: milliseconds / RMS error in grey levels of \
         255 beside {TRUE_RAYS} true rays, of which the look-ups take other directions. In parentheses the papers', whose floor filled 75 % of 512 x 512.",
        model.title()
    ));
    let baker = baker_of(model)?;
    let floor = Floor::new(timer.gpu, baker.sphere(), side)?;
    let truth = floor.truth(&baker, sky_rays);
    let base = OcclusionSettings { rays, denoise: false, ..OcclusionSettings::default() };
    let mut lines = Vec::new();
    let mut last = None;
    for &(points, directions) in sizes(quick) {
        let (_, field, _) = model.baked(Settings { points, directions, ..Settings::default() })?;
        let placed = Placed::new(timer.gpu, &[&field])?;
        let case = format!("{points} x {directions} x {directions}");
        let paper = FIGURE_37.iter().find(|(p, d, _)| (*p, *d) == (points, directions)).map(|(.., v)| *v);
        let mut line = vec![case.clone()];
        for (name, blended) in [("nearest map", false), ("three maps", true)] {
            let settings = OcclusionSettings { blended, denoise: true, ..base };
            let (time, found) = placed.occlusion(timer, &floor, settings)?;
            let error = rms(&found, &truth);
            let beside = paper.filter(|_| !blended).map_or(String::new(), |[a, b]| format!(" ({a} / {b})"));
            line.push(format!("{} / {error:.3}{beside}", ms(time.ms)));
            let paper = paper.filter(|_| !blended);
            report.push(row(
                "Figure 37",
                format!("{case}, {name}"),
                "time",
                time.ms,
                "ms",
                paper.map(|p| p[0]),
            ));
            report.push(row(
                "Figure 37",
                format!("{case}, {name}"),
                "RMS",
                error,
                "grey levels",
                paper.map(|p| p[1]),
            ));
        }
        lines.push(line);
        last = Some(placed);
    }
    report.table(&["field", "nearest map", "three maps"].map(str::to_owned), &lines);
    let Some(placed) = last else { return Ok(()) };
    let counts: &[u32] = if quick { &[4, 16] } else { &[1, 4, 16, 64, 121, 256] };
    let mut series = ["milliseconds", "RMS", "RMS, denoised"]
        .map(|name| Series { name: name.to_owned(), points: Vec::new() });
    let mut lines = Vec::new();
    for &rays in counts {
        let (time, found) = placed.occlusion(timer, &floor, OcclusionSettings { rays, ..base })?;
        let (_, smooth) =
            placed.occlusion(timer, &floor, OcclusionSettings { rays, denoise: true, ..base })?;
        let values = [time.ms, rms(&found, &truth), rms(&smooth, &truth)];
        for ((series, value), metric) in series.iter_mut().zip(values).zip(["time", "RMS", "RMS, denoised"]) {
            series.points.push((f64::from(rays), value));
            let unit = if metric == "time" { "ms" } else { "grey levels" };
            report.push(row("Figure 38", format!("{rays} rays"), metric, value, unit, None));
        }
        lines.push(vec![
            rays.to_string(),
            ms(values[0]),
            format!("{:.3}", values[1]),
            format!("{:.3}", values[2]),
        ]);
    }
    report.table(&["rays per pixel", "ms", "RMS", "RMS, denoised"].map(str::to_owned), &lines);
    report.plot(
        "rays",
        &Plot { title: model.title(), x: "rays per pixel", y: "ms, grey levels", series: series.to_vec() },
    )
}
