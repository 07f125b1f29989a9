//! What views prove about cells, by definition: in double precision, and without the code of shaders. Whether something should be
//! gone that is still there.

use anyhow::Result;
use glam::{BVec3, DMat4, DVec2, DVec3, DVec4, UVec2, UVec3};
use lumivox::core::{Grid, View};
use lumivox::gpu::{Gpu, read_texture};
use lumivox::progressive::{CleanupRule, SURFACE_SHIFT};

use super::rig::Rig;

/// What single precision may be off, in texels and in depths: what is proven only without these is not called so.
const TEXELS: f64 = 1e-4;
const DEPTH: f64 = 2e-6;
/// The same of the rule by centres, in cells.
const CELLS: f64 = 1e-4;
/// Footprints of more texels across than this are looked at in blocks of 2, 4, 8..
const FINE: u32 = 8;

/// A depth image, and where it was taken.
pub(super) struct Shot {
    view: View,
    size: UVec2,
    depth: Vec<f32>,
    clip_from_world: DMat4,
    world_from_clip: DMat4,
}

/// A cube in a picture.
struct Footprint {
    low: UVec2,
    high: UVec2,
    /// How far away its farthest corner lies.
    farthest: f64,
}

impl Shot {
    /// What a rig has drawn last.
    pub(super) fn take(gpu: &Gpu, rig: &Rig) -> Result<Self> {
        let (view, texture) = (rig.camera.view, &rig.camera.input.textures.depth);
        let clip_from_world = view.clip_from_world.as_dmat4();
        Ok(Self {
            view,
            size: UVec2::from(texture.size()),
            depth: read_texture(gpu, texture)?,
            clip_from_world,
            world_from_clip: clip_from_world.inverse(),
        })
    }

    /// Whether it surely proves a cell empty by a rule of cleanup.
    pub(super) fn proves_empty(&self, grid: &Grid, cell: UVec3, rule: CleanupRule) -> bool {
        match rule {
            CleanupRule::Center => self.clears_center(grid, cell),
            CleanupRule::Footprint | CleanupRule::Rays => self.clears_whole(grid, cell, rule),
        }
    }

    /// Whether all of a cell is in the picture and each texel whose ray meets it shows something behind it: one looks through the
    /// cell, whatever a rule makes of that.
    pub(super) fn sees_through(&self, grid: &Grid, cell: UVec3) -> bool {
        let (middle, half) = (middle(grid, cell), 0.5 * f64::from(grid.cell_size));
        let Some(print) = self.footprint(middle, half, 0.0) else { return false };
        let mut meets = false;
        for (x, y) in texels(print.low, print.high) {
            let ndc = self.ndc(DVec2::new(f64::from(x), f64::from(y)) + 0.5);
            let [start, end] = [0.75, 0.25].map(|z| self.world_from_clip.project_point3(ndc.extend(z)));
            let along = (end - start) * if self.view.reversed_depth { 1.0 } else { -1.0 };
            let faces = [-half, half].map(|side| (middle + side - start) / along);
            let (enters, leaves) = (faces[0].min(faces[1]), faces[0].max(faces[1]));
            if enters.max_element() >= leaves.min_element() {
                continue;
            }
            meets = true;
            let left = self.clip_from_world.project_point3(start + leaves.min_element() * along).z;
            if self.shown(x, y) <= self.away(left) {
                return false;
            }
        }
        meets
    }

    /// Depths that grow away from the eye.
    fn away(&self, depth: f64) -> f64 {
        if self.view.reversed_depth { 1.0 - depth } else { depth }
    }

    fn shown(&self, x: u32, y: u32) -> f64 {
        self.away(f64::from(self.depth[(y * self.size.x + x) as usize]))
    }

    fn ndc(&self, at: DVec2) -> DVec2 {
        let at = at / self.size.as_dvec2();
        DVec2::new(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y)
    }

    /// Texel and depth of a point before the eye.
    fn project(&self, point: DVec3) -> Option<(DVec2, f64)> {
        let clip: DVec4 = self.clip_from_world * point.extend(1.0);
        let ndc = clip.truncate() / clip.w;
        let at = DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * self.size.as_dvec2();
        (clip.w > 0.0).then_some((at, ndc.z))
    }

    /// None where a cube does not lie in the picture whole, with a margin.
    fn footprint(&self, middle: DVec3, half: f64, margin: f64) -> Option<Footprint> {
        let (mut low, mut high) = (DVec2::MAX, DVec2::MIN);
        let mut farthest = 0f64;
        for corner in 0..8 {
            let sides = BVec3::new(corner & 1 > 0, corner & 2 > 0, corner & 4 > 0);
            let point = middle + DVec3::select(sides, DVec3::splat(half), DVec3::splat(-half));
            let (at, depth) = self.project(point)?;
            if self.away(depth) < margin * DEPTH {
                return None;
            }
            (low, high) = (low.min(at), high.max(at));
            farthest = farthest.max(self.away(depth));
        }
        (low, high) = (low - margin * TEXELS, high + margin * TEXELS);
        let is_whole = low.cmpge(DVec2::ZERO).all() && high.cmple(self.size.as_dvec2()).all();
        let high = high.as_uvec2().min(self.size - 1);
        is_whole.then_some(Footprint { low: low.as_uvec2(), high, farthest })
    }

    /// The papers' rule: what the texel of the centre shows lies farther than half the cell's extent behind it.
    fn clears_center(&self, grid: &Grid, cell: UVec3) -> bool {
        let middle = middle(grid, cell);
        let Some((at, depth)) = self.project(middle) else { return false };
        let size = self.size.as_dvec2();
        let is_between = (at - at.round()).abs().min_element() < TEXELS;
        let is_outside = at.cmplt(DVec2::ZERO).any() || at.cmpge(size).any();
        if is_between || is_outside || self.away(depth) < DEPTH || self.away(depth) > 1.0 - DEPTH {
            return false;
        }
        let shown = f64::from(self.depth[(at.y as u32 * self.size.x + at.x as u32) as usize]);
        let surface = self.world_from_clip.project_point3(self.ndc(at).extend(shown));
        let along = |p: DVec3| -self.view.eye_from_world.as_dmat4().transform_point3(p).z;
        let reach = 0.5 * self.view.forward().as_dvec3().abs().element_sum();
        (along(surface) - along(middle)) / f64::from(grid.cell_size) > reach + CELLS
    }

    /// Ours: each texel that the cell touches shows something behind its farthest corner, or behind where rays leave it.
    fn clears_whole(&self, grid: &Grid, cell: UVec3, rule: CleanupRule) -> bool {
        let by_rays = rule == CleanupRule::Rays;
        let shift = if by_rays { 2.0 * SURFACE_SHIFT } else { SURFACE_SHIFT };
        let (middle, half) = (middle(grid, cell), f64::from(grid.cell_size) * (0.5 + shift));
        let Some(print) = self.footprint(middle, half, 1.0) else { return false };
        let across = (print.high - print.low).max_element();
        let mut block = 1;
        while across >= FINE * block {
            block *= 2;
        }
        let blocks = texels(print.low / block, print.high / block);
        blocks.into_iter().all(|(x, y)| {
            let first = block * UVec2::new(x, y);
            let last = (first + block - 1).min(self.size - 1);
            let behind = match by_rays {
                true => self.leaves(middle, half, first, last).min(print.farthest),
                false => print.farthest,
            };
            texels(first, last).into_iter().all(|(x, y)| self.shown(x, y) > behind + DEPTH)
        })
    }

    /// How far away the last ray through these texels leaves a cube: first by any face, last of the block's corners.
    fn leaves(&self, middle: DVec3, half: f64, first: UVec2, last: UVec2) -> f64 {
        let mut left = f64::MAX;
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let mut outward = DVec3::ZERO;
            outward[axis] = sign;
            // The face's plane in clip space: zero on it, growing beyond.
            let plane = self.world_from_clip.transpose() * outward.extend(-outward.dot(middle) - half);
            let away = if self.view.reversed_depth { -plane.z } else { plane.z };
            if away <= 0.0 {
                continue;
            }
            let corners = [first, UVec2::new(first.x, last.y), UVec2::new(last.x, first.y), last];
            let at = corners.map(|corner| {
                let ndc = self.ndc(corner.as_dvec2() + 0.5);
                self.away(-(plane.x * ndc.x + plane.y * ndc.y + plane.w) / plane.z)
            });
            left = left.min(at.into_iter().fold(f64::MIN, f64::max));
        }
        left
    }
}

fn middle(grid: &Grid, cell: UVec3) -> DVec3 {
    grid.origin.as_dvec3() + f64::from(grid.cell_size) * (cell.as_dvec3() + 0.5)
}

fn texels(low: UVec2, high: UVec2) -> impl IntoIterator<Item = (u32, u32)> {
    (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| (x, y)))
}
