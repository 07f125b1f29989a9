//! The part of a triangle in a cell: its area and its centroid.

use glam::{DVec3, IVec3};

use crate::coverage::Triangle;

/// A part of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Area in cell faces.
    pub(crate) area: f64,
    /// A point of it, in cells.
    pub(crate) point: DVec3,
}

/// A triangle cut at six planes has up to nine corners; one place more takes what rounding might add.
type Corners = [DVec3; 10];

const NO_CORNERS: [Corners; 2] = [[DVec3::ZERO; 10]; 2];

/// Copies what lies at `side * (x[AXIS] - at) >= 0`; returns the number of corners.
#[inline]
fn clip<const AXIS: usize>(from: &Corners, len: usize, to: &mut Corners, at: f64, side: f64) -> usize {
    let Some(&last) = from[..len].last() else { return 0 };
    let mut kept = 0;
    let mut push = |corner: DVec3| {
        if let Some(place) = to.get_mut(kept) {
            *place = corner;
            kept += 1;
        }
    };
    let (mut before, mut d0) = (last, side * (last[AXIS] - at));
    for &corner in &from[..len] {
        let d1 = side * (corner[AXIS] - at);
        if (d0 > 0.0 && d1 < 0.0) || (d0 < 0.0 && d1 > 0.0) {
            push(before + (corner - before) * (d0 / (d0 - d1)));
        }
        if d1 >= 0.0 {
            push(corner);
        }
        (before, d0) = (corner, d1);
    }
    kept
}

/// Clips along one axis to a cell, where the triangle reaches beyond it: from the first buffer, back and forth.
#[inline]
fn clip_axis<'a, const AXIS: usize>(
    triangle: &Triangle,
    cell: IVec3,
    (mut from, mut to): (&'a mut Corners, &'a mut Corners),
    mut len: usize,
) -> ((&'a mut Corners, &'a mut Corners), usize) {
    let low = f64::from(cell[AXIS]);
    if triangle.reach.low[AXIS] < cell[AXIS] {
        len = clip::<AXIS>(from, len, to, low, 1.0);
        std::mem::swap(&mut from, &mut to);
    }
    if triangle.reach.high[AXIS] > cell[AXIS] {
        len = clip::<AXIS>(from, len, to, low + 1.0, -1.0);
        std::mem::swap(&mut from, &mut to);
    }
    ((from, to), len)
}

/// The corners of the part in a cell.
#[inline]
fn clipped<'a>(triangle: &Triangle, cell: IVec3, [a, b]: &'a mut [Corners; 2]) -> &'a [DVec3] {
    a[..3].copy_from_slice(&triangle.corners);
    let (buffers, len) = clip_axis::<0>(triangle, cell, (a, b), 3);
    let (buffers, len) = clip_axis::<1>(triangle, cell, buffers, len);
    let ((corners, _), len) = clip_axis::<2>(triangle, cell, buffers, len);
    &corners[..len]
}

/// The whole triangle.
pub(crate) fn whole(triangle: &Triangle) -> Piece {
    let [a, b, c] = triangle.corners;
    Piece { area: 0.5 * (b - a).cross(c - a).length(), point: (a + b + c) / 3.0 }
}

/// The part of the triangle in a cell that it marks. Where it only touches the cell, or has no area: no area, and the
/// middle of what is left or the triangle's point nearest to the cell's centre.
pub(crate) fn in_cell(triangle: &Triangle, cell: IVec3) -> Piece {
    if triangle.reach.low == triangle.reach.high {
        return whole(triangle);
    }
    let mut buffers = NO_CORNERS;
    middle(clipped(triangle, cell, &mut buffers)).unwrap_or_else(|| {
        let center = cell.as_dvec3() + 0.5;
        Piece { area: 0.0, point: nearest_point(triangle, center) }
    })
}

/// The smaller, in one instruction, where `f64::min` is several.
#[inline(always)]
pub(crate) fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger, as [`least`].
#[inline(always)]
pub(crate) fn most(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The share of a triangle's area on the upper side of a plane at these distances from its corners, of which at least one
/// is negative.
///
/// With the lowest corner `l` below the plane and the highest `h` above, the corner between them at `m` above it or `n`
/// below, that is `h / (h + n)` times `1 - l^2 / ((h + l) (m + l))`: of the two one is 1 but where the lone corner is. In
/// one fraction of sums, no digits are lost, and nothing is branched to: nobody foresees on which side corners are.
#[inline(always)]
pub(crate) fn share_above(a: f64, b: f64, c: f64) -> f64 {
    // For a triangle that touches the plane from below.
    const TINY: f64 = 1e-200;
    let (less, more) = (least(a, b), most(a, b));
    let middle = most(less, least(more, c));
    let l = most(-least(less, c), 0.0);
    let h = most(most(more, c), 0.0);
    let (m, n) = (most(middle, 0.0), most(-middle, 0.0));
    h * (h * m + l * (h + m)) / ((h + n + TINY) * ((h + l) * (m + l)))
}

/// Area and centroid; none of an empty polygon.
#[inline]
fn middle(corners: &[DVec3]) -> Option<Piece> {
    let (&first, rest) = corners.split_first()?;
    let mut normal = DVec3::ZERO;
    let mut moment = DVec3::ZERO;
    for pair in rest.windows(2) {
        let (b, c) = (pair[0] - first, pair[1] - first);
        let part = b.cross(c);
        // All parts of a convex polygon turn the same way, so that a sum of absolutes is the length along the normal.
        let weight = part.abs().element_sum();
        normal += part;
        moment += weight * (b + c);
    }
    let weight = normal.abs().element_sum();
    if weight > 0.0 {
        return Some(Piece { area: 0.5 * normal.length(), point: first + moment / (3.0 * weight) });
    }
    let sum: DVec3 = corners.iter().sum();
    Some(Piece { area: 0.0, point: sum / corners.len() as f64 })
}

/// The point of the triangle's edges that is nearest to `point`; for triangles that are, but for rounding, edge alone.
fn nearest_point(triangle: &Triangle, point: DVec3) -> DVec3 {
    let nearest_on = |(from, edge): (DVec3, DVec3)| {
        let length = edge.length_squared();
        let along = if length > 0.0 { ((point - from).dot(edge) / length).clamp(0.0, 1.0) } else { 0.0 };
        from + along * edge
    };
    let [a, b, c] = triangle.edges();
    let [from_a, from_b, from_c] = triangle.corners;
    [(from_b, b), (from_c, c)].into_iter().map(nearest_on).fold(nearest_on((from_a, a)), |best, next| {
        if next.distance_squared(point) < best.distance_squared(point) { next } else { best }
    })
}

/// Weights of the corners at a point of the triangle, none negative, sum one; thirds where the corners are one point.
pub(crate) fn barycentric(triangle: &Triangle, point: DVec3) -> DVec3 {
    let [a, b, c] = triangle.corners;
    let normal = triangle.normal();
    let weights =
        if normal != DVec3::ZERO {
            let part = |from: DVec3, to: DVec3| (from - point).cross(to - point).dot(normal).max(0.0);
            DVec3::new(part(b, c), part(c, a), part(a, b))
        } else {
            // A segment: between the ends of its longest edge.
            let edges = triangle.edges();
            let longest = (0..3).fold(0, |best, n| {
                if edges[n].length_squared() > edges[best].length_squared() { n } else { best }
            });
            let length = edges[longest].length_squared();
            let along = (point - triangle.corners[longest]).dot(edges[longest]) / length;
            let along = if length > 0.0 { along.clamp(0.0, 1.0) } else { 0.5 };
            let mut weights = DVec3::ZERO;
            weights[longest] = 1.0 - along;
            weights[(longest + 1) % 3] = along;
            weights
        };
    let sum = weights.element_sum();
    if sum > 0.0 { weights / sum } else { DVec3::splat(1.0 / 3.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec3;
    use proptest::prelude::*;

    use crate::coverage::{CellBox, Coverage, walk};

    const DIMS: UVec3 = UVec3::splat(9);

    fn corner() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(0.0..9.0).prop_map(DVec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

        /// The parts make up the whole: area and moment.
        #[test]
        fn parts_of_a_triangle_add_up(corners in prop::array::uniform3(corner())) {
            let triangle = Triangle::on_grid(corners, DIMS);
            let (mut area, mut moment) = (0.0, DVec3::ZERO);
            let mut outside = 0.0f64;
            walk(Coverage::Exact, &triangle, &CellBox::of_grid(DIMS), &mut |cell| {
                let piece = in_cell(&triangle, cell);
                let center = cell.as_dvec3() + 0.5;
                outside = outside.max((piece.point - center).abs().max_element() - 0.5);
                area += piece.area;
                moment += piece.area * piece.point;
            });
            let all = whole(&triangle);
            prop_assert!((area - all.area).abs() < 1e-9 * all.area.max(1.0));
            prop_assert!((moment - all.area * all.point).abs().max_element() < 1e-7);
            prop_assert!(outside < 1e-8, "{}", outside);
        }

        #[test]
        fn barycentric_weights_give_the_point_back(corners in prop::array::uniform3(corner())) {
            let triangle = Triangle::on_grid(corners, DIMS);
            let point = whole(&triangle).point.lerp(corners[1], 0.3);
            let w = barycentric(&triangle, point);
            let back = w.x * corners[0] + w.y * corners[1] + w.z * corners[2];
            prop_assert!((back - point).length() < 1e-6);
        }
    }

    #[test]
    fn lines_and_points_have_no_area_but_a_place() {
        let (a, b) = (DVec3::new(0.5, 0.5, 0.5), DVec3::new(4.5, 0.5, 0.5));
        let line = Triangle::on_grid([a, b, a], DIMS);
        let piece = in_cell(&line, IVec3::new(2, 0, 0));
        assert!(piece.area == 0.0 && (piece.point.x - 2.5).abs() <= 0.5);
        let weights = barycentric(&line, DVec3::new(1.5, 0.5, 0.5));
        assert!((weights.x * a + weights.y * b + weights.z * a - DVec3::new(1.5, 0.5, 0.5)).length() < 1e-12);
        let point = Triangle::on_grid([a; 3], DIMS);
        assert_eq!(in_cell(&point, IVec3::ZERO).point, a);
        assert!((barycentric(&point, a).element_sum() - 1.0).abs() < 1e-12);
    }
}
