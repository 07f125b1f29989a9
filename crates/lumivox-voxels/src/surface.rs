//! What channels see at a point of a triangle.

use glam::{DMat3, DVec3, Mat3, Vec2, Vec3, Vec4};
use rayon::prelude::*;

use crate::channels::{FlatPiece, Source, fixed, unit};
use crate::coverage::Triangle;
use crate::fragment::{Piece, barycentric};
use crate::job::Job;
use crate::model::{Material, MaterialOf};
use crate::{Channel, MeshView, SurfacePoint};

/// What all triangles of a mesh share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// -1 where the mesh is mirrored, so that its triangles turn the other way.
    side: f32,
    normal_from_local: Mat3,
}

impl Placed {
    pub(crate) fn new(view: &MeshView<'_>) -> Self {
        let side = if view.world_from_local.determinant() < 0.0 { -1.0 } else { 1.0 };
        Self { side, normal_from_local: normal_from_local(view) }
    }
}

/// Which surface attributes the channels ask for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    albedo: bool,
    pub(crate) normal: bool,
    emission: bool,
    /// Everything, at its place.
    own: bool,
}

impl Asked {
    pub(crate) fn new(channels: &[Channel]) -> Self {
        let any = |is: fn(&Source) -> bool| channels.iter().any(|channel| is(&channel.source));
        Self {
            albedo: any(|s| matches!(s, Source::Albedo)),
            normal: any(|s| matches!(s, Source::Normal)),
            emission: any(|s| matches!(s, Source::Emission)),
            own: any(|s| matches!(s, Source::Custom(_) | Source::Area)),
        }
    }
}

/// A triangle about to be shaded.
pub(crate) struct Face<'a> {
    mesh: usize,
    number: u32,
    view: &'a MeshView<'a>,
    placed: &'a Placed,
    material_number: usize,
    material: &'a Material<'a>,
    /// Twice its area times its unit normal, in cells.
    normal: DVec3,
    /// The mesh's normal, if all corners have the same.
    corner_normal: Option<Vec3>,
    /// Whether its values or its outline depend on where one looks.
    pub(crate) varies: bool,
}

impl<'a> Face<'a> {
    /// `normal` is twice the triangle's area times its unit normal.
    #[inline]
    pub(crate) fn new(job: &'a Job<'a>, mesh: usize, number: u32, normal: DVec3) -> Self {
        let view = &job.model.meshes[mesh];
        let material_number = job.material_of(mesh, number);
        let material = job.model.materials.get(material_number).unwrap_or(&job.plain);
        let placed = &job.placed[mesh];
        let asked = &job.asked;
        let corner_normal = if asked.normal { equal_normals(view, number) } else { None };
        let varies = asked.own
            || varies(asked, view, material)
            || (asked.normal && view.normals.is_some() && corner_normal.is_none());
        let normal = f64::from(placed.side) * normal;
        Self { mesh, number, view, placed, material_number, material, normal, corner_normal, varies }
    }

    /// A stand-in for the faces of a mesh that are all flat and of one material, if it is such a mesh.
    pub(crate) fn flat(job: &'a Job<'a>, mesh: usize) -> Option<Self> {
        let MaterialOf::Mesh(material_number) = job.model.meshes[mesh].material else { return None };
        Self::plain(job, mesh, material_number)
    }

    /// The same for the faces of a mesh that have one of its materials.
    pub(crate) fn plain(job: &'a Job<'a>, mesh: usize, material_number: usize) -> Option<Self> {
        let view = &job.model.meshes[mesh];
        let material = job.model.materials.get(material_number).unwrap_or(&job.plain);
        (job.takes_flat && !varies(&job.asked, view, material)).then(|| Self {
            mesh,
            number: 0,
            view,
            placed: &job.placed[mesh],
            material_number,
            material,
            normal: DVec3::ZERO,
            corner_normal: None,
            varies: false,
        })
    }

    /// As [`Self::direction`], for a triangle of such a mesh; none if its normals differ.
    #[inline(always)]
    pub(crate) fn direction_of(
        &self,
        number: u32,
        normal: DVec3,
        asks_normal: bool,
    ) -> Option<(DVec3, bool)> {
        let normal = f64::from(self.placed.side) * normal;
        if !asks_normal || self.view.normals.is_none() {
            return Some((normal, true));
        }
        let corner_normal = equal_normals(self.view, number)?;
        Some(direction(self.placed, Some(corner_normal), normal))
    }

    /// The values of channels of colours in fixed point.
    pub(crate) fn shade_flat(&self, channels: &[Channel], fixed_values: &mut [[i64; 4]]) {
        for (channel, fixed_values) in channels.iter().zip(fixed_values) {
            let value = match channel.source {
                Source::Albedo => self.material.base_color.to_array(),
                Source::Emission => self.material.emission.extend(0.0).to_array(),
                _ => [0.0; 4],
            };
            *fixed_values = fixed(value, channel.components);
        }
    }

    /// What points as the normals of a face do that has one normal, with the face's area times two as length if it is
    /// the geometry's own.
    #[inline]
    pub(crate) fn direction(&self) -> (DVec3, bool) {
        direction(self.placed, self.corner_normal, self.normal)
    }

    fn unit_normal(&self) -> Vec3 {
        unit(self.direction().0)
    }

    /// What the colours of flat faces depend on.
    pub(crate) fn constants(&self) -> usize {
        self.material_number
    }

    /// Fills in the values of all channels, and the same in fixed point. False, with nothing filled in, in the holes of
    /// a mask.
    pub(crate) fn shade(
        &self,
        job: &Job<'_>,
        triangle: &Triangle,
        piece: &Piece,
        values: &mut [[f32; 4]],
        fixed_values: &mut [[i64; 4]],
    ) -> bool {
        let point = if self.varies {
            self.point(job, triangle, piece)
        } else {
            SurfacePoint {
                position: Vec3::ZERO,
                normal: if job.asked.normal { self.unit_normal() } else { Vec3::ZERO },
                uv: Vec2::ZERO,
                uv_area: 0.0,
                color: self.material.base_color,
                emission: self.material.emission,
                area: 0.0,
                barycentric: Vec3::ZERO,
                mesh: self.mesh,
                triangle: self.number as usize,
                material: self.material_number,
            }
        };
        if self.material.alpha_cutoff.is_some_and(|cutoff| point.color.w < cutoff) {
            return false;
        }
        for ((channel, values), fixed_values) in job.channels.iter().zip(values).zip(fixed_values) {
            *values = match &channel.source {
                Source::Albedo => point.color.to_array(),
                Source::Normal => point.normal.extend(0.0).to_array(),
                Source::Emission => point.emission.extend(0.0).to_array(),
                Source::Area => [point.area, 0.0, 0.0, 0.0],
                Source::Custom(function) => function(&point),
            };
            *fixed_values = fixed(*values, channel.components);
        }
        true
    }

    fn point(&self, job: &Job<'_>, triangle: &Triangle, piece: &Piece) -> SurfacePoint {
        let side = f64::from(job.grid.cell_size);
        let indices = self.view.triangles.indices[self.number as usize].map(|i| i as usize);
        let weights = barycentric(triangle, piece.point).as_vec3();
        let uvs = self.view.uvs.map_or([Vec2::ZERO; 3], |uvs| indices.map(|i| Vec2::from_array(uvs[i])));
        let uv = (0..3).map(|i| weights[i] * uvs[i]).sum();
        let whole = triangle.normal().length();
        let uv_area = if whole > 0.0 {
            // Both areas are twice too large.
            (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs() * (piece.area / whole) as f32
        } else {
            0.0
        };
        let vertex_color = self.view.colors.map_or(Vec4::ONE, |colors| {
            (0..3).map(|i| weights[i] * Vec4::from_array(colors[indices[i]])).sum()
        });
        let face_normal = unit(self.normal);
        let normal = self.view.normals.map_or(face_normal, |normals| {
            let local: Vec3 = (0..3).map(|i| weights[i] * Vec3::from_array(normals[indices[i]])).sum();
            unit((self.placed.normal_from_local * local).as_dvec3())
        });
        let texel = |texture: Option<&crate::TextureFn<'_>>| {
            texture.map_or(Vec4::ONE, |texture| texture(uv, uv_area))
        };
        SurfacePoint {
            position: job.world_from_grid(piece.point).as_vec3(),
            normal: if normal == Vec3::ZERO { face_normal } else { normal },
            uv,
            uv_area,
            color: self.material.base_color * texel(self.material.base_color_texture) * vertex_color,
            emission: self.material.emission * texel(self.material.emission_texture).truncate(),
            area: (piece.area * side * side) as f32,
            barycentric: weights,
            mesh: self.mesh,
            triangle: self.number as usize,
            material: self.material_number,
        }
    }
}

/// The plane of a flat triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatFace {
    /// Its normal as channels see it, for each cell face of its area.
    per_area: DVec3,
    /// Anything that points like that.
    direction: DVec3,
}

impl FlatFace {
    /// `length` is twice the area, and the rest as [`Face::direction`] has it.
    #[inline(always)]
    pub(crate) fn new(length: f64, (direction, is_doubled_area): (DVec3, bool)) -> Self {
        let per_area = match is_doubled_area {
            true if length > 0.0 => direction * (1.0 / length),
            true => DVec3::ZERO,
            false => direction,
        };
        Self { per_area, direction }
    }

    /// All of a face, with what [`Self::new`] takes.
    #[inline(always)]
    pub(crate) fn whole(length: f64, (direction, is_doubled_area): (DVec3, bool)) -> FlatPiece {
        let area = 0.5 * length;
        FlatPiece::new(area, if is_doubled_area { 0.5 * direction } else { area * direction }, direction)
    }

    /// A part of it.
    #[inline(always)]
    pub(crate) fn piece(&self, area: f64) -> FlatPiece {
        FlatPiece::new(area, area * self.per_area, self.direction)
    }
}

/// Whether all triangles of a mesh have one normal each.
pub(crate) fn has_flat_normals(view: &MeshView<'_>) -> bool {
    let Some(normals) = view.normals else { return true };
    view.triangles.indices.par_iter().with_min_len(4096).all(|triangle| {
        let [a, b, c] = triangle.map(|i| normals.get(i as usize));
        // Triangles that name no vertex are left out.
        a.is_none() || b.is_none() || c.is_none() || (a == b && b == c)
    })
}

/// Whether colours or outlines depend on where one looks on a mesh.
fn varies(asked: &Asked, view: &MeshView<'_>, material: &Material<'_>) -> bool {
    material.alpha_cutoff.is_some()
        || (asked.albedo && (view.colors.is_some() || material.base_color_texture.is_some()))
        || (asked.emission && material.emission_texture.is_some())
}

#[inline]
fn direction(placed: &Placed, corner_normal: Option<Vec3>, normal: DVec3) -> (DVec3, bool) {
    let turned = || (placed.normal_from_local * corner_normal?).try_normalize();
    match turned() {
        Some(normal) => (normal.as_dvec3(), false),
        None => (normal, true),
    }
}

/// The normal of a triangle whose corners have the same.
#[inline]
fn equal_normals(view: &MeshView<'_>, number: u32) -> Option<Vec3> {
    let normals = view.normals?;
    let [a, b, c] = view.triangles.indices[number as usize].map(|i| normals[i as usize]);
    (a == b && b == c).then(|| Vec3::from_array(a))
}

/// Turns normals as the mesh is turned: the cofactors, which exist for flattening transforms too.
fn normal_from_local(view: &MeshView<'_>) -> Mat3 {
    let m = DMat3::from_mat4(view.world_from_local.as_dmat4());
    let cofactors =
        DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let largest = cofactors.to_cols_array().into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    // A mirror turns cofactors inside out.
    let scale = if m.determinant() < 0.0 { -1.0 } else { 1.0 } / if largest > 0.0 { largest } else { 1.0 };
    (cofactors * scale).as_mat3()
}
