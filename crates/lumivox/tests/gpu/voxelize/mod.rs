//! Triangles to volumes.

mod channels;
mod coverage;
mod soups;

use crate::Test;

const TESTS: &[Test] = &[
    ("voxelize: one triangle at every tilt", coverage::every_tilt),
    ("voxelize: soups of all sizes and shapes", coverage::all_sizes),
    ("voxelize: what is no triangle", coverage::degenerate),
    ("voxelize: one triangle across the whole grid", coverage::across),
    ("voxelize: closed surfaces on fitted grids", coverage::closed),
    ("voxelize: averages are those of the CPU", channels::averages),
];

pub(crate) fn tests() -> Vec<Test> {
    TESTS.to_vec()
}
