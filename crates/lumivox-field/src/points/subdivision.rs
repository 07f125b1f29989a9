//! Slater's subdivision of one octant: a triangle whose edges are halved again and again, with every new corner pushed
//! out to the sphere.

use glam::{DVec3, Vec3};

/// The corners of one octant. Corner `(i, j)` lies `i` steps towards +X and `j` steps towards +Z from the pole +Y, of
/// `divisions` steps along each side.
pub(crate) struct Octant {
    pub(crate) divisions: u32,
    corners: Vec<Vec3>,
}

impl Octant {
    /// `divisions` is a power of two.
    pub(crate) fn new(divisions: u32) -> Self {
        let side = divisions as usize + 1;
        let mut found = vec![DVec3::ZERO; side * side];
        let at = |i: usize, j: usize| i + side * j;
        found[at(0, 0)] = DVec3::Y;
        found[at(divisions as usize, 0)] = DVec3::X;
        found[at(0, divisions as usize)] = DVec3::Z;
        let mut step = divisions as usize;
        while step > 1 {
            let half = step / 2;
            for j in (0..side).step_by(half) {
                for i in (0..side - j).step_by(half) {
                    // The edge that a new corner halves runs along the axis on which it is odd; odd on both: across.
                    let (a, b) = match (i / half % 2, j / half % 2) {
                        (0, 0) => continue,
                        (1, 0) => (at(i - half, j), at(i + half, j)),
                        (0, _) => (at(i, j - half), at(i, j + half)),
                        _ => (at(i + half, j - half), at(i - half, j + half)),
                    };
                    found[at(i, j)] = (found[a] + found[b]).normalize_or_zero();
                }
            }
            step = half;
        }
        let rows = (0..side).flat_map(|j| (0..side - j).map(move |i| (i, j)));
        Self { divisions, corners: rows.map(|(i, j)| found[at(i, j)].as_vec3()).collect() }
    }

    /// A corner, for `i + j <= divisions`.
    #[inline]
    pub(crate) fn corner(&self, i: u32, j: u32) -> Vec3 {
        self.corners[self.position(i, j)]
    }

    /// Place of a corner in row order: row `j` has `divisions + 1 - j` corners.
    #[inline]
    fn position(&self, i: u32, j: u32) -> usize {
        (j * (self.divisions + 1) - (j * j - j) / 2 + i) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_unit_symmetric_and_evenly_spaced_along_the_sides() {
        for divisions in [4, 8, 16, 32, 64] {
            let octant = Octant::new(divisions);
            assert_eq!(octant.corners.len() as u32, (divisions + 1) * (divisions + 2) / 2);
            for j in 0..=divisions {
                for i in 0..=divisions - j {
                    let p = octant.corner(i, j);
                    assert!((p.length() - 1.0).abs() < 1e-6);
                    let mirrored = octant.corner(j, i);
                    assert!((p - Vec3::new(mirrored.z, mirrored.y, mirrored.x)).length() < 1e-6);
                    let turned = octant.corner(divisions - i - j, i);
                    assert!((p - Vec3::new(turned.z, turned.x, turned.y)).length() < 1e-6, "{i} {j}");
                }
            }
            for i in 0..=divisions {
                let angle = f64::from(i) / f64::from(divisions) * std::f64::consts::FRAC_PI_2;
                let expected = Vec3::new(angle.sin() as f32, angle.cos() as f32, 0.0);
                assert!((octant.corner(i, 0) - expected).length() < 1e-6);
            }
        }
    }
}
