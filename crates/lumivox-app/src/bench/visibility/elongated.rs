//! An elongated object with one sphere and with several (Figure 48).

use anyhow::Result;
use lumivox::visibility::OcclusionSettings;
use lumivox_field::{Baker, Field, Settings, parts};

use super::corner::rms;
use super::models::cane;
use super::surface::{Placed, Surface, TRUE_RAYS, baker_of, row, side, sky_rays};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

/// Figure 48.
pub(super) fn elongated(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("An elongated object (Figure 48)");
    let model = cane();
    let baker = baker_of(&model)?;
    let floor = Surface::floor(timer.gpu, baker.sphere(), side(quick))?;
    let truth = floor.truth(&baker, sky_rays(TRUE_RAYS));
    report.say(&format!(
        "{}; 121 rays per pixel without denoising, one sphere with all maps, as in the papers, and as many with fewer each as pay, of eight at most: memory, \
         milliseconds, and RMS error in grey levels of 255 beside {TRUE_RAYS} true rays.",
        model.title()
    ));
    let settings = OcclusionSettings { rays: 121, denoise: false, ..OcclusionSettings::default() };
    let cases: &[(usize, u32, u32)] = if quick {
        &[(1, 290, 64), (4, 82, 64)]
    } else {
        &[(1, 4226, 64), (1, 16642, 64), (1, 4226, 128), (1, 16642, 128), (8, 1090, 64), (8, 1090, 128)]
    };
    let mut lines = Vec::new();
    for &(most, points, directions) in cases {
        let settings_of = Settings { points, directions, ..Settings::default() };
        let pieces = parts(&model.object.mesh(), most)?;
        let bake = |part: &lumivox_field::Part| -> Result<Field> {
            let baker = Baker::new(part.mesh(), settings_of)?;
            Ok(baker.bake(|_| std::ops::ControlFlow::Continue(()))?)
        };
        let fields = pieces.iter().map(bake).collect::<Result<Vec<_>>>()?;
        let placed = Placed::new(timer.gpu, &fields.iter().collect::<Vec<_>>())?;
        let (time, found) = placed.occlusion(timer, &floor, settings)?;
        let error = rms(&found, &truth);
        let mib = fields.iter().map(|f| f.bytes() as f64).sum::<f64>() / f64::from(1 << 20);
        let case = format!("{} of {points} x {directions} x {directions}", pieces.len());
        lines.push(vec![case.clone(), format!("{mib:.1}"), ms(time.ms), format!("{error:.3}")]);
        report.push(row("Figure 48", case.clone(), "time", time.ms, "ms", None));
        report.push(row("Figure 48", case.clone(), "memory", mib, "MiB", None));
        report.push(row("Figure 48", case, "RMS", error, "grey levels", None));
    }
    report.table(&["spheres", "MiB", "ms", "RMS"].map(str::to_owned), &lines);
    Ok(())
}
