//! 3.3: refraction for several materials, and thickness beside rays.

use anyhow::Result;
use glam::{Mat4, UVec2, Vec3};
use lumivox::core::View;
use lumivox::refraction::Glass;
use lumivox_render::{Environment, GiMethod, GlassSettings, Layer, Renderer, Settings, tone};
use lumivox_scene::{Camera, Material, Scene};

use super::leaves::tiled;
use super::rays::{Rays, inner_metres, ndc};
use super::row;
use super::table_1::sum;
use crate::bench::models::asset;
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;
use crate::{clock, sheet};

/// A scene with glass, and where it is seen from.
struct Subject {
    name: &'static str,
    scene: Scene,
    camera: Camera,
}

/// The knot, and the bunny with a lid under it in the knot's place.
fn subjects(quick: bool, report: &mut Report) -> Result<Vec<Subject>> {
    let knot = lumivox_scene::builtin::knot_glass(if quick { 1 } else { 3 });
    let camera = knot.cameras.first().cloned().unwrap_or(Camera::look("", Vec3::Z, Vec3::ZERO, 45.0));
    let mut subjects = Vec::new();
    if !quick && let Some(path) = asset("meshes/bunny.ply", report) {
        let mut loaded = lumivox_scene::load(&path.to_string_lossy())?;
        let bounds = loaded.bounds();
        let mut scene = knot.clone();
        if let (Some(mesh), Some(placed)) = (loaded.meshes.pop(), scene.instances.first_mut()) {
            let material = scene.meshes[placed.mesh].material;
            scene.meshes[placed.mesh] = lumivox_scene::Mesh { material, ..mesh };
            // The normals of its 69,451 faces, a pixel each, would be seen as noise.
            scene.meshes[placed.mesh].smooth();
            scene.meshes[placed.mesh].close_holes();
            let scale = 1.5 / bounds.size().max_element();
            let low = Vec3::new(bounds.center().x, bounds.min.y, bounds.center().z);
            placed.world_from_local = Mat4::from_translation(0.01 * Vec3::Y)
                * Mat4::from_scale(Vec3::splat(scale))
                * Mat4::from_translation(-low);
        }
        subjects.push(Subject { name: "bunny", scene, camera: camera.clone() });
    }
    subjects.insert(0, Subject { name: "knot", scene: knot, camera });
    Ok(subjects)
}

/// Materials with their names.
fn materials() -> [(&'static str, Glass); 4] {
    let clear = Glass { bend: 4.0, ..Glass::default() };
    [
        ("clear", clear),
        ("tinted", Glass { through: Vec3::new(0.15, 0.75, 0.45), ..clear }),
        ("frosted", Glass { frost: 0.5, through: Vec3::new(0.8, 0.9, 0.9), ..clear }),
        (
            "gas",
            Glass {
                ior: 1.0,
                gloss: 0.0,
                through: Vec3::splat(0.08),
                body: Vec3::new(0.5, 0.2, 0.9),
                ..clear
            },
        ),
    ]
}

fn settings(size: UVec2, glass: GlassSettings, layer: Layer) -> Settings {
    Settings {
        size,
        gi: GiMethod::Off,
        grid: 16,
        area_samples: 16,
        area_maps: 0,
        shadow_size: 1024,
        glass: Some(glass),
        layer,
        ..Settings::default()
    }
}

pub(super) fn glass(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let subjects = subjects(quick, report)?;
    rates(timer, &subjects, quick, report)?;
    thickness(timer, &subjects, quick, report)
}

fn rates(timer: &Timer<'_>, subjects: &[Subject], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Refraction");
    let size = if quick { UVec2::splat(128) } else { UVec2::splat(512) };
    report.say(&format!(
        "Milliseconds, and frames per second, of all stages of glass over a finished picture of {} x {}, 32 local slices: slicemap, nearest \
         surface, thickness, pyramid of the picture and shading. The paper: above 200 Hz at 512 x 512, without its model's name. *Paper's form* \
         looks into an environment alone.",
        size.x, size.y
    ));
    let mut lines = Vec::new();
    for subject in subjects {
        let mut rows = Vec::new();
        for uses_picture in [true, false] {
            let environment = if uses_picture { Environment::Sky } else { Environment::Studio };
            let glass = GlassSettings { uses_picture, environment, ..GlassSettings::default() };
            let mut renderer = Renderer::new(timer.gpu, &subject.scene, settings(size, glass, Layer::Final))?;
            renderer.set_camera(&subject.camera);
            renderer.frame(None)?;
            for (name, glass) in materials() {
                if !uses_picture && name != "clear" {
                    continue;
                }
                renderer.set_glass(0, glass);
                let mut times = Vec::new();
                for _ in 0..if quick { 1 } else { 3 } {
                    let stages = renderer.settle(0, Some(clock::millis))?.stages;
                    times.push(sum(&stages, &["refraction/glass"]));
                }
                times.sort_by(f64::total_cmp);
                let time = times[times.len() / 2];
                let form = if uses_picture { "" } else { ", paper's form" };
                let case = format!("{}: {name}{form}", subject.name);
                let hz = 1e3 / time;
                lines.push(vec![case.clone(), ms(time), format!("{hz:.1} (200)")]);
                report.push(row("refraction", case, "rate", hz, "Hz", Some(200.0)));
                let shown = renderer.read_picture()?;
                let picture = tiled(size, shown.iter().map(|p| tone::tone_mapped(*p, -1.0)));
                rows.push((name, image::imageops::thumbnail(&picture, 240, 240)));
            }
        }
        let (titles, pictures): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        let titles: Vec<&str> = titles.into_iter().take(4).chain(["environment alone"]).collect();
        let sheet = sheet::contact_sheet(&[(subject.name, pictures)], &titles);
        report.picture(
            &format!("glass-{}", subject.name),
            "clear, tinted, frosted, gas; clear in the paper's form",
            &sheet,
        )?;
    }
    report.table(&["", "ms", "Hz"].map(str::to_owned), &lines);
    Ok(())
}

/// The scene's glass without anything opaque, seen from its camera; and the metres that rays cross.
fn true_metres(subject: &Subject, size: UVec2) -> Vec<f64> {
    let Subject { scene, camera, .. } = subject;
    let aspect = size.x as f32 / size.y as f32;
    let view = View::perspective(camera.eye, camera.target, camera.up, camera.fov_y, aspect, 0.01, 50.0);
    let rays =
        Rays::new(scene, view, 256, |mesh| scene.materials[scene.meshes[mesh].material].glass.is_some());
    let slant = |hits: &[super::rays::Hit]| {
        hits.first().map_or(1.0, |hit| hit.world.distance(camera.eye.as_dvec3()) / hit.distance)
    };
    let pixels = (0..size.element_product()).map(|n| UVec2::new(n % size.x, n / size.x));
    pixels
        .map(|pixel| {
            let hits = rays.through(ndc(pixel, size));
            inner_metres(&hits) * slant(&hits)
        })
        .collect()
}

fn thickness(timer: &Timer<'_>, subjects: &[Subject], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Thickness beside rays");
    let size = if quick { UVec2::splat(96) } else { UVec2::splat(256) };
    report.say(&format!(
        "Metres of glass at each pixel of {} x {} beside those between fronts and backs that rays meet, over pixels with glass: root mean square and mean of \
         the difference, in millimetres, and how thick it is on average.",
        size.x, size.y
    ));
    let mut lines = Vec::new();
    for subject in subjects {
        let mut alone = subject.scene.clone();
        // Nothing that would cut it but a speck far away.
        for mesh in &mut alone.meshes {
            if alone.materials[mesh.material].glass.is_none() {
                mesh.indices.clear();
            }
        }
        alone.instances.retain(|i| !alone.meshes[i.mesh].indices.is_empty());
        alone.materials.push(Material::matte("speck", Vec3::ONE));
        let speck = lumivox_scene::Mesh::flat(
            "speck",
            vec![[0.0, -2.0, 0.0], [1e-4, -2.0, 0.0], [0.0, -2.0, 1e-4]],
            vec![[0, 1, 2]],
            alone.materials.len() - 1,
        );
        alone.meshes.push(speck);
        let mesh = alone.meshes.len() - 1;
        alone.instances.push(lumivox_scene::Instance { mesh, world_from_local: Mat4::IDENTITY });
        let truth = true_metres(subject, size);
        let mean = truth.iter().sum::<f64>() / truth.iter().filter(|t| **t > 0.0).count().max(1) as f64;
        let mut shown = Vec::new();
        for slices in if quick { vec![32] } else { vec![32, 96, 512] } {
            let glass = GlassSettings { slices, ..GlassSettings::default() };
            let mut renderer = Renderer::new(timer.gpu, &alone, settings(size, glass, Layer::Thickness))?;
            renderer.set_camera(&subject.camera);
            renderer.frame(None)?;
            let found: Vec<f64> = renderer.read_picture()?.iter().map(|p| f64::from(p.x)).collect();
            let pairs =
                || found.iter().zip(&truth).filter(|(f, t)| **t > 0.0 || **f > 0.0).map(|(f, t)| f - t);
            let count = pairs().count().max(1) as f64;
            let rms = (pairs().map(|d| d * d).sum::<f64>() / count).sqrt();
            let bias = pairs().sum::<f64>() / count;
            let case = format!("{}: {slices} slices", subject.name);
            lines.push(vec![
                case.clone(),
                format!("{:.1}", 1e3 * rms),
                format!("{:+.1}", 1e3 * bias),
                format!("{:.0}", 1e3 * mean),
            ]);
            report.push(row("thickness", case.clone(), "rms", 1e3 * rms, "mm", None));
            report.push(row("thickness", case, "mean", 1e3 * bias, "mm", None));
            if slices == 32 {
                shown = found;
            }
        }
        let most = truth.iter().copied().fold(1e-9, f64::max);
        let grey = |v: &f64| [(255.0 * (v / most).clamp(0.0, 1.0)) as u8; 3];
        let off = shown.iter().zip(&truth).map(|(s, t)| {
            let part = ((s - t) / (0.1 * most)).clamp(-1.0, 1.0);
            [(255.0 * part.max(0.0)) as u8, 0, (255.0 * (-part).max(0.0)) as u8]
        });
        let pictures =
            vec![tiled(size, shown.iter().map(grey)), tiled(size, truth.iter().map(grey)), tiled(size, off)];
        let titles = ["32 slices", "by rays", "difference x 10"];
        let sheet = sheet::contact_sheet(&[(subject.name, pictures)], &titles);
        report.picture(
            &format!("thickness-{}", subject.name),
            "thickness by 32 slices, by rays, and too much in red, too little in blue",
            &sheet,
        )?;
    }
    report.table(&["", "rms, mm", "mean, mm", "thickness, mm"].map(str::to_owned), &lines);
    Ok(())
}
