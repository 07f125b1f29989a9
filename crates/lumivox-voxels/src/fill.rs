//! Solid fill: what no path of face neighbours leads to from outside the grid.
//!
//! Bricks without surface are filled as one; in bricks with surface the cells of 64-bit layers spread at once. The time
//! goes with the number of bricks of the whole grid: about half a second for 2048 cells a side.

use glam::{IVec3, UVec3};

use crate::boundary;
use crate::job::Job;
use crate::options::Stage;
use crate::sparse::{BrickSet, Mask, SIDE, brick_index, brick_of};
use crate::{GridSpec, Model, SolidReport, SparseVolume, VoxelizeError, VoxelizeOptions};

/// Bits with x = 0, and those with y = 0.
const LOW_X: u64 = 0x0101_0101_0101_0101;
const LOW_Y: u64 = 0xff;
const FULL: Mask = [u64::MAX; SIDE as usize];

impl SparseVolume {
    /// Fills what the surface encloses, as [`VoxelizeOptions::solid`] does, in a volume that was made elsewhere. The holes are those of
    /// `model`, which it was made of; of the options the limit of memory and the progress count.
    ///
    /// # Errors
    /// As of [`voxelize`](crate::voxelize).
    pub fn filled(self, model: &Model<'_>, options: &VoxelizeOptions<'_>) -> Result<Self, VoxelizeError> {
        let grid = *self.grid();
        let options = VoxelizeOptions { grid: GridSpec::Grid(grid), channels: Vec::new(), ..options.clone() };
        let job = Job::new(model, &options, grid)?;
        let (solid, found) = solid(&job, self.surface())?;
        Ok(self.with_solid(solid, found))
    }
}

/// The surface and all that it encloses.
pub(crate) fn solid(job: &Job<'_>, surface: &BrickSet) -> Result<(BrickSet, SolidReport), VoxelizeError> {
    let mut outside = Outside::new(job.dims(), surface);
    outside.enter();
    outside.spread(|done, total| job.report(Stage::Filling, done, total))?;
    let solid = outside.rest(job)?;
    let (boundary_edges, hole) = boundary::longest_hole(job);
    let filled_cells = solid.len() - surface.len();
    Ok((solid, SolidReport { filled_cells, boundary_edges, hole }))
}

/// What has been reached from outside.
struct Outside<'a> {
    dims: UVec3,
    along: UVec3,
    surface: &'a BrickSet,
    /// Reached cells of the bricks with surface, by the number of the brick.
    cells: Vec<Mask>,
    /// Whether a brick without surface is reached, a bit each by the index of the brick.
    bricks: Vec<u64>,
    /// Bricks that have something new to hand on.
    waiting: Vec<u32>,
}

impl<'a> Outside<'a> {
    fn new(dims: UVec3, surface: &'a BrickSet) -> Self {
        let along = surface.along();
        let count = along.element_product() as usize;
        Self {
            dims,
            along,
            surface,
            cells: vec![[0; SIDE as usize]; surface.brick_count()],
            bricks: vec![0; count.div_ceil(64)],
            waiting: Vec::new(),
        }
    }

    /// Starts at the faces of the grid. Cells of the last bricks that lie beyond the grid count as outside.
    fn enter(&mut self) {
        let last = self.along - 1;
        for index in 0..self.along.element_product() {
            let brick = brick_of(self.along, index);
            if brick.cmpne(UVec3::ZERO).all() && brick.cmplt(last).all() {
                continue;
            }
            let mut way_in = inside(self.dims, brick).map(|word| !word);
            for axis in 0..3 {
                if brick[axis] == 0 {
                    join(&mut way_in, &face(axis, false));
                }
                if brick[axis] == last[axis] {
                    join(&mut way_in, &face(axis, true));
                }
            }
            self.reach(brick, &way_in);
        }
    }

    /// Hands on until nothing is new.
    fn spread(
        &mut self,
        mut report: impl FnMut(u64, u64) -> Result<(), VoxelizeError>,
    ) -> Result<(), VoxelizeError> {
        let total = u64::from(self.along.element_product());
        let mut done = 0u64;
        while let Some(index) = self.waiting.pop() {
            done += 1;
            if done.is_multiple_of(1 << 16) {
                report(done.min(total), total)?;
            }
            let brick = brick_of(self.along, index);
            let reached = match self.surface.number(brick) {
                Some(number) => {
                    flood(&mut self.cells[number], self.surface.mask_of(number));
                    self.cells[number]
                }
                None => FULL,
            };
            for axis in 0..3 {
                for upwards in [false, true] {
                    let mut step = IVec3::ZERO;
                    step[axis] = if upwards { 1 } else { -1 };
                    let next = brick.as_ivec3() + step;
                    if next.cmpge(IVec3::ZERO).all() && next.cmplt(self.along.as_ivec3()).all() {
                        self.reach(next.as_uvec3(), &across(&reached, axis, upwards));
                    }
                }
            }
        }
        report(total, total)
    }

    /// Marks cells of a brick as reached, unless they are surface; the brick waits if there is anything new.
    fn reach(&mut self, brick: UVec3, cells: &Mask) {
        let index = brick_index(self.along, brick);
        let is_new = match self.surface.number(brick) {
            Some(number) => {
                let surface = self.surface.mask_of(number);
                let mut news = 0;
                for (z, reached) in self.cells[number].iter_mut().enumerate() {
                    let new = cells[z] & !surface[z] & !*reached;
                    *reached |= new;
                    news |= new;
                }
                news != 0
            }
            None => {
                let word = &mut self.bricks[index as usize / 64];
                let bit = 1 << (index % 64);
                let is_new = *word & bit == 0 && cells.iter().any(|&c| c != 0);
                if is_new {
                    *word |= bit;
                }
                is_new
            }
        };
        if is_new {
            self.waiting.push(index);
        }
    }

    /// All cells that were not reached.
    fn rest(self, job: &Job<'_>) -> Result<BrickSet, VoxelizeError> {
        let (mut indices, mut masks) = (Vec::new(), Vec::new());
        for index in 0..self.along.element_product() {
            let reached_brick = self.bricks[index as usize / 64] >> (index % 64) & 1 == 1;
            if reached_brick {
                continue;
            }
            let brick = brick_of(self.along, index);
            let reached = self.surface.number(brick).map_or([0; SIDE as usize], |number| self.cells[number]);
            let mut rest = inside(self.dims, brick);
            rest.iter_mut().zip(reached).for_each(|(rest, reached)| *rest &= !reached);
            if rest != [0; SIDE as usize] {
                indices.push(index);
                masks.push(rest);
            }
            if masks.len() % 4096 == 4095 {
                job.check_bytes(masks.len() * (size_of::<Mask>() + 16))?;
            }
        }
        Ok(BrickSet::new(self.dims, indices, masks))
    }
}

/// The cells of a brick that lie in the grid.
fn inside(dims: UVec3, brick: UVec3) -> Mask {
    let left = (dims - brick * SIDE).min(UVec3::splat(SIDE));
    let row = if left.x == SIDE { 0xff } else { (1u64 << left.x) - 1 };
    let layer = (0..left.y).fold(0, |layer, y| layer | row << (SIDE * y));
    std::array::from_fn(|z| if (z as u32) < left.z { layer } else { 0 })
}

/// The cells on one face of a brick.
fn face(axis: usize, upper: bool) -> Mask {
    match (axis, upper) {
        (0, false) => [LOW_X; SIDE as usize],
        (0, true) => [LOW_X << 7; SIDE as usize],
        (1, false) => [LOW_Y; SIDE as usize],
        (1, true) => [LOW_Y << 56; SIDE as usize],
        (_, upper) => {
            let mut mask = [0; SIDE as usize];
            mask[if upper { 7 } else { 0 }] = u64::MAX;
            mask
        }
    }
}

fn join(mask: &mut Mask, other: &Mask) {
    mask.iter_mut().zip(other).for_each(|(a, b)| *a |= b);
}

/// What the neighbour along an axis sees of a brick's reached cells, on its own facing side.
fn across(reached: &Mask, axis: usize, upwards: bool) -> Mask {
    let side = face(axis, upwards);
    let mut seen = [0; SIDE as usize];
    for z in 0..SIDE as usize {
        let bits = reached[z] & side[z];
        match (axis, upwards) {
            (0, true) => seen[z] = bits >> 7,
            (0, false) => seen[z] = bits << 7,
            (1, true) => seen[z] = bits >> 56,
            (1, false) => seen[z] = bits << 56,
            (_, _) => seen[SIDE as usize - 1 - z] = bits,
        }
    }
    seen
}

/// Spreads reached cells within a brick, around those of `walls`.
fn flood(reached: &mut Mask, walls: &Mask) {
    loop {
        let before = *reached;
        // Upwards and then downwards, so that one pass carries through all layers.
        for z in 0..SIDE as usize {
            let below = if z == 0 { 0 } else { reached[z - 1] };
            reached[z] = flood_layer((reached[z] | below) & !walls[z], walls[z]);
        }
        for z in (0..SIDE as usize - 1).rev() {
            reached[z] = flood_layer((reached[z] | reached[z + 1]) & !walls[z], walls[z]);
        }
        if *reached == before {
            return;
        }
    }
}

fn flood_layer(layer: u64, walls: u64) -> u64 {
    let mut layer = layer;
    loop {
        let along_x = (layer & !(LOW_X << 7)) << 1 | (layer & !LOW_X) >> 1;
        let next = (layer | along_x | layer << 8 | layer >> 8) & !walls;
        if next == layer {
            return layer;
        }
        layer = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_meet_and_layers_spread_around_walls() {
        for axis in 0..3 {
            assert_eq!(across(&FULL, axis, true), face(axis, false));
            assert_eq!(across(&FULL, axis, false), face(axis, true));
        }
        // A wall with a gap at its upper end, x = 3.
        let wall = (0..7).fold(0u64, |wall, y| wall | 1 << (3 + 8 * y));
        assert_eq!(flood_layer(1, wall), !wall);
        let closed = wall | 1 << (3 + 8 * 7);
        assert_eq!(flood_layer(1, closed).count_ones(), 24);
        let mut reached = [0; 8];
        reached[7] = 1;
        let mut walls = [0; 8];
        walls[4] = u64::MAX;
        flood(&mut reached, &walls);
        assert_eq!(reached.map(u64::count_ones), [0, 0, 0, 0, 0, 64, 64, 64]);
    }
}
