//! How far one set of cells is from the reference, with and without the margin of its verdicts.

use super::VoxelSet;

/// Why two sets cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DifferenceError {
    /// One value per cell of the reference's grid is needed.
    #[error("{ours} cells do not fit a grid of {reference}")]
    Length {
        /// Cells given.
        ours: usize,
        /// Cells of the reference's grid.
        reference: usize,
    },
}

/// Counts of cells in which a set differs from its reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VoxelDifference {
    /// Cells of the set under test.
    pub ours: usize,
    /// Cells of the reference.
    pub reference: usize,
    /// Cells of both.
    pub common: usize,
    /// Cells of the reference that are missing.
    pub missing: usize,
    /// Cells that the reference does not have.
    pub strays: usize,
    /// Cells whose verdict changes within the margin, marked or not.
    pub marginal: usize,
    /// Cells the reference has whatever the margin.
    pub sure: usize,
    /// Missing cells that no margin excuses.
    pub surely_missing: usize,
    /// Strays that no margin excuses.
    pub sure_strays: usize,
}

impl VoxelDifference {
    /// Compares `ours`, one flag per cell in the order of [`lumivox_core::Grid::index`], with a reference.
    ///
    /// # Errors
    /// When `ours` does not have one flag per cell of the reference's grid.
    pub fn between(ours: &[bool], reference: &VoxelSet) -> Result<Self, DifferenceError> {
        let cells = reference.grid().cell_count() as usize;
        if ours.len() != cells {
            return Err(DifferenceError::Length { ours: ours.len(), reference: cells });
        }
        let mut sum = Self::default();
        for (index, &ours) in ours.iter().enumerate() {
            let verdict = reference.verdict_at(index);
            sum.ours += usize::from(ours);
            sum.reference += usize::from(verdict.marked);
            sum.common += usize::from(ours && verdict.marked);
            sum.missing += usize::from(!ours && verdict.marked);
            sum.strays += usize::from(ours && !verdict.marked);
            sum.marginal += usize::from(verdict.is_marginal());
            sum.sure += usize::from(verdict.surely);
            sum.surely_missing += usize::from(!ours && verdict.surely);
            sum.sure_strays += usize::from(ours && !verdict.possibly);
        }
        Ok(sum)
    }

    /// Share of the reference's cells that are there, 0..=1; 1 for an empty reference.
    pub fn recall(&self) -> f64 {
        share(self.common, self.reference)
    }

    /// Share of the cells the reference has whatever the margin that are there, 0..=1.
    pub fn sure_recall(&self) -> f64 {
        share(self.sure - self.surely_missing, self.sure)
    }

    /// Whether the sets are equal but for cells within the margin.
    pub fn is_equal_within_margin(&self) -> bool {
        self.surely_missing == 0 && self.sure_strays == 0
    }
}

fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 1.0 } else { part as f64 / whole as f64 }
}

impl std::fmt::Display for VoxelDifference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} cells, reference {}: recall {:.6} ({} missing, {} beyond the margin), {} strays ({} beyond the margin), {} marginal",
            self.ours,
            self.reference,
            self.recall(),
            self.missing,
            self.surely_missing,
            self.strays,
            self.sure_strays,
            self.marginal
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxels::Coverage;
    use glam::Vec3;
    use lumivox_core::{Bounds, Grid, TriangleView};

    #[test]
    fn counts_what_is_missing_and_what_strays_with_and_without_margin() {
        let grid = Grid::fit(&Bounds::new(Vec3::ZERO, Vec3::splat(4.0)), 4).unwrap();
        let positions = [[-9.0, 2.0, -9.0], [20.0, 2.0, -9.0], [-9.0, 2.0, 20.0]];
        let on_boundary = TriangleView::new(&positions, &[[0, 1, 2]]).unwrap();
        let reference = VoxelSet::of(grid, on_boundary, Coverage::Exact);
        let only_above: Vec<bool> = grid.cells().map(|c| c.y == 2).collect();
        let d = VoxelDifference::between(&only_above, &reference).unwrap();
        assert_eq!((d.common, d.missing, d.strays, d.marginal), (16, 16, 0, 32));
        assert!(d.is_equal_within_margin() && d.recall() == 0.5 && d.sure_recall() == 1.0);
        let one_too_far: Vec<bool> = grid.cells().map(|c| c.y == 3).collect();
        let d = VoxelDifference::between(&one_too_far, &reference).unwrap();
        assert_eq!((d.strays, d.sure_strays, d.surely_missing), (16, 16, 0));
        assert!(!d.is_equal_within_margin());
        let short = VoxelDifference::between(&only_above[1..], &reference);
        assert_eq!(short, Err(DifferenceError::Length { ours: 63, reference: 64 }));
    }
}
