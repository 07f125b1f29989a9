//! Figure 4: what foliage leaves of the sun, beside rays that count every leaf.

use anyhow::Result;
use glam::{DVec2, UVec2, Vec3};
use image::{Rgb, RgbImage};
use lumivox::core::View;
use lumivox::slicemap::Slicing;
use lumivox_render::{GiMethod, Layer, LeafShadowSettings, Renderer, Settings, tone};
use lumivox_scene::{AlphaMode, Camera, Light, Scene};

use super::rays::{Rays, along, ndc};
use super::row;
use crate::bench::models::assets;
use crate::bench::report::Report;
use crate::bench::timing::Timer;
use crate::sheet;

/// A leaf is not its own shade, metres.
const OWN: f64 = 2e-3;

fn settings(size: UVec2, leaves: Option<LeafShadowSettings>, layer: Layer) -> Settings {
    Settings {
        size,
        gi: GiMethod::Off,
        grid: 16,
        area_samples: 0,
        area_maps: 0,
        shadow_size: 1024,
        leaf_shadows: leaves,
        layer,
        ..Settings::default()
    }
}

/// For each pixel the number of leaves between what it shows and the sun; none for the sky and for what wood shades.
fn true_counts(scene: &Scene, camera: &Camera, sun: Vec3, size: UVec2) -> Vec<Option<u32>> {
    let far = 2.0 * scene.bounds().size().length() + camera.eye.distance(camera.target);
    let aspect = size.x as f32 / size.y as f32;
    let view = View::perspective(camera.eye, camera.target, camera.up, camera.fov_y, aspect, 0.01, far);
    let seen = Rays::new(scene, view, 256, |_| true);
    let lit = Rays::new(scene, along(scene, sun), 1024, |_| true);
    let is_leaf = |mesh: usize| scene.materials[scene.meshes[mesh].material].alpha != AlphaMode::Opaque;
    let pixels = (0..size.element_product()).map(|n| UVec2::new(n % size.x, n / size.x));
    pixels
        .map(|pixel| {
            let first = *seen.through(ndc(pixel, size)).first()?;
            let (place, distance): (DVec2, f64) = lit.place(first.world);
            let hits = lit.through(place);
            let before = hits.iter().take_while(|h| h.distance < distance - OWN);
            let (leaves, opaque) = before.fold((0, 0), |(leaves, opaque), hit| {
                if is_leaf(hit.mesh) { (leaves + 1, opaque) } else { (leaves, opaque + 1) }
            });
            (opaque == 0).then_some(leaves)
        })
        .collect()
}

struct Tree {
    name: &'static str,
    scene: Scene,
    camera: Camera,
    sun: Vec3,
}

fn trees(quick: bool) -> Result<Vec<Tree>> {
    let mut trees = Vec::new();
    let mut add = |name, mut scene: Scene| {
        let light = scene.lights.iter().find_map(|l| match l {
            Light::Directional { direction, .. } => Some(*direction),
            _ => None,
        });
        let sun = light.unwrap_or(Vec3::new(0.5, -0.74, -0.45).normalize_or_zero());
        scene.lights = vec![Light::Directional { direction: sun, irradiance: Vec3::splat(4.0) }];
        let bounds = scene.bounds();
        let away = bounds.size().length();
        let usual =
            Camera::look("", bounds.center() + away * Vec3::new(0.5, 0.1, 0.9), bounds.center(), 45.0);
        let camera = scene.cameras.first().cloned().unwrap_or(usual);
        trees.push(Tree { name, scene, camera, sun });
    };
    add("tree", lumivox_scene::builtin::tree(if quick { 0 } else { 2 }));
    let oak = assets().map(|folder| folder.join("scenes/oak_tree.glb")).filter(|path| path.is_file());
    if let (Some(path), false) = (oak, quick) {
        add("oak", lumivox_scene::load(&path.to_string_lossy())?);
    }
    Ok(trees)
}

/// Cases with their names.
fn cases(quick: bool) -> Vec<(String, LeafShadowSettings)> {
    let sizes: &[u32] = if quick { &[96] } else { &[32, 96, 512] };
    let of = |slicing: Slicing, word: &str, interpolates: bool| -> Vec<(String, LeafShadowSettings)> {
        let case = |slices: &u32| {
            let settings = LeafShadowSettings {
                slices: *slices,
                slicing,
                interpolates,
                size: 1024,
                ..Default::default()
            };
            (format!("{word}, {slices}"), settings)
        };
        sizes.iter().map(case).collect()
    };
    let mut cases = of(Slicing::Local, "local", false);
    for (slicing, word, interpolates) in
        [(Slicing::Uniform, "uniform", false), (Slicing::Local, "local, linear", true)]
    {
        cases.extend(of(slicing, word, interpolates).into_iter().filter(|(_, case)| case.slices == 96));
    }
    cases
}

pub(super) fn leaves(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Leaves beside rays");
    let size = if quick { UVec2::new(128, 96) } else { UVec2::new(256, 192) };
    let sigma = LeafShadowSettings::default().sigma;
    report.say(&format!(
        "The part of the sun that leaves leave at each pixel of {size} that wood does not shade, sigma {sigma}, maps of 1024 x 1024: \
         root mean square and mean of the difference from `(1 - sigma)^n` with n counted by rays. A slicemap counts leaves that share \
         a cell of a column as one, so fewer slices are brighter; a standard shadow map knows all or nothing."
    ));
    let mut lines = Vec::new();
    for tree in trees(quick)? {
        let truth = true_counts(&tree.scene, &tree.camera, tree.sun, size);
        let expected: Vec<Option<f32>> =
            truth.iter().map(|n| n.map(|n| (1.0 - sigma).powi(n as i32))).collect();
        let mut judge = |name: String, found: &[f32], report: &mut Report| {
            let pairs = || found.iter().zip(&expected).filter_map(|(f, e)| e.map(|e| f64::from(f - e)));
            let count = pairs().count().max(1) as f64;
            let rms = (pairs().map(|d| d * d).sum::<f64>() / count).sqrt();
            let bias = pairs().sum::<f64>() / count;
            lines.push(vec![format!("{}: {name}", tree.name), format!("{rms:.3}"), format!("{bias:+.3}")]);
            let case = format!("{}: {name}", tree.name);
            report.push(row("leaves", case.clone(), "rms", rms, "", None));
            report.push(row("leaves", case, "mean", bias, "", None));
        };
        let standard: Vec<f32> = truth.iter().map(|n| if *n == Some(0) { 1.0 } else { 0.0 }).collect();
        judge("all or nothing, by rays".to_owned(), &standard, report);
        let picture = |leaves, layer| -> Result<Vec<Vec3>> {
            let mut renderer = Renderer::new(timer.gpu, &tree.scene, settings(size, leaves, layer))?;
            renderer.set_camera(&tree.camera);
            renderer.frame(None)?;
            Ok(renderer.read_picture()?)
        };
        let mut shown = Vec::new();
        for (name, case) in cases(quick) {
            let left = picture(Some(case), Layer::Transmittance)?;
            let red: Vec<f32> = left.iter().map(|p| p.x).collect();
            judge(name, &red, report);
            if case.slices == 96 && case.slicing == Slicing::Local && !case.interpolates {
                shown = red;
            }
        }
        let usual = LeafShadowSettings { size: 1024, ..Default::default() };
        let lit = |pixels: &[Vec3]| tiled(size, pixels.iter().map(|p| tone::tone_mapped(*p, 0.5)));
        let grey = |v: f32| [(255.0 * v.clamp(0.0, 1.0)) as u8; 3];
        let beside = vec![
            lit(&picture(None, Layer::Direct)?),
            lit(&picture(Some(usual), Layer::Direct)?),
            tiled(size, shown.iter().zip(&expected).map(|(s, e)| e.map_or([40, 40, 90], |_| grey(*s)))),
            tiled(size, expected.iter().map(|e| e.map_or([40, 40, 90], grey))),
        ];
        let titles = ["shadow map", "slicemap", "what leaves leave", "by rays"];
        let what = "standard shadow map; slicemap; what it leaves of the sun; the same by rays (blue: sky, or shaded by wood)";
        report.picture(
            &format!("leaves-{}", tree.name),
            what,
            &sheet::contact_sheet(&[(tree.name, beside)], &titles),
        )?;
    }
    report.table(&["", "rms", "mean"].map(str::to_owned), &lines);
    Ok(())
}

/// A picture of its pixels, row by row.
pub(super) fn tiled(size: UVec2, pixels: impl Iterator<Item = [u8; 3]>) -> RgbImage {
    let mut image = RgbImage::new(size.x, size.y);
    image.pixels_mut().zip(pixels).for_each(|(to, from)| *to = Rgb(from));
    image
}
