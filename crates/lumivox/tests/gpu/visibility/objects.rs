//! Meshes, their fields, and random rays.

use std::f32::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::sync::OnceLock;

use lumivox::core::TriangleView;
use lumivox::glam::{Quat, Vec3};
use lumivox_field::{Baker, Field, Mesh, Ray, Settings};

use crate::support::Random;

/// Triangles of some shape.
pub(crate) struct Soup {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
}

impl Soup {
    /// A sheet that closes around itself.
    fn sheet(columns: u32, rows: u32, at: impl Fn(f32, f32) -> Vec3) -> Self {
        let corner = |i: u32, j: u32| at((i % columns) as f32 / columns as f32, j as f32 / rows as f32);
        let mut positions: Vec<[f32; 3]> = Vec::new();
        let mut indices = Vec::new();
        for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
            let first = positions.len() as u32;
            let corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            positions.extend(corners.map(|p| p.to_array()));
            indices.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        Self { positions, indices }
    }

    /// A ball about the origin.
    pub(crate) fn ball(radius: f32) -> Self {
        Self::sheet(96, 48, |u, v| {
            let (polar, turn) = (v * PI, u * TAU);
            let around = if v == 1.0 { 0.0 } else { polar.sin() };
            radius * Vec3::new(around * turn.cos(), polar.cos(), around * turn.sin())
        })
    }

    /// A ring about Y off the origin, as thick as 0.35 of its radius 1.
    pub(crate) fn ring() -> Self {
        Self::sheet(96, 32, |u, v| {
            let (turn, tube) = (u * TAU, (v % 1.0) * TAU);
            let r = 1.0 + 0.35 * tube.cos();
            Vec3::new(3.0 + r * turn.cos(), 0.35 * tube.sin() - 1.0, 0.5 + r * turn.sin())
        })
    }

    /// Two balls above each other, of radius 1 about the origin and of 0.8 at 2.2, as one object.
    pub(crate) fn pair() -> Self {
        let (mut all, other) = (Self::ball(1.0), Self::ball(0.8));
        let first = all.positions.len() as u32;
        all.positions.extend(other.positions.iter().map(|[x, y, z]| [*x, y + 2.2, *z]));
        all.indices.extend(other.indices.iter().map(|t| t.map(|i| i + first)));
        all
    }

    pub(crate) fn baked(&self, settings: Settings) -> Field {
        let triangles = TriangleView { positions: &self.positions, indices: &self.indices };
        let baker = Baker::new(Mesh::new(triangles), settings).expect("a sound mesh");
        baker.bake(|_| ControlFlow::Continue(())).expect("a field")
    }
}

/// The field of a ball of radius 1, baked once.
pub(crate) fn ball() -> &'static Field {
    static BALL: OnceLock<Field> = OnceLock::new();
    BALL.get_or_init(|| Soup::ball(1.0).baked(Settings { normals: true, ..Settings::default() }))
}

pub(crate) fn direction(random: &mut Random) -> Vec3 {
    let (z, turn) = (2.0 * random.unit() - 1.0, TAU * random.unit());
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * turn.cos(), r * turn.sin(), z)
}

pub(crate) fn rotation(random: &mut Random) -> Quat {
    Quat::from_axis_angle(direction(random), TAU * random.unit())
}

/// A ray through a sphere, from outside of it or from within.
pub(crate) fn ray(random: &mut Random, center: Vec3, radius: f32) -> Ray {
    let (a, b) = (direction(random), direction(random));
    let way = (b - a).normalize_or(-a);
    if random.unit() < 0.5 {
        Ray::new(center + radius * (a - (0.5 + random.unit()) * way), 2.0 * way)
    } else {
        Ray::new(center + radius * random.unit().cbrt() * a, way)
    }
}
