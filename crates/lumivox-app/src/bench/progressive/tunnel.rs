//! Figures 6.11 and 78 (dissertation: 77 and 78) as light: a tank in a tunnel, its shadow on the wall, and what
//! views know of the lamps.

use anyhow::Result;
use glam::Vec3;
use lumivox_render::{Layer, Renderer, Settings, tone};
use lumivox_scene::{Camera, builtin};

use super::lighting::{Run, SOURCES, WARM_UP, compare, settings, size};
use crate::bench::report::{Report, Row};
use crate::bench::timing::Timer;
use crate::output::Picture;
use crate::sheet;

/// Seconds between frames, and of the tank's way to the camera.
const STEP: f32 = 0.25;
const WAY: f32 = 5.5;
/// Moments that pictures show.
const SHOWN: [f32; 4] = [1.0, 2.5, 3.5, 5.5];

/// The tank drives towards the camera.
pub(super) fn run(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let scene = builtin::tunnel(if quick { 0 } else { 1 });
    let Some(camera) = scene.cameras.first() else { return Ok(()) };
    report.head("Figures 77 and 78: light in the tunnel");
    let step = if quick { 4.0 * STEP } else { STEP };
    let times: Vec<f32> = (0..).map(|n| n as f32 * step).take_while(|t| *t <= WAY).collect();
    let nearest = |moment: f32| {
        let off = |n: &usize| (times[*n] - moment).abs();
        (0..times.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or_default()
    };
    let shown = SHOWN.map(nearest);
    let mut runs: Vec<Run> = Vec::new();
    let mut finals = Vec::new();
    for (name, voxels) in SOURCES {
        let mut renderer = Renderer::new(timer.gpu, &scene, Settings { voxels, ..settings(quick) })?;
        // Through the tunnel once, for its lamps hang behind the camera too, and a rest for all bounces.
        for camera in walk(camera).iter().chain(std::iter::repeat_n(camera, WARM_UP)) {
            renderer.set_pose(&scene.pose(0, 0.0));
            renderer.set_camera(camera);
            renderer.frame(None)?;
        }
        let (mut pictures, mut of_final) = (Vec::new(), Vec::new());
        for (n, seconds) in times.iter().enumerate() {
            renderer.set_pose(&scene.pose(0, *seconds));
            renderer.frame(None)?;
            pictures.push(renderer.read_picture()?);
            if shown.contains(&n) {
                renderer.set_layer(Layer::Final);
                renderer.frame(None)?;
                of_final.push(renderer.read_picture()?);
                renderer.set_layer(Layer::Indirect);
            }
        }
        runs.push(Run { name, pictures, off: Vec::new(), level: Vec::new() });
        finals.push(of_final);
    }
    compare(&mut runs);
    numbers(&runs, report);

    let of_indirect = runs.iter().map(|run| shown.map(|n| run.pictures[n].clone()).to_vec()).collect();
    let mut rows = Vec::new();
    for (layer, pictures) in [("indirect", of_indirect), ("final", finals)] {
        let pictures: Vec<Vec<Vec<Vec3>>> = pictures;
        let all: Vec<Vec3> = pictures.iter().flatten().flatten().copied().collect();
        let exposure_ev = tone::auto_exposure(&all);
        for (run, pictures) in runs.iter().zip(pictures) {
            let tile = |(n, pixels): (&usize, Vec<Vec3>)| {
                let size = size(quick);
                let picture = Picture { width: size.x, height: size.y, pixels };
                let off = match (run.name, layer) {
                    ("triangles", _) | (_, "final") => String::new(),
                    _ => format!(", {:.0} % off, mean {:.2}", 100.0 * run.off[*n], run.level[*n]),
                };
                let words = [format!("{layer}, {}", run.name), format!("{:.1} s{off}", times[*n])];
                (words, picture.srgb(Layer::Final, exposure_ev))
            };
            rows.push(shown.iter().zip(pictures).map(tile).collect());
        }
    }
    let what = "The tunnel while the tank comes: indirect light, then the whole picture, each of the voxels of each frame, of those that are kept, and of all \
                triangles. The lamp hangs ahead of the tank on the left, and throws its shadow on the right wall, over the blue stripe (whole pictures, 2.5 to \
                5.5 s). By each frame's voxels alone the near walls are too dark, since the crown lamps behind the camera are in none of its views; with \
                those that are kept they are as bright as with triangles, or a little brighter. In indirect light the tank darkens the road under it; what walls and \
                tank colour of each other is faint here";
    report.picture("tunnel-light", what, &sheet::captioned_sheet(&rows))
}

/// Away from where a camera stands, looking back to it and up, and to it again.
fn walk(last: &Camera) -> Vec<Camera> {
    let along = (last.target - last.eye).with_y(0.0);
    let looks = |part: f32, ahead: f32| {
        let eye = last.eye + part * along;
        Camera { eye, target: eye + ahead * along + 2.0 * Vec3::Y, ..last.clone() }
    };
    let parts = [0.2, 0.4, 0.6, 0.8];
    let (there, back) = (parts.map(|part| looks(part, -0.5)), parts.map(|part| looks(0.8 - part, 0.5)));
    [there, back].concat()
}

fn numbers(runs: &[Run], report: &mut Report) {
    let mut lines = Vec::new();
    for run in runs.iter().filter(|run| run.name != "triangles") {
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len().max(1) as f64;
        let most = run.off.iter().copied().fold(0.0, f64::max);
        let row = |metric: &str, value: f64| Row {
            figure: "light in the tunnel",
            case: "tunnel, drive".to_owned(),
            metric: format!("{metric}, {}", run.name),
            value,
            unit: "1",
            paper: None,
            note: format!("{} frames", run.off.len()),
        };
        report.push_frames(row("off", mean(&run.off)), &run.off);
        report.push_frames(row("level", mean(&run.level)), &run.level);
        report.push(row("off, most", most));
        let percent = |v: f64| format!("{:.1} %", 100.0 * v);
        lines.push(vec![
            run.name.to_owned(),
            percent(mean(&run.off)),
            percent(most),
            percent(mean(&run.level)),
        ]);
    }
    report.say(
        "Gathered light in the built-in tunnel while a tank drives towards the camera, a lamp ahead of it; the voxels of each frame alone, \
         those that are kept, and those of all triangles. Before, the camera has gone through the tunnel and back: lamps hang in the crown behind it too. *Off* is the mean difference of indirect light at the pixels, in parts of its mean with triangles; *level* is the mean of indirect light in parts of that of triangles.",
    );
    let header = ["voxels of", "off, mean", "off, most", "level, mean"];
    report.table(&header.map(str::to_owned), &lines);
}
