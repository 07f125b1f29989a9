use super::*;
use crate::points::SpherePoints;

fn maps() -> impl Iterator<Item = Directions> {
    Mapping::ALL.into_iter().flat_map(|m| MAP_SIDES.map(|side| Directions::new(m, side).unwrap()))
}

fn texels(map: Directions) -> impl Iterator<Item = (u32, Vec3)> {
    (0..map.count()).filter_map(move |n| Some((n, map.direction(n % map.side(), n / map.side())?)))
}

#[test]
fn the_inverse_returns_every_direction_to_its_texel() {
    for map in maps() {
        for (n, d) in texels(map) {
            assert!((d.length() - 1.0).abs() < 1e-6 && d.z > 0.0, "{d} {map:?}");
            assert_eq!(map.texel(d), n, "{d} {map:?}");
        }
    }
}

#[test]
fn the_inverse_survives_the_frames_of_all_points() {
    for map in maps().filter(|m| m.side() < 128) {
        for (n, &p) in SpherePoints::new(290).unwrap().positions().iter().enumerate() {
            let frame = Frame::at(p);
            // Every fifth direction, another fifth for each point.
            for (texel, d) in texels(map).filter(|(t, _)| (*t as usize + n).is_multiple_of(5)) {
                let back = frame.local_from_object(frame.object_from_local(d));
                assert_eq!(map.texel(back), texel, "{d} at {p} {map:?}");
            }
        }
    }
}

#[test]
fn frames_are_orthonormal_and_look_inwards() {
    for &p in SpherePoints::new(1090).unwrap().positions() {
        let frame = Frame::at(p);
        assert!((frame.object_from_local(Vec3::Z) + p).length() < 1e-6);
        let (x, y) = (frame.object_from_local(Vec3::X), frame.object_from_local(Vec3::Y));
        assert!((x.cross(y) + p).length() < 1e-6 && (x.length() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn the_rejection_mapping_leaves_a_fifth_unused() {
    let map = Directions::new(Mapping::Rejection, 256).unwrap();
    let unused = 1.0 - texels(map).count() as f64 / 65536.0;
    assert!((unused - (1.0 - std::f64::consts::FRAC_PI_4)).abs() < 0.002, "{unused}");
    for mapping in [Mapping::Uniform, Mapping::Concentric] {
        assert_eq!(texels(Directions::new(mapping, 64).unwrap()).count(), 4096);
    }
}

#[test]
fn densities_are_those_of_the_mappings() {
    // The mean of cos(theta): 2/3 when the density goes with the cosine, 2/pi for even steps of the angle.
    // The rim of the rejection mapping is as ragged as its texels.
    for (mapping, expected, tolerance) in [
        (Mapping::Uniform, std::f64::consts::FRAC_2_PI, 2e-4),
        (Mapping::Rejection, 2.0 / 3.0, 2e-3),
        (Mapping::Concentric, 2.0 / 3.0, 5e-4),
    ] {
        let map = Directions::new(mapping, 128).unwrap();
        let mean = texels(map).map(|(_, d)| f64::from(d.z)).sum::<f64>() / texels(map).count() as f64;
        assert!((mean - expected).abs() < tolerance, "{mean} {mapping:?}");
    }
}

#[test]
fn any_direction_falls_in_a_texel_in_use_and_close() {
    for map in maps() {
        let side = map.side() as f32;
        for n in 0..20_000u32 {
            // A spiral from above the normal to a little below the horizon.
            let (z, turn) = (1.0 - 1.1 * n as f32 / 20_000.0, 2.4 * n as f32);
            let r = (1.0 - z * z).max(0.0).sqrt();
            let d = Vec3::new(r * turn.cos(), r * turn.sin(), z);
            let texel = map.texel(d);
            let centre = map.direction(texel % map.side(), texel / map.side()).expect("a texel in use");
            if z > 0.0 {
                // Malley's maps are even on the disk, the other one in angle.
                let apart = match map.mapping() {
                    Mapping::Uniform => centre.angle_between(d),
                    _ => centre.truncate().distance(d.truncate()),
                };
                assert!(apart < 4.0 / side, "{apart} {d} {map:?}");
            }
        }
        for d in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, -Vec3::Z, Vec3::new(0.0, f32::MIN_POSITIVE, -1.0)] {
            let texel = map.texel(d);
            assert!(map.direction(texel % map.side(), texel / map.side()).is_some(), "{d} {map:?}");
        }
    }
}

#[test]
fn the_concentric_map_keeps_neighbours_together() {
    let map = Directions::new(Mapping::Concentric, 64).unwrap();
    let at = |s: u32, t: u32| map.direction(s, t).unwrap().truncate();
    for t in 0..64 {
        for s in 0..63 {
            let step = 2.0 / 64.0;
            assert!(
                at(s, t).distance(at(s + 1, t)) < 1.5 * step && at(t, s).distance(at(t, s + 1)) < 1.5 * step
            );
        }
    }
}

#[test]
fn sides_and_names_are_checked() {
    for side in [0, 1, 31, 33, 96, 512, u32::MAX] {
        assert!(Directions::new(Mapping::Concentric, side).is_err());
    }
    for mapping in Mapping::ALL {
        assert_eq!(mapping.name().parse::<Mapping>().unwrap(), mapping);
    }
    let text = "polar".parse::<Mapping>().unwrap_err().to_string();
    assert_eq!(
        text,
        "the mapping of directions 'polar' is not supported; it must be one of uniform, rejection and concentric"
    );
}
