//! What it costs to bake: the whole command, from the start of the process to the field on disk.

use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use super::surface::row;
use crate::bench::models::assets;
use crate::bench::report::Report;
use crate::clock;

/// The papers' hours for a bunny of 39K triangles and a dragon of 255K.
const PAPER_HOURS: [f64; 2] = [0.28, 15.91];
/// Of which the best counts.
const TURNS: usize = 2;

/// `lumivox field` with its defaults, and without holding the field against true rays.
pub(super) fn baking(quick: bool, report: &mut Report) -> Result<()> {
    let Some(folder) = assets().filter(|_| !quick) else { return Ok(()) };
    report.head("Baking");
    report.say(&format!(
        "`lumivox field MESH -o FIELD.lvf` in a process of its own, from its start to its end: 4226 x 64 x 64 bytes, 17.3 million rays, and with the \
         defaults 100,000 true rays to tell the errors; the better of {TURNS} runs. The papers baked a bunny of 39K triangles in {} hours \
         and a dragon of 255K in {}.",
        PAPER_HOURS[0], PAPER_HOURS[1]
    ));
    let out = std::env::temp_dir().join(format!("lumivox-bench-{}", std::process::id()));
    std::fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    let mut lines = Vec::new();
    let models = [("Bunny", "bunny.ply", PAPER_HOURS[0]), ("Dragon", "dragon.ply", PAPER_HOURS[1])];
    for (name, file, hours) in models {
        let mesh = folder.join("meshes").join(file);
        if !mesh.is_file() {
            continue;
        }
        for (case, extra) in
            [("defaults", &[][..]), ("one sphere, no check", &["--spheres", "1", "--check", "0"][..])]
        {
            let mut best = f64::INFINITY;
            let mut rate = None;
            for _ in 0..TURNS {
                let (field, stats) = (out.join("field.lvf"), out.join("stats.json"));
                let begun = clock::millis();
                let status = Command::new(std::env::current_exe()?)
                    .arg("field")
                    .arg(&mesh)
                    .arg("-o")
                    .arg(&field)
                    .arg("--stats")
                    .arg(&stats)
                    .args(extra)
                    .stdout(Stdio::null())
                    .stderr(Stdio::null())
                    .status()?;
                let seconds = (clock::millis() - begun) / 1e3;
                ensure!(status.success(), "lumivox field {} failed", mesh.display());
                let told: serde_json::Value = serde_json::from_slice(&std::fs::read(&stats)?)?;
                if seconds < best {
                    best = seconds;
                    rate = told["million_rays_per_cpu_second"].as_f64();
                }
            }
            let title = format!("{name}, {case}");
            lines.push(vec![
                title.clone(),
                format!("{best:.1} ({:.0})", 3600.0 * hours),
                rate.map_or("-".to_owned(), |rate| format!("{rate:.2}")),
            ]);
            report.push(row("baking", title.clone(), "whole command", best, "s", Some(3600.0 * hours)));
            if let Some(rate) = rate {
                report.push(row("baking", title, "rays per CPU-second", rate, "M/s", None));
            }
        }
    }
    std::fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
    report.table(&["mesh", "whole command, s", "million rays a CPU-second"].map(str::to_owned), &lines);
    Ok(())
}
