use super::*;
use glam::UVec3;
use proptest::prelude::*;

use crate::coverage::walk;
use crate::fragment::in_cell;

const DIMS: UVec3 = UVec3::splat(8);

/// Areas of all cells of boxes are those of the pieces that cutting gives.
fn compare(corners: [DVec3; 3], within: &CellBox, tolerance: f64) -> Result<(), TestCaseError> {
    let triangle = Triangle::on_grid(corners, DIMS);
    let normal = triangle.normal();
    let plane = (normal, normal.length());
    let mut areas = Areas::default();
    // What the triangle before has left must not show.
    let other =
        Triangle::on_grid([DVec3::new(0.1, 7.9, 0.2), DVec3::new(7.7, 0.3, 3.1), DVec3::splat(7.5)], DIMS);
    let plane_of_other = (other.normal(), other.normal().length());
    let grid = CellBox::of_grid(DIMS);
    areas.for_each(Coverage::Exact, &other, plane_of_other, &grid, |_, _| {});
    for coverage in [Coverage::Exact, Coverage::Thin] {
        let mut cells = Vec::new();
        let mut found = Vec::new();
        let mut worst = 0.0f64;
        if !triangle.reach.intersection(within).is_empty() {
            walk(coverage, &triangle, within, &mut |cell| cells.push(cell));
        }
        areas.for_each(coverage, &triangle, plane, within, |cell, area| {
            found.push(cell);
            worst = worst.max((area - in_cell(&triangle, cell).area).abs());
        });
        prop_assert!(worst < tolerance, "{}", worst);
        cells.sort_by_key(|cell| cell.to_array());
        found.sort_by_key(|cell| cell.to_array());
        prop_assert_eq!(cells, found);
    }
    Ok(())
}

fn whole(corners: [DVec3; 3]) -> Result<(), TestCaseError> {
    compare(corners, &CellBox::of_grid(DIMS), 1e-9)
}

fn corner() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(0.0..8.0).prop_map(DVec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// The same as cutting gives, for triangles of all sizes.
    #[test]
    fn areas_are_those_of_the_pieces(a in corner(), b in corner(), c in corner(), size in -4.0..0.0f64) {
        let near = |corner: DVec3| a + (corner - a) * 10f64.powf(size);
        whole([a, near(b), near(c)])?;
    }

    /// Edges along the axes and through corners of cells.
    #[test]
    fn areas_on_whole_numbers_are_those_of_the_pieces(corners in prop::array::uniform3(prop::array::uniform3(0..17i32))) {
        whole(corners.map(|c| 0.5 * DVec3::from(c.map(f64::from))))?;
    }

    /// Corners, edges and planes that come near boundaries, edges and corners of cells, nearer than the slack of tests and
    /// farther: the cells are those of the tests in any case.
    #[test]
    fn areas_near_whole_numbers_are_those_of_the_pieces(
        start in prop::array::uniform3(0..13i32),
        ways in prop::array::uniform2(prop::array::uniform3(-6..7i32)),
        offsets in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)),
        sizes in prop::array::uniform3(-13.0..-2.0f64),
        is_plane in any::<bool>(),
    ) {
        let ends = [start, std::array::from_fn(|n| start[n] + ways[0][n]), std::array::from_fn(|n| start[n] + ways[1][n])];
        let mut corners = [DVec3::ZERO; 3];
        for n in 0..3 {
            // The same offset for all moves a plane away from corners of cells.
            let m = if is_plane { 0 } else { n };
            let offset = DVec3::from(offsets[m]) * 10f64.powf(sizes[m]);
            corners[n] = (0.5 * IVec3::from(ends[n]).as_dvec3() + offset).clamp(DVec3::ZERO, DVec3::splat(8.0));
        }
        // Cutting rounds corners to the last bits, of which planes that near have no more.
        let nearest = sizes.into_iter().fold(0.0, f64::min);
        compare(corners, &CellBox::of_grid(DIMS), 1e-9 + 1e-14 / 10f64.powf(nearest))?;
    }

    /// Boxes that hold a part of the triangle, which may reach beyond the grid, in halves too.
    #[test]
    fn areas_in_boxes_are_those_of_the_pieces(
        corners in prop::array::uniform3(prop::array::uniform3(-8.0..16.0f64)),
        low in prop::array::uniform3(0..8i32),
        size in prop::array::uniform3(0..8i32),
        in_halves in any::<bool>(),
    ) {
        let low = IVec3::from(low);
        let within = CellBox { low, high: (low + IVec3::from(size)).min(IVec3::splat(7)) };
        let rounded = |x: f64| if in_halves { 0.5 * (2.0 * x).round() } else { x };
        compare(corners.map(|c| DVec3::from(c.map(rounded))), &within, 1e-9)?;
    }
}

/// A triangle that touches the last cells with an edge, and lies beyond them.
#[test]
fn what_only_touches_the_last_cells_has_no_area_there() {
    let corners = [DVec3::new(8.0, 0.0, 0.0), DVec3::new(14.5, 0.0, -6.0), DVec3::new(8.0, 11.5, 5.0)];
    let within = CellBox { low: IVec3::new(1, 0, 0), high: IVec3::new(7, 0, 1) };
    compare(corners, &within, 1e-9).unwrap();
}

#[test]
fn slivers_have_the_area_of_their_pieces() {
    for n in 0..200 {
        let thin = 10f64.powi(-n / 20);
        let tilt = f64::from(n % 20) / 20.0;
        let from = DVec3::new(0.1 + tilt, 0.3, 0.2);
        let to = DVec3::new(7.9, 0.3 + 7.0 * tilt, 6.0 * tilt);
        whole([from, to, from + DVec3::new(thin, -0.3 * thin, thin)]).unwrap();
    }
}

/// Corners a million cells away leave few digits, but no square holds more than itself.
#[test]
fn triangles_far_beyond_the_grid_fill_no_more_than_squares() {
    let corners = [DVec3::new(-1e30, -2e30, 3.3), DVec3::new(1e30, -1e30, 3.6), DVec3::new(4.0, 1e30, 3.4)];
    let triangle = Triangle::on_grid(corners, DIMS);
    let normal = triangle.normal();
    let mut count = 0;
    Areas::default().for_each(
        Coverage::Exact,
        &triangle,
        (normal, normal.length()),
        &CellBox::of_grid(DIMS),
        |_, area| {
            count += 1;
            assert!((0.0..=1.0 + 1e-9).contains(&area), "{area}");
        },
    );
    assert_eq!(count, 64);
}
