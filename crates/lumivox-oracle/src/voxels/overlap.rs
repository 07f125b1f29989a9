//! The tests that decide whether a triangle marks a cell.
//!
//! With the cell's centre at the origin, `h` half its side, corners `v0..v2`, edges `e0..e2` and normal `n`:
//!
//! - **exact**: the closed triangle and the closed cube have a point in common. By the separating axis theorem that is
//!   so unless one of 13 directions separates them: three axes, `n`, and nine `axis x edge` (Akenine-Moeller 2001).
//! - **thin**: the 6-separating set of Schwarz and Seidel, *Fast parallel surface and solid voxelization on GPUs*
//!   (2010, section 3.2): the bounding boxes overlap, the plane comes within `h max|n|` of the centre, and in each of the
//!   three axis-aligned projections the centre lies inside of every edge or within `h max|edge normal|` beyond it.
//! - **sampled**: along the axis where `n` is largest, the line through the cell's centre meets the triangle within
//!   the cell. The cell is half-open there, as everywhere; the grid owns its upper face. What a rasterizer with one
//!   sample per pixel and one view per dominant axis gives, apart from its snapping of corners.
//!
//! Each comes with its margin: the same test for a cube whose side is larger or smaller by a fraction. (For *sampled*
//! the sampled point also moves within a square of that fraction, and axes that tie within it are all tried.)
//! Degenerate triangles are segments or points, and are treated as such; *sampled* does not see them.

use glam::{DVec3, UVec3};
use lumivox_core::Grid;

/// Which cells a triangle marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// Every cell the closed triangle touches: 26-separating.
    Exact,
    /// Schwarz and Seidel's 6-separating set.
    Thin,
    /// One cell per pixel of the dominant axis.
    Sampled,
}

/// Whether a cell is marked, and whether that would change if it were a little smaller or larger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Marked even when the cell shrinks by the margin.
    pub surely: bool,
    /// Marked.
    pub marked: bool,
    /// Marked at least when the cell grows by the margin.
    pub possibly: bool,
}

impl Verdict {
    /// Whether the verdict changes within the margin.
    pub fn is_marginal(&self) -> bool {
        self.surely != self.possibly
    }
}

impl Coverage {
    /// The verdict about one cell and one triangle. `margin` is a fraction of the cell's size.
    pub fn verdict(self, grid: &Grid, cell: UVec3, corners: &[DVec3; 3], margin: f64) -> Verdict {
        let side = f64::from(grid.cell_size);
        let center = grid.origin.as_dvec3() + side * (cell.as_dvec3() + 0.5);
        let corners = corners.map(|c| c - center);
        let half = 0.5 * side;
        let test = |half: f64| match self {
            Self::Exact => exact(&corners, half),
            _ => thin(&corners, half),
        };
        match self {
            Self::Exact | Self::Thin => {
                let possibly = test(half * (1.0 + margin));
                let marked = possibly && test(half);
                Verdict { surely: marked && test(half * (1.0 - margin)), marked, possibly }
            }
            Self::Sampled => {
                let last = cell.cmpeq(grid.dims - UVec3::ONE);
                sampled(&corners, half, margin, [last.x, last.y, last.z])
            }
        }
    }
}

const AXES: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];

fn edges([a, b, c]: &[DVec3; 3]) -> [DVec3; 3] {
    [b - a, c - b, a - c]
}

/// The normal, of any length; zero where the corners lie on a line but for rounding.
fn normal(corners: &[DVec3; 3]) -> DVec3 {
    let edges = edges(corners);
    let normal = edges[0].cross(edges[1]);
    let longest = edges.map(DVec3::length_squared).into_iter().fold(0.0, f64::max);
    if normal.length() <= 1e-12 * longest { DVec3::ZERO } else { normal }
}

/// Sum of the absolute components: how far a cube with half side 1 reaches along a direction.
fn cube_reach(direction: DVec3) -> f64 {
    direction.abs().element_sum()
}

/// Whether the projections of triangle and cube onto `axis` are disjoint. A zero axis separates nothing.
fn separates(axis: DVec3, corners: &[DVec3; 3], half: f64) -> bool {
    let [a, b, c] = corners.map(|corner| corner.dot(axis));
    let reach = half * cube_reach(axis);
    a.min(b).min(c) > reach || a.max(b).max(c) < -reach
}

fn exact(corners: &[DVec3; 3], half: f64) -> bool {
    let across = AXES.iter().flat_map(|axis| edges(corners).map(|edge| axis.cross(edge)));
    !AXES.into_iter().chain([normal(corners)]).chain(across).any(|axis| separates(axis, corners, half))
}

fn thin(corners: &[DVec3; 3], half: f64) -> bool {
    if AXES.iter().any(|&axis| separates(axis, corners, half)) {
        return false;
    }
    let normal = normal(corners);
    if normal.dot(corners[0]).abs() > half * normal.abs().max_element() {
        return false;
    }
    AXES.iter().all(|axis| {
        // Seen along the axis from where the triangle runs counter-clockwise, `axis x edge` points inwards.
        let facing = if normal.dot(*axis) >= 0.0 { *axis } else { -*axis };
        (0..3).all(|i| {
            let inwards = facing.cross(edges(corners)[i]);
            inwards.dot(corners[i]) <= half * inwards.abs().max_element()
        })
    })
}

/// `last[a]`: the cell is the grid's last along axis `a`.
fn sampled(corners: &[DVec3; 3], half: f64, margin: f64, last: [bool; 3]) -> Verdict {
    let normal = normal(corners);
    let length = normal.abs().to_array();
    let longest = normal.abs().max_element();
    let mut verdict = Verdict { surely: longest > 0.0, marked: false, possibly: false };
    let dominant = length.iter().position(|&l| l == longest).unwrap_or(0);
    for axis in (0..3).filter(|&a| longest > 0.0 && length[a] >= longest * (1.0 - margin)) {
        let facing = AXES[axis] * normal[axis].signum();
        // How far inside of the nearest edge the line through the centre runs, in units of that edge's reach.
        let inside = (0..3).map(|i| {
            let inwards = facing.cross(edges(corners)[i]);
            let reach = half * cube_reach(inwards);
            if reach > 0.0 { -inwards.dot(corners[i]) / reach } else { 0.0 }
        });
        let inside = inside.fold(f64::INFINITY, f64::min);
        let depth = normal.dot(corners[0]) / normal[axis];
        let slope = (cube_reach(normal) - length[axis]) / length[axis];
        let slack = half * margin * (1.0 + slope);
        verdict.possibly |= inside >= -margin && depth.abs() <= half + slack;
        verdict.surely &= inside >= margin && depth.abs() <= half - slack;
        if axis == dominant {
            let in_cell = -half <= depth && (depth < half || last[axis] && depth <= half);
            verdict.marked = inside >= 0.0 && in_cell;
        }
    }
    verdict
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lumivox_core::Bounds;
    use proptest::prelude::*;

    /// What is left of a polygon within the cube: clips at each of its six faces in turn.
    fn clip(corners: &[DVec3; 3], half: f64) -> Vec<DVec3> {
        let mut polygon = corners.to_vec();
        for axis in AXES.into_iter().flat_map(|a| [a, -a]) {
            let distance = |p: DVec3| half - p.dot(axis);
            let mut kept = Vec::new();
            for (i, &from) in polygon.iter().enumerate() {
                let to = polygon[(i + 1) % polygon.len()];
                let (d0, d1) = (distance(from), distance(to));
                if d0 >= 0.0 {
                    kept.push(from);
                }
                if (d0 > 0.0 && d1 < 0.0) || (d0 < 0.0 && d1 > 0.0) {
                    kept.push(from.lerp(to, d0 / (d0 - d1)));
                }
            }
            polygon = kept;
        }
        polygon
    }

    fn grid() -> Grid {
        Grid::fit(&Bounds::new(Vec3::splat(-1.0), Vec3::ONE), 1).unwrap()
    }

    fn point(reach: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-reach..reach).prop_map(DVec3::from)
    }

    fn triangle() -> impl Strategy<Value = [DVec3; 3]> {
        let any = || prop::array::uniform3(point(3.0));
        let segment = (point(3.0), point(3.0), 0.0..1.0).prop_map(|(a, b, t)| [a, b, a.lerp(b, t)]);
        let flat = (any(), 0..3usize).prop_map(|(mut corners, axis)| {
            (1..3).for_each(|i| corners[i][axis] = corners[0][axis]);
            corners
        });
        prop_oneof![4 => any(), 1 => segment, 2 => flat]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn separating_axes_agree_with_clipping(corners in triangle()) {
            let verdict = Coverage::Exact.verdict(&grid(), UVec3::ZERO, &corners, 1e-9);
            if !verdict.is_marginal() {
                prop_assert_eq!(verdict.marked, !clip(&corners, 1.0).is_empty());
            }
        }

        #[test]
        fn order_of_corners_does_not_matter(corners in triangle()) {
            let [a, b, c] = corners;
            for coverage in [Coverage::Exact, Coverage::Thin, Coverage::Sampled] {
                let verdict = |t| coverage.verdict(&grid(), UVec3::ZERO, &t, 1e-9);
                let first = verdict(corners);
                for other in [[b, c, a], [c, b, a], [a, c, b]].map(verdict) {
                    if !first.is_marginal() && !other.is_marginal() {
                        prop_assert_eq!(first.marked, other.marked, "{:?}", coverage);
                    }
                }
            }
        }

        #[test]
        fn sampled_lies_in_thin_lies_in_exact(corners in triangle()) {
            let marks = |coverage: Coverage| coverage.verdict(&grid(), UVec3::ZERO, &corners, 1e-9);
            prop_assert!(!marks(Coverage::Sampled).surely || marks(Coverage::Thin).possibly);
            prop_assert!(!marks(Coverage::Thin).marked || marks(Coverage::Exact).marked);
        }

        #[test]
        fn margins_enclose(corners in triangle()) {
            for coverage in [Coverage::Exact, Coverage::Thin, Coverage::Sampled] {
                let v = coverage.verdict(&grid(), UVec3::ZERO, &corners, 0.05);
                prop_assert!((!v.surely || v.marked) && (!v.marked || v.possibly), "{:?} {:?}", coverage, v);
            }
        }
    }

    #[test]
    fn a_corner_cut_is_exact_but_not_thin() {
        let triangle = [2.8 * DVec3::X, 2.8 * DVec3::Y, 2.8 * DVec3::Z];
        let marks = |c: Coverage| c.verdict(&grid(), UVec3::ZERO, &triangle, 1e-4).marked;
        assert!(marks(Coverage::Exact) && !marks(Coverage::Thin) && !marks(Coverage::Sampled));
    }
}
