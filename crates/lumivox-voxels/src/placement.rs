//! From a mesh's own space to cells.

use glam::{DAffine3, DMat3, DVec3, IVec3, Mat4};
use lumivox_core::Grid;

use crate::coverage::{cell_of, is_inside, onto_rim};

/// A cell in one word, or none for a vertex that is not finite. Coordinates are one more than [`cell_of`] says, so that
/// none is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PackedCell(u64);

impl PackedCell {
    pub(crate) const NONE: Self = Self(u64::MAX);

    #[inline]
    fn new(cell: IVec3) -> Self {
        let [x, y, z] = (cell + 1).as_u64vec3().to_array();
        Self(x | y << 16 | z << 32)
    }

    #[inline]
    pub(crate) fn cell(self) -> IVec3 {
        let part = |shift: u32| i32::from((self.0 >> shift) as u16) - 1;
        IVec3::new(part(0), part(16), part(32))
    }
}

/// Where a mesh stands in a grid.
pub(crate) struct Placement {
    way: Way,
    rim: Rim,
    snap: f64,
}

enum Way {
    /// Meshes that stand as they are.
    Scaled(Scaled),
    /// All others.
    Affine(DAffine3),
}

/// Scale and offset, which is all that most meshes need.
#[derive(Clone, Copy)]
pub(crate) struct Scaled {
    scale: f64,
    offset: DVec3,
    rim: Rim,
}

/// The grid's faces, and how far outside of them corners are moved onto them.
#[derive(Clone, Copy)]
struct Rim {
    dims: DVec3,
    width: f64,
}

impl Placement {
    /// `snap` as [`VoxelizeOptions`](crate::VoxelizeOptions) has it.
    pub(crate) fn new(grid: &Grid, world_from_local: &Mat4, snap: f64) -> Self {
        let side = f64::from(grid.cell_size);
        let grid_from_world = DAffine3 {
            matrix3: DMat3::from_diagonal(DVec3::splat(1.0 / side)),
            translation: -grid.origin.as_dvec3() / side,
        };
        // Half of the last bit of coordinates in f32 is 2^-13 cells in a grid of 2048.
        let width = (f64::from(grid.dims.max_element()) * 2f64.powi(-23)).max(1e-4);
        let rim = Rim { dims: grid.dims.as_dvec3(), width };
        let way = if *world_from_local == Mat4::IDENTITY {
            let (scale, offset) = (grid_from_world.matrix3.x_axis.x, grid_from_world.translation);
            Way::Scaled(Scaled { scale, offset, rim })
        } else {
            Way::Affine(grid_from_world * DAffine3::from_mat4(world_from_local.as_dmat4()))
        };
        Self { way, rim, snap: if snap > 0.0 { snap.min(0.5) } else { 0.0 } }
    }

    /// The placement if it is of the simplest kind.
    pub(crate) fn scaled(&self) -> Option<Scaled> {
        match &self.way {
            Way::Scaled(scaled) if self.snap == 0.0 => Some(*scaled),
            _ => None,
        }
    }

    /// A vertex in units of cells.
    #[inline(always)]
    pub(crate) fn corner(&self, position: &[f32; 3]) -> DVec3 {
        match &self.way {
            Way::Scaled(scaled) if self.snap == 0.0 => scaled.corner(position),
            _ => self.any_corner(position),
        }
    }

    /// Not inlined, so that the code of most meshes stays near.
    #[inline(never)]
    fn any_corner(&self, position: &[f32; 3]) -> DVec3 {
        let corner = match &self.way {
            Way::Scaled(scaled) => scaled.at(position),
            Way::Affine(grid_from_local) => {
                grid_from_local.transform_point3(DVec3::from_array(position.map(f64::from)))
            }
        };
        if self.snap == 0.0 {
            return self.rim.onto(corner);
        }
        let boundary = corner.round();
        let is_near = (corner - boundary).abs().cmple(DVec3::splat(self.snap));
        self.rim.onto(DVec3::select(is_near, boundary, corner))
    }

    /// Corners of a triangle.
    #[inline(always)]
    pub(crate) fn corners(&self, [a, b, c]: [&[f32; 3]; 3]) -> [DVec3; 3] {
        match &self.way {
            Way::Scaled(scaled) if self.snap == 0.0 => [scaled.corner(a), scaled.corner(b), scaled.corner(c)],
            _ => [self.any_corner(a), self.any_corner(b), self.any_corner(c)],
        }
    }

    /// The cell of a corner.
    #[inline]
    pub(crate) fn cell(&self, corner: DVec3) -> PackedCell {
        if corner.is_finite() { PackedCell::new(cell_of(corner, self.rim.dims)) } else { PackedCell::NONE }
    }
}

impl Scaled {
    #[inline(always)]
    fn at(&self, &[x, y, z]: &[f32; 3]) -> DVec3 {
        self.scale * DVec3::new(x.into(), y.into(), z.into()) + self.offset
    }

    /// As [`Placement::corner`].
    #[inline(always)]
    pub(crate) fn corner(&self, position: &[f32; 3]) -> DVec3 {
        self.rim.onto(self.at(position))
    }
}

impl Rim {
    #[inline(always)]
    fn onto(&self, corner: DVec3) -> DVec3 {
        if is_inside(corner, self.dims) { corner } else { onto_rim(corner, self.dims, self.width) }
    }
}
