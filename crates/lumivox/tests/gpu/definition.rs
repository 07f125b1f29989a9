//! What cleanup and injection are defined to do, in double precision and without the shaders' code, for one cell or sample
//! at a time. Verdicts that single precision may turn over are marked as such.

use lumivox::core::{Grid, View};
use lumivox::glam::{DVec2, DVec3, DVec4, IVec3, UVec2, UVec3};
use lumivox::progressive::SURFACE_SHIFT;

use crate::support::{SCALE, Shot, lifted, ndc_of_texel};

/// Distance from the eye along the view direction, in double precision.
fn distance_along(view: &View, point: DVec3) -> f64 {
    -view.eye_from_world.as_dmat4().transform_point3(point).z
}

/// How far a cell lies before what the view shows there, less the bias, in cells: positive when it is proven empty. None
/// when it is not in the picture, or so near a texel's border that single precision may look into the next texel.
pub(crate) fn margin_of_emptiness(shot: &Shot, grid: &Grid, cell: UVec3) -> Result<f64, bool> {
    const CLEAR_OF_BORDER: f64 = 1e-4;
    let cell_size = f64::from(grid.cell_size);
    let center = grid.origin.as_dvec3() + cell_size * (cell.as_dvec3() + 0.5);
    let clip: DVec4 = shot.view.clip_from_world.as_dmat4() * center.extend(1.0);
    let ndc = clip.truncate() / clip.w;
    let at = DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * shot.picture.size.as_dvec2();
    if (at - at.round()).abs().min_element() < CLEAR_OF_BORDER {
        return Err(true);
    }
    if clip.w <= 0.0 || at.min_element() < 0.0 || at.cmpge(shot.picture.size.as_dvec2()).any() {
        return Err(false);
    }
    if ndc.z < 0.0 || ndc.z > 1.0 {
        return Err(ndc.z.abs().min((ndc.z - 1.0).abs()) < 1e-5);
    }
    let depth = shot.picture.depth[(at.y as u32 * shot.picture.size.x + at.x as u32) as usize];
    // What was not drawn lies at the far plane: a surface behind it may reach into the last cell before it.
    let surface = distance_along(&shot.view, lifted(&shot.view, ndc.truncate(), depth));
    let forward = shot.view.forward().as_dvec3().abs();
    let bias = 0.5 * cell_size * forward.element_sum();
    Ok((surface - bias - distance_along(&shot.view, center)) / cell_size)
}

/// Sums of the samples that fall in one cell: normal, albedo, emission, and three bands of light.
#[derive(Clone, Copy, Default)]
pub(crate) struct Sums {
    pub(crate) count: f64,
    pub(crate) attributes: [DVec3; 3],
    pub(crate) light: [DVec4; 3],
    /// A sample lies so near the cell's border that single precision may put it on the other side.
    pub(crate) uncertain: bool,
}

/// What injection is defined to add up, with every `stride`-th texel as a point.
pub(crate) fn defined_sums(shots: &[&Shot], grid: &Grid, stride: u32) -> Vec<Sums> {
    /// Error of a depth value lifted in single precision, in cells.
    const CLEAR_OF_BORDER: f64 = 5e-4;
    let pi = std::f64::consts::PI;
    let mut cells = vec![Sums::default(); grid.cell_count() as usize];
    for shot in shots {
        let size = shot.picture.size;
        let points = (stride / 2..size.y).step_by(stride as usize);
        let points = points.flat_map(|y| (stride / 2..size.x).step_by(stride as usize).map(move |x| (x, y)));
        for (x, y) in points {
            let texel = (y * size.x + x) as usize;
            let [nx, ny, nz, _] = shot.picture.normal[texel].map(f64::from);
            let Some(n) = DVec3::new(nx, ny, nz).try_normalize() else { continue };
            let depth = shot.picture.depth[texel];
            let world = lifted(&shot.view, ndc_of_texel(UVec2::new(x, y), size), depth);
            let p = (world - grid.origin.as_dvec3()) / f64::from(grid.cell_size) - SURFACE_SHIFT * n;
            let inside = |c: IVec3| c.cmpge(IVec3::ZERO).all() && c.cmplt(grid.dims.as_ivec3()).all();
            let corners = [-CLEAR_OF_BORDER, CLEAR_OF_BORDER].map(|d| (p + d).floor().as_ivec3());
            if corners[0] != corners[1] {
                for corner in 0..8 {
                    let c = IVec3::from_array(std::array::from_fn(|i| corners[corner >> i & 1][i]));
                    if inside(c) {
                        cells[grid.index(c.as_uvec3())].uncertain = true;
                    }
                }
                continue;
            }
            if !inside(corners[0]) {
                continue;
            }
            let sums = &mut cells[grid.index(corners[0].as_uvec3())];
            let rgb = |v: [half::f16; 4]| {
                DVec3::new(v[0].into(), v[1].into(), v[2].into()).min(DVec3::splat(SCALE.radiance_max.into()))
            };
            let albedo = shot.picture.albedo[texel].map(|v| f64::from(v) / 255.0);
            sums.count += 1.0;
            sums.attributes[0] += n;
            sums.attributes[1] += DVec3::new(albedo[0], albedo[1], albedo[2]);
            sums.attributes[2] += rgb(shot.picture.emission[texel]);
            // The clamped cosine about n in the first four spherical harmonics.
            let linear = (pi / 3.0).sqrt() * n;
            let lobe = DVec4::new(0.5 * pi.sqrt(), linear.x, linear.y, linear.z);
            for (band, l) in rgb(shot.picture.radiance[texel]).to_array().into_iter().enumerate() {
                sums.light[band] += l * lobe;
            }
        }
    }
    cells
}
