use super::*;

/// Directions from a linear congruence, over the whole sphere and not even.
fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    let mut state = 12345u64;
    let mut unit = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    std::iter::repeat_with(move || Vec3::new(unit(), unit(), unit()).normalize_or(Vec3::X)).take(count)
}

#[test]
fn counts_are_those_of_the_subdivision_and_others_are_refused() {
    for (step, count) in POINT_COUNTS.into_iter().enumerate() {
        let m = 4 << step;
        assert_eq!(count, 2 * (2 * m * m + 2 * m + 1));
        let points = SpherePoints::new(count).unwrap();
        assert_eq!((points.count(), points.divisions()), (count, m));
        assert!(points.positions().iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
        let mut places: Vec<_> =
            points.positions().iter().map(|p| (*p + Vec3::ZERO).to_array().map(f32::to_bits)).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len() as u32, count - 4 * m, "only the equator occurs twice");
    }
    for count in [0, 80, 81, 83, 4225, u32::MAX] {
        assert!(matches!(SpherePoints::new(count), Err(FieldError::Unsupported { .. })), "{count}");
    }
}

#[test]
fn the_inverse_returns_every_sample_to_itself() {
    for count in POINT_COUNTS {
        let points = SpherePoints::new(count).unwrap();
        for (n, &p) in points.positions().iter().enumerate() {
            for length in [1.0, 1e-6, 1e6] {
                assert_eq!(points.nearest(p * length), n as u32, "{p} of {count}");
            }
            let around = points.surrounding(p);
            let at = around.points.iter().position(|&q| q == n as u32).expect("a corner");
            assert!(around.weights[at] > 0.999, "{around:?} around {n}");
        }
    }
}

#[test]
fn the_nearest_sample_is_that_of_trying_all_but_for_a_quarter_of_the_spacing() {
    for count in POINT_COUNTS {
        let points = SpherePoints::new(count).unwrap();
        let spacing = (4.0 * std::f32::consts::PI / count as f32).sqrt();
        let (mut most, mut other) = (0.0f32, 0);
        for d in directions(if count > 5000 { 1000 } else { 4000 }) {
            let best = points.positions().iter().map(|p| p.distance(d)).fold(f32::MAX, f32::min);
            let found = points.positions()[points.nearest(d) as usize].distance(d);
            most = most.max((found - best) / spacing);
            other += u32::from(found > best + 1e-6);
            // The nearest of the three around it is the nearest of all.
            let around = points.surrounding(d).points.map(|p| points.positions()[p as usize].distance(d));
            assert!(around.into_iter().fold(f32::MAX, f32::min) <= best + 1e-6, "{d} of {count}");
        }
        println!("{count} points: farther by up to {most:.3} spacings, at {other} directions");
        assert!(most < 0.25, "{most} of {count}");
    }
}

#[test]
fn a_direction_lies_within_its_surrounding_triangle() {
    for count in POINT_COUNTS {
        let points = SpherePoints::new(count).unwrap();
        let mut outside = 0.0f32;
        for d in directions(200_000) {
            let Surrounding { points: p, weights: w } = points.surrounding(d);
            let sum: Vec3 = (0..3).map(|n| w[n] * points.positions()[p[n] as usize]).sum();
            outside = outside.max((sum.normalize_or_zero() - d).length());
            assert!((w.iter().sum::<f32>() - 1.0).abs() < 1e-6 && w.iter().all(|w| *w >= 0.0));
        }
        assert!(outside < 1e-5, "{outside} of {count}");
    }
}

#[test]
fn directions_on_the_borders_of_octants_and_none_at_all_have_a_sample() {
    let points = SpherePoints::new(290).unwrap();
    for d in [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z] {
        assert_eq!(points.positions()[points.nearest(d) as usize], d);
    }
    for d in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::new(1.0, f32::NAN, f32::NEG_INFINITY)] {
        assert!(points.nearest(d) < 290);
        assert!(points.surrounding(d).points.iter().all(|&p| p < 290));
    }
}

#[test]
fn spacing_is_even_within_the_bounds_of_the_subdivision() {
    // Slater's points are only nearly uniform: the farthest any direction lies from a sample, against the angle of a
    // square cell of the mean size.
    for count in POINT_COUNTS {
        let points = SpherePoints::new(count).unwrap();
        let mean = (4.0 * std::f32::consts::PI / count as f32).sqrt();
        let farthest = directions(100_000)
            .map(|d| points.surrounding(d).points.map(|p| points.positions()[p as usize].distance(d)))
            .map(|three| three.into_iter().fold(f32::MAX, f32::min))
            .fold(0.0, f32::max);
        assert!(farthest < 1.05 * mean, "{} of {count}", farthest / mean);
    }
}
