//! What the stencil counts where a pixel lies on the very edge of a volume.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{UVec2, Vec2, Vec3};
use lumivox::gpu::read_texture;
use lumivox::shadow_volumes::{CullSettings, ShadowVolumes, VolumeLight, VolumeSettings};

use super::compare;
use super::stage::{Stage, mask, things};
use crate::support::{Random, run};
use crate::voxelize::soups::{Soup, cuboid, sphere};
use crate::{Labs, Test};

pub(super) const TESTS: &[Test] = &[
    (
        "shadow volumes: no count is below 0 at outlines of many casters, and culled ones differ nowhere",
        outlines,
    ),
    ("shadow volumes: a lamp close to wide triangles, seen in parallel", wide_triangles),
];

const SIZE: UVec2 = UVec2::new(240, 160);
const BALLS: usize = 800;
/// Metres: so little that at outlines surfaces and caps lie less than a rounded corner apart.
const SMALL_BIAS: f32 = 3e-4;

/// Balls everywhere, and a plate that some of them are in the shadow of.
fn cloud() -> Vec<Soup> {
    let mut random = Random::new(17);
    let mut ball = || sphere(16.0 * (random.cube() - 0.5), 0.1 + 0.2 * random.unit(), 2);
    let mut soups: Vec<_> = (0..BALLS).map(|_| ball()).collect();
    soups.push(cuboid(Vec3::new(-9.0, 9.0, -9.0), Vec3::new(3.0, 9.2, 9.0)));
    soups
}

fn outlines(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut stage = Stage { soups: cloud(), view: super::views()[0], size: SIZE };
    let (topologies, meshes) = (stage.topologies(), stage.meshes(gpu)?);
    let topologies: Vec<_> = topologies.iter().collect();
    let meshes: Vec<_> = meshes.iter().collect();
    let settings = VolumeSettings { size: SIZE, bias: SMALL_BIAS, culling: None };
    let mut all = ShadowVolumes::new(gpu, &topologies, 1, settings)?;
    let culling = Some(CullSettings { map_size: 128, ..CullSettings::default() });
    let mut culled = ShadowVolumes::new(gpu, &topologies, 1, VolumeSettings { culling, ..settings })?;
    let (mut below, mut differing, mut dropped) = (Vec::new(), Vec::new(), 0);
    for n in 0..4u8 {
        let turn = 2.4 * f32::from(n);
        let eye = 22.0 * Vec3::new(turn.cos(), 0.3 * (3.0 * turn).sin(), turn.sin()).normalize_or_zero();
        let aside = eye.cross(Vec3::Y).normalize_or_zero();
        let lights = [
            VolumeLight::Directional { direction: -eye - 14.0 * aside - 40.0 * Vec3::Y },
            VolumeLight::Point { position: eye - 10.0 * aside },
        ];
        let perspective = View::perspective(eye, Vec3::ZERO, Vec3::Y, 0.9, 1.5, 0.1, 60.0);
        let parallel = View::orthographic(eye, Vec3::ZERO, Vec3::Y, Vec2::new(24.0, 16.0), 50.0);
        for view in [perspective, parallel.with_reversed_depth()] {
            stage.view = view;
            let depth = stage.depth(gpu, &stage.seen())?;
            for light in lights {
                let mut masks = Vec::new();
                for volumes in [&mut all, &mut culled] {
                    volumes.update(gpu, &view, &[(light, &super::culling::lit(&light))]);
                    run(gpu, |e| volumes.record(gpu, e, &depth, &meshes))?;
                    masks.push(mask(gpu, volumes)?);
                }
                let counts: Vec<u8> = read_texture(gpu, all.stencil())?;
                // No pixel here is behind as many casting triangles.
                below.extend((0..counts.len()).filter(|pixel| counts[*pixel] >= 128).map(|pixel| (n, pixel)));
                differing.extend(
                    (0..counts.len())
                        .filter(|pixel| masks[0][*pixel] != masks[1][*pixel])
                        .map(|pixel| (n, pixel)),
                );
                let drawn = culled.read_counts(gpu)?;
                dropped += drawn.casters - drawn.kept_casters;
            }
        }
    }
    eprintln!(
        "{} counts below 0, {} pixels differ, {dropped} casters left out",
        below.len(),
        differing.len()
    );
    assert!(below.is_empty(), "views and pixels of counts below 0: {below:?}");
    assert!(differing.is_empty(), "views and pixels that differ: {differing:?}");
    assert!(dropped > 200, "{dropped} casters left out");
    Ok(())
}

fn wide_triangles(labs: &Labs) -> Result<(), Failed> {
    // Each lamp shines into a corner of the floor, the way that the camera looks: no other corner lies that way.
    let mut shadowed = 0;
    for [x, z] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
        let corner = 7.7 * Vec3::new(x, 0.0, z);
        let eye = 5.0 * Vec3::Y - 0.9 * corner;
        let view = View::orthographic(eye, Vec3::ZERO, Vec3::Y, Vec2::new(15.0, 10.0), 40.0);
        let stage = Stage { soups: things(30, 6), view, size: super::SIZE };
        let position = corner + 1.5 * eye.normalize_or_zero();
        shadowed += compare(labs, &stage, &VolumeLight::Point { position })?;
    }
    assert!(shadowed > 500, "{shadowed}");
    Ok(())
}
