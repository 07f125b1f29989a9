//! Distances between a point set, such as the centres of voxels, and a mesh, both ways.
//!
//! From points to the mesh: for each point, to the nearest point of any triangle, exactly (in `f64`). From the mesh to the
//! points: for samples spread evenly over the mesh's area, to the nearest point of the set; the mean and the RMS are
//! estimates and the maximum is a lower bound that more samples raise. The larger of the two maxima is the Hausdorff
//! distance. Papers give them in percent of the diagonal of the mesh's bounding box: [`TwoWay::percent`].
//!
//! The first direction does not see what is missing, the second does not see what is too much: both are needed.

use std::time::Duration;

use glam::{DVec3, Vec3};
use lumivox_core::TriangleView;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::{Boundable, BvhBuildParams};
use rayon::prelude::*;

/// Mean, root of the mean square and maximum of a set of distances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distances {
    /// Mean.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Largest.
    pub max: f64,
}

impl Distances {
    fn of(distances: &[f64]) -> Self {
        let n = distances.len() as f64;
        Self {
            mean: distances.iter().sum::<f64>() / n,
            rms: (distances.iter().map(|d| d * d).sum::<f64>() / n).sqrt(),
            max: distances.iter().copied().fold(0.0, f64::max),
        }
    }

    /// The same in percent of a length.
    #[must_use]
    pub fn percent_of(&self, length: f64) -> Self {
        let percent = |d: f64| 100.0 * d / length;
        Self { mean: percent(self.mean), rms: percent(self.rms), max: percent(self.max) }
    }
}

/// Distances both ways.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoWay {
    /// From each point to the mesh, in metres.
    pub points_to_mesh: Distances,
    /// From samples of the mesh to the points, in metres.
    pub mesh_to_points: Distances,
    /// Diagonal of the mesh's bounding box in metres.
    pub diagonal: f64,
}

impl TwoWay {
    /// Both directions (to the mesh, to the points) in percent of the diagonal.
    pub fn percent(&self) -> (Distances, Distances) {
        (self.points_to_mesh.percent_of(self.diagonal), self.mesh_to_points.percent_of(self.diagonal))
    }

    /// The larger of the maxima in metres.
    pub fn hausdorff(&self) -> f64 {
        self.points_to_mesh.max.max(self.mesh_to_points.max)
    }
}

/// Why there is no distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DistanceError {
    /// The set of points is empty.
    #[error("there are no points to measure from or to")]
    NoPoints,
    /// The mesh has no triangle, or no area where it has to be sampled.
    #[error("the mesh has no triangles with an area")]
    NoArea,
    /// A coordinate is not finite.
    #[error("a point or corner has a coordinate that is not finite")]
    NotFinite,
}

/// Distances both ways, from `samples` samples of the mesh (at least one).
///
/// # Errors
/// When either set is empty, the mesh has no area or a coordinate is not finite.
pub fn two_way(points: &[Vec3], mesh: TriangleView<'_>, samples: usize) -> Result<TwoWay, DistanceError> {
    Ok(TwoWay {
        points_to_mesh: points_to_mesh(points, mesh)?,
        mesh_to_points: points_to_points(&spread(mesh, samples.max(1))?, points)?,
        diagonal: f64::from(mesh.bounds().size().length()),
    })
}

/// From each point to the nearest point of a mesh, in metres.
///
/// # Errors
/// When either set is empty or a coordinate is not finite.
pub fn points_to_mesh(points: &[Vec3], mesh: TriangleView<'_>) -> Result<Distances, DistanceError> {
    if mesh.is_empty() {
        return Err(DistanceError::NoArea);
    }
    distances(points, mesh.iter().collect(), |from, corners| {
        distance2_to_triangle(from, &corners.map(|c| c.as_dvec3()))
    })
}

/// From each point of one set to the nearest of another, in metres.
///
/// # Errors
/// When either set is empty or a coordinate is not finite.
pub fn points_to_points(from: &[Vec3], to: &[Vec3]) -> Result<Distances, DistanceError> {
    let to = to.iter().map(|&p| [p]).collect();
    distances(from, to, |from, [point]| from.distance_squared(point.as_dvec3()))
}

/// Points spread over a mesh with equal areas between them: one at a random place of the triangle at each step of the
/// running sum of areas. The places follow a low-discrepancy sequence, so the result is always the same.
///
/// # Errors
/// When the mesh has no area or a coordinate is not finite.
pub fn spread(mesh: TriangleView<'_>, samples: usize) -> Result<Vec<Vec3>, DistanceError> {
    let area = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).as_dvec3().cross((c - a).as_dvec3()).length();
    let areas: Vec<f64> = mesh.iter().map(area).collect();
    let total: f64 = areas.iter().sum();
    if !total.is_finite() {
        return Err(DistanceError::NotFinite);
    }
    if total <= 0.0 {
        return Err(DistanceError::NoArea);
    }
    let step = total / samples as f64;
    let mut points = Vec::with_capacity(samples);
    let mut sum = 0.0;
    for (triangle, area) in mesh.iter().zip(areas) {
        sum += area;
        while points.len() < samples && (points.len() as f64 + 0.5) * step <= sum {
            points.push(place(triangle, points.len()));
        }
    }
    Ok(points)
}

/// The `n`th place in a triangle, by the R2 sequence (powers of the inverse of the plastic number).
fn place([a, b, c]: [Vec3; 3], n: usize) -> Vec3 {
    let [s, t] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2].map(|step| (step * n as f64).fract());
    let root = s.sqrt();
    let [a, b, c] = [a, b, c].map(|p| p.as_dvec3());
    ((1.0 - root) * a + root * (1.0 - t) * b + root * t * c).as_vec3()
}

/// Nearest distances by a tree over the boxes of `items`; `distance2` is the square.
fn distances<const N: usize>(
    points: &[Vec3],
    items: Vec<[Vec3; N]>,
    distance2: impl Fn(DVec3, &[Vec3; N]) -> f64 + Sync,
) -> Result<Distances, DistanceError> {
    if points.is_empty() || items.is_empty() {
        return Err(DistanceError::NoPoints);
    }
    if !points.iter().chain(items.iter().flatten()).all(|p| p.is_finite()) {
        return Err(DistanceError::NotFinite);
    }
    let items: Vec<Item<N>> = items.into_iter().map(Item).collect();
    let tree = build_bvh2(&items, BvhBuildParams::fast_build(), &mut Duration::default());
    let nearest = |p: &Vec3| nearest2(&tree, p.as_dvec3(), |n, from| distance2(from, &items[n].0)).sqrt();
    let all: Vec<f64> = points.par_iter().map(nearest).collect();
    Ok(Distances::of(&all))
}

/// A point or a triangle.
struct Item<const N: usize>([Vec3; N]);

impl<const N: usize> Boundable for Item<N> {
    fn aabb(&self) -> Aabb {
        Aabb::from_points(&self.0.map(Into::into))
    }
}

fn nearest2(tree: &Bvh2, from: DVec3, distance2: impl Fn(usize, DVec3) -> f64) -> f64 {
    let to_box = |node: u32| {
        let aabb = tree.nodes[node as usize].aabb();
        let (min, max) = (Vec3::from(aabb.min).as_dvec3(), Vec3::from(aabb.max).as_dvec3());
        from.clamp(min, max).distance_squared(from)
    };
    let mut best = f64::INFINITY;
    let mut open = vec![(0, to_box(0))];
    while let Some((node, bound)) = open.pop() {
        if bound >= best {
            continue;
        }
        let node = &tree.nodes[node as usize];
        if node.is_leaf() {
            for n in node.first_index..node.first_index + node.prim_count {
                best = best.min(distance2(tree.primitive_indices[n as usize] as usize, from));
            }
            continue;
        }
        let [one, other] = [node.first_index, node.first_index + 1].map(|child| (child, to_box(child)));
        let (near, far) = if one.1 < other.1 { (one, other) } else { (other, one) };
        open.extend([far, near]);
    }
    best
}

/// Square of the distance from a point to a closed triangle; segments and points are triangles too.
fn distance2_to_triangle(from: DVec3, corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - from);
    let normal = (b - a).cross(c - a);
    // The foot on the plane lies inside if it is on the inner side of each edge.
    let above = [[a, b], [b, c], [c, a]].iter().all(|[p, q]| p.cross(*q).dot(normal) >= 0.0);
    if above && normal != DVec3::ZERO {
        return a.dot(normal).powi(2) / normal.length_squared();
    }
    let to_edge = |p: DVec3, q: DVec3| {
        let along = q - p;
        let t = (-p.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        // Not a number for an edge without length, which is its end.
        if t >= 0.0 { (p + t * along).length_squared() } else { p.length_squared() }
    };
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use crate::tracer::random::Random;
    use crate::voxels::{Coverage, VoxelSet};
    use lumivox_core::{Bounds, Grid};

    fn cloud(n: usize, seed: u64) -> Vec<Vec3> {
        let mut random = Random::new(seed, 0);
        (0..n).map(|_| 3.0 * Vec3::new(random.unit(), random.unit(), random.unit()) - 1.5).collect()
    }

    #[test]
    fn tree_gives_what_trying_all_gives() {
        let mesh = shapes::sphere(1.0, 3);
        let triangles: Vec<_> = mesh.view().iter().map(|t| t.map(|c| c.as_dvec3())).collect();
        let points = cloud(400, 1);
        let all: Vec<f64> = points
            .iter()
            .map(|p| {
                let to = triangles.iter().map(|t| distance2_to_triangle(p.as_dvec3(), t));
                to.fold(f64::INFINITY, f64::min).sqrt()
            })
            .collect();
        assert_eq!(points_to_mesh(&points, mesh.view()), Ok(Distances::of(&all)));
        let others = cloud(300, 2);
        let all: Vec<f64> = points
            .iter()
            .map(|p| others.iter().map(|q| p.as_dvec3().distance(q.as_dvec3())).fold(f64::INFINITY, f64::min))
            .collect();
        let got = points_to_points(&points, &others).unwrap();
        let expected = Distances::of(&all);
        assert!((got.mean - expected.mean).abs() < 1e-12 && (got.max - expected.max).abs() < 1e-12);
    }

    #[test]
    fn distance_to_a_triangle_is_that_of_its_nearest_sample() {
        let mut random = Random::new(3, 3);
        let mut point =
            || 2.0 * DVec3::new(random.unit().into(), random.unit().into(), random.unit().into()) - 1.0;
        for case in 0..200 {
            let mut corners = [point(), point(), point()];
            if case % 10 == 0 {
                corners[2] = corners[0].lerp(corners[1], 0.3);
            }
            if case % 25 == 0 {
                corners = [corners[0]; 3];
            }
            let from = point();
            let n = 200;
            let mut best = f64::INFINITY;
            for i in 0..=n {
                for j in 0..=n - i {
                    let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                    let p = corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t;
                    best = best.min(p.distance(from));
                }
            }
            let exact = distance2_to_triangle(from, &corners).sqrt();
            // Samples lie at most 1/200 of an edge apart.
            assert!(exact <= best + 1e-12 && best <= exact + 0.02, "{exact} {best}");
        }
    }

    #[test]
    fn a_shifted_square_is_as_far_away_as_it_was_shifted() {
        let square = shapes::quad([Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y]);
        let positions: Vec<[f32; 3]> = square.iter().flatten().map(|p| p.to_array()).collect();
        let indices = [[0, 1, 2], [3, 4, 5]];
        let mesh = TriangleView::new(&positions, &indices).unwrap();
        let n = 50;
        let grid = (0..n * n).map(|i| Vec3::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5, 0.0) / n as f32);
        let points: Vec<Vec3> = grid.map(|p| p + 0.25 * Vec3::Z).collect();
        let d = two_way(&points, mesh, 20_000).unwrap();
        let to_mesh = d.points_to_mesh;
        assert!([to_mesh.mean, to_mesh.rms, to_mesh.max].iter().all(|d| (d - 0.25).abs() < 1e-9));
        // Sideways at most half a cell's diagonal; its mean square is 1/6 of the squared side.
        let cell = 1.0 / n as f64;
        let rms = (0.25f64.powi(2) + cell * cell / 6.0).sqrt();
        let max = (0.25f64.powi(2) + cell * cell / 2.0).sqrt();
        assert!((d.mesh_to_points.rms - rms).abs() < 1e-5, "{} {rms}", d.mesh_to_points.rms);
        assert!(d.mesh_to_points.max <= max + 1e-9 && d.mesh_to_points.max > max - 1e-4);
        let (percent, _) = d.percent();
        assert!((percent.mean - 25.0 / 2f64.sqrt()).abs() < 1e-4);
        assert!((d.hausdorff() - max).abs() < 1e-4);
    }

    #[test]
    fn centres_of_exact_voxels_lie_within_half_a_diagonal_both_ways() {
        let mesh = shapes::sphere(1.0, 4);
        let grid = Grid::fit(&Bounds::new(Vec3::splat(-1.1), Vec3::splat(1.1)), 40).unwrap();
        let set = VoxelSet::of(grid, mesh.view(), Coverage::Exact);
        let centers: Vec<Vec3> = set.cells().map(|c| grid.center(c)).collect();
        let d = two_way(&centers, mesh.view(), 20_000).unwrap();
        let half_diagonal = f64::from(0.5 * grid.cell_size) * 3f64.sqrt() + 1e-6;
        assert!(d.points_to_mesh.max <= half_diagonal && d.mesh_to_points.max <= half_diagonal);
    }

    #[test]
    fn nothing_and_what_is_not_finite_are_refused() {
        let mesh = shapes::sphere(1.0, 0);
        let empty = TriangleView::new(&[], &[]).unwrap();
        assert_eq!(points_to_mesh(&[], mesh.view()), Err(DistanceError::NoPoints));
        assert_eq!(points_to_mesh(&[Vec3::ZERO], empty), Err(DistanceError::NoArea));
        assert_eq!(two_way(&[Vec3::NAN], mesh.view(), 9), Err(DistanceError::NotFinite));
        assert_eq!(spread(mesh.view(), 9).map(|p| p.len()), Ok(9));
    }
}
