//! Rays against fields, beside the CPU's look-ups.

use libtest_mimic::Failed;
use lumivox::glam::{Affine3A, Mat4, Vec3};
use lumivox::gpu::{Buffer, Gpu, GpuError, read_buffer};
use lumivox::visibility::{
    Fields, HIT_BYTES, MAX_OBJECTS, Objects, Placement, QueryHit, QueryRay, RAY_BYTES, RayQuery,
};
use lumivox_field::{Field, Interpolation, Mapping, Ray, Settings, Storage};

use super::objects::{Soup, ball, ray, rotation};
use crate::support::{Random, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("visibility: look-ups are the CPU's, ray by ray", lookups),
    ("visibility: a transformed object equals a transformed query", transformed),
    ("visibility: the nearest of many objects counts, with its normal", nearest),
    ("visibility: fields that do not fit are refused", refused),
];

/// How far ahead a hit must lie within the sphere, in radii.
const BIAS: f32 = 0.05;
const RAYS: u32 = 20_000;

/// What rays of the world meet.
fn hits(
    gpu: &Gpu,
    fields: &Fields,
    objects: &Objects,
    rays: &[Ray],
    blended: bool,
) -> Result<Vec<QueryHit>, GpuError> {
    let packed: Vec<_> = rays
        .iter()
        .map(|r| QueryRay {
            origin: r.origin.extend(0.0).to_array(),
            direction: r.direction.extend(0.0).to_array(),
        })
        .collect();
    let input = Buffer::storage_with(gpu, "rays", &packed)?;
    let mut output = Buffer::storage(gpu, "hits", rays.len() as u64 * HIT_BYTES)?;
    assert_eq!(input.size(), rays.len() as u64 * RAY_BYTES);
    let query = RayQuery::new(gpu, rays.len() as u32, blended);
    query.update(gpu, objects, rays.len() as u32);
    run(gpu, |e| query.record(gpu, e, fields, objects, &input, &mut output))?;
    read_buffer(gpu, &output)
}

/// Whether the GPU's answer is the CPU's, for the ray itself, or for one beside it where a texel or a map ends within rounding.
fn agrees(hit: &QueryHit, ray: &Ray, lookup: impl Fn(&Ray) -> Option<f32>) -> [bool; 2] {
    let equal = |expected: Option<f32>| match expected {
        Some(distance) => hit.is_hit() && (hit.distance - distance).abs() < 1e-4 * (1.0 + distance),
        None => !hit.is_hit(),
    };
    if equal(lookup(ray)) {
        return [true, true];
    }
    let by = 2e-5 * ray.direction.length();
    let shifts = (0..27).map(|n| Vec3::new((n % 3) as f32, (n / 3 % 3) as f32, (n / 9) as f32) - 1.0);
    let beside = shifts.into_iter().any(|shift| {
        let turned = Ray::new(ray.origin, ray.direction + by * shift);
        let moved = Ray::new(ray.origin + by * shift, ray.direction);
        equal(lookup(&turned)) || equal(lookup(&moved))
    });
    [false, beside]
}

fn placed(gpu: &Gpu, field: &Field, world_from_object: Mat4) -> Result<(Fields, Objects), GpuError> {
    let packed = field.packed().expect("a field that fits");
    let fields = Fields::new(gpu, &[&packed])?;
    let mut objects = Objects::new(gpu, 1)?.with_bias(BIAS);
    objects.update(gpu, &fields, &[Placement::new(0, world_from_object, 0)])?;
    Ok((fields, objects))
}

fn lookups(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let ring = Soup::ring();
    let cases = [
        (1090, 64, Mapping::Concentric, Storage::Byte),
        (4226, 32, Mapping::Concentric, Storage::Float),
        (290, 64, Mapping::Concentric, Storage::Bit),
        (290, 32, Mapping::Uniform, Storage::Byte),
        (82, 32, Mapping::Rejection, Storage::Byte),
        (16642, 32, Mapping::Concentric, Storage::Bit),
    ];
    for (n, (points, directions, mapping, storage)) in cases.into_iter().enumerate() {
        let field = ring.baked(Settings { points, directions, mapping, storage, normals: false });
        let (fields, objects) = placed(gpu, &field, Mat4::IDENTITY)?;
        let sphere = field.sphere();
        let mut random = Random::new(100 + n as u64);
        let rays: Vec<_> = (0..RAYS).map(|_| ray(&mut random, sphere.center, sphere.radius)).collect();
        for (blended, interpolation) in [(false, Interpolation::Nearest), (true, Interpolation::Blended)] {
            let found = hits(gpu, &fields, &objects, &rays, blended)?;
            let lookup = |ray: &Ray| field.ahead(ray, BIAS * sphere.radius, interpolation);
            let (mut beside, mut wrong, mut met) = (0, 0, 0);
            for (hit, ray) in found.iter().zip(&rays) {
                let [same, close] = agrees(hit, ray, lookup);
                beside += i32::from(!same);
                wrong += i32::from(!close);
                met += i32::from(hit.is_hit());
            }
            eprintln!(
                "{points} {directions} {mapping:?} {storage:?} {interpolation:?}: {met} hits, {beside} beside, {wrong} wrong"
            );
            assert!(met > 4000, "{met} hits");
            // Texels end within rounding of a few rays in a thousand; nothing else may differ.
            assert!(beside < RAYS as i32 / 100 && wrong <= 2, "{beside} beside, {wrong} wrong");
        }
    }
    Ok(())
}

fn transformed(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let field = Soup::ring().baked(Settings { points: 1090, directions: 32, ..Settings::default() });
    let sphere = field.sphere();
    let mut random = Random::new(7);
    for stretch in [Vec3::ONE, Vec3::splat(4.0), Vec3::new(-1.0, 1.0, 1.0), Vec3::new(2.0, 0.5, 1.3)] {
        let turned = Affine3A::from_rotation_translation(rotation(&mut random), Vec3::new(5.0, 6.0, -7.0));
        let world_from_object = turned * Affine3A::from_scale(stretch);
        let (fields, objects) = placed(gpu, &field, Mat4::from(world_from_object))?;
        let home: Vec<_> = (0..RAYS).map(|_| ray(&mut random, sphere.center, sphere.radius)).collect();
        let rays: Vec<_> = home.iter().map(|ray| ray.transformed(&world_from_object)).collect();
        let found = hits(gpu, &fields, &objects, &rays, false)?;
        let lookup = |ray: &Ray| field.ahead(ray, BIAS * sphere.radius, Interpolation::Nearest);
        let checked: Vec<_> = found.iter().zip(&home).map(|(hit, ray)| agrees(hit, ray, lookup)).collect();
        let beside = checked.iter().filter(|[same, _]| !same).count();
        let wrong = checked.iter().filter(|[_, close]| !close).count();
        eprintln!("{stretch}: {beside} beside, {wrong} wrong of {RAYS}");
        assert!(beside < 400 && wrong <= 4, "{stretch}: {beside} beside, {wrong} wrong");
    }
    Ok(())
}

fn nearest(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let packed = ball().packed().expect("a field that fits");
    let fields = Fields::new(gpu, &[&packed])?;
    // More than one word of objects in a row along x, of which the ray meets the first.
    let mut objects = Objects::new(gpu, 40)?.with_bias(BIAS);
    let place = |n: u32| Mat4::from_translation(Vec3::new(3.0 * (40 - n) as f32, 0.0, 0.0));
    let all: Vec<_> = (0..40).map(|n| Placement::new(0, place(n), n)).collect();
    objects.update(gpu, &fields, &all)?;
    let rays: Vec<_> = (-9..=9)
        .map(|n| Ray::new(Vec3::new(0.0, 0.1 * n as f32, 0.0), Vec3::X))
        .chain([Ray::new(Vec3::ZERO, -Vec3::X), Ray::new(Vec3::new(200.0, 0.2, 0.0), -Vec3::X)])
        .collect();
    let found = hits(gpu, &fields, &objects, &rays, true)?;
    for (hit, ray) in found.iter().zip(&rays[..19]) {
        let y = ray.origin.y;
        let expected = 3.0 - (1.0 - y * y).sqrt();
        assert!((hit.distance - expected).abs() < 0.06 && hit.object == 39, "{hit:?} at {y}");
        let normal = Vec3::new(expected - 3.0, y, 0.0);
        let met = unfolded(hit.normal);
        assert!(met.angle_between(normal).to_degrees() < 6.0, "{met} for {normal}");
    }
    assert!(!found[19].is_hit());
    assert!(found[20].object == 0 && (found[20].distance - 79.0).abs() < 0.1, "{:?}", found[20]);
    // What has no volume is left out.
    let flat = Placement::new(0, Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0)), 0);
    objects.update(gpu, &fields, &[flat, all[39]])?;
    assert_eq!(objects.count(), 1);
    Ok(())
}

fn unfolded(flat: [f32; 2]) -> Vec3 {
    let [x, y] = flat;
    let z = 1.0 - x.abs() - y.abs();
    let (x, y) = if z >= 0.0 { (x, y) } else { ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)) };
    Vec3::new(x, y, z).normalize_or_zero()
}

fn refused(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let bake = |storage| {
        let settings = Settings { points: 82, directions: 32, storage, ..Settings::default() };
        Soup::ball(1.0).baked(settings).packed().expect("a field that fits")
    };
    let (byte, bit) = (bake(Storage::Byte), bake(Storage::Bit));
    assert!(Fields::new(gpu, &[]).is_err());
    assert!(Fields::new(gpu, &[&byte, &bit]).is_err());
    let mut damaged = vec![byte.clone(); 5];
    damaged[0].maps.bytes.pop();
    damaged[1].points.pop();
    damaged[2].maps.columns += 1;
    damaged[3].table_side += 1;
    damaged[4].radius = f32::NAN;
    for field in &damaged {
        assert!(Fields::new(gpu, &[field]).is_err());
    }
    let fields = Fields::new(gpu, &[&byte, &byte])?;
    let mut objects = Objects::new(gpu, 1)?.with_bias(BIAS);
    assert!(objects.update(gpu, &fields, &[Placement::new(2, Mat4::IDENTITY, 0)]).is_err());
    let twice = [Placement::new(0, Mat4::IDENTITY, 0); 2];
    assert!(objects.update(gpu, &fields, &twice).is_err());
    assert!(Objects::new(gpu, MAX_OBJECTS + 1).is_err());
    gpu.check()?;
    Ok(())
}
