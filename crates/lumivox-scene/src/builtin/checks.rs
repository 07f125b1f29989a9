//! What tests ask of the geometry of built-in scenes.

use std::collections::HashMap;

use glam::Vec3;

use crate::{Mesh, Scene};

pub(super) type Corners = [Vec3; 3];

/// The triangles of a mesh.
pub(super) fn mesh_triangles(mesh: &Mesh) -> Vec<Corners> {
    mesh.indices.iter().map(|t| t.map(|i| mesh.positions[i as usize].into())).collect()
}

/// The triangles of those instances whose mesh has a name that is `wanted`, in world space.
pub(super) fn world_triangles(scene: &Scene, wanted: impl Fn(&str) -> bool) -> Vec<Corners> {
    let instances = scene.instances.iter().filter(|i| wanted(&scene.meshes[i.mesh].name));
    instances
        .flat_map(|i| {
            let place = |p| i.world_from_local.transform_point3(p);
            mesh_triangles(&scene.meshes[i.mesh]).into_iter().map(move |t| t.map(place))
        })
        .collect()
}

/// How many edges lack their partner in the other direction; zero for closed solids. Points less than about a tenth
/// of a millimetre apart are one.
pub(super) fn open_edges(triangles: &[Corners]) -> usize {
    // Cells of half a millimetre; a point near a cell's side also asks the neighbour.
    let mut numbers: HashMap<[i64; 3], (u32, Vec3)> = HashMap::new();
    let mut number = |p: Vec3| {
        let cell = (p.as_dvec3() / 5e-4).floor().as_i64vec3().to_array();
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    let near = [cell[0] + dx, cell[1] + dy, cell[2] + dz];
                    if let Some((n, _)) = numbers.get(&near).filter(|(_, q)| q.distance(p) < 1e-4) {
                        return *n;
                    }
                }
            }
        }
        let next = numbers.len() as u32;
        numbers.insert(cell, (next, p));
        next
    };
    let mut balance: HashMap<[u32; 2], i64> = HashMap::new();
    for t in triangles {
        let [a, b, c] = t.map(&mut number);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *balance.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    balance.iter().filter(|([a, b], sum)| a != b && **sum != 0).count()
}

/// The volume that closed surfaces wound outwards enclose.
pub(super) fn volume(triangles: &[Corners]) -> f32 {
    let six = triangles.iter().map(|[a, b, c]| a.as_dvec3().dot(b.as_dvec3().cross(c.as_dvec3())));
    (six.sum::<f64>() / 6.0) as f32
}

/// Distance along the unit vector `way` to the first triangle hit.
pub(super) fn hit(triangles: &[Corners], from: Vec3, way: Vec3) -> Option<f32> {
    let distances = triangles.iter().filter_map(|t| hit_one(t, from, way));
    distances.min_by(f32::total_cmp)
}

fn hit_one([a, b, c]: &Corners, from: Vec3, way: Vec3) -> Option<f32> {
    let (u, v, s) = (*b - *a, *c - *a, from - *a);
    let p = way.cross(v);
    let det = u.dot(p);
    if det.abs() < 1e-12 {
        return None;
    }
    let q = s.cross(u);
    let (x, y, t) = (s.dot(p) / det, way.dot(q) / det, v.dot(q) / det);
    // A little over the edge counts: rays must not slip between neighbours.
    (x >= -1e-5 && y >= -1e-5 && x + y <= 1.0 + 1e-5 && t > 1e-5).then_some(t)
}

/// `count` directions spread evenly over the sphere.
pub(super) fn directions(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
        let ring = (1.0 - y * y).sqrt();
        Vec3::new(ring * cos, y, ring * sin)
    })
}
