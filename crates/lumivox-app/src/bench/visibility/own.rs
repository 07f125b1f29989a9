//! Occlusion of objects by themselves, on the device (Figure 40).

use anyhow::Result;
use lumivox::visibility::OcclusionSettings;
use lumivox_field::Settings;

use super::corner::rms;
use super::models::Model;
use super::surface::{Placed, Surface, TRUE_RAYS, baker_of, row, side, sky_rays};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

/// Figure 40's elephant: milliseconds and million rays per second.
const ELEPHANT: [f64; 2] = [400.0, 60.5];
/// The papers' rays per pixel.
const RAYS: u32 = 121;

/// Figure 40.
pub(super) fn own(timer: &Timer<'_>, models: &[Model], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Objects that occlude themselves (Figure 40)");
    let side = side(quick) / 2;
    let rays = if quick { 16 } else { RAYS };
    report.say(&format!(
        "Each model alone in a picture of {side} x {side} pixels, {rays} rays from each pixel that shows it, none denoised; rays that start within \
         the sphere take the nearest map. RMS error in grey levels of 255 beside {TRUE_RAYS} true rays. In parentheses the papers' \
         elephant of 157,160 triangles."
    ));
    let settings = OcclusionSettings { rays, denoise: false, ..OcclusionSettings::default() };
    let points: &[u32] = if quick { &[1090] } else { &[1090, 4226, 16642] };
    let mut lines = Vec::new();
    for model in models {
        let baker = baker_of(model)?;
        let surface = Surface::own(timer.gpu, &baker, side)?;
        let truth = surface.truth(&baker, sky_rays(TRUE_RAYS));
        let sent = surface.shown() as f64 * f64::from(rays);
        for &points in points {
            let (_, field, _) = model.baked(Settings { points, directions: 64, ..Settings::default() })?;
            let (time, found) = Placed::new(timer.gpu, &[&field])?.occlusion(timer, &surface, settings)?;
            let (error, rate) = (rms(&found, &truth), sent / time.ms / 1e3);
            let paper = (model.name == "Elephant" && points == 16642).then_some(ELEPHANT);
            let beside = |n: usize| paper.map_or(String::new(), |paper| format!(" ({})", paper[n]));
            let case = format!("{}, {points} x 64 x 64", model.title());
            lines.push(vec![
                case.clone(),
                format!("{}{}", ms(time.ms), beside(0)),
                format!("{rate:.2}{}", beside(1)),
                format!("{error:.2}"),
            ]);
            report.push(row("Figure 40", case.clone(), "time", time.ms, "ms", paper.map(|p| p[0])));
            report.push(row("Figure 40", case.clone(), "look-ups, device", rate, "M/s", paper.map(|p| p[1])));
            report.push(row("Figure 40", case, "RMS", error, "grey levels", None));
        }
    }
    report.table(&["field", "ms", "million rays/s", "RMS"].map(str::to_owned), &lines);
    Ok(())
}
