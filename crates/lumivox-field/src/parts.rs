//! Several spheres for one object (dissertation 4.8): an elongated or branching object leaves most of its bounding sphere empty, so
//! that few of the rays of its maps meet it. Cut into pieces, each has a smaller sphere and a field of its own.

use glam::Vec3;
use lumivox_core::{Bounds, TriangleView};

use crate::{FieldError, Mesh, Sphere};

/// Where a piece's box may be cut across each axis. A corner of two arms lies near an end.
const CUTS: [f32; 7] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875];
/// Triangles that the choice of a cut looks at; of larger meshes every so many.
const LOOKED_AT: usize = 4096;

/// A piece of a mesh, cut out by planes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
}

impl Part {
    /// The piece, to be baked. It is open where it was cut.
    pub fn mesh(&self) -> Mesh<'_> {
        let triangles = TriangleView { positions: &self.positions, indices: &self.indices };
        let normals = (!self.normals.is_empty()).then_some(self.normals.as_slice());
        Mesh { triangles, normals }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.indices.len()
    }
}

/// The pieces of a mesh that are worth a sphere each, at most `most`: one for a compact object, which is then the mesh as it is.
///
/// The piece with the largest sphere is cut first, across the axis and at the place that leave the least room in the spheres of both
/// sides. Of all numbers of pieces on that way the one is taken with which their spheres' room, times their number for the memory
/// of as many fields, is the least: 1 for the whole, a quarter of that for a rod in four, twice that for a ball in two. Triangles
/// on a cut are cut too, so that all pieces together are the mesh, and the nearest hit over all of them is the mesh's.
///
/// # Errors
/// Those of [`Baker::new`](crate::Baker::new) for the mesh.
pub fn parts(mesh: &Mesh<'_>, most: usize) -> Result<Vec<Part>, FieldError> {
    mesh.check()?;
    let whole = Part {
        positions: mesh.triangles.positions.to_vec(),
        normals: mesh.normals.unwrap_or_default().to_vec(),
        indices: mesh.triangles.indices.to_vec(),
    };
    let radius = mesh.sphere()?.radius;
    let mut pieces = vec![whole];
    let plan = plan(mesh, radius, most);
    for (n, cut) in &plan {
        let Some(sides) = pieces[*n].sides(*cut) else { break };
        let [below, above] = sides;
        pieces[*n] = below;
        pieces.push(above);
    }
    Ok(pieces)
}

/// A piece as the plan sees it: its triangles, the radius of its sphere, and whether it can be cut.
struct Planned {
    triangles: Vec<[Vec3; 3]>,
    radius: f32,
    open: bool,
}

/// The pieces to be cut, each as it is then, and where.
fn plan(mesh: &Mesh<'_>, radius: f32, most: usize) -> Vec<(usize, Cut)> {
    let every = mesh.triangles.len().div_ceil(LOOKED_AT).max(1);
    let triangles = mesh.triangles.iter().step_by(every).collect();
    let mut pieces = vec![Planned { triangles, radius, open: true }];
    let (mut cuts, mut best) = (Vec::new(), (1.0, 0));
    while pieces.len() < most {
        let largest = (0..pieces.len())
            .filter(|&n| pieces[n].open)
            .max_by(|&a, &b| pieces[a].radius.total_cmp(&pieces[b].radius));
        let Some(n) = largest else { break };
        let Some((cut, [below, above])) = best_cut(&pieces[n].triangles, radius) else {
            pieces[n].open = false;
            continue;
        };
        cuts.push((n, cut));
        pieces[n] = below;
        pieces.push(above);
        let room: f32 = pieces.iter().map(|piece| (piece.radius / radius).powi(3)).sum();
        let price = room * pieces.len() as f32;
        if price < best.0 {
            best = (price, cuts.len());
        }
    }
    cuts.truncate(best.1);
    cuts
}

impl Part {
    /// Both sides of a cut, unless one has no sphere.
    fn sides(&self, cut: Cut) -> Option<[Self; 2]> {
        let (mut below, mut above) = (Self::default(), Self::default());
        for triangle in &self.indices {
            let corners = triangle.map(|i| self.corner(i));
            below.add(&clipped(&corners, |[p, _]| cut.at - p[cut.axis]));
            above.add(&clipped(&corners, |[p, _]| p[cut.axis] - cut.at));
        }
        if self.normals.is_empty() {
            below.normals.clear();
            above.normals.clear();
        }
        let sound = below.mesh().sphere().is_ok() && above.mesh().sphere().is_ok();
        sound.then_some([below, above])
    }

    fn corner(&self, index: u32) -> [Vec3; 2] {
        let normal = self.normals.get(index as usize).copied().unwrap_or_default();
        [Vec3::from(self.positions[index as usize]), Vec3::from(normal)]
    }

    /// Adds a convex polygon as a fan.
    fn add(&mut self, polygon: &[[Vec3; 2]]) {
        let first = self.positions.len() as u32;
        for n in 2..polygon.len() as u32 {
            self.indices.push([first, first + n - 1, first + n]);
        }
        if polygon.len() > 2 {
            self.positions.extend(polygon.iter().map(|[p, _]| p.to_array()));
            self.normals.extend(polygon.iter().map(|[_, n]| n.to_array()));
        }
    }
}

/// A plane across an axis.
#[derive(Clone, Copy, Debug)]
struct Cut {
    axis: usize,
    at: f32,
}

/// The cut that leaves the least room, and both sides; lengths are taken in radii of the whole, whose cubes are numbers.
fn best_cut(triangles: &[[Vec3; 3]], whole: f32) -> Option<(Cut, [Planned; 2])> {
    let bounds = Bounds::of_points(triangles.iter().flatten().copied());
    if bounds.is_empty() {
        return None;
    }
    let cut = |n: usize| {
        let (axis, share) = (n / CUTS.len(), CUTS[n % CUTS.len()]);
        Cut { axis, at: bounds.min[axis] + share * bounds.size()[axis] }
    };
    let tried = (0..3 * CUTS.len()).filter_map(|n| {
        let cut = cut(n);
        let [below, above] = [-1.0f32, 1.0].map(|sign| planned(triangles, |p| sign * (p[cut.axis] - cut.at)));
        let sides = [below?, above?];
        let room: f32 = sides.iter().map(|side| (side.radius / whole).powi(3)).sum();
        Some((room, cut, sides))
    });
    tried.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, cut, sides)| (cut, sides))
}

/// The parts of triangles where `side` is not negative, unless they have no sphere.
fn planned(triangles: &[[Vec3; 3]], side: impl Fn(&Vec3) -> f32) -> Option<Planned> {
    let mut kept = Vec::new();
    for triangle in triangles {
        let polygon = clipped(triangle, &side);
        kept.extend((2..polygon.len()).map(|n| [polygon[0], polygon[n - 1], polygon[n]]));
    }
    let points: Vec<_> = kept.iter().flatten().map(|p| p.as_dvec3()).collect();
    let radius = Sphere::around(&points).radius;
    (radius > 0.0 && radius.is_finite()).then_some(Planned { triangles: kept, radius, open: true })
}

/// A vertex between two others.
trait Between: Copy {
    fn between(self, other: Self, share: f32) -> Self;
}

impl Between for Vec3 {
    fn between(self, other: Self, share: f32) -> Self {
        self.lerp(other, share)
    }
}

impl Between for [Vec3; 2] {
    fn between(self, other: Self, share: f32) -> Self {
        [0, 1].map(|i| self[i].lerp(other[i], share))
    }
}

/// The part of a triangle where `side` is not negative.
fn clipped<V: Between>(corners: &[V; 3], side: impl Fn(&V) -> f32) -> Vec<V> {
    let mut kept = Vec::with_capacity(4);
    for (n, corner) in corners.iter().enumerate() {
        let next = &corners[(n + 1) % 3];
        let (here, there) = (side(corner), side(next));
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push(corner.between(*next, here / (here - there)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::shapes::{self, Random, Shape};
    use crate::{Baker, Field, Interpolation, Settings};

    /// A rod with a crook, as a cane has.
    fn cane() -> Shape {
        let rod = shapes::cuboid(Vec3::new(-0.05, -2.0, -0.05), Vec3::new(0.05, 2.0, 0.05));
        rod.and(&shapes::torus(0.3, 0.06, 24).moved(|p| Vec3::new(p.x + 0.3, p.z + 2.0, p.y)))
    }

    #[test]
    fn compact_objects_stay_whole_and_long_ones_are_cut() {
        let count = |shape: &Shape| parts(&shape.mesh(), 8).unwrap().len();
        assert_eq!(count(&shapes::sphere(1.0, 24)), 1);
        assert_eq!(count(&shapes::torus(1.0, 0.35, 24)), 1);
        assert_eq!(count(&shapes::cuboid(Vec3::ZERO, Vec3::ONE)), 1);
        assert_eq!(count(&shapes::cuboid(Vec3::ZERO, Vec3::new(1.0, 0.05, 1.0))), 1);
        assert!((4..=8).contains(&count(&cane())), "{}", count(&cane()));
        assert_eq!(parts(&cane().mesh(), 3).unwrap().len(), 3);
        assert_eq!(parts(&cane().mesh(), 0).unwrap().len(), 1);
        // Two arms that meet in a corner, and a bracket of three.
        let arm = |low: [f32; 3], high: [f32; 3]| shapes::cuboid(low.into(), high.into());
        let (foot, back) = (arm([0.0; 3], [1.0, 0.1, 0.1]), arm([0.0; 3], [0.1, 1.0, 0.1]));
        let angle = foot.and(&back);
        assert!(count(&angle) >= 4, "{}", count(&angle));
        let room = |shape: &Shape| -> f32 {
            let pieces = parts(&shape.mesh(), 8).unwrap();
            pieces.iter().map(|p| p.mesh().sphere().unwrap().radius.powi(3)).sum()
        };
        let whole = |shape: &Shape| shape.mesh().sphere().unwrap().radius.powi(3);
        assert!(room(&angle) < 0.1 * whole(&angle), "{} of {}", room(&angle), whole(&angle));
        let bracket = angle.and(&arm([0.0; 3], [0.1, 0.1, 1.0]));
        assert!(room(&bracket) < 0.2 * whole(&bracket), "{} of {}", room(&bracket), whole(&bracket));
        let empty = Shape { positions: Vec::new(), indices: Vec::new() };
        assert!(parts(&empty.mesh(), 4).is_err());
    }

    #[test]
    fn pieces_together_are_the_mesh() {
        let shape = cane();
        let pieces = parts(&shape.mesh(), 8).unwrap();
        let area = |mesh: Mesh<'_>| -> f32 {
            mesh.triangles.iter().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
        };
        let whole = area(shape.mesh());
        let sum: f32 = pieces.iter().map(|p| area(p.mesh())).sum();
        assert!((sum / whole - 1.0).abs() < 1e-4, "{sum} {whole}");
    }

    #[test]
    fn fields_of_pieces_are_better_than_one_of_as_much_room() {
        let shape = cane();
        let bake = |mesh: Mesh<'_>, points: u32| -> Field {
            let settings = Settings { points, directions: 32, ..Settings::default() };
            Baker::new(mesh, settings).unwrap().bake(|_| ControlFlow::Continue(())).unwrap()
        };
        let exact = Baker::new(shape.mesh(), Settings::default()).unwrap();
        let pieces: Vec<Field> =
            parts(&shape.mesh(), 4).unwrap().iter().map(|p| bake(p.mesh(), 290)).collect();
        let whole = bake(shape.mesh(), 1090);
        let (mut random, mut wrong) = (Random(21), [0; 2]);
        // Lines that pass close by the rod.
        for _ in 0..20_000 {
            let p = Vec3::new(0.0, 4.4 * random.unit() - 2.0, 0.0) + 0.1 * random.direction();
            let d = random.direction();
            let ray = crate::Ray::new(p - 6.0 * d, d);
            let truth = exact.trace(&ray).is_some();
            let nearest = |field: &Field| field.ahead(&ray, 0.0, Interpolation::Nearest).is_some();
            wrong[0] += i32::from(pieces.iter().any(nearest) != truth);
            wrong[1] += i32::from(nearest(&whole) != truth);
        }
        // Four times 290 points are about as many as 1090; found were 5008 and 8691, where a rod is as thin as its maps' steps.
        assert!(3 * wrong[0] < 2 * wrong[1] && wrong[1] > 1000, "{wrong:?}");
    }
}
