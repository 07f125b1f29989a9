use std::ops::ControlFlow;

use glam::Affine3A;

use super::*;
use crate::shapes::{self, Random, Shape};
use crate::{Baker, Settings, Sphere, Storage};

fn baker(shape: &Shape, points: u32, directions: u32, storage: Storage) -> Baker {
    let settings = Settings { points, directions, storage, ..Settings::default() };
    Baker::new(shape.mesh(), settings).unwrap()
}

fn baked(baker: &Baker) -> Field {
    baker.bake(|_| ControlFlow::Continue(())).unwrap()
}

/// A torus with a box through it, off centre.
fn object() -> Shape {
    let cuboid = shapes::cuboid(Vec3::new(-0.3, -0.6, -0.2), Vec3::new(0.1, 0.9, 0.3));
    shapes::torus(1.0, 0.35, 16).and(&cuboid).moved(|p| p + Vec3::new(3.0, -1.0, 0.5))
}

/// The root mean square over lines through the sphere of the difference to the true distance over 2 R, a miss counting
/// as 1 (Algorithm 1), and the part of lines whose verdict is wrong.
fn error(baker: &Baker, lookup: impl Fn(&Ray) -> Option<f32>) -> [f64; 2] {
    let (sphere, mut random) = (baker.sphere(), Random(7));
    let lines = 40_000;
    let mut sums = [0.0; 2];
    for _ in 0..lines {
        let line = random.line(sphere.center, sphere.radius);
        let from_sphere = 2.0 * sphere.radius;
        // Distances from the ray's start, which is up to 1.5 R before the sphere.
        let value = |d: Option<f32>| d.map_or(1.0, |d| f64::from(d / from_sphere).min(2.0));
        let (found, exact) = (lookup(&line), baker.trace(&line));
        sums[0] += if found.is_some() == exact.is_some() { value(found) - value(exact) } else { 0.5 }.powi(2);
        sums[1] += f64::from(u8::from(found.is_some() != exact.is_some()));
    }
    [(sums[0] / f64::from(lines)).sqrt(), sums[1] / f64::from(lines)]
}

#[test]
fn errors_fall_with_points_and_with_directions() {
    let shape = object();
    let errors = |points, directions| {
        let baker = baker(&shape, points, directions, Storage::Byte);
        let field = baked(&baker);
        let nearest = error(&baker, |ray| field.nearest(ray));
        let blend = error(&baker, |ray| field.blend(ray).hit());
        println!("{points} x {directions}^2: nearest {nearest:.4?}, blend {blend:.4?}");
        [nearest, blend].concat()
    };
    let by_points = [82, 290, 1090, 4226].map(|points| errors(points, 64));
    let by_directions = [32, 64, 128].map(|directions| errors(1090, directions));
    for pair in by_points.windows(2).chain(by_directions.windows(2)) {
        assert!(pair[0].iter().zip(&pair[1]).all(|(coarse, fine)| fine < coarse), "{pair:?}");
    }
    // The points stand 7.2 times closer: wrong verdicts along silhouettes go with that, their root mean square with its
    // root.
    assert!(
        by_points[3][0] < 0.5 * by_points[0][0] && by_points[3][1] < 0.25 * by_points[0][1],
        "{by_points:?}"
    );
    // Three maps know more than one.
    assert!(by_points.iter().all(|e| e[2] < e[0]), "{by_points:?}");
}

#[test]
fn a_ray_along_a_sampled_one_has_its_distance() {
    let shape = object();
    for (storage, step) in [(Storage::Byte, 1.0 / 254.0), (Storage::Float, 1e-5)] {
        let baker = baker(&shape, 290, 32, storage);
        let field = baked(&baker);
        let Sphere { center, radius } = field.sphere();
        let (mut hits, mut grazing, map) = (0, 0, field.directions());
        for &p in field.points().positions() {
            for n in (0..map.count()).step_by(13) {
                let Some(local) = map.direction(n % 32, n / 32) else { continue };
                let direction = 2.5 * Frame::at(p).object_from_local(local);
                let ray = Ray::new(center + radius * p - direction, direction);
                let (found, exact) = (field.nearest(&ray), baker.trace(&ray));
                let close = |exact: Option<f32>| match (found, exact) {
                    (Some(found), Some(exact)) => (found - exact).abs() * 2.5 < step * 2.0 * radius,
                    (found, exact) => found == exact,
                };
                hits += i32::from(found.is_some());
                if !close(exact) {
                    // An edge within rounding of the ray: then a ray beside it agrees.
                    grazing += 1;
                    let beside = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| [-1e-6, 1e-6].map(|by| by * axis));
                    let moved = |by: &Vec3| baker.trace(&Ray::new(ray.origin + radius * *by, direction));
                    assert!(
                        beside.as_flattened().iter().any(|by| close(moved(by))),
                        "{found:?} {exact:?} {p}"
                    );
                }
            }
        }
        assert!(grazing < 20, "{grazing}");
        assert!(hits > 5_000, "{hits}");
    }
}

#[test]
fn a_transformed_object_equals_a_transformed_query() {
    let shape = object();
    let still = baker(&shape, 1090, 32, Storage::Float);
    let field = baked(&still);
    let mut random = Random(3);

    // Scaled by a power of two the moved object's own field answers with the same bits.
    let world_from_object = Affine3A::from_scale(Vec3::splat(4.0));
    let moved = baked(&baker(&shape.moved(|p| 4.0 * p), 1090, 32, Storage::Float));
    for _ in 0..5000 {
        let line = random.line(moved.sphere().center, moved.sphere().radius);
        let query = line.transformed(&world_from_object.inverse());
        assert_eq!(moved.nearest(&line), field.nearest(&query));
        assert_eq!(moved.blend(&line), field.blend(&query));
    }

    // Turned, mirrored, sheared or stretched, queries are as good in the world as in the object's space.
    let at_home = error(&still, |ray| field.nearest(ray));
    for stretch in [Vec3::ONE, Vec3::new(-1.0, 1.0, 1.0), Vec3::new(2.0, 0.5, 1.3)] {
        let turned = Affine3A::from_rotation_translation(random.rotation(), Vec3::new(5.0, 6.0, -7.0));
        let world_from_object = turned * Affine3A::from_scale(stretch);
        let object_from_world = world_from_object.inverse();
        let placed = shape.moved(|p| world_from_object.transform_point3(p));
        let placed = baker(&placed, 82, 32, Storage::Bit);
        let (mut apart, mut wrong, mut seen) = (0.0, 0, 0);
        for _ in 0..20_000 {
            let home = random.line(field.sphere().center, field.sphere().radius);
            let line = home.transformed(&world_from_object);
            let (found, exact) = (field.nearest(&line.transformed(&object_from_world)), placed.trace(&line));
            match (found, exact) {
                (Some(found), Some(exact)) => {
                    // In lengths of the direction, so in the object's metres.
                    apart += f64::from((found - exact) / (2.0 * field.sphere().radius)).powi(2);
                    seen += 1;
                }
                _ => wrong += i32::from(found.is_some() != exact.is_some()),
            }
        }
        let rms = (apart / f64::from(seen)).sqrt();
        assert!(
            rms < 1.3 * at_home[0] && f64::from(wrong) < 1.2 * 20_000.0 * at_home[1],
            "{rms} {wrong} {at_home:?}"
        );
        assert!(seen > 4000, "{seen}");
    }
}

#[test]
fn many_rays_have_the_distances_of_each() {
    let field = baked(&baker(&object(), 82, 32, Storage::Byte));
    let mut random = Random(9);
    let rays: Vec<_> =
        (0..1000).map(|_| random.line(field.sphere().center, 1.5 * field.sphere().radius)).collect();
    let each: Vec<_> = rays.iter().map(|ray| field.nearest(ray)).collect();
    for count in [0, 1, 31, 32, 33, 1000] {
        let mut many = vec![Some(-1.0); count];
        field.nearest_many(&rays, &mut many);
        assert_eq!(many, each[..count]);
        field.nearest_many(&rays[..count / 2], &mut many);
        assert_eq!(many, each[..count]);
    }
    assert!(each.iter().flatten().count() > 200);
}

#[test]
fn rays_that_pass_the_sphere_or_are_none_meet_nothing() {
    let field = baked(&baker(&object(), 82, 32, Storage::Byte));
    let Sphere { center, radius } = field.sphere();
    let outside = center + Vec3::new(0.0, 3.0 * radius, 0.0);
    for ray in [
        Ray::new(outside, Vec3::Y),
        Ray::new(outside, Vec3::X),
        Ray::new(outside, Vec3::ZERO),
        Ray::new(outside, Vec3::NAN),
        Ray::new(Vec3::NAN, Vec3::Y),
        Ray::new(Vec3::INFINITY, -Vec3::Y),
        Ray::new(outside, Vec3::splat(f32::INFINITY)),
    ] {
        assert_eq!(field.nearest(&ray), None, "{ray:?}");
        assert_eq!(field.blend(&ray), Blend { coverage: 0.0, distance: f32::INFINITY });
        assert!(!field.is_blocked(&ray, 0.0) && field.nearest_with_normal(&ray).is_none());
    }
    assert!(field.nearest(&Ray::new(outside, -Vec3::Y)).is_some());
    assert!(field.is_blocked(&Ray::new(outside, -Vec3::Y), 0.0));
}

#[test]
fn rays_from_the_object_itself_are_blocked_where_its_own_parts_stand_in_the_way() {
    // From a ball nothing is blocked outwards and everything inwards.
    let ball = shapes::sphere(1.0, 48);
    let speck = shapes::cuboid(Vec3::splat(1.2), Vec3::splat(1.21));
    let baker_of_ball = baker(&ball.and(&speck), 1090, 64, Storage::Byte);
    let field = baked(&baker_of_ball);
    let mut random = Random(11);
    let mut wrong = 0;
    for _ in 0..20_000 {
        let (p, d) = (random.direction(), random.direction());
        if p.dot(d).abs() > 0.5 && p.distance(Vec3::splat(0.6)) > 0.4 {
            let expected = p.dot(d) < 0.0;
            wrong += i32::from(field.is_blocked(&Ray::new(p, d), 0.15) != expected);
        }
    }
    assert!(wrong < 300, "{wrong} of 20000");

    // From a torus against true rays.
    let shape = shapes::torus(1.0, 0.35, 48);
    let baker = baker(&shape, 4226, 64, Storage::Byte);
    let field = baked(&baker);
    let (mut wrong, mut blocked) = (0, 0);
    for _ in 0..20_000 {
        let (turn, tube) = (std::f32::consts::TAU * random.unit(), std::f32::consts::TAU * random.unit());
        let outwards = Vec3::new(turn.cos() * tube.cos(), tube.sin(), turn.sin() * tube.cos());
        let p = Vec3::new(turn.cos(), 0.0, turn.sin()) + 0.37 * outwards;
        let d = (outwards + random.direction()).normalize_or(outwards);
        let expected = baker.trace(&Ray::new(p, d)).is_some();
        blocked += i32::from(expected);
        wrong += i32::from(field.is_blocked(&Ray::new(p, d), 0.08) != expected);
    }
    assert!(blocked > 1000 && wrong < 300, "{wrong} wrong, {blocked} blocked of 20000");
}

#[test]
fn one_bit_gives_the_verdict_of_a_byte_and_a_distance_close_to_it() {
    let shape = object();
    let byte = baked(&baker(&shape, 1090, 32, Storage::Byte));
    let bit = baked(&baker(&shape, 1090, 32, Storage::Bit));
    let (sphere, mut random) = (byte.sphere(), Random(5));
    let (mut apart, mut spread, mut hits, mut mean) = (0.0, 0.0, 0.0, 0.0);
    let mut all = Vec::new();
    for _ in 0..20_000 {
        let line = random.line(sphere.center, sphere.radius);
        let (a, b) = (byte.nearest(&line), bit.nearest(&line));
        assert_eq!(a.is_some(), b.is_some());
        if let (Some(a), Some(b)) = (a, b) {
            apart += f64::from(a - b).powi(2);
            hits += 1.0;
            mean += f64::from(a);
            all.push(f64::from(a));
        }
    }
    mean /= hits;
    all.iter().for_each(|a| spread += (a - mean).powi(2));
    // Better than one distance for all.
    assert!(apart < 0.5 * spread, "{} {}", (apart / hits).sqrt(), (spread / hits).sqrt());
}

#[test]
fn normals_come_with_the_distance() {
    let shape = shapes::sphere(1.0, 64);
    let settings = Settings { points: 1090, directions: 64, normals: true, ..Settings::default() };
    let field = baked(&Baker::new(shape.mesh(), settings).unwrap());
    let mut random = Random(2);
    for _ in 0..5000 {
        let line = random.line(Vec3::ZERO, 1.0);
        if let Some((distance, normal)) = field.nearest_with_normal(&line) {
            assert_eq!(field.nearest(&line), Some(distance));
            // The nearest of 1090 points lies up to 4.5 degrees away.
            let apart = normal.angle_between(line.at(distance)).to_degrees();
            assert!(apart < 12.0, "{apart}");
        }
    }
}

#[test]
fn one_field_serves_other_levels_of_detail() {
    let fine = baker(&shapes::torus(1.0, 0.35, 64), 1090, 64, Storage::Byte);
    let coarse = baker(&shapes::torus(1.0, 0.35, 16), 82, 32, Storage::Byte);
    let field = baked(&fine);
    let (own, other) = (error(&fine, |r| field.nearest(r)), error(&coarse, |r| field.nearest(r)));
    assert!(other[0] < 1.5 * own[0] && other[1] < 2.0 * own[1], "{own:?} {other:?}");
}

#[test]
fn rays_from_anywhere_meet_what_lies_ahead() {
    let shape = shapes::torus(1.0, 0.35, 48);
    let baker = baker(&shape, 4226, 64, Storage::Byte);
    let field = baked(&baker);
    let Sphere { center, radius } = field.sphere();
    let mut random = Random(13);
    // From outside it is the look-up that tests above hold to true rays.
    for _ in 0..5000 {
        let line = random.line(center, radius);
        assert_eq!(field.ahead(&line, 0.05, Interpolation::Nearest), field.nearest(&line));
        let blend = field.blend(&line).hit();
        let ahead = field.ahead(&line, 0.05, Interpolation::Blended);
        assert_eq!(ahead.is_some(), blend.is_some());
        assert!((ahead.unwrap_or(0.0) - blend.unwrap_or(0.0)).abs() < 1e-5);
    }
    // From free space within the sphere: two verdicts of a hundred may be wrong, and distances are too short for as few. Where
    // the torus stands behind the origin too, the far side of what lies ahead is found.
    for interpolation in [Interpolation::Nearest, Interpolation::Blended] {
        let (mut rays, mut hits, mut wrong, mut near, mut far) = (0, 0, 0, 0, 0);
        while rays < 20_000 {
            let (p, d) = (radius * random.unit().cbrt() * random.direction(), random.direction());
            let from_tube = Vec3::new(p.x, 0.0, p.z).normalize_or(Vec3::X).distance(p);
            if from_tube < 0.45 {
                continue;
            }
            let ray = Ray::new(center + p, d);
            let (found, exact) = (field.ahead(&ray, 0.08, interpolation), baker.trace(&ray));
            rays += 1;
            hits += i32::from(exact.is_some());
            wrong += i32::from(found.is_some() != exact.is_some());
            let apart = found.zip(exact).map_or(0.0, |(found, exact)| found - exact);
            near += i32::from(apart < -0.1 * radius);
            far += i32::from(apart > 0.1 * radius);
        }
        assert!(hits > 4000 && wrong < 400 && near < 100, "{wrong} {near} of {hits} hits");
        assert!(far < hits / 8, "{far} of {hits} hits");
    }
}
