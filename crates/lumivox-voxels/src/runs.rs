//! Sums of small flat triangles, cell by cell, while triangles are binned.
//!
//! Scans have many triangles in one cell, most of them one after the other. Their areas and normals are summed where
//! they are met first, so that bricks get one entry for a run of triangles and need not look at these again. Sums are
//! integers, so that it does not matter where a run ends.

use glam::IVec3;

use crate::channels::FlatPiece;

/// What several pieces in one cell sum to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Cell of the grid.
    pub(crate) cell: IVec3,
    pub(crate) sum: FlatPiece,
}

/// Runs that go on. A cell and its neighbours in all directions have places of their own, since triangles go to and fro
/// between them.
pub(crate) struct OpenRuns([Run; 8]);

/// Runs end before their normals could overflow: at 256 cell faces.
const LONGEST: u64 = 1 << 30;

impl OpenRuns {
    pub(crate) fn new() -> Self {
        Self([Run { cell: IVec3::ZERO, sum: FlatPiece::NOTHING }; 8])
    }

    /// Adds a piece; returns the run that it ends, if any.
    #[inline(always)]
    pub(crate) fn add(&mut self, cell: IVec3, piece: FlatPiece) -> Option<Run> {
        let place = (cell.x & 1) | (cell.y & 1) << 1 | (cell.z & 1) << 2;
        let run = &mut self.0[place as usize];
        if run.cell == cell && run.sum.weight < LONGEST {
            run.sum.add(&piece);
            return None;
        }
        let ended = std::mem::replace(run, Run { cell, sum: piece });
        (ended.sum.weight > 0).then_some(ended)
    }

    /// The runs that are left.
    pub(crate) fn finish(self) -> impl Iterator<Item = Run> {
        self.0.into_iter().filter(|run| run.sum.weight > 0)
    }
}
