//! Several spheres for one object (dissertation 4.8): an elongated object leaves most of its bounding sphere empty, so that
//! few of the rays of its maps meet it. Cut across, each piece has a smaller sphere and a field of its own.

use glam::Vec3;
use lumivox_core::TriangleView;

use crate::{FieldError, Mesh};

/// A piece is cut in two where the spheres of the halves together have at most this part of its own sphere's volume: two halves of
/// a rod have a quarter, those of a disk or a ball two.
const WORTH: f32 = 0.5;

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
/// Pieces are halved across the longest side of their boxes, the largest sphere first, as long as that saves room. Triangles on a
/// cut are cut too, so that all pieces together are the mesh, and the nearest hit over all of them is the mesh's.
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
    let mut done = vec![(whole.radius()?, whole, true)];
    while done.len() < most {
        let largest = (0..done.len()).filter(|&n| done[n].2).max_by(|&a, &b| done[a].0.total_cmp(&done[b].0));
        let Some(n) = largest else { break };
        match done[n].1.halves(done[n].0)? {
            Some([a, b]) => {
                done[n] = (a.0, a.1, true);
                done.push((b.0, b.1, true));
            }
            None => done[n].2 = false,
        }
    }
    Ok(done.into_iter().map(|(_, part, _)| part).collect())
}

impl Part {
    fn radius(&self) -> Result<f32, FieldError> {
        Ok(self.mesh().sphere()?.radius)
    }

    /// Both halves with the radii of their spheres, if they are worth it.
    fn halves(&self, radius: f32) -> Result<Option<[(f32, Self); 2]>, FieldError> {
        let view = TriangleView { positions: &self.positions, indices: &self.indices };
        let bounds = view.bounds();
        let size = bounds.size();
        let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
        let at = bounds.center()[axis];
        let (mut below, mut above) = (Self::default(), Self::default());
        for triangle in &self.indices {
            let corners = triangle.map(|i| self.corner(i));
            below.add(&clipped(&corners, |p| at - p[axis]));
            above.add(&clipped(&corners, |p| p[axis] - at));
        }
        if below.indices.is_empty() || above.indices.is_empty() {
            return Ok(None);
        }
        if self.normals.is_empty() {
            below.normals.clear();
            above.normals.clear();
        }
        // A half may be a flake without extent, which has no sphere.
        let (Ok(a), Ok(b)) = (below.radius(), above.radius()) else { return Ok(None) };
        let volume = (a / radius).powi(3) + (b / radius).powi(3);
        Ok((volume <= WORTH).then_some([(a, below), (b, above)]))
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

/// The part of a triangle where `side` is not negative.
fn clipped(corners: &[[Vec3; 2]; 3], side: impl Fn(Vec3) -> f32) -> Vec<[Vec3; 2]> {
    let mut kept = Vec::with_capacity(4);
    for (n, corner) in corners.iter().enumerate() {
        let next = &corners[(n + 1) % 3];
        let (here, there) = (side(corner[0]), side(next[0]));
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            let t = here / (here - there);
            kept.push([0, 1].map(|i| corner[i].lerp(next[i], t)));
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
