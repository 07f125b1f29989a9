use std::ops::ControlFlow;

use glam::{DVec3, Vec3};
use lumivox_core::TriangleView;

use super::*;
use crate::field::maps::from_octahedral;
use crate::shapes::{self, Shape};
use crate::{Distances, Mapping, Storage};

fn settings(points: u32, directions: u32, storage: Storage) -> Settings {
    Settings { points, directions, storage, ..Settings::default() }
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn baked(shape: &Shape, settings: Settings) -> Field {
    Baker::new(shape.mesh(), settings).unwrap().bake(go_on).unwrap()
}

/// Every sampled ray of a field, in the object's space, with what is stored: distance over 2 R, and where.
fn rays(field: &Field) -> impl Iterator<Item = (DVec3, DVec3, Option<f64>, usize)> {
    let map = field.directions();
    let side = map.side();
    let Sphere { center, radius } = field.sphere();
    let all = (0..field.points().count()).flat_map(move |p| (0..map.count()).map(move |t| (p, t)));
    all.filter_map(move |(point, texel)| {
        let position = field.points().positions()[point as usize];
        let direction = Frame::at(position).object_from_local(map.direction(texel % side, texel / side)?);
        let place = (point * map.count() + texel) as usize;
        let stored = match field.distances() {
            Distances::Byte(codes) => (codes[place] != 255).then(|| f64::from(codes[place]) / 254.0),
            Distances::Float(values) => (values[place] < 1.0).then_some(f64::from(values[place])),
            Distances::Bit { words, .. } => (words[place / 32] >> (place % 32) & 1 == 1).then_some(0.0),
        };
        let origin = center.as_dvec3() + f64::from(radius) * position.as_dvec3();
        Some((origin, direction.as_dvec3(), stored, place))
    })
}

/// A box by the closed form of its slabs, grown by `grow`.
fn slabs(min: DVec3, max: DVec3, grow: f64, origin: DVec3, direction: DVec3) -> Option<f64> {
    let (a, b) = ((min - grow - origin) / direction, (max + grow - origin) / direction);
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    (near <= far).then_some(near)
}

#[test]
fn every_sampled_ray_of_a_box_has_its_closed_form() {
    let (min, max) = (Vec3::new(-1.0, 2.0, 0.5), Vec3::new(2.0, 3.0, 2.5));
    let shape = shapes::cuboid(min, max);
    for mapping in Mapping::ALL {
        for (storage, step) in [(Storage::Byte, 0.5 / 254.0), (Storage::Float, 0.0)] {
            let field = baked(&shape, Settings { mapping, ..settings(290, 32, storage) });
            let Sphere { center, radius } = field.sphere();
            assert!((center - 0.5 * (min + max)).length() < 1e-6);
            assert!((radius - 0.5 * (max - min).length()).abs() < 3e-4);
            let (mut hits, mut misses, mut grazing) = (0, 0, 0);
            for (origin, direction, stored, place) in rays(&field) {
                let [inner, exact, outer] = [-1e-5, 0.0, 1e-5]
                    .map(|grow| slabs(min.as_dvec3(), max.as_dvec3(), grow, origin, direction));
                if inner.is_some() != outer.is_some() {
                    grazing += 1;
                } else if let (Some(exact), Some(stored)) = (exact, stored) {
                    hits += 1;
                    let off = (stored - exact / f64::from(2.0 * radius)).abs();
                    assert!(off <= step + 1e-5, "{off} at {place} {mapping:?} {storage:?}");
                } else {
                    misses += 1;
                    assert_eq!((exact, stored), (None, None), "{origin} {direction}");
                }
            }
            assert!(hits > 50_000 && misses > 50_000, "{hits} {misses}");
            assert!(grazing < 200, "{grazing}");
        }
    }
}

#[test]
fn every_sampled_ray_of_a_sphere_has_its_closed_form() {
    // Two specks keep the bounding sphere away from the ball.
    let speck = |x: f32| shapes::cuboid(Vec3::new(x - 1e-4, -1e-4, -1e-4), Vec3::new(x + 1e-4, 1e-4, 1e-4));
    let shape = shapes::sphere(0.5, 200).and(&speck(-1.0)).and(&speck(1.0));
    let field = baked(&shape, Settings { normals: true, ..settings(82, 64, Storage::Float) });
    let radius = f64::from(field.sphere().radius);
    assert!((radius - 1.0).abs() < 3e-4 && field.sphere().center.length() < 2e-4);
    let mut hits = 0;
    for (origin, direction, stored, place) in rays(&field) {
        let middle = -origin.dot(direction);
        let height = (origin + middle * direction).length();
        // Facets of 0.9 degrees lie up to 0.0001 below the ball, and grazing rays feel it most.
        if height < 0.49
            && let Some(stored) = stored.filter(|s| *s > 0.1)
        {
            hits += 1;
            let exact = middle - (0.25 - height * height).sqrt();
            let off = (stored * 2.0 * radius - exact).abs();
            assert!(off < 0.0006, "{off} at height {height}");
            let expected = (origin + exact * direction).normalize_or_zero().as_vec3();
            let normal = from_octahedral(field.octahedral_normals()[place]);
            assert!(normal.angle_between(expected).to_degrees() < 2.0, "{normal} {expected}");
        } else if height > 0.5 && stored.is_some() {
            let at = origin + stored.unwrap_or(0.0) * 2.0 * radius * direction;
            assert!(at.y.abs() < 2e-4 && at.z.abs() < 2e-4, "only the specks: {at}");
        }
    }
    assert!(hits > 50_000, "{hits}");
}

/// The nearest triangle by trying all, in double precision (Moeller and Trumbore).
fn nearest_of_all(shape: &Shape, origin: DVec3, direction: DVec3) -> Option<f64> {
    let corner = |i: u32| DVec3::from_array(shape.positions[i as usize].map(f64::from));
    let meets = shape.indices.iter().filter_map(|t| {
        let [a, b, c] = t.map(corner);
        let p = direction.cross(c - a);
        let determinant = p.dot(b - a);
        let u = p.dot(origin - a) / determinant;
        let q = (origin - a).cross(b - a);
        let v = q.dot(direction) / determinant;
        let t = q.dot(c - a) / determinant;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
    });
    meets.min_by(f64::total_cmp)
}

#[test]
fn sampled_rays_are_those_of_trying_all_triangles() {
    let shape = shapes::torus(1.0, 0.4, 12).and(&shapes::cuboid(Vec3::splat(-0.3), Vec3::splat(0.2)));
    for storage in [Storage::Byte, Storage::Float] {
        let field = baked(&shape, settings(82, 32, storage));
        let step = if storage == Storage::Byte { 0.5 / 254.0 } else { 0.0 };
        let diameter = f64::from(2.0 * field.sphere().radius);
        let (mut tried, mut grazing) = (0, 0);
        for (origin, direction, stored, _) in rays(&field).step_by(7) {
            let exact = nearest_of_all(&shape, origin, direction).map(|d| d / diameter);
            tried += 1;
            match (stored, exact) {
                (None, None) => {}
                (Some(stored), Some(exact)) if (stored - exact).abs() <= step + 1e-5 => {}
                // A silhouette within rounding of the ray: moving the ray by 1e-5 must change the verdict.
                _ => {
                    grazing += 1;
                    let around = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
                        [-1e-5, 1e-5].map(|by| nearest_of_all(&shape, origin + by * axis, direction))
                    });
                    let agrees = around.as_flattened().iter().any(|other| match (stored, other) {
                        (Some(s), Some(o)) => (s - o / diameter).abs() <= step + 1e-4,
                        (None, None) => true,
                        _ => false,
                    });
                    assert!(agrees, "{stored:?} {exact:?} {around:?}");
                }
            }
        }
        assert!(tried > 10_000 && grazing < 10, "{tried} {grazing}");
    }
}

#[test]
fn threads_change_nothing_and_bits_tell_what_bytes_tell() {
    let shape = shapes::torus(1.0, 0.4, 24);
    let baker =
        Baker::new(shape.mesh(), Settings { normals: true, ..settings(82, 32, Storage::Byte) }).unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| baker.bake(go_on).unwrap())
    };
    let one = on(1);
    assert_eq!(one, on(3));
    let bits = baked(&shape, settings(82, 32, Storage::Bit));
    let same = rays(&one).zip(rays(&bits)).all(|(a, b)| a.2.is_some() == b.2.is_some());
    assert!(same && rays(&bits).filter(|r| r.2.is_some()).count() > 10_000);
}

#[test]
fn a_bake_tells_how_far_it_is_and_stops_when_asked() {
    let baker = Baker::new(shapes::torus(1.0, 0.3, 8).mesh(), settings(290, 32, Storage::Byte)).unwrap();
    assert_eq!(baker.rays(), 290 * 1024);
    let mut told = Vec::new();
    baker
        .bake(|p| {
            told.push(p);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(told.iter().map(|p| p.maps_done).collect::<Vec<_>>(), [64, 128, 192, 256, 290]);
    assert_eq!(told[4], Progress { maps_done: 290, maps: 290, rays: baker.rays() });
    let stopped = baker.bake(|p| if p.maps_done > 100 { ControlFlow::Break(()) } else { go_on(p) });
    assert_eq!(stopped, Err(FieldError::Cancelled { done: 128, total: 290 }));
}

#[test]
fn scales_and_places_do_not_matter() {
    let shape = shapes::torus(1.0, 0.4, 10);
    let field = baked(&shape, settings(82, 32, Storage::Byte));
    // Powers of two keep every bit.
    for scale in [2f32.powi(90), 2f32.powi(-90), 0.25] {
        let other = baked(&shape.moved(|p| scale * p), settings(82, 32, Storage::Byte));
        assert_eq!(other.distances(), field.distances());
        assert_eq!(other.sphere().radius, scale * field.sphere().radius);
    }
}

#[test]
fn meshes_that_cannot_be_baked_are_refused_with_a_reason() {
    let good = shapes::torus(1.0, 0.4, 4);
    let reason = |positions: &[[f32; 3]], indices: &[[u32; 3]], normals: Option<&[[f32; 3]]>| {
        let mesh = Mesh { triangles: TriangleView { positions, indices }, normals };
        Baker::new(mesh, settings(82, 32, Storage::Byte)).map(drop).unwrap_err().to_string()
    };
    let p = &good.positions;
    let with = |place: usize, value: f32| {
        let mut positions = p.clone();
        positions[place][1] = value;
        positions
    };
    assert_eq!(reason(p, &[], None), "the mesh cannot be baked: it has no triangles");
    assert_eq!(reason(&p[..3], &[[0, 1, 3]], None), "the mesh cannot be baked: it uses vertex 3 of 3");
    for bad in [f32::NAN, f32::INFINITY] {
        let text = reason(&with(5, bad), &good.indices, None);
        assert_eq!(text, "the mesh cannot be baked: vertex 5 is not finite");
    }
    let text = reason(p, &good.indices, Some(&p[1..]));
    assert_eq!(
        text,
        format!("the mesh cannot be baked: it has {} vertices but {} normals", p.len(), p.len() - 1)
    );
    for positions in
        [vec![[3.0; 3]; 3], vec![[0.0; 3], [1e-33; 3], [0.0; 3]], vec![[3e38; 3], [-3e38; 3], [0.0; 3]]]
    {
        assert!(reason(&positions, &[[0, 1, 2]], None).contains("its radius is"));
    }
    // A vertex that no triangle uses may be anything.
    let mut loose = p.clone();
    loose.push([f32::NAN; 3]);
    let mesh = Mesh::new(TriangleView { positions: &loose, indices: &good.indices });
    assert!(Baker::new(mesh, settings(82, 32, Storage::Byte)).is_ok());
    let bad = [settings(80, 32, Storage::Byte), settings(82, 33, Storage::Byte)];
    assert!(
        bad.into_iter().all(|s| matches!(Baker::new(good.mesh(), s), Err(FieldError::Unsupported { .. })))
    );
}

#[test]
fn flat_thin_and_huge_meshes_are_baked() {
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let line = [[0.0; 3], [1.0; 3], [2.0; 3]];
    let far = [[1e6, 0.0, 0.0], [1e6 + 1.0, 0.0, 0.0], [1e6, 1.0, 0.0]];
    for (positions, hits) in [(flat, true), (line, false), (far, true)] {
        let shape = Shape { positions: positions.to_vec(), indices: vec![[0, 1, 2]] };
        let field = baked(&shape, settings(82, 32, Storage::Byte));
        assert_eq!(rays(&field).any(|r| r.2.is_some()), hits);
    }
}

#[test]
fn smooth_normals_are_interpolated_and_face_the_ray() {
    let shape = shapes::sphere(1.0, 12);
    let normals: Vec<_> = shape.positions.iter().map(|p| (-Vec3::from(*p)).to_array()).collect();
    let mesh = Mesh { normals: Some(&normals), ..shape.mesh() };
    let all = Settings { normals: true, ..settings(82, 32, Storage::Float) };
    let field = Baker::new(mesh, all).unwrap().bake(go_on).unwrap();
    for (origin, direction, stored, place) in rays(&field) {
        let Some(stored) = stored else { continue };
        let at = origin + stored * 2.0 * f64::from(field.sphere().radius) * direction;
        let normal = from_octahedral(field.octahedral_normals()[place]);
        let apart = normal.angle_between(at.normalize_or_zero().as_vec3()).to_degrees();
        assert!(apart < 3.0, "{apart}: facets of 15 degrees alone would be off by 7");
    }
}
