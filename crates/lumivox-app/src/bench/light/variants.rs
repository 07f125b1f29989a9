//! The other ways to do what the methods do: the text's mirrors and its constant albedo in propagation, and what holds light back in
//! light propagation volumes.

use anyhow::Result;
use lumivox::gpu::Gpu;
use lumivox::light::{LightSettings, Reflection};
use lumivox::lpv::Blocking;
use lumivox_render::{GiMethod, Settings};

use super::STEPS;
use super::errors::{self, HEADER, Sums};
use super::stage::Stage;
use crate::bench::report::Report;

const SCENES: [&str; 4] = ["test", "cornell", "room", "two rooms"];
const GRID: u32 = 32;

/// What is changed of a method's settings.
type Change = fn(Settings) -> Settings;

const VARIANTS: [(&str, GiMethod, Change); 7] = [
    ("lpv", GiMethod::Lpv, |s| s),
    ("lpv, blocking", GiMethod::Lpv, |s| Settings { lpv_blocking: Blocking::Fuzzy, ..s }),
    ("lpv, blocking and reflecting", GiMethod::Lpv, |s| Settings { lpv_blocking: Blocking::Reflecting, ..s }),
    ("propagation", GiMethod::Propagation, |s| s),
    ("propagation, axis mirror", GiMethod::Propagation, |s| Settings {
        reflection: Reflection::AxisMirror,
        ..s
    }),
    ("propagation, normal mirror", GiMethod::Propagation, |s| Settings {
        reflection: Reflection::NormalMirror,
        ..s
    }),
    ("propagation, albedo 0.5", GiMethod::Propagation, |s| Settings {
        light: LightSettings { bounce_albedo: Some(0.5), ..s.light },
        ..s
    }),
];

pub(super) fn run(gpu: &Gpu, stages: &[Stage], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Variants of propagation");
    report.say(&format!(
        "{GRID} cells. Blocking: a volume of surfaces that the camera and the lamps see, by which light propagation volumes hold light \
         back, and reflect it. Mirrors and the albedo after the first bounce are those of the dissertation (5.5.2, 5.6)."
    ));
    let mut lines = Vec::new();
    let mut sums = [Sums::default(); VARIANTS.len()];
    for stage in stages.iter().filter(|s| SCENES.contains(&s.case.name)) {
        for ((name, gi, change), sums) in VARIANTS.iter().zip(&mut sums) {
            if quick && *gi == GiMethod::Propagation {
                continue;
            }
            let found = stage.measure(gpu, change(stage.settings(*gi, GRID)), STEPS)?;
            lines.push(errors::line(stage, name, &found));
            errors::push(report, stage, GRID, name, &found);
            sums.add(&found);
        }
    }
    lines.extend(VARIANTS.iter().zip(sums).filter(|(_, s)| s.any()).map(|((name, ..), s)| s.line(name)));
    report.table(&HEADER.map(str::to_owned), &lines);
    Ok(())
}
