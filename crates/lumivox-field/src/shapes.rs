//! Meshes and random rays that the tests of this crate share.

use glam::{Quat, Vec3};
use lumivox_core::TriangleView;

use crate::{Mesh, Ray};

pub(crate) struct Shape {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) indices: Vec<[u32; 3]>,
}

impl Shape {
    pub(crate) fn mesh(&self) -> Mesh<'_> {
        Mesh::new(TriangleView { positions: &self.positions, indices: &self.indices })
    }

    fn new(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let positions: Vec<_> = triangles.into_iter().flatten().map(|p| p.to_array()).collect();
        let indices = (0..positions.len() as u32 / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        Self { positions, indices }
    }

    pub(crate) fn moved(&self, transform: impl Fn(Vec3) -> Vec3) -> Self {
        let positions = self.positions.iter().map(|p| transform(Vec3::from(*p)).to_array()).collect();
        Self { positions, indices: self.indices.clone() }
    }

    pub(crate) fn and(&self, other: &Self) -> Self {
        let shift = self.positions.len() as u32;
        let more = other.indices.iter().map(|t| t.map(|i| i + shift));
        Self {
            positions: [self.positions.as_slice(), &other.positions].concat(),
            indices: self.indices.iter().copied().chain(more).collect(),
        }
    }
}

/// A sphere of quads in `rings` rings around Y, as a grid of triangles.
pub(crate) fn sphere(radius: f32, rings: u32) -> Shape {
    surface(2 * rings, rings, |u, v| {
        let (polar, turn) = (v * std::f32::consts::PI, u * std::f32::consts::TAU);
        // The last row must meet in one pole.
        let around = if v == 1.0 { 0.0 } else { polar.sin() };
        radius * Vec3::new(around * turn.cos(), polar.cos(), around * turn.sin())
    })
}

/// A torus around Y.
pub(crate) fn torus(major: f32, minor: f32, rings: u32) -> Shape {
    surface(2 * rings, rings, |u, v| {
        let (turn, tube) = (u * std::f32::consts::TAU, (v % 1.0) * std::f32::consts::TAU);
        let r = major + minor * tube.cos();
        Vec3::new(r * turn.cos(), minor * tube.sin(), r * turn.sin())
    })
}

fn surface(columns: u32, rows: u32, at: impl Fn(f32, f32) -> Vec3) -> Shape {
    let corner = |i: u32, j: u32| at((i % columns) as f32 / columns as f32, j as f32 / rows as f32);
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    Shape::new(cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    }))
}

/// An axis-aligned box.
pub(crate) fn cuboid(min: Vec3, max: Vec3) -> Shape {
    let corner = |n: usize| {
        let pick = |axis: usize| if n >> axis & 1 == 0 { min[axis] } else { max[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Shape::new(faces.into_iter().flat_map(|face| {
        let [a, b, c, d] = face.map(corner);
        [[a, b, c], [a, c, d]]
    }))
}

/// Numbers from a linear congruence.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Even over the unit sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let (z, turn) = (2.0 * self.unit() - 1.0, std::f32::consts::TAU * self.unit());
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * turn.cos(), r * turn.sin(), z)
    }

    pub(crate) fn rotation(&mut self) -> Quat {
        Quat::from_axis_angle(self.direction(), std::f32::consts::TAU * self.unit())
    }

    /// A ray from outside a sphere through two points of it: even over all lines that meet it.
    pub(crate) fn line(&mut self, center: Vec3, radius: f32) -> Ray {
        let (a, b) = (self.direction(), self.direction());
        let direction = (b - a).normalize_or(-a);
        Ray::new(center + radius * (a - (0.5 + self.unit()) * direction), direction)
    }
}
