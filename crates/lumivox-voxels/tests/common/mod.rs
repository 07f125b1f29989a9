//! Meshes and comparisons that tests share.
#![allow(dead_code, reason = "each test binary uses its own part")]

use glam::{UVec3, Vec3};
use lumivox_core::{Grid, TriangleView};
use lumivox_oracle::voxels::{Coverage as Reference, VoxelDifference, VoxelSet};
use lumivox_voxels::{Coverage, GridSpec, Model, SparseVolume, VoxelizeOptions, voxelize};

pub(crate) const COVERAGES: [Coverage; 3] = [Coverage::Exact, Coverage::Thin, Coverage::Sampled];

/// A mesh that owns its arrays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Soup {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) indices: Vec<[u32; 3]>,
}

impl Soup {
    pub(crate) fn view(&self) -> TriangleView<'_> {
        TriangleView { positions: &self.positions, indices: &self.indices }
    }

    pub(crate) fn of(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let mut soup = Self::default();
        for triangle in triangles {
            let n = soup.positions.len() as u32;
            soup.positions.extend(triangle.map(|p| p.to_array()));
            soup.indices.push([n, n + 1, n + 2]);
        }
        soup
    }
}

/// Numbers without pattern, 0..1.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn roll(&mut self) -> f32 {
        // The multiplier and increment of Knuth's MMIX; the upper bits are good.
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    pub(crate) fn point(&mut self) -> Vec3 {
        Vec3::new(self.roll(), self.roll(), self.roll())
    }
}

/// A closed sphere of `8 * 4^level` triangles around the origin.
pub(crate) fn sphere(radius: f32, level: u32) -> Soup {
    let mut triangles: Vec<[Vec3; 3]> = Vec::new();
    for octant in 0..8 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let [x, y, z] = [sign(0) * Vec3::X, sign(1) * Vec3::Y, sign(2) * Vec3::Z];
        triangles.push(if sign(0) * sign(1) * sign(2) > 0.0 { [x, y, z] } else { [x, z, y] });
    }
    for _ in 0..level {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [(a + b), (b + c), (c + a)].map(|v| v.normalize_or_zero());
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    Soup::of(triangles.into_iter().map(|t| t.map(|p| radius * p)))
}

/// A closed box between two corners, 12 triangles.
pub(crate) fn cuboid(low: Vec3, high: Vec3) -> Soup {
    let corner = |n: u32| {
        let pick = |bit: u32, a: f32, b: f32| if n >> bit & 1 == 0 { a } else { b };
        Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    };
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Soup::of(faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(corner)))
}

/// A grid of unit cells at the origin.
pub(crate) fn unit_grid(x: u32, y: u32, z: u32) -> Grid {
    Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::new(x, y, z) }
}

pub(crate) fn on_grid(soup: &Soup, grid: Grid, coverage: Coverage) -> SparseVolume {
    let options = VoxelizeOptions { grid: GridSpec::Grid(grid), coverage, ..VoxelizeOptions::default() };
    voxelize(&Model::from(soup.view()), &options).unwrap()
}

pub(crate) fn flags(volume: &SparseVolume) -> Vec<bool> {
    let mut flags = vec![false; volume.grid().cell_count() as usize];
    volume.cells().for_each(|cell| flags[volume.grid().index(cell)] = true);
    flags
}

/// Our cells against the oracle's, of which those may differ that hang on a ten-thousandth of a cell.
pub(crate) fn against_oracle(soup: &Soup, grid: Grid, coverage: Coverage) -> VoxelDifference {
    let ours = on_grid(soup, grid, coverage);
    let reference = match coverage {
        Coverage::Exact => Reference::Exact,
        Coverage::Thin => Reference::Thin,
        Coverage::Sampled => Reference::Sampled,
    };
    let set = VoxelSet::of(grid, soup.view(), reference);
    VoxelDifference::between(&flags(&ours), &set).unwrap()
}

/// Fails unless the two agree, and prints how many cells were left to the margin.
pub(crate) fn assert_agrees(what: &str, soup: &Soup, grid: Grid) {
    for coverage in COVERAGES {
        let difference = against_oracle(soup, grid, coverage);
        println!("{what}, {coverage:?}: {difference}");
        assert!(difference.is_equal_within_margin(), "{what}, {coverage:?}: {difference}");
    }
}
