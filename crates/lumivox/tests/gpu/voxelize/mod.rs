//! Triangles to volumes.

mod channels;
mod coverage;
mod inputs;
mod laws;
mod lights;
mod slices;
pub(crate) mod soups;
mod sweeps;

use crate::Test;

const TESTS: &[Test] = &[
    ("voxelize: one triangle at every tilt", coverage::every_tilt),
    ("voxelize: soups of all sizes and shapes", coverage::all_sizes),
    ("voxelize: what is no triangle", coverage::degenerate),
    ("voxelize: one triangle across the whole grid", coverage::across),
    ("voxelize: closed surfaces on fitted grids", coverage::closed),
    ("voxelize: averages are those of the CPU", channels::averages),
    ("voxelize: sums, maxima and nearest values are those of the CPU", channels::rules),
    ("voxelize: every format holds what it can", channels::formats),
    ("voxelize: order and partition of triangles change nothing", laws::order),
    ("voxelize: layers merge to what all at once give", laws::layers),
    ("voxelize: windows change nothing", laws::windows),
    ("voxelize: slabs change nothing", laws::slabs),
    ("voxelize: walls on cell boundaries", laws::boundaries),
    ("voxelize: closed shells separate", laws::separation),
    ("voxelize: moved surfaces lie behind their visible side", laws::shift),
    ("voxelize: light with shadows, and its harmonics", lights::shadows),
    ("voxelize: meshes of every layout", inputs::layouts),
    ("voxelize: what does not fit is refused with numbers", inputs::refusals),
    ("voxelize: recording makes nothing", inputs::nothing_is_made),
    ("voxelize: sweeps of all faces, walls on cell boundaries", sweeps::planes),
    ("voxelize: slivers between columns", sweeps::narrow),
    ("voxelize: sweeps of all faces, order and partition", sweeps::order),
    ("voxelize: sweeps of all faces mark every column", sweeps::every_face),
    ("voxelize: sweeps of all faces close closed surfaces", sweeps::separation),
    ("voxelize: a slicemap sees one direction", sweeps::one_direction),
    ("voxelize: limits on output vertices leave holes", slices::limits),
    ("voxelize: slices hold what direct cells hold", slices::values),
    ("voxelize: slices share the surface", slices::areas),
    ("voxelize: a slice per pass, an axis a frame", slices::interleaved),
    ("voxelize: slices in windows", slices::windows),
    ("voxelize: what methods cannot do", slices::refusals),
];

pub(crate) fn tests() -> Vec<Test> {
    TESTS.to_vec()
}
