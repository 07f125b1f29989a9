//! Axis-aligned boxes.

use glam::{Mat4, Vec3};

/// An axis-aligned box in metres. An empty box has `min > max` on every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Corner with the smallest coordinates.
    pub min: Vec3,
    /// Corner with the largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box between two corners.
    pub fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around `points`; empty for no points. Non-finite points are ignored.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().filter(|p| p.is_finite()).fold(Self::EMPTY, |b, p| b.including(p))
    }

    /// Whether nothing is inside.
    pub fn is_empty(&self) -> bool {
        !(self.min.cmple(self.max).all())
    }

    /// The smallest box around `self` and `point`.
    #[must_use]
    pub fn including(&self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Side lengths; zero for an empty box.
    pub fn size(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// Midpoint.
    pub fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Whether `point` lies inside or on the surface.
    pub fn contains(&self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            Vec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The axis-aligned box around this box after `target_from_source`.
    #[must_use]
    pub fn transformed(&self, target_from_source: &Mat4) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::of_points(self.corners().map(|c| target_from_source.transform_point3(c)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_box_has_no_size_and_unites_neutrally() {
        let unit = Bounds::new(Vec3::ZERO, Vec3::ONE);
        assert!(Bounds::EMPTY.is_empty());
        assert_eq!(Bounds::EMPTY.size(), Vec3::ZERO);
        assert_eq!(Bounds::EMPTY.union(&unit), unit);
    }

    #[test]
    fn points_that_are_not_finite_are_ignored() {
        let b = Bounds::of_points([Vec3::NAN, Vec3::ONE, Vec3::splat(f32::INFINITY)]);
        assert_eq!(b, Bounds::new(Vec3::ONE, Vec3::ONE));
    }

    #[test]
    fn rotation_keeps_the_box_around_its_corners() {
        let b = Bounds::new(Vec3::splat(-1.0), Vec3::ONE);
        let r = b.transformed(&Mat4::from_rotation_y(std::f32::consts::FRAC_PI_4));
        assert!((r.max.x - 2f32.sqrt()).abs() < 1e-5 && (r.max.y - 1.0).abs() < 1e-6);
    }
}
