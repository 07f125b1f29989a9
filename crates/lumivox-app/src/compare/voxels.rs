//! Our occupied cells against those of the exact voxelizer.

use anyhow::{Context, Result};
use glam::Vec3;
use lumivox::core::TriangleView;
use lumivox::gpu::Gpu;
use lumivox::progressive::SURFACE_SHIFT;
use lumivox::volume::NORMAL;
use lumivox_oracle::scene::{Light, Scene};
use lumivox_oracle::voxels::{Coverage, VoxelDifference, VoxelSet};
use lumivox_render::Renderer;
use serde::Serialize;

/// The exact voxelizer tries every triangle with every cell around it, which takes too long above this many cells a side.
pub(crate) const MAX_SIDE: u32 = 128;

/// Recall of the thin set and strays beyond the exact one. Cells whose verdict changes when they grow or shrink by
/// `margin_cells` count as right either way in the numbers that say so.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct VoxelComparison {
    pub(crate) cells: usize,
    pub(crate) thin_cells: usize,
    pub(crate) exact_cells: usize,
    /// Share of the thin set that is there.
    pub(crate) recall: f64,
    pub(crate) recall_with_margin: f64,
    /// Cells that no triangle touches.
    pub(crate) strays: usize,
    pub(crate) strays_beyond_margin: usize,
    /// In cells: points are moved this far behind their surface before they mark a cell.
    pub(crate) margin_cells: f64,
}

/// Compares the volume that the renderer has; in a scene with masks their holes count as surface.
pub(crate) fn compare(renderer: &Renderer, gpu: &Gpu, scene: &Scene) -> Result<VoxelComparison> {
    let volume = renderer.volume().read_back(gpu)?;
    let occupied: Vec<bool> =
        volume.channel(NORMAL).unwrap_or_default().iter().map(|normal| normal.w > 0.0).collect();
    let positions: Vec<[f32; 3]> = surfaces(scene).map(|p| p.to_array()).collect();
    let count = u32::try_from(positions.len()).context("too many triangles for the exact voxelizer")?;
    let indices: Vec<[u32; 3]> = (0..count / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    let triangles = TriangleView::new(&positions, &indices).context("triangles without corners")?;
    // A cell grows on both sides by half of what it grows by.
    let margin = 2.0 * SURFACE_SHIFT;
    let grid = *renderer.volume().grid();
    let difference = |coverage| {
        VoxelDifference::between(&occupied, &VoxelSet::with_margin(grid, triangles, coverage, margin))
    };
    let (thin, exact) = (difference(Coverage::Thin)?, difference(Coverage::Exact)?);
    Ok(VoxelComparison {
        cells: thin.ours,
        thin_cells: thin.reference,
        exact_cells: exact.reference,
        recall: thin.recall(),
        recall_with_margin: thin.sure_recall(),
        strays: exact.strays,
        strays_beyond_margin: exact.sure_strays,
        margin_cells: SURFACE_SHIFT,
    })
}

/// Corners of all triangles; a rect light is two, since it blocks light.
fn surfaces(scene: &Scene) -> impl Iterator<Item = Vec3> {
    let rects = scene.lights.iter().filter_map(|light| match *light {
        Light::Rect { origin: a, u, v, .. } => Some([a, a + u, a + u + v, a, a + u + v, a + v]),
        _ => None,
    });
    scene.triangles.iter().flat_map(|t| t.positions).chain(rects.flatten())
}
