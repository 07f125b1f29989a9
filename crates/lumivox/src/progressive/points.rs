//! The points of an injection grid: how many there are, in which order they are taken, and which of them in which frame
//! (dissertation 7.7 and 7.10).

use glam::UVec2;
use lumivox_core::Grid;

/// Texels or points a side of a block.
const BLOCK: u32 = 8;

/// How many points a view injects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InjectionGrid {
    /// So many columns and rows.
    Fixed(UVec2),
    /// So many columns and rows for each cell along the longest side of the grid.
    PerCell(f32),
    /// Every texel.
    Full,
}

impl InjectionGrid {
    /// Columns and rows for pictures of this size; never more than one point a texel, and never none.
    pub fn points(self, size: UVec2, grid: &Grid) -> UVec2 {
        let points = match self {
            Self::Fixed(points) => points,
            Self::PerCell(points) => UVec2::splat((points * grid.dims.max_element() as f32).ceil() as u32),
            Self::Full => size,
        };
        points.clamp(UVec2::ONE, size.max(UVec2::ONE))
    }
}

/// In which order points are taken, and so which of them are taken together when they are split over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum InjectionPattern {
    /// Row by row. A frame of a split takes a band of the picture.
    #[default]
    Linear = 0,
    /// Block by block, of 8 x 8 points. A frame of a split takes every so manieth block.
    Block = 1,
    /// Row by row. A frame of a split takes every so manieth point of a row, those of the next row shifted, so that each
    /// frame's points lie all over the picture.
    Stippled = 2,
}

impl InjectionPattern {
    /// Invocations that the points of one frame of a split take; some of the last may have none.
    pub(super) fn invocations(self, points: UVec2, split: u32) -> u32 {
        match self {
            Self::Linear => (points.x * points.y).div_ceil(split),
            Self::Block => {
                let blocks = points.x.div_ceil(BLOCK) * points.y.div_ceil(BLOCK);
                blocks.div_ceil(split) * BLOCK * BLOCK
            }
            Self::Stippled => points.x.div_ceil(split) * points.y,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;

    #[test]
    fn grids_of_points_have_the_sizes_that_are_asked_for() {
        let grid = Grid { origin: Vec3::ZERO, cell_size: 0.1, dims: UVec3::new(64, 20, 30) };
        let size = UVec2::new(400, 100);
        let points = |of: InjectionGrid| of.points(size, &grid);
        assert_eq!(points(InjectionGrid::Fixed(UVec2::splat(64))), UVec2::splat(64));
        assert_eq!(points(InjectionGrid::PerCell(2.0)), UVec2::new(128, 100));
        assert_eq!(points(InjectionGrid::Full), size);
        assert_eq!(points(InjectionGrid::PerCell(-1.0)), UVec2::ONE);
        assert_eq!(points(InjectionGrid::Fixed(UVec2::ZERO)), UVec2::ONE);
    }
}
