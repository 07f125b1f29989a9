//! A cascade in memory, and what is found there.

use std::collections::HashMap;

use glam::{IVec3, Vec3, Vec4};
use lumivox_core::Grid;

use super::BLEND_CELLS;
use crate::gpu::{Gpu, GpuError};
use crate::progressive::ProgressiveVoxelizer;

#[derive(Clone, Debug)]
struct Level {
    grid: Grid,
    /// By their place in the window.
    cells: HashMap<IVec3, Vec<Vec4>>,
}

/// The occupied cells of all levels.
#[derive(Clone, Debug)]
pub struct CascadeCells {
    levels: Vec<Level>,
}

/// What there is around a point.
#[derive(Clone, Debug, PartialEq)]
pub struct CascadeSample {
    /// How much of it is occupied, 0 to 1.
    pub coverage: f32,
    /// The channels, times that.
    pub values: Vec<Vec4>,
}

impl CascadeCells {
    pub(super) fn read(gpu: &Gpu, levels: &[ProgressiveVoxelizer]) -> Result<Self, GpuError> {
        let level = |level: &ProgressiveVoxelizer| -> Result<Level, GpuError> {
            let corner = level.first_cell();
            let cells = level.read_cells(gpu)?;
            let cells = cells.into_iter().map(|c| (c.cell - corner, c.values)).collect();
            Ok(Level { grid: level.grid(), cells })
        };
        Ok(Self { levels: levels.iter().map(level).collect::<Result<_, _>>()? })
    }

    /// The number of the finest level whose window contains a point, and the channels of the cell there if it is occupied.
    pub fn find(&self, point: Vec3) -> Option<(usize, Option<&[Vec4]>)> {
        self.levels.iter().enumerate().find_map(|(n, level)| {
            let at = level.in_cells(point);
            let dims = level.grid.dims.as_vec3();
            let inside = at.cmpge(Vec3::ZERO).all() && at.cmplt(dims).all();
            inside.then(|| (n, level.cells.get(&at.floor().as_ivec3()).map(Vec::as_slice)))
        })
    }

    /// A blend of the cells around a point, linear between their middles, in which each level fades into the next over the last
    /// [`BLEND_CELLS`] cells before its window's border, and the last into nothing: without a seam everywhere. As `lumivox_cascade_smooth`.
    pub fn smooth(&self, point: Vec3) -> CascadeSample {
        let channels = self.levels.iter().flat_map(|l| l.cells.values()).map(Vec::len).next().unwrap_or(0);
        let mut sample = CascadeSample { coverage: 0.0, values: vec![Vec4::ZERO; channels] };
        let mut left = 1.0;
        for level in &self.levels {
            let share = left * level.share(point);
            if share > 0.0 {
                level.add(point, share, &mut sample);
            }
            left -= share;
        }
        sample
    }
}

impl Level {
    fn in_cells(&self, point: Vec3) -> Vec3 {
        (point - self.grid.origin) / self.grid.cell_size
    }

    /// How much of a blend this level has: all but near its border.
    fn share(&self, point: Vec3) -> f32 {
        let at = self.in_cells(point);
        let inward = at.min(self.grid.dims.as_vec3() - at).min_element();
        ((inward - 0.5) / BLEND_CELLS).clamp(0.0, 1.0)
    }

    fn add(&self, point: Vec3, share: f32, sample: &mut CascadeSample) {
        let at = self.in_cells(point) - 0.5;
        let (low, part) = (at.floor(), at - at.floor());
        for corner in 0..8 {
            let side = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let Some(values) = self.cells.get(&(low.as_ivec3() + side)) else { continue };
            let of_axis = |axis: usize| if side[axis] == 1 { part[axis] } else { 1.0 - part[axis] };
            let weight = share * of_axis(0) * of_axis(1) * of_axis(2);
            sample.coverage += weight;
            for (sum, value) in sample.values.iter_mut().zip(values) {
                *sum += weight * *value;
            }
        }
    }
}
