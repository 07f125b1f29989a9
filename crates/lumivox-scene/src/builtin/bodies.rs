//! Closed solids for the built-in scenes. Each is watertight by itself, wound outwards and free of triangles without
//! area. `place` puts the solid's own axes into those of the mesh; it may scale, but not mirror.

use std::f32::consts::{PI, TAU};

use glam::{Mat3, Mat4, Vec2, Vec3};

use super::builder::Builder;

/// Neighbouring faces share a smooth normal where they bend by less than about 30 degrees.
const SMOOTH: f32 = 0.86;

impl Builder {
    /// Takes over the triangles of another builder; those without area are left out.
    pub(super) fn append(&mut self, place: Mat4, other: &Self) {
        let first = self.mesh.positions.len() as u32;
        let turn = Mat3::from_mat4(place).inverse().transpose();
        let m = &other.mesh;
        for (i, &p) in m.positions.iter().enumerate() {
            let normal = turn * Vec3::from(m.normals[i]);
            let [r, g, b, _] = m.colors[i];
            self.vertex(place.transform_point3(p.into()), normal, m.uvs[i].into(), Vec3::new(r, g, b));
        }
        let at = |i: u32| Vec3::from(m.positions[i as usize]);
        let solid = m.indices.iter().filter(|t| {
            let [a, b, c] = t.map(at);
            (b - a).cross(c - a).length() > 1e-10
        });
        self.mesh.indices.extend(solid.map(|t| t.map(|i| first + i)));
    }

    /// A body turned about the local Y, as [`Builder::lathe`]; the profile must start and end on the axis.
    pub(super) fn turned(&mut self, place: Mat4, profile: &[[f32; 2]], sides: u32, color: Vec3) {
        let profile: Vec<Vec2> = profile.iter().map(|&p| p.into()).collect();
        let mut body = Self::default();
        body.lathe(Vec3::ZERO, &profile, sides, color);
        self.append(place, &body);
    }

    /// A round bar along the local Y from 0 to `length`.
    pub(super) fn bar(&mut self, place: Mat4, radius: f32, length: f32, sides: u32, color: Vec3) {
        self.turned(place, &[[0.0, 0.0], [radius, 0.0], [radius, length], [0.0, length]], sides, color);
    }

    /// A ball of radius one about the local origin.
    pub(super) fn ball(&mut self, place: Mat4, sides: u32, color: Vec3) {
        let mut body = Self::default();
        body.sheet([sides, sides.div_ceil(2)], color, |s, t| {
            let (sin, cos) = (-s * TAU).sin_cos();
            let (ring, y) = (PI * t).sin_cos();
            // The last ring is one point, not almost one.
            let ring = if t == 1.0 { 0.0 } else { ring };
            let normal = Vec3::new(ring * cos, -y, ring * sin);
            (normal, normal)
        });
        self.append(place, &body);
    }

    /// A box with faces of `steps` x `steps` cells between two local corners.
    pub(super) fn brick(&mut self, place: Mat4, min: Vec3, max: Vec3, steps: u32, color: Vec3) {
        let mut body = Self::default();
        body.block(0.5 * (min + max), max - min, 0.0, steps, color);
        self.append(place, &body);
    }

    /// A convex outline in the local xy plane, counter-clockwise seen from +z, drawn out from z = 0 to `depth` in
    /// `steps` cells.
    pub(super) fn prism(&mut self, place: Mat4, outline: &[[f32; 2]], depth: f32, steps: u32, color: Vec3) {
        let mut body = Self::default();
        let at = |i: usize, z: f32| Vec2::from(outline[i % outline.len()]).extend(z);
        for (z, normal) in [(0.0, Vec3::NEG_Z), (depth, Vec3::Z)] {
            let corners: Vec<u32> =
                (0..outline.len()).map(|i| body.vertex(at(i, z), normal, Vec2::ZERO, color)).collect();
            corners[1..].windows(2).for_each(|pair| body.triangle([corners[0], pair[0], pair[1]]));
        }
        for i in 0..outline.len() {
            let (a, along) = (at(i, 0.0), at(i + 1, 0.0) - at(i, 0.0));
            body.grid(a, along, depth * Vec3::Z, [1, steps], color);
        }
        self.append(place, &body);
    }

    /// What lies between two lines of as many points in the local xy plane, drawn out from z = 0 to `depth` in `steps`
    /// cells: an arch, a vault, a track. Seen from +z, `outer` lies to the right of the way along `inner`. A `closed`
    /// band joins its last points with the first.
    pub(super) fn band(
        &mut self,
        place: Mat4,
        [inner, outer]: [&[Vec2]; 2],
        closed: bool,
        [depth, steps]: [f32; 2],
        color: Vec3,
    ) {
        let mut body = Self::default();
        let count = inner.len().min(outer.len());
        let pieces = if closed { count } else { count - 1 };
        for i in 0..pieces {
            let j = (i + 1) % count;
            let flat = [inner[i], outer[i], outer[j], inner[j]];
            body.quad(flat.map(|p| p.extend(depth)), [1, 1], color);
            let [a, b, c, d] = flat.map(|p| p.extend(0.0));
            body.quad([a, d, c, b], [1, 1], color);
            for (line, side) in [(inner, -1.0), (outer, 1.0)] {
                let normals = [0, 1].map(|end| side * line_normal(line, i, end, closed));
                body.sheet([1, steps as u32], color, |s, t| {
                    let p = line[i].lerp(line[j], s).extend(depth * t);
                    (p, normals[0].lerp(normals[1], s).extend(0.0))
                });
            }
        }
        if !closed {
            for (end, sign) in [(0, -1.0), (count - 1, 1.0)] {
                let across = (outer[end] - inner[end]).extend(0.0);
                let (u, v) = if sign > 0.0 { (across, Vec3::Z) } else { (-across, Vec3::Z) };
                let from = if sign > 0.0 { inner[end] } else { outer[end] }.extend(0.0);
                body.sheet([1, steps as u32], color, |s, t| (from + s * u + depth * t * v, v.cross(u)));
            }
        }
        self.append(place, &body);
    }
}

/// The normal, to the right of the way along, at one end of piece `i` of a line.
fn line_normal(line: &[Vec2], i: usize, end: usize, closed: bool) -> Vec2 {
    let count = line.len();
    let pieces = if closed { count } else { count - 1 };
    let way = |k: usize| (line[(k + 1) % count] - line[k]).normalize_or_zero();
    let right = |v: Vec2| Vec2::new(v.y, -v.x);
    let neighbour = match end {
        0 if i > 0 => Some(i - 1),
        0 => closed.then_some(count - 1),
        _ if i + 1 < pieces => Some(i + 1),
        _ => closed.then_some(0),
    };
    let joined = neighbour.map(way).filter(|n| n.dot(way(i)) > SMOOTH);
    right(way(i) + joined.unwrap_or_default()).normalize_or_zero()
}

/// Points of an arc about `middle`, `from` and `to` in radians, both ends included.
pub(super) fn arc(middle: Vec2, radius: f32, [from, to]: [f32; 2], pieces: u32) -> Vec<Vec2> {
    let angle = |i: u32| from + (to - from) * i as f32 / pieces as f32;
    (0..=pieces).map(|i| middle + radius * Vec2::from_angle(angle(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn every_solid_is_closed_and_has_its_volume() {
        let place = Mat4::from_rotation_x(0.3) * Mat4::from_translation(Vec3::new(0.2, 3.0, -1.0));
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let half = [arc(Vec2::ZERO, 1.0, [0.0, PI], 64), arc(Vec2::ZERO, 2.0, [0.0, PI], 64)];
        let ring: Vec<_> = half
            .iter()
            .map(|line| line.iter().copied().chain(line[1..64].iter().map(|p| -p)).collect::<Vec<_>>())
            .collect();
        type Make<'a> = &'a dyn Fn(&mut Builder);
        let solids: [(&str, f32, Make<'_>); 6] = [
            ("bar", PI, &|b| b.bar(place, 1.0, 1.0, 96, Vec3::ONE)),
            ("ball", 4.0 / 3.0 * PI, &|b| b.ball(place, 128, Vec3::ONE)),
            ("brick", 6.0, &|b| b.brick(place, Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0), 3, Vec3::ONE)),
            ("prism", 6.0, &|b| b.prism(place, &square, 3.0, 4, Vec3::ONE)),
            ("arch", 1.5 * PI * 5.0, &|b| b.band(place, [&half[0], &half[1]], false, [5.0, 3.0], Vec3::ONE)),
            ("ring", 3.0 * PI, &|b| b.band(place, [&ring[0], &ring[1]], true, [1.0, 2.0], Vec3::ONE)),
        ];
        for (name, expected, make) in solids {
            let mut b = Builder::default();
            make(&mut b);
            assert_eq!(checks::open_edges(&checks::mesh_triangles(&b.mesh)), 0, "{name}");
            let volume = checks::volume(&checks::mesh_triangles(&b.mesh));
            assert!((volume / expected - 1.0).abs() < 0.005, "{name}: {volume}, not {expected}");
        }
    }
}
