//! Three baked models in an atrium (Figure 41), beside the path tracer.

use anyhow::{Context, Result};
use glam::{Mat4, UVec2, Vec3};
use image::{Rgb, RgbImage};
use lumivox::gpu::Gpu;
use lumivox::visibility::{Combine, OcclusionSettings};
use lumivox_field::{Baker, Ray, Settings};
use lumivox_oracle::scene::{Light, Scene as OracleScene};
use lumivox_oracle::tracer::Tracer;
use lumivox_render::{GiMethod, Layer, Renderer};
use lumivox_scene::{Camera, Instance, Material, Scene, builtin};
use rayon::prelude::*;

use super::corner::rms;
use super::models::{self, Model};
use super::surface::{STRIDE, TRUE_RAYS, row};
use crate::bench::models::assets;
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;
use crate::compare::oracle_scene;
use crate::field::casters;
use crate::field::object::Object;
use crate::sheet::contact_sheet;
use crate::{clock, stats};

/// The papers' milliseconds a frame: 2.5 frames a second in three passes.
const FIGURE_41: f64 = 400.0;
/// Where they stand before the camera, to the right and ahead, and how they are turned.
const PLACES: [[f32; 3]; 3] = [[-1.5, 4.4, 0.5], [0.1, 5.6, 2.4], [1.6, 4.3, -0.6]];
/// Radius of each, metres.
const RADIUS: f32 = 0.95;

/// The hall, its camera, and the numbers of the instances that cast.
struct Hall {
    scene: Scene,
    camera: Camera,
    casters: Vec<usize>,
    names: Vec<String>,
}

impl Hall {
    /// The papers' atrium and models where they are at hand.
    fn new(quick: bool) -> Result<Self> {
        let path = assets().map(|folder| folder.join("scenes/sponza_dabrovic/sponza.glb"));
        let (mut scene, camera) = match path.filter(|path| path.is_file()) {
            Some(path) => {
                let scene = lumivox_scene::load(&path.to_string_lossy())?;
                let (eye, target) = (Vec3::new(-11.0, 1.9, 0.3), Vec3::new(-5.0, 0.85, 0.0));
                (scene, Camera::look("hall", eye, target, 52.0))
            }
            None => {
                let scene = builtin::atrium(1);
                let camera = scene.cameras.first().cloned().context("the built-in scene's camera")?;
                (scene, camera)
            }
        };
        let all = models::models(false)?;
        let wanted = |name: &str| all.iter().find(|m| m.name == name);
        let papers = [wanted("Bunny"), wanted("Cow"), wanted("Elephant")];
        let chosen: Vec<&Model> = if papers.iter().all(Option::is_some) {
            papers.into_iter().flatten().collect()
        } else {
            all.iter().take(3).collect()
        };
        let ground = Baker::new(Object::whole(&scene).mesh(), small())?;
        let forward = ((camera.target - camera.eye) * Vec3::new(1.0, 0.0, 1.0)).normalize_or(Vec3::X);
        let right = forward.cross(Vec3::Y);
        let mut casters = Vec::new();
        for (model, [aside, ahead, turned]) in chosen.iter().zip(PLACES) {
            let above = camera.eye + aside * right + ahead * forward;
            let down = Ray::new(above, Vec3::NEG_Y);
            let foot = ground.trace(&down).map_or(above, |distance| down.at(distance));
            let sphere = Baker::new(model.object.mesh(), small())?.sphere();
            let low = model.object.mesh().triangles.bounds().min.y;
            let from = Vec3::new(sphere.center.x, low, sphere.center.z);
            let world_from_local = Mat4::from_translation(foot)
                * Mat4::from_rotation_y(turned)
                * Mat4::from_scale(Vec3::splat(RADIUS / sphere.radius))
                * Mat4::from_translation(-from);
            scene.materials.push(Material::matte(model.name.clone(), Vec3::splat(0.75)));
            let mesh = model.object.scene_mesh(&format!("caster {}", model.name), scene.materials.len() - 1);
            casters.push(scene.instances.len());
            scene.instances.push(Instance { mesh: scene.meshes.len(), world_from_local });
            scene.meshes.push(mesh);
        }
        stats::warn_of_import(&scene);
        let names = chosen.iter().map(|m| if quick { m.name.clone() } else { m.title() }).collect();
        Ok(Self { scene, camera, casters, names })
    }

    /// What each pixel of a picture shows: point and normal.
    fn points(&self, size: UVec2) -> Result<Vec<Option<(Vec3, Vec3)>>> {
        let whole = Baker::new(Object::whole(&self.scene).mesh(), small())?;
        let Camera { eye, target, up, fov_y, .. } = self.camera;
        let forward = (target - eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(up).normalize_or(Vec3::X);
        let above = right.cross(forward);
        let half = (0.5 * fov_y).tan() / size.y as f32;
        let met = |n: u32| {
            let [x, y] = [n % size.x, n / size.x].map(|v| v as f32 + 0.5);
            let across = half * (2.0 * x - size.x as f32) * right;
            let ray = Ray::new(eye, forward + across + half * (size.y as f32 - 2.0 * y) * above);
            whole.trace_with_normal(&ray).map(|(distance, normal)| (ray.at(distance), normal))
        };
        Ok((0..size.x * size.y).into_par_iter().map(met).collect())
    }

    /// What the casters let through of the light from all around, by the path tracer.
    /// Of the pixels that are `kept`; those of the open sky let all through.
    fn truth(&self, points: &[Option<(Vec3, Vec3)>], samples: u32, kept: &[usize]) -> Result<Vec<f64>> {
        let alone = Scene {
            meshes: self.scene.meshes.clone(),
            materials: self.scene.materials.clone(),
            textures: self.scene.textures.clone(),
            instances: self.casters.iter().map(|&n| self.scene.instances[n]).collect(),
            ..Scene::default()
        };
        let lights = vec![Light::Constant { radiance: Vec3::ONE }];
        let oracle = OracleScene { lights, ..oracle_scene::oracle_scene(&alone) };
        let tracer = Tracer::new(&oracle)?;
        let at = |&n: &usize| {
            let Some((p, normal)) = points[n] else { return 1.0 };
            let light = tracer.irradiance(p, normal, Some(0), samples, n as u64);
            f64::from(light.direct.x) / std::f64::consts::PI
        };
        Ok(kept.par_iter().map(at).collect())
    }
}

/// Settings of bakers that are only asked for true rays.
fn small() -> Settings {
    Settings { points: 82, directions: 32, ..Settings::default() }
}

/// Occlusion of each pixel, the albedo, and milliseconds.
fn looked_up(
    gpu: &Gpu,
    hall: &Hall,
    size: UVec2,
    points: u32,
    occlusion: OcclusionSettings,
) -> Result<(Vec<f64>, Vec<Vec3>, f64)> {
    let settings = Settings { points, ..Settings::default() };
    let fields = casters::fields(&hall.scene, &["caster ".to_owned()], settings)?;
    let settings = lumivox_render::Settings {
        size,
        gi: GiMethod::Off,
        area_samples: 4,
        occlusion: Some(occlusion),
        layer: Layer::Occlusion,
        ..lumivox_render::Settings::default()
    };
    let mut renderer = Renderer::with_fields(gpu, &hall.scene, settings, &fields)?;
    renderer.set_camera(&hall.camera);
    renderer.frame(None)?;
    // The median of three.
    let mut times = Vec::new();
    for _ in 0..3 {
        let timed = renderer.frame(Some(clock::millis))?;
        let of_occlusion = timed.stages.iter().filter(|s| s.stage == "visibility/occlusion");
        times.push(of_occlusion.map(|s| s.millis).sum::<f64>());
    }
    times.sort_by(f64::total_cmp);
    let time = times[1];
    let found = renderer.read_picture()?.iter().map(|v| f64::from(v.x)).collect();
    renderer.set_layer(Layer::Albedo);
    renderer.settle(0, None)?;
    Ok((found, renderer.read_picture()?, time))
}

/// Figure 41.
pub(super) fn atrium(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Three models in an atrium (Figure 41)");
    let size = if quick { UVec2::new(160, 100) } else { UVec2::new(480, 300) };
    let points = if quick { 290 } else { 4226 };
    let hall = Hall::new(quick)?;
    let shown = hall.points(size)?;
    let all: Vec<usize> = (0..shown.len()).collect();
    let pictured = hall.truth(&shown, if quick { 16 } else { 64 }, &all)?;
    // Pixels of the open sky have nothing to compare.
    let is_chosen = |n: &usize| {
        let [x, y] = [*n as u32 % size.x, *n as u32 / size.x];
        x.is_multiple_of(STRIDE) && y.is_multiple_of(STRIDE) && shown[*n].is_some()
    };
    let chosen: Vec<usize> = all.into_iter().filter(is_chosen).collect();
    let truth = hall.truth(&shown, TRUE_RAYS, &chosen)?;
    let rays = if quick { 8 } else { 64 };
    let base = OcclusionSettings { rays, blended: true, ..OcclusionSettings::default() };
    report.say(&format!(
        "{} in the atrium, {} x {} pixels, {rays} rays each by three maps, denoised; {points} x 64 x 64 bytes each. Milliseconds of the occlusion, \
         and RMS error in grey levels of 255 of what the models let through, beside {TRUE_RAYS} paths of the path tracer \
         in every {STRIDE}th pixel along x and y. The \
         papers' frame of three passes took {FIGURE_41} ms.",
        hall.names.join(", "),
        size.x,
        size.y
    ));
    let cases = [
        ("nearest hit over all", base),
        ("each subtracted, as in the papers", OcclusionSettings { combine: Combine::Subtract, ..base }),
        ("nearest, less than 1 % of a hemisphere left out", OcclusionSettings { least_share: 0.01, ..base }),
    ];
    let (mut lines, mut pictures) = (Vec::new(), Vec::new());
    for (n, (name, settings)) in cases.into_iter().enumerate() {
        let (found, albedo, time) = looked_up(timer.gpu, &hall, size, points, settings)?;
        let error = rms(&chosen.iter().map(|&n| found[n]).collect::<Vec<_>>(), &truth);
        lines.push(vec![name.to_owned(), ms(time), format!("{error:.2}")]);
        report.push(row("Figure 41", name.to_owned(), "time", time, "ms", Some(FIGURE_41)));
        report.push(row("Figure 41", name.to_owned(), "RMS", error, "grey levels", None));
        if n == 0 {
            pictures.push(picture(size, &albedo, &found));
            pictures.push(picture(size, &albedo, &pictured));
            let apart: Vec<f64> =
                found.iter().zip(&pictured).map(|(a, b)| (5.0 * (a - b).abs()).min(1.0)).collect();
            pictures.push(picture(size, &vec![Vec3::ONE; apart.len()], &apart));
        }
    }
    report.table(&["casters", "ms", "RMS"].map(str::to_owned), &lines);
    let titles = ["look-ups", "path tracer", "apart, x 5"];
    report.picture("atrium", "Three models in an atrium", &contact_sheet(&[("Figure 41", pictures)], &titles))
}

fn picture(size: UVec2, albedo: &[Vec3], factor: &[f64]) -> RgbImage {
    RgbImage::from_fn(size.x, size.y, |x, y| {
        let n = (x + size.x * y) as usize;
        let color = albedo[n] * factor[n] as f32;
        Rgb(color.clamp(Vec3::ZERO, Vec3::ONE).powf(1.0 / 2.2).to_array().map(|v| (255.0 * v) as u8))
    })
}
