//! Occlusion on a floor, on the device (Figures 37 and 38).

use anyhow::Result;
use lumivox::visibility::OcclusionSettings;
use lumivox_field::{Settings, Storage};

use super::corner::rms;
use super::models::Model;
use super::surface::{Placed, Surface, baker_of, row, side, sizes, sky_rays};
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
    let true_rays = if quick { 1024 } else { 4096 };
    report.say(&format!(
        "{} over a floor that fills a picture of {side} x {side} pixels; {rays} rays per pixel: milliseconds / RMS error in grey levels of 255, and both of the same denoised, beside {true_rays} true rays. In parentheses the papers', whose floor filled 75 % of 512 x 512, beside a reference of 256 rays.",
        model.title()
    ));
    let baker = baker_of(model)?;
    let floor = Surface::floor(timer.gpu, baker.sphere(), side)?;
    let truth = floor.truth(&baker, sky_rays(true_rays));
    let base = OcclusionSettings { rays, denoise: false, ..OcclusionSettings::default() };
    let mut lines = Vec::new();
    let mut kept = Vec::new();
    let bytes = sizes(quick).iter().map(|size| (*size, Storage::Byte));
    // One bit, at the usual size.
    let bit = [(if quick { (1090, 64) } else { (4226, 64) }, Storage::Bit)];
    for ((points, directions), storage) in bytes.chain(bit) {
        let (_, field, _) = model.baked(Settings { points, directions, storage, ..Settings::default() })?;
        let placed = Placed::new(timer.gpu, &[&field])?;
        let bits = if storage == Storage::Bit { ", 1 bit" } else { "" };
        let case = format!("{points} x {directions} x {directions}{bits}");
        let paper = FIGURE_37.iter().find(|(p, d, _)| (*p, *d) == (points, directions)).map(|(.., v)| *v);
        let paper = paper.filter(|_| storage == Storage::Byte);
        let mut line = vec![case.clone()];
        for (name, blended) in [("nearest map", false), ("three maps", true)] {
            let settings = OcclusionSettings { blended, ..base };
            let (time, found) = placed.occlusion(timer, &floor, settings)?;
            let (smooth_time, smooth) =
                placed.occlusion(timer, &floor, OcclusionSettings { denoise: true, ..settings })?;
            let (error, smooth) = (rms(&found, &truth), rms(&smooth, &truth));
            let paper = paper.filter(|_| !blended);
            let beside = paper.map_or(String::new(), |[a, b]| format!(" ({a} / {b})"));
            line.push(format!("{} / {error:.3}{beside}; {} / {smooth:.3}", ms(time.ms), ms(smooth_time.ms)));
            let case = format!("{case}, {name}");
            report.push(row("Figure 37", case.clone(), "time", time.ms, "ms", paper.map(|p| p[0])));
            report.push(row("Figure 37", case.clone(), "RMS", error, "grey levels", paper.map(|p| p[1])));
            report.push(row("Figure 37", case, "RMS, denoised", smooth, "grey levels", None));
        }
        lines.push(line);
        kept.push((case, placed));
    }
    report.table(&["field", "nearest map", "three maps"].map(str::to_owned), &lines);
    // The smallest, the usual and the largest.
    let shown = if quick { vec![0, 1] } else { vec![0, 4, 5] };
    let counts: &[u32] = if quick { &[4, 16] } else { &[1, 4, 16, 64, 121, 256] };
    report
        .say("The same against rays per pixel (Figure 38), nearest map: milliseconds / RMS / RMS denoised.");
    let mut lines: Vec<Vec<String>> = counts.iter().map(|rays| vec![rays.to_string()]).collect();
    let (mut times, mut errors) = (Vec::new(), Vec::new());
    let mut header = vec!["rays per pixel".to_owned()];
    for (case, placed) in shown.into_iter().filter_map(|n| kept.get(n)) {
        header.push(case.clone());
        let mut curves = [Vec::new(), Vec::new()];
        for (&rays, line) in counts.iter().zip(&mut lines) {
            let settings = OcclusionSettings { rays, ..base };
            let (time, found) = placed.occlusion(timer, &floor, settings)?;
            let (_, smooth) =
                placed.occlusion(timer, &floor, OcclusionSettings { denoise: true, ..settings })?;
            let (error, smooth) = (rms(&found, &truth), rms(&smooth, &truth));
            line.push(format!("{} / {error:.3} / {smooth:.3}", ms(time.ms)));
            let case = format!("{case}, {rays} rays");
            report.push(row("Figure 38", case.clone(), "time", time.ms, "ms", None));
            report.push(row("Figure 38", case.clone(), "RMS", error, "grey levels", None));
            report.push(row("Figure 38", case, "RMS, denoised", smooth, "grey levels", None));
            curves[0].push((f64::from(rays), time.ms));
            curves[1].push((f64::from(rays), error));
        }
        let [time, error] = curves;
        times.push(Series { name: case.clone(), points: time });
        errors.push(Series { name: case.clone(), points: error });
    }
    report.table(&header, &lines);
    let plot = |y, series| Plot { title: model.title(), x: "rays per pixel", y, series };
    report.plot("rays-time", &plot("ms", times))?;
    report.plot("rays-error", &plot("grey levels", errors))
}
