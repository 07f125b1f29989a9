//! Solid fill.

use crate::job::Job;
use crate::sparse::BrickSet;
use crate::{SolidReport, VoxelizeError};

pub(crate) fn solid(_job: &Job<'_>, surface: &BrickSet) -> Result<(BrickSet, SolidReport), VoxelizeError> {
    Ok((surface.clone(), SolidReport::default()))
}
