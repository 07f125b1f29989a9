//! Shadow volumes (3.2): what culling and clamping save.

use std::f32::consts::FRAC_PI_2;

use anyhow::{Context, Result};
use glam::{UVec2, Vec2, Vec3};
use lumivox::core::View;
use lumivox::gpu::{Texture, read_texture};
use lumivox::shadow_volumes::{
    CullSettings, Reduction, ShadowVolumes, VolumeCounts, VolumeLight, VolumeSettings,
};

use super::row;
use super::yard::{Built, Yard};
use crate::bench::report::{Report, ms, thousands};
use crate::bench::timing::Timer;

const FIGURE: &str = "Shadow volumes";
/// Texels a side of a view of the light: a fifth of a metre of the yard each. Software drivers take a minute with twice as many.
const MAP: u32 = 256;
const QUICK_MAP: u32 = 128;

/// A light over the yard, and the camera.
struct Case {
    name: &'static str,
    light: VolumeLight,
    lit: Vec<View>,
    view: View,
}

/// All that one rule drew.
struct Drawn {
    mask: Vec<u16>,
    counts: VolumeCounts,
    ms: f64,
}

fn cases(half: f32, aspect: f32) -> Vec<Case> {
    let direction = Vec3::new(0.5, -1.0, 0.35).normalize_or_zero();
    let reach = 4.0 * half;
    let sunlit = View::orthographic_along(
        -0.5 * reach * direction,
        direction,
        Vec3::Z,
        Vec2::splat(3.2 * half),
        reach,
    );
    let position = Vec3::new(0.3 * half, 4.4, 0.1 * half);
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let lamplit = axes.map(|axis| {
        let up = if axis.y == 0.0 { Vec3::Y } else { Vec3::Z };
        View::perspective_along(position, axis, up, FRAC_PI_2, 1.0, 0.01, reach)
    });
    let look = |eye: Vec3, target: Vec3| {
        View::perspective(eye, target, Vec3::Y, 0.9, aspect, 0.1, 2.0 * reach).with_reversed_depth()
    };
    let above = look(Vec3::new(0.9 * half, 7.0, 0.9 * half), Vec3::ZERO);
    let within = look(Vec3::new(0.8 * half, 1.6, 0.2 * half), Vec3::new(-half, 0.8, -0.4 * half));
    let sun = VolumeLight::Directional { direction };
    let lamp = VolumeLight::Point { position };
    vec![
        Case { name: "sun, from above", light: sun, lit: vec![sunlit], view: above },
        Case { name: "sun, from among the posts", light: sun, lit: vec![sunlit], view: within },
        Case { name: "lamp, from above", light: lamp, lit: lamplit.to_vec(), view: above },
    ]
}

/// The rules that are compared, the plain one first.
fn rules(quick: bool) -> Vec<(&'static str, Option<CullSettings>)> {
    let (layers, map_size) = if quick { (16, QUICK_MAP) } else { (32, MAP) };
    let of = |reduction, by_texel, by_pixel| {
        Some(CullSettings { layers, map_size, reduction, by_texel, by_pixel })
    };
    vec![
        ("none", None),
        ("ideal", of(Reduction::Ideal, false, false)),
        ("practical", of(Reduction::Practical, false, false)),
        ("ideal, casters by pixel", of(Reduction::Ideal, true, false)),
        ("ideal, receivers by pixel", of(Reduction::Ideal, false, true)),
        ("ideal, both by pixel", of(Reduction::Ideal, true, true)),
        ("practical, both by pixel", of(Reduction::Practical, true, true)),
    ]
}

pub(super) fn volumes(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let size = if quick { UVec2::new(240, 136) } else { UVec2::new(960, 544) };
    let yard = Yard::new(if quick { 6 } else { 16 });
    report.head("Shadow volumes: culling and clamping");
    report.say(&format!(
        "A yard of {} casters ({} triangles: posts, balls over them, a wall, a roof over half of it) in a picture of {} x {}, {} layers, views of the \
         light of {} texels a side (a lamp has six). Quads are sides of volumes that are kept; draws of them are more, one for each run of layers that a side is kept in; filled pixels are \
         all fragments of sides and caps, counted one by one. *Differing pixels* compares the mask with that of all volumes. Milliseconds are of everything from \
         meshes and depth image to the mask.",
        yard.casters(),
        thousands(yard.triangles() as f64),
        size.x,
        size.y,
        if quick { 16 } else { 32 },
        if quick { QUICK_MAP } else { MAP },
    ));
    let built = yard.build(timer.gpu)?;
    for case in cases(yard.half, size.x as f32 / size.y as f32) {
        let depth = built.depth(timer.gpu, &case.view, size)?;
        table(timer, (&case, &depth, size), (&yard, &built), (report, quick))?;
        // Long runs are sometimes cut short.
        report.write()?;
    }
    Ok(())
}

fn table(
    timer: &Timer<'_>,
    (case, depth, size): (&Case, &Texture, UVec2),
    (yard, built): (&Yard, &Built),
    (report, quick): (&mut Report, bool),
) -> Result<()> {
    report.say(&format!("**{}**", case.name));
    let mut lines = Vec::new();
    let mut plain: Option<Drawn> = None;
    for (name, culling) in rules(quick) {
        let drawn = draw(timer, (case, depth, size), (yard, built), culling)?;
        let whole = plain.as_ref().unwrap_or(&drawn);
        let differing = drawn.mask.iter().zip(&whole.mask).filter(|(a, b)| a != b).count();
        let saved = |own: u32, whole: u32| 100.0 * (1.0 - f64::from(own) / f64::from(whole.max(1)));
        let (counts, all) = (drawn.counts, whole.counts);
        let values = [
            ("casters drawn", f64::from(counts.kept_casters), ""),
            ("quads", f64::from(counts.kept_sides), ""),
            ("quads saved", saved(counts.kept_sides, all.kept_sides), "%"),
            ("draws of quads", f64::from(counts.sides), ""),
            ("filled pixels", f64::from(counts.fragments), ""),
            ("filled pixels saved", saved(counts.fragments, all.fragments), "%"),
            ("differing pixels", differing as f64, ""),
            ("time", drawn.ms, "ms"),
        ];
        for (metric, value, unit) in values {
            report.push(row(FIGURE, format!("{}, {name}", case.name), metric, value, unit, None));
        }
        lines.push(vec![
            name.to_owned(),
            counts.kept_casters.to_string(),
            thousands(f64::from(counts.kept_sides)),
            format!("{:.1}", saved(counts.kept_sides, all.kept_sides)),
            thousands(f64::from(counts.sides)),
            thousands(f64::from(counts.fragments)),
            format!("{:.1}", saved(counts.fragments, all.fragments)),
            differing.to_string(),
            ms(drawn.ms),
        ]);
        plain.get_or_insert(drawn);
    }
    let header = [
        "culled by",
        "casters",
        "quads",
        "saved, %",
        "draws of quads",
        "filled pixels",
        "saved, %",
        "differing pixels",
        "ms",
    ];
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}

fn draw(
    timer: &Timer<'_>,
    (case, depth, size): (&Case, &Texture, UVec2),
    (yard, built): (&Yard, &Built),
    culling: Option<CullSettings>,
) -> Result<Drawn> {
    let gpu = timer.gpu;
    let topologies = yard.topologies();
    let settings = VolumeSettings { size, culling, ..VolumeSettings::default() };
    let mut volumes = ShadowVolumes::new(gpu, &topologies.iter().collect::<Vec<_>>(), 1, settings)?;
    volumes.update(gpu, &case.view, &[(case.light, &case.lit)]);
    let meshes: Vec<_> = built.meshes.iter().collect();
    let time = timer.median(|| timer.submit(|e| volumes.record(gpu, e, depth, &meshes)))?;
    volumes.set_counting(gpu, true)?;
    timer.submit(|e| volumes.record(gpu, e, depth, &meshes))?;
    let mask = read_texture(gpu, volumes.mask(0).context("the mask of the light")?)?;
    Ok(Drawn { mask, counts: volumes.read_counts(gpu)?, ms: time.ms })
}
