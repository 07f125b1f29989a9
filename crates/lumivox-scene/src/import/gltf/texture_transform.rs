//! `KHR_texture_transform`, baked into texture coordinates.

use glam::{Affine2, Mat2, Vec2};
use gltf::texture::Info;

use crate::ImportReport;

/// Which texture coordinates a material uses, and what becomes of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct UvSource {
    /// `TEXCOORD_n`.
    pub(super) set: u32,
    transform: Option<Affine2>,
}

impl UvSource {
    /// That of a material's colour, else of its emission. A mesh has one set of texture coordinates, so an emission
    /// that differs from the colour is shown with the colour's.
    pub(super) fn of_material(
        color: Option<&Info>,
        emission: Option<&Info>,
        report: &mut ImportReport,
    ) -> Self {
        let [color, emission] = [color, emission].map(|info| info.map(|i| Self::of(i, report)));
        if let (Some(color), Some(emission)) = (color, emission)
            && color != emission
        {
            report.warn(
                "a material's emission uses other texture coordinates than its colour; those of the colour are kept",
            );
        }
        color.or(emission).unwrap_or_default()
    }

    fn of(info: &Info, report: &mut ImportReport) -> Self {
        let Some(stated) = info.texture_transform() else {
            return Self { set: info.tex_coord(), transform: None };
        };
        let set = stated.tex_coord().unwrap_or(info.tex_coord());
        let (sin, cos) = stated.rotation().sin_cos();
        // Counterclockwise as seen; v points down, so the signs are those of a clockwise turn in numbers.
        let turn = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
        let scaled = turn * Mat2::from_diagonal(stated.scale().into());
        let transform = Affine2::from_mat2_translation(scaled, stated.offset().into());
        if !transform.is_finite() {
            report.warn("a texture transform is left out: its numbers are not finite");
            return Self { set, transform: None };
        }
        Self { set, transform: Some(transform).filter(|t| *t != Affine2::IDENTITY) }
    }

    pub(super) fn apply(&self, uv: [f32; 2]) -> [f32; 2] {
        self.transform.map_or(uv, |t| t.transform_point2(uv.into()).to_array())
    }
}
