//! One cell per column of the dominant axis.

use glam::{DVec3, IVec3};

use super::triangle::{CellBox, Triangle, dominant, floor};
use crate::fragment::Piece;

/// Calls `mark` for each cell of `within` in which the line through the centre of its column, along the axis that the
/// triangle faces most, meets the triangle. Of axes that tie, the first counts. Triangles without area mark nothing.
pub(crate) fn walk(triangle: &Triangle, within: &CellBox, mark: &mut impl FnMut(IVec3)) {
    let CellBox { low, high } = triangle.reach.intersection(within);
    let normal = triangle.normal();
    if normal == DVec3::ZERO {
        return;
    }
    let d = dominant(normal);
    let (p, q) = ((d + 1) % 3, (d + 2) % 3);
    let side = normal[d].signum();
    let edges = triangle.edges();
    // Positive on the inner side of each edge.
    let lines: [_; 3] = std::array::from_fn(|i| {
        let (a, b) = (-side * edges[i][q], side * edges[i][p]);
        let corner = triangle.corners[i];
        (a, b, a * corner[p] + b * corner[q])
    });
    let (slope_p, slope_q) = (normal[p] / normal[d], normal[q] / normal[d]);
    let corner = triangle.corners[0];
    let mut cell = low;
    for j in low[q]..=high[q] {
        for i in low[p]..=high[p] {
            let (x, y) = (f64::from(i) + 0.5, f64::from(j) + 0.5);
            if lines.iter().all(|(a, b, c)| a * x + b * y >= *c) {
                let height = corner[d] - slope_p * (x - corner[p]) - slope_q * (y - corner[q]);
                // Rounding must not take a point out of its triangle.
                let k = floor(height).clamp(triangle.reach.low[d], triangle.reach.high[d]);
                if low[d] <= k && k <= high[d] {
                    cell[d] = k;
                    cell[p] = i;
                    cell[q] = j;
                    mark(cell);
                }
            }
        }
    }
}

/// Where the line through a cell's column meets the triangle, and the area of the triangle that one column sees.
pub(crate) fn sample(triangle: &Triangle, cell: IVec3) -> Piece {
    let normal = triangle.normal();
    let d = dominant(normal);
    let mut point = cell.as_dvec3() + 0.5;
    let height = normal[d];
    let offset = normal.dot(triangle.corners[0] - point);
    point[d] += if height == 0.0 { 0.0 } else { offset / height };
    let area = if height == 0.0 { 0.0 } else { normal.length() / height.abs() };
    Piece { area, point }
}
