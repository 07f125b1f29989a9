//! What is left out of the drawing is never seen.

use std::f32::consts::FRAC_PI_2;

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{UVec2, Vec2, Vec3};
use lumivox::gpu::{Gpu, Texture};
use lumivox::shadow_volumes::{
    CullSettings, Reduction, ShadowVolumes, VolumeCounts, VolumeLight, VolumeSettings,
};
use lumivox::voxelize::Mesh;

use super::stage::{BIAS, Stage, mask, things};
use super::{lights, views};
use crate::support::run;
use crate::voxelize::soups::cuboid;
use crate::{Labs, Test};

pub(super) const TESTS: &[Test] = &[
    ("culled volumes: no pixel differs, by any rule", no_pixel_differs),
    ("culled volumes: no pixel differs, whatever stands where", many_seeds),
    ("culled volumes: both reductions keep the same, and finer rules keep less", rules),
    ("culled volumes: what is hidden from the light or the camera is left out", left_out),
    ("culled volumes: settings that do not fit are refused with numbers", refused),
];

const SIZE: UVec2 = UVec2::new(150, 100);

/// All that the light shines on here.
pub(super) fn lit(light: &VolumeLight) -> Vec<View> {
    match *light {
        VolumeLight::Directional { direction } => {
            let along = direction.normalize_or_zero();
            vec![View::orthographic_along(-20.0 * along, along, Vec3::X, Vec2::splat(24.0), 40.0)]
        }
        VolumeLight::Point { position } => [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z]
            .map(|axis| {
                let up = if axis.y == 0.0 { Vec3::Y } else { Vec3::Z };
                View::perspective_along(position, axis, up, FRAC_PI_2, 1.0, 0.01, 50.0)
            })
            .to_vec(),
    }
}

/// The stage's meshes on the device, with volumes by one rule.
struct Drawn {
    volumes: ShadowVolumes,
    meshes: Vec<Mesh>,
}

impl Drawn {
    fn new(gpu: &Gpu, stage: &Stage, culling: Option<CullSettings>) -> Result<Self, Failed> {
        let topologies = stage.topologies();
        let settings = VolumeSettings { size: SIZE, bias: BIAS, culling };
        let mut volumes = ShadowVolumes::new(gpu, &topologies.iter().collect::<Vec<_>>(), 1, settings)?;
        volumes.set_counting(gpu, true)?;
        Ok(Self { volumes, meshes: stage.meshes(gpu)? })
    }

    fn draw(
        &mut self,
        gpu: &Gpu,
        view: &View,
        light: &VolumeLight,
        depth: &Texture,
    ) -> Result<Shown, Failed> {
        let Self { volumes, meshes } = self;
        volumes.update(gpu, view, &[(*light, &lit(light))]);
        run(gpu, |e| volumes.record(gpu, e, depth, &meshes.iter().collect::<Vec<_>>()))?;
        let layers = volumes.read_layers(gpu)?;
        Ok(Shown {
            mask: mask(gpu, volumes)?,
            counts: volumes.read_counts(gpu)?,
            layers: layers.unwrap_or_default(),
        })
    }
}

struct Shown {
    mask: Vec<bool>,
    counts: VolumeCounts,
    layers: Vec<u128>,
}

fn differing(a: &[bool], b: &[bool]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

/// Small, so that texels are coarse and layers many.
const SMALL: CullSettings =
    CullSettings { layers: 40, map_size: 128, reduction: Reduction::Ideal, by_texel: true, by_pixel: true };

fn all_rules() -> Vec<CullSettings> {
    let mut rules = Vec::new();
    for reduction in [Reduction::Ideal, Reduction::Practical] {
        for (by_texel, by_pixel) in [(false, false), (true, false), (false, true), (true, true)] {
            rules.push(CullSettings { reduction, by_texel, by_pixel, ..SMALL });
        }
    }
    rules
}

/// Things on a floor, many of them under a roof.
fn roofed(seed: u64, count: u32) -> Stage {
    let mut soups = things(seed, count);
    soups.push(cuboid(Vec3::new(-8.0, 4.5, -8.0), Vec3::new(1.0, 4.7, 3.0)));
    Stage { soups, view: views()[0], size: SIZE }
}

fn no_pixel_differs(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut stage = roofed(3, 24);
    let mut cases = Vec::new();
    for view in views() {
        stage.view = view;
        let depth = stage.depth(gpu, &stage.seen())?;
        cases.extend(lights().map(|light| (view, light, depth.clone())));
    }
    let mut all = Drawn::new(gpu, &stage, None)?;
    let expected: Vec<_> = cases.iter().map(|(v, l, d)| all.draw(gpu, v, l, d)).collect::<Result<_, _>>()?;
    for rule in all_rules() {
        let mut culled = Drawn::new(gpu, &stage, Some(rule))?;
        let mut saved = 0;
        for ((view, light, depth), expected) in cases.iter().zip(&expected) {
            let shown = culled.draw(gpu, view, light, depth)?;
            let pixels = differing(&shown.mask, &expected.mask);
            assert_eq!(pixels, 0, "{rule:?}, {light:?}, {view:?}");
            let (own, whole) = (shown.counts, expected.counts);
            assert!(!own.is_too_long && own.all_sides == whole.sides && own.all_triangles == whole.triangles);
            assert!(whole.kept_sides == whole.sides && own.kept_sides < whole.sides, "{own:?}, {whole:?}");
            assert!(0 < own.kept_sides && own.kept_sides <= own.sides);
            assert!(own.fragments <= whole.fragments && own.updates <= whole.updates, "{own:?}, {whole:?}");
            saved += whole.fragments - own.fragments;
        }
        let whole: u32 = expected.iter().map(|e| e.counts.fragments).sum();
        eprintln!("{rule:?}: {saved} of {whole} fragments saved");
        assert!(10 * saved > whole, "{rule:?}: {saved} of {whole}");
    }
    Ok(())
}

fn many_seeds(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for seed in 20..24u64 {
        let mut stage = roofed(seed, 16);
        stage.view = views()[seed as usize % 3];
        let depth = stage.depth(gpu, &stage.seen())?;
        let settings =
            CullSettings { layers: 1 + 31 * (seed as u32 % 3), map_size: 64 << (seed % 4), ..SMALL };
        let (mut all, mut culled) =
            (Drawn::new(gpu, &stage, None)?, Drawn::new(gpu, &stage, Some(settings))?);
        for n in 0..4 {
            let turn = n as f32;
            let moved = Vec3::new(2.0 * turn.sin(), 0.5 * turn, 2.0 * turn.cos());
            let light = match lights()[n % 2] {
                VolumeLight::Directional { direction } => {
                    VolumeLight::Directional { direction: direction + 0.2 * moved }
                }
                VolumeLight::Point { position } => VolumeLight::Point { position: position + moved },
            };
            let expected = all.draw(gpu, &stage.view, &light, &depth)?;
            let shown = culled.draw(gpu, &stage.view, &light, &depth)?;
            assert_eq!(differing(&shown.mask, &expected.mask), 0, "seed {seed}, {settings:?}, {light:?}");
        }
    }
    Ok(())
}

fn rules(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let stage = roofed(5, 20);
    let depth = stage.depth(gpu, &stage.seen())?;
    let mut rules: Vec<_> = Vec::new();
    for rule in all_rules() {
        let mut drawn = Drawn::new(gpu, &stage, Some(rule))?;
        let of_light = |light| Ok(drawn.draw(gpu, &stage.view, &light, &depth)?.layers);
        rules.push(lights().map(of_light).into_iter().collect::<Result<Vec<_>, Failed>>()?);
    }
    let (ideal, practical) = rules.split_at(4);
    assert!(ideal == practical, "the reductions differ");
    let bits = |n: usize| ideal[n].iter().flatten().map(|layers| layers.count_ones()).sum::<u32>();
    eprintln!(
        "layers kept: {} by neither, {} by texel, {} by pixel, {} by both",
        bits(0),
        bits(1),
        bits(2),
        bits(3)
    );
    for (finer, coarser) in [(1, 0), (2, 0), (3, 1), (3, 2)] {
        let pairs = ideal[finer].iter().flatten().zip(ideal[coarser].iter().flatten());
        for (caster, (fine, coarse)) in pairs.enumerate() {
            assert_eq!(fine & !coarse, 0, "caster {caster}: {fine:x} of {coarse:x}");
        }
        assert!(bits(finer) < bits(coarser));
    }
    Ok(())
}

fn left_out(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // A floor; a plate over a box that shades nothing else; a box that shades the floor; and one that shades what the camera
    // does not see.
    let floor = cuboid(Vec3::new(-4.0, -0.2, -4.0), Vec3::new(4.0, 0.0, 4.0));
    let cube = |at: Vec3| cuboid(at - 0.3, at + 0.3);
    let plate = cuboid(Vec3::new(-3.0, 2.0, -1.0), Vec3::new(-1.0, 2.1, 1.0));
    let soups = vec![
        floor,
        plate,
        cube(Vec3::new(-2.0, 1.0, 0.0)),
        cube(Vec3::new(1.0, 1.0, 0.0)),
        cube(Vec3::new(7.0, 1.0, 0.0)),
    ];
    let view = View::perspective(Vec3::new(0.0, 4.0, 7.0), Vec3::ZERO, Vec3::Y, 0.8, 1.5, 0.1, 40.0);
    let stage = Stage { soups, view, size: SIZE };
    let depth = stage.depth(gpu, &stage.seen())?;
    let light = VolumeLight::Directional { direction: Vec3::NEG_Y };
    for reduction in [Reduction::Ideal, Reduction::Practical] {
        for by_texel in [false, true] {
            let rule = CullSettings { reduction, by_texel, ..SMALL };
            let shown = Drawn::new(gpu, &stage, Some(rule))?.draw(gpu, &view, &light, &depth)?;
            assert!(shown.layers[1] != 0 && shown.layers[3] != 0, "{:x?}", shown.layers);
            assert_eq!((shown.layers[2], shown.layers[4]), (0, 0), "{rule:?}");
            assert!(shown.counts.casters == 5 && shown.counts.kept_casters <= 3, "{:?}", shown.counts);
        }
    }
    Ok(())
}

fn refused(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for (layers, map_size) in [(0, 64), (129, 64), (8, 8), (8, 2048)] {
        let culling = Some(CullSettings { layers, map_size, ..SMALL });
        let settings = VolumeSettings { size: SIZE, bias: BIAS, culling };
        let refused = ShadowVolumes::new(gpu, &[], 1, settings);
        assert!(
            refused.is_err_and(|e| e.to_string().contains("1 to 128 and 16 to 1024")),
            "{layers}, {map_size}"
        );
    }
    Ok(())
}
