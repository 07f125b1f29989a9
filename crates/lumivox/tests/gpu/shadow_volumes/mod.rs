//! Shadow volumes against shadow rays in double precision, and culled ones against all.

mod counts;
mod culling;
mod stage;

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{UVec2, Vec2, Vec3};
use lumivox::shadow_volumes::{ShadowVolumes, Topology, VolumeLight, VolumeSettings};

use crate::support::run;
use crate::{Labs, Test};
use stage::{BIAS, Stage, mask, reference, things};

pub(crate) fn tests() -> Vec<Test> {
    [TESTS, counts::TESTS, culling::TESTS].concat()
}

const TESTS: &[Test] = &[
    ("shadow volumes: shadows are those of rays", rays),
    ("shadow volumes: a camera in a shadow sees as any other", in_shadow),
    ("shadow volumes: a lamp inside of a closed box shines no farther", inside),
    ("shadow volumes: what does not fit is refused with numbers", refused),
];

const SIZE: UVec2 = UVec2::new(96, 64);

fn settings() -> VolumeSettings {
    VolumeSettings { size: SIZE, bias: BIAS, ..VolumeSettings::default() }
}

fn lights() -> [VolumeLight; 2] {
    [
        VolumeLight::Directional { direction: Vec3::new(0.5, -1.0, 0.3) },
        VolumeLight::Point { position: Vec3::new(-1.3, 6.2, 0.7) },
    ]
}

fn views() -> [View; 3] {
    let eye = Vec3::new(7.0, 5.0, 8.0);
    let near = View::perspective(eye, Vec3::ZERO, Vec3::Y, 0.9, 1.5, 0.5, 40.0);
    let low =
        View::perspective(Vec3::new(-6.0, 1.0, 2.0), Vec3::new(0.0, 0.5, 0.0), Vec3::Y, 1.3, 1.5, 0.05, 30.0);
    let parallel = View::orthographic(eye, Vec3::ZERO, Vec3::Y, Vec2::new(12.0, 8.0), 30.0);
    [near, low.with_reversed_depth(), parallel]
}

/// Compares the mask with rays, and returns how many pixels are in shadow.
fn compare(labs: &Labs, stage: &Stage, light: &VolumeLight) -> Result<u32, Failed> {
    let gpu = &labs.core.gpu;
    let (topologies, meshes) = (stage.topologies(), stage.meshes(gpu)?);
    let mut volumes = ShadowVolumes::new(gpu, &topologies.iter().collect::<Vec<_>>(), 1, settings())?;
    volumes.update(gpu, &stage.view, &[(*light, &[])]);
    let seen = stage.seen();
    let depth = stage.depth(gpu, &seen)?;
    run(gpu, |e| volumes.record(gpu, e, &depth, &meshes.iter().collect::<Vec<_>>()))?;
    let mask = mask(gpu, &volumes)?;
    let triangles = stage.triangles();
    let (mut unclear, mut shown, mut shadowed) = (0, 0, 0);
    for (n, seen) in seen.iter().enumerate() {
        let Some(seen) = seen else {
            assert!(mask[n], "nothing is in shadow");
            continue;
        };
        shown += 1;
        let Some(lit) = reference(&triangles, light, seen) else {
            unclear += 1;
            continue;
        };
        shadowed += u32::from(!lit);
        assert_eq!(mask[n], lit, "{light:?}, {:?}, pixel {n}: {}", stage.view, seen.point);
    }
    eprintln!("{shown} pixels, {shadowed} in shadow, {unclear} at edges");
    assert!(20 * unclear < shown, "{unclear} of {shown} pixels are at edges");
    Ok(shadowed)
}

fn rays(labs: &Labs) -> Result<(), Failed> {
    for (seed, view) in (1..).zip(views()) {
        for light in lights() {
            let stage = Stage { soups: things(seed, 16), view, size: SIZE };
            let shadowed = compare(labs, &stage, &light)?;
            assert!((300..4000).contains(&shadowed), "{shadowed}");
        }
    }
    Ok(())
}

fn in_shadow(labs: &Labs) -> Result<(), Failed> {
    // Under a roof, with the eye in its shadow, and the floor's far part in the light.
    let mut soups = things(9, 12);
    let roof = crate::voxelize::soups::cuboid(Vec3::new(-8.0, 3.0, 0.0), Vec3::new(-2.0, 3.1, 6.0));
    soups.push(roof);
    let view =
        View::perspective(Vec3::new(-5.0, 1.5, 4.0), Vec3::new(6.0, 0.0, -3.0), Vec3::Y, 1.2, 1.5, 0.1, 40.0);
    let stage = Stage { soups, view, size: SIZE };
    for light in lights() {
        let shadowed = compare(labs, &stage, &light)?;
        assert!((500..5000).contains(&shadowed), "{shadowed}");
    }
    Ok(())
}

fn inside(labs: &Labs) -> Result<(), Failed> {
    let VolumeLight::Point { position } = lights()[1] else { return Ok(()) };
    let boxed = |size: Vec3| crate::voxelize::soups::cuboid(position - size, position + 0.8 * size);
    let ball = |at: Vec3, radius: f32| crate::voxelize::soups::sphere(at, radius, 2);
    // A box around the lamp alone; one around all, seen from within; and a ball, and one the corner of whose box holds the lamp.
    let cases = [
        (boxed(Vec3::splat(0.6)), views()[0], 2500),
        (boxed(Vec3::splat(16.0)), views()[1], 300),
        (ball(position, 1.0), views()[2], 2500),
        (ball(position - 0.65, 1.0), views()[0], 300),
    ];
    for (seed, (around, view, least)) in (40..).zip(cases) {
        let mut soups = things(seed, 12);
        soups.push(around);
        let stage = Stage { soups, view, size: SIZE };
        let shadowed = compare(labs, &stage, &VolumeLight::Point { position })?;
        assert!(shadowed > least, "{shadowed}");
    }
    Ok(())
}

fn refused(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let stage = Stage { soups: things(1, 2), view: views()[0], size: SIZE };
    let (topologies, meshes) = (stage.topologies(), stage.meshes(gpu)?);
    let mut volumes = ShadowVolumes::new(gpu, &topologies.iter().collect::<Vec<_>>(), 1, settings())?;
    let depth = stage.depth(gpu, &stage.seen())?;
    let one = run(gpu, |e| volumes.record(gpu, e, &depth, &[&meshes[0]]));
    assert!(one.is_err_and(|e| e.to_string().contains("3 meshes")));
    let nothing = ShadowVolumes::new(gpu, &[], 1, VolumeSettings { size: UVec2::new(0, 4), ..settings() });
    assert!(nothing.is_err_and(|e| e.to_string().contains("0 x 4")));
    // Nothing that casts, and a mesh without triangles, leave all in the light.
    let empty = Topology::default();
    let mut volumes = ShadowVolumes::new(gpu, &[&empty], 1, settings())?;
    volumes.update(gpu, &stage.view, &[(lights()[1], &[])]);
    run(gpu, |e| volumes.record(gpu, e, &depth, &[&meshes[0]]))?;
    assert!(mask(gpu, &volumes)?.iter().all(|lit| *lit));
    Ok(())
}
