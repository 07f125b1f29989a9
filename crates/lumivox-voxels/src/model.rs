//! What is voxelized: meshes in borrowed slices, and materials.

use glam::{Mat4, Vec2, Vec3, Vec4};
use lumivox_core::{Bounds, TriangleView};
use rayon::prelude::*;

/// A texture: linear colour and opacity around texture coordinates, whatever they are; wrapping is its own affair. The second
/// argument is the area in texture coordinates that the answer stands for, so that a texture finer than the cells can be
/// averaged over it.
pub type TextureFn<'a> = dyn Fn(Vec2, f32) -> Vec4 + Sync + 'a;

/// A surface: linear values, multiplied by textures and vertex colours.
#[derive(Clone, Copy)]
pub struct Material<'a> {
    /// Linear albedo (rgb) and opacity (a).
    pub base_color: Vec4,
    /// Multiplies `base_color`.
    pub base_color_texture: Option<&'a TextureFn<'a>>,
    /// Emitted radiance in W/(m2 sr).
    pub emission: Vec3,
    /// Its rgb multiplies `emission`.
    pub emission_texture: Option<&'a TextureFn<'a>>,
    /// Where the opacity is less than this, there is no surface: a triangle marks only cells in which it is at least
    /// this at the fragment's point. One point stands for a cell, so that holes smaller than cells come and go.
    pub alpha_cutoff: Option<f32>,
}

impl Default for Material<'_> {
    /// White, opaque, dark.
    fn default() -> Self {
        Self {
            base_color: Vec4::ONE,
            base_color_texture: None,
            emission: Vec3::ZERO,
            emission_texture: None,
            alpha_cutoff: None,
        }
    }
}

impl std::fmt::Debug for Material<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Material")
            .field("base_color", &self.base_color)
            .field("emission", &self.emission)
            .field("alpha_cutoff", &self.alpha_cutoff)
            .finish_non_exhaustive()
    }
}

/// Which material a triangle has.
#[derive(Clone, Copy, Debug)]
pub enum MaterialOf<'a> {
    /// All triangles have this one.
    Mesh(usize),
    /// One number per triangle.
    Triangle(&'a [u32]),
}

/// One placed mesh: triangles and attributes per vertex, all borrowed. A mesh that stands in several places is several
/// of these over the same slices.
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a> {
    /// Positions in the mesh's own space, and triangles; any soup. Triangles with an index out of range or a position
    /// that is not finite are skipped and counted.
    pub triangles: TriangleView<'a>,
    /// Normals of any length; without them the faces' own.
    pub normals: Option<&'a [[f32; 3]]>,
    /// Texture coordinates.
    pub uvs: Option<&'a [[f32; 2]]>,
    /// Linear colour and opacity that multiply the material's.
    pub colors: Option<&'a [[f32; 4]]>,
    /// Number into [`Model::materials`]; one that is out of range stands for the default material.
    pub material: MaterialOf<'a>,
    /// The mesh's own space to the world.
    pub world_from_local: Mat4,
}

impl<'a> MeshView<'a> {
    /// A mesh of the first material, with nothing but geometry, that stands where its positions say.
    pub fn new(triangles: TriangleView<'a>) -> Self {
        Self {
            triangles,
            normals: None,
            uvs: None,
            colors: None,
            material: MaterialOf::Mesh(0),
            world_from_local: Mat4::IDENTITY,
        }
    }

    /// The world box around the mesh's triangles, leaving aside what is not finite.
    pub fn bounds(&self) -> Bounds {
        let (positions, to_world) = (self.triangles.positions, self.world_from_local);
        let stands = to_world == Mat4::IDENTITY;
        let parts = self.triangles.indices.par_chunks(1 << 14).map(|triangles| {
            let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
            for &position in triangles.iter().flatten().filter_map(|&i| positions.get(i as usize)) {
                let point =
                    if stands { position } else { to_world.transform_point3(position.into()).to_array() };
                for axis in 0..3 {
                    // One instruction each, where `f32::min` is several; NaN compares as false and is passed by.
                    low[axis] = if point[axis] < low[axis] { point[axis] } else { low[axis] };
                    high[axis] = if point[axis] > high[axis] { point[axis] } else { high[axis] };
                }
            }
            let bounds = Bounds::new(low.into(), high.into());
            if bounds.min.is_finite() && bounds.max.is_finite() {
                return bounds;
            }
            let used = triangles.iter().flatten().filter_map(|&i| positions.get(i as usize));
            Bounds::of_points(used.map(|&p| to_world.transform_point3(p.into())))
        });
        parts.reduce(|| Bounds::EMPTY, |a, b| a.union(&b))
    }

    /// What is wrong with the number of its attributes, if anything.
    pub(crate) fn fault(&self) -> Option<String> {
        let positions = self.triangles.positions.len();
        let triangles = self.triangles.indices.len();
        let lengths = [
            ("normals", self.normals.map(<[_]>::len), positions),
            ("texture coordinates", self.uvs.map(<[_]>::len), positions),
            ("colours", self.colors.map(<[_]>::len), positions),
            (
                "material numbers",
                match self.material {
                    MaterialOf::Mesh(_) => None,
                    MaterialOf::Triangle(numbers) => Some(numbers.len()),
                },
                triangles,
            ),
        ];
        lengths.into_iter().find_map(|(what, found, wanted)| match found {
            Some(found) if found != wanted => Some(format!("{found} {what} where {wanted} are needed")),
            _ => None,
        })
    }
}

/// Meshes and the materials they name.
#[derive(Clone, Debug, Default)]
pub struct Model<'a> {
    /// The meshes.
    pub meshes: Vec<MeshView<'a>>,
    /// The materials.
    pub materials: Vec<Material<'a>>,
}

impl Model<'_> {
    /// The world box around all triangles.
    pub fn bounds(&self) -> Bounds {
        self.meshes.iter().fold(Bounds::EMPTY, |sum, mesh| sum.union(&mesh.bounds()))
    }
}

impl<'a> From<TriangleView<'a>> for Model<'a> {
    fn from(triangles: TriangleView<'a>) -> Self {
        Self { meshes: vec![MeshView::new(triangles)], materials: Vec::new() }
    }
}
