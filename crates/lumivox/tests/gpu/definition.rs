//! What cleanup, injection and the single pass are defined to do, in double precision and without the shaders' code, for one cell or sample
//! at a time. Verdicts that single precision may turn over are marked as such.

use lumivox::core::{Grid, Projection, View};
use lumivox::glam::{DVec2, DVec3, DVec4, IVec3, UVec2, UVec3};
use lumivox::progressive::{CleanupRule, InjectionPattern, SURFACE_SHIFT};

use crate::picture::{lifted, ndc_of_texel, ray};
use crate::support::{SCALE, Shot};

/// Distance from the eye along the view direction, in double precision.
fn distance_along(view: &View, point: DVec3) -> f64 {
    -view.eye_from_world.as_dmat4().transform_point3(point).z
}

/// Where a view shows the centre of a cell.
pub(crate) enum Seen {
    /// So near a texel's border or the view's planes that single precision may decide otherwise.
    Unsure,
    Outside,
    /// Number of the texel, and how far the centre lies behind what the texel's depth shows, in metres along the view.
    At {
        texel: usize,
        behind: f64,
    },
}

/// `CLEAR_OF_BORDER` is in texels: single precision places a centre to 1e-5 of them.
pub(crate) fn seen(shot: &Shot, grid: &Grid, cell: UVec3) -> Seen {
    const CLEAR_OF_BORDER: f64 = 1e-4;
    let center = grid.origin.as_dvec3() + f64::from(grid.cell_size) * (cell.as_dvec3() + 0.5);
    let clip: DVec4 = shot.view.clip_from_world.as_dmat4() * center.extend(1.0);
    if clip.w <= 0.0 {
        return Seen::Outside;
    }
    let (ndc, size) = (clip.truncate() / clip.w, shot.picture.size.as_dvec2());
    let at = DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * size;
    let beyond = |margin: f64| at.cmplt(DVec2::splat(margin)).any() || at.cmpgt(size - margin).any();
    if beyond(-CLEAR_OF_BORDER) || ndc.z < -1e-5 || ndc.z > 1.0 + 1e-5 {
        return Seen::Outside;
    }
    let between_texels = (at - at.round()).abs().min_element() < CLEAR_OF_BORDER;
    if between_texels || beyond(0.0) || ndc.z < 1e-5 || ndc.z > 1.0 - 1e-5 {
        return Seen::Unsure;
    }
    let texel = (at.y as u32 * shot.picture.size.x + at.x as u32) as usize;
    let surface = lifted(&shot.view, ndc.truncate(), shot.picture.depth[texel]);
    let behind = distance_along(&shot.view, center) - distance_along(&shot.view, surface);
    Seen::At { texel, behind }
}

/// Half the extent of a cell along the view's depth axis, in metres.
fn reach(view: &View, grid: &Grid) -> f64 {
    0.5 * f64::from(grid.cell_size) * view.forward().as_dvec3().abs().element_sum()
}

/// In cells: a verdict that turns over when its threshold moves by this much is too close to call.
const CLOSE: f64 = 1e-4;

/// Whether cleanup clears a cell; none when that is too close to call. What was not drawn lies at the far plane.
pub(crate) fn proven_empty(shot: &Shot, grid: &Grid, cell: UVec3) -> Option<bool> {
    match seen(shot, grid, cell) {
        Seen::Unsure => None,
        Seen::Outside => Some(false),
        Seen::At { behind, .. } => {
            let margin = (-reach(&shot.view, grid) - behind) / f64::from(grid.cell_size);
            (margin.abs() > CLOSE).then_some(margin > 0.0)
        }
    }
}

/// Whether cleanup by footprint clears a cell; none when that is too close to call.
pub(crate) fn proven_empty_whole(shot: &Shot, grid: &Grid, cell: UVec3) -> Option<bool> {
    let [sooner, later] = [-1.0, 1.0].map(|margin| whole_verdict(shot, grid, cell, margin, false));
    (sooner == later).then_some(sooner)
}

/// The same of cleanup by rays.
pub(crate) fn proven_empty_by_rays(shot: &Shot, grid: &Grid, cell: UVec3) -> Option<bool> {
    let [sooner, later] = [-1.0, 1.0].map(|margin| whole_verdict(shot, grid, cell, margin, true));
    (sooner == later).then_some(sooner)
}

/// The verdict when the cell's footprint is larger by `margin` times what single precision may be off, and its farthest
/// corner so much farther.
fn whole_verdict(shot: &Shot, grid: &Grid, cell: UVec3, margin: f64, by_rays: bool) -> bool {
    const TEXELS: f64 = 1e-4;
    const DEPTH: f64 = 2e-6;
    let (size, is_reversed) = (shot.picture.size.as_dvec2(), shot.view.reversed_depth);
    // Distances in depth grow away from the eye.
    let away = |depth: f64| if is_reversed { 1.0 - depth } else { depth };
    let cell_size = f64::from(grid.cell_size);
    let middle = grid.origin.as_dvec3() + cell_size * (cell.as_dvec3() + 0.5);
    let half_side = cell_size * (0.5 + if by_rays { 2.0 } else { 1.0 } * SURFACE_SHIFT);
    let (mut low, mut high) = (DVec2::splat(f64::MAX), DVec2::splat(f64::MIN));
    let mut farthest = 0f64;
    for corner in 0..8 {
        let side = DVec3::from_array(std::array::from_fn(|i| f64::from(corner >> i & 1) - 0.5));
        let point = middle + 2.0 * half_side * side;
        let clip: DVec4 = shot.view.clip_from_world.as_dmat4() * point.extend(1.0);
        let ndc = clip.truncate() / clip.w;
        if clip.w <= 0.0 || away(ndc.z) < margin * DEPTH {
            return false;
        }
        let at = DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * size;
        (low, high) = (low.min(at), high.max(at));
        farthest = farthest.max(away(ndc.z));
    }
    (low, high) = (low - margin * TEXELS, high + margin * TEXELS);
    if low.cmplt(DVec2::ZERO).any() || high.cmpgt(size).any() {
        return false;
    }
    let (first, last) = (low.as_uvec2(), high.as_uvec2().min(shot.picture.size - 1));
    // Blocks of 2, 4, 8.. texels, of which at most 9 lie across.
    let across = (last - first).max_element();
    let block = (0..).map(|level| 1u32 << level).find(|block| across < 8 * block).unwrap_or(1);
    let (first, last) =
        (first / block * block, (last / block * block + block - 1).min(shot.picture.size - 1));
    if by_rays {
        let blocks = |low: u32, high: u32| (low..=high).step_by(block as usize);
        return blocks(first.y, last.y).flat_map(|y| blocks(first.x, last.x).map(move |x| (x, y))).all(
            |(x, y)| {
                let from = UVec2::new(x, y);
                let to = (from + block - 1).min(shot.picture.size - 1);
                let left = exit_away(shot, (middle, half_side), from, to, margin * TEXELS).min(farthest);
                (from.y..=to.y).all(|y| {
                    let row = (y * shot.picture.size.x) as usize;
                    let texels = &shot.picture.depth[row + from.x as usize..=row + to.x as usize];
                    texels.iter().all(|depth| away(f64::from(*depth)) > left + margin * DEPTH)
                })
            },
        );
    }
    (first.y..=last.y).all(|y| {
        let row = (y * shot.picture.size.x) as usize;
        let texels = &shot.picture.depth[row + first.x as usize..=row + last.x as usize];
        texels.iter().all(|depth| away(f64::from(*depth)) > farthest + margin * DEPTH)
    })
}

/// How far away, in depth, rays through the middles of a block of texels have left a cube: for each face that they leave by, the last
/// of the block's corners, and of these the first. Texels are moved by a margin, to where their rays leave later, or sooner
/// if it is negative.
fn exit_away(shot: &Shot, (middle, half_side): (DVec3, f64), from: UVec2, to: UVec2, margin: f64) -> f64 {
    let (view, size) = (&shot.view, shot.picture.size.as_dvec2());
    let clip_from_world = view.clip_from_world.as_dmat4();
    let eye = view.eye().as_dvec3();
    let corners = [from, UVec2::new(from.x, to.y), UVec2::new(to.x, from.y), to];
    let moves = [DVec2::ZERO, DVec2::ONE, DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0)];
    let mut left = f64::MAX;
    for (axis, sign) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
        let plane = middle[axis] + sign * half_side;
        let leaves_at = |at: DVec2| {
            let at = at / size;
            let (start, along) = ray(view, DVec2::new(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y));
            if sign * along[axis] <= 0.0 {
                return f64::MAX;
            }
            let point = start + (plane - start[axis]) / along[axis] * along;
            let depth = clip_from_world.project_point3(point).z;
            if view.reversed_depth { 1.0 - depth } else { depth }
        };
        // Rays leave by the faces that look away from the eye.
        if view.projection == Projection::Perspective && sign * (eye[axis] - plane) >= 0.0 {
            continue;
        }
        let of_corner = |corner: UVec2| {
            let all = moves.map(|moved| leaves_at(corner.as_dvec2() + 0.5 + margin.abs() * moved));
            let pick = if margin > 0.0 { f64::max } else { f64::min };
            all.into_iter().fold(all[0], pick)
        };
        left = left.min(corners.map(of_corner).into_iter().fold(f64::MIN, f64::max));
    }
    left
}

/// What the single pass does with a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict {
    /// The view does not show the centre.
    NotSeen,
    Kept,
    Cleared,
    /// Takes what the texel of this number shows.
    Written(usize),
}

/// By a rule of cleanup; none when the verdict is too close to call.
pub(crate) fn verdict(rule: CleanupRule, shot: &Shot, grid: &Grid, cell: UVec3) -> Option<Verdict> {
    let (texel, behind) = match seen(shot, grid, cell) {
        Seen::Unsure => return None,
        Seen::Outside => return Some(Verdict::NotSeen),
        Seen::At { texel, behind } => (texel, behind),
    };
    let normal = unit_normal(shot, texel);
    // A surface that is moved against its normal moves away from the eye.
    let cell_size = f64::from(grid.cell_size);
    let moved = normal.map_or(0.0, |n| SURFACE_SHIFT * cell_size * -n.dot(shot.view.forward().as_dvec3()));
    let (behind, reach) = (behind - moved, reach(&shot.view, grid));
    let close = |threshold: f64| (behind - threshold).abs() < CLOSE * cell_size;
    let is_cleared = match rule {
        CleanupRule::Center => (!close(-reach)).then_some(behind < -reach),
        CleanupRule::Footprint => proven_empty_whole(shot, grid, cell),
        CleanupRule::Rays => proven_empty_by_rays(shot, grid, cell),
    }?;
    if is_cleared {
        return Some(Verdict::Cleared);
    }
    if normal.is_some() && (close(reach) || close(-reach)) {
        return None;
    }
    Some(match normal {
        Some(_) if behind.abs() <= reach => Verdict::Written(texel),
        _ => Verdict::Kept,
    })
}

/// The normal of what a texel shows; none where nothing was drawn or no normal was given.
fn unit_normal(shot: &Shot, texel: usize) -> Option<DVec3> {
    let undrawn = if shot.view.reversed_depth { 0.0 } else { 1.0 };
    let [x, y, z, _] = shot.picture.normal[texel].map(f64::from);
    let normal = DVec3::new(x, y, z).try_normalize();
    normal.filter(|_| shot.picture.depth[texel] != undrawn)
}

/// What injection and the single pass take from a texel that shows a surface: normal, albedo, emission, and three bands
/// of light, the clamped cosine about the normal in the first four spherical harmonics.
pub(crate) fn sample(shot: &Shot, texel: usize) -> Option<([DVec3; 3], [DVec4; 3])> {
    let pi = std::f64::consts::PI;
    let (n, picture) = (unit_normal(shot, texel)?, &shot.picture);
    let rgb = |v: [half::f16; 4]| {
        DVec3::new(v[0].into(), v[1].into(), v[2].into()).min(DVec3::splat(SCALE.radiance_max.into()))
    };
    let albedo = picture.albedo[texel].map(|v| f64::from(v) / 255.0);
    let linear = (pi / 3.0).sqrt() * n;
    let lobe = DVec4::new(0.5 * pi.sqrt(), linear.x, linear.y, linear.z);
    let light = rgb(picture.radiance[texel]).to_array().map(|l| l * lobe);
    Some(([n, DVec3::new(albedo[0], albedo[1], albedo[2]), rgb(picture.emission[texel])], light))
}

/// The area that one of `points` stands for, on the surface that a texel shows with this normal, in cell faces: the texels of
/// its share of the picture at the texel's depth, turned into the surface, at most 8.
fn faces(shot: &Shot, grid: &Grid, points: UVec2, texel: UVec2, normal: DVec3) -> f64 {
    let size = shot.picture.size;
    let depth = shot.picture.depth[(texel.y * size.x + texel.x) as usize];
    let share = (size.as_dvec2() / points.as_dvec2()).element_product();
    let middle = ndc_of_texel(texel, size);
    let texel_size = 2.0 / size.as_dvec2();
    let [right, down] = [DVec2::X, DVec2::Y].map(|axis| {
        let [a, b] = [-0.5, 0.5].map(|side| lifted(&shot.view, middle + side * axis * texel_size, depth));
        b - a
    });
    let along = ray(&shot.view, middle).1.normalize();
    // What a plane across the ray catches of the texel, and what the surface has to hold of it.
    let caught = right.cross(down).dot(along).abs() * share;
    let area = caught / normal.dot(along).abs().max(0.05);
    (area / f64::from(grid.cell_size).powi(2)).min(8.0)
}

/// Error of a depth value lifted in single precision, in cells.
pub(crate) const LIFT_ERROR: f64 = 5e-4;

/// Sums of the samples that fall in one cell: normal, albedo, emission, and three bands of light.
#[derive(Clone, Copy, Default)]
pub(crate) struct Sums {
    pub(crate) count: f64,
    pub(crate) attributes: [DVec3; 3],
    pub(crate) light: [DVec4; 3],
    /// The same, each sample by the share of a cell's face that its point stands for.
    pub(crate) light_by_area: [DVec4; 3],
    /// A sample lies so near the cell's border that single precision may put it on the other side.
    pub(crate) uncertain: bool,
}

/// What injection is defined to add up, with every `stride`-th texel as a point.
pub(crate) fn defined_sums(shots: &[&Shot], grid: &Grid, stride: u32) -> Vec<Sums> {
    defined_sums_of(shots, grid, stride, &|_| true)
}

/// Whether a frame of a split takes a point, in a grid of so many points.
pub(crate) fn is_taken(
    (pattern, split, frame): (InjectionPattern, u32, u32),
    points: UVec2,
    point: UVec2,
) -> bool {
    let phase = frame % split;
    match pattern {
        InjectionPattern::Linear => {
            let band = (points.x * points.y).div_ceil(split);
            (point.y * points.x + point.x) / band == phase
        }
        InjectionPattern::Block => (point.y / 8 * points.x.div_ceil(8) + point.x / 8) % split == phase,
        InjectionPattern::Stippled => (phase + point.y * split.div_ceil(2)) % split == point.x % split,
    }
}

/// The same of those points that are taken.
pub(crate) fn defined_sums_of(
    shots: &[&Shot],
    grid: &Grid,
    stride: u32,
    takes: &dyn Fn(UVec2) -> bool,
) -> Vec<Sums> {
    let mut cells = vec![Sums::default(); grid.cell_count() as usize];
    for shot in shots {
        let size = shot.picture.size;
        let points = (stride / 2..size.y).step_by(stride as usize);
        let points = points.flat_map(|y| (stride / 2..size.x).step_by(stride as usize).map(move |x| (x, y)));
        for (x, y) in points {
            let texel = (y * size.x + x) as usize;
            let point = UVec2::new(x, y) / stride;
            let Some((attributes, light)) = sample(shot, texel).filter(|_| takes(point)) else { continue };
            let n = attributes[0];
            let depth = shot.picture.depth[texel];
            let world = lifted(&shot.view, ndc_of_texel(UVec2::new(x, y), size), depth);
            let p = (world - grid.origin.as_dvec3()) / f64::from(grid.cell_size) - SURFACE_SHIFT * n;
            let inside = |c: IVec3| c.cmpge(IVec3::ZERO).all() && c.cmplt(grid.dims.as_ivec3()).all();
            let corners = [-LIFT_ERROR, LIFT_ERROR].map(|d| (p + d).floor().as_ivec3());
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
            sums.count += 1.0;
            for (sum, value) in sums.attributes.iter_mut().zip(attributes) {
                *sum += value;
            }
            let faces = faces(shot, grid, size / stride, UVec2::new(x, y), n);
            for (band, value) in light.into_iter().enumerate() {
                sums.light[band] += value;
                sums.light_by_area[band] += faces * value;
            }
        }
    }
    cells
}
