//! Figure 4: what foliage leaves of the sun, beside rays that count every leaf.

use anyhow::Result;
use glam::{UVec2, Vec3};
use image::{Rgb, RgbImage};
use lumivox::slicemap::Slicing;
use lumivox_render::{GiMethod, Layer, LeafShadowSettings, Renderer, Settings, tone};
use lumivox_scene::{Camera, Light, Scene};

use super::leaves_truth::{Counted, counted};
use super::row;
use crate::bench::models::asset;
use crate::bench::report::Report;
use crate::bench::timing::Timer;
use crate::sheet;

/// Texels and columns a side of all maps.
const MAP: u32 = 1024;

fn settings(size: UVec2, leaves: Option<LeafShadowSettings>, layer: Layer) -> Settings {
    Settings {
        size,
        gi: GiMethod::Off,
        grid: 16,
        area_samples: 0,
        area_maps: 0,
        shadow_size: MAP,
        leaf_shadows: leaves,
        layer,
        ..Settings::default()
    }
}

struct Tree {
    name: &'static str,
    scene: Scene,
    camera: Camera,
    sun: Vec3,
}

fn trees(quick: bool, report: &mut Report) -> Result<Vec<Tree>> {
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
            Camera::look("", bounds.center() + away * Vec3::new(0.36, 0.07, 0.65), bounds.center(), 45.0);
        let camera = scene.cameras.first().cloned().unwrap_or(usual);
        trees.push(Tree { name, scene, camera, sun });
    };
    add("tree", lumivox_scene::builtin::tree(if quick { 0 } else { 2 }));
    if !quick && let Some(path) = asset("meshes/oak_tree.glb", report) {
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
                size: MAP,
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

/// A tree in a picture, and what of the sun arrives there.
struct Shot<'a> {
    timer: &'a Timer<'a>,
    tree: &'a Tree,
    size: UVec2,
}

impl Shot<'_> {
    fn renderer(&self, leaves: Option<LeafShadowSettings>, layer: Layer) -> Result<Renderer> {
        let mut renderer =
            Renderer::new(self.timer.gpu, &self.tree.scene, settings(self.size, leaves, layer))?;
        renderer.set_camera(&self.tree.camera);
        renderer.frame(None)?;
        Ok(renderer)
    }

    fn picture(&self, leaves: Option<LeafShadowSettings>, layer: Layer) -> Result<Vec<Vec3>> {
        Ok(self.renderer(leaves, layer)?.read_picture()?)
    }
}

pub(super) fn leaves(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Leaves beside rays");
    let size = if quick { UVec2::new(128, 96) } else { UVec2::new(256, 192) };
    let sigma = LeafShadowSettings::default().sigma;
    report.say(&format!(
        "The part of the sun that leaves leave at each pixel of {} x {} that faces the sun and that wood does not shade, sigma {sigma}, \
         maps of {MAP} x {MAP}: root mean square and mean of the difference from `(1 - sigma)^n`, with n counted by rays from the place \
         that the renderer's depth says. A shadow map knows all or nothing; *by rays* it is exact, and *rastered* it has texels and their \
         3 x 3 filter. *Rays in columns* count all leaves, but in the middle of the slicemap's columns: the error that is left without slices.",
        size.x, size.y
    ));
    let mut lines = Vec::new();
    for tree in trees(quick, report)? {
        let shot = Shot { timer, tree: &tree, size };
        let usual = LeafShadowSettings { size: MAP, ..Default::default() };
        // Leaves that take nothing: the sun, and the shadows of wood.
        let bare = shot.renderer(Some(LeafShadowSettings { sigma: 0.0, ..usual }), Layer::Direct)?;
        let places = bare.read_places()?;
        let bare = bare.read_picture()?;
        let most = bare.iter().map(|p| p.max_element()).fold(0.0, f32::max);
        let Counted { through, in_columns } =
            counted(&tree.scene, &tree.camera, tree.sun, (&places, size), MAP);
        let left = |n: u32| (1.0 - sigma).powi(n as i32);
        let is_lit = |n: usize| bare[n].max_element() > 0.01 * most;
        let expected: Vec<Option<f32>> =
            through.iter().enumerate().map(|(n, count)| count.filter(|_| is_lit(n)).map(left)).collect();
        let mut judge = |name: String, found: &[f32], report: &mut Report| {
            let pairs = || found.iter().zip(&expected).filter_map(|(f, e)| e.map(|e| f64::from(f - e)));
            let count = pairs().count().max(1) as f64;
            let rms = (pairs().map(|d| d * d).sum::<f64>() / count).sqrt();
            let bias = pairs().sum::<f64>() / count;
            let case = format!("{}: {name}", tree.name);
            lines.push(vec![case.clone(), format!("{rms:.3}"), format!("{bias:+.3}")]);
            report.push(row("leaves", case.clone(), "rms", rms, "", None));
            report.push(row("leaves", case, "mean", bias, "", None));
        };
        let exact: Vec<f32> = through.iter().map(|n| if *n == Some(0) { 1.0 } else { 0.0 }).collect();
        judge("shadow map, by rays".to_owned(), &exact, report);
        let mapped = shot.picture(None, Layer::Direct)?;
        let share = |(with, without): (&Vec3, &Vec3)| with.max_element() / without.max_element().max(1e-6);
        let rastered: Vec<f32> = mapped.iter().zip(&bare).map(share).collect();
        judge("shadow map, rastered".to_owned(), &rastered, report);
        let in_columns: Vec<f32> = in_columns.iter().map(|n| left(*n)).collect();
        judge("rays in columns".to_owned(), &in_columns, report);
        let mut shown = Vec::new();
        for (name, case) in cases(quick) {
            let red: Vec<f32> = shot.picture(Some(case), Layer::Transmittance)?.iter().map(|p| p.x).collect();
            judge(name, &red, report);
            if case.slices == 96 && case.slicing == Slicing::Local && !case.interpolates {
                shown = red;
            }
        }
        let by_rays: Vec<Vec3> = bare.iter().zip(&through).map(|(p, n)| *p * n.map_or(0.0, left)).collect();
        let exposure = tone::auto_exposure(&by_rays);
        let lit = |pixels: &[Vec3]| tiled(size, pixels.iter().map(|p| tone::tone_mapped(*p, exposure)));
        let grey = |v: f32| [(255.0 * v.clamp(0.0, 1.0)) as u8; 3];
        let only = |v: &[f32]| {
            tiled(size, v.iter().zip(&expected).map(|(v, e)| e.map_or([40, 40, 90], |_| grey(*v))))
        };
        let first = [
            ("shadow map", lit(&mapped)),
            ("slicemap", lit(&shot.picture(Some(usual), Layer::Direct)?)),
            ("by rays", lit(&by_rays)),
        ];
        let wanted: Vec<f32> = expected.iter().map(|e| e.unwrap_or(0.0)).collect();
        let second = [
            ("sun that is left", only(&rastered)),
            ("sun that is left", only(&shown)),
            ("sun that is left", only(&wanted)),
        ];
        let named = |tiles: [(&str, RgbImage); 3]| {
            tiles.map(|(title, picture)| ([tree.name.to_owned(), title.to_owned()], picture)).to_vec()
        };
        let what = "standard shadow map, slicemap and rays that count every leaf: the tree, and below the part of the sun that is left \
                    (blue: sky, turned away from the sun, or shaded by wood)";
        let pictures = sheet::captioned_sheet(&[named(first), named(second)]);
        report.picture(&format!("leaves-{}", tree.name), what, &pictures)?;
    }
    report.table(&["", "rms", "mean"].map(str::to_owned), &lines);
    report.say(
        "What is left of the error of many local slices is that of rays in columns: the edge of a leaf, or of a hole in it, that lies between a place and \
         the middle of its column; a shadow map has it too. Fewer slices are brighter, since leaves that share a cell count as one. Uniform \
         slices lie along the whole scene, where the crown has a part of them, so they are the brightest of their number.",
    );
    Ok(())
}

/// A picture of its pixels, row by row.
pub(super) fn tiled(size: UVec2, pixels: impl Iterator<Item = [u8; 3]>) -> RgbImage {
    let mut image = RgbImage::new(size.x, size.y);
    image.pixels_mut().zip(pixels).for_each(|(to, from)| *to = Rgb(from));
    image
}
