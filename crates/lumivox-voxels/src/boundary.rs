//! Holes of a surface: chains of edges that only one triangle has.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::Hole;
use crate::job::Job;

/// The number of boundary edges, and the hole with the longest boundary. Corners at the same place are one, whichever
/// meshes they belong to; triangles with two corners at one place have no say.
pub(crate) fn longest_hole(job: &Job<'_>) -> (u64, Option<Hole>) {
    let (places, mut edges) = edges(job);
    edges.par_sort_unstable();
    let boundary: Vec<[u32; 2]> =
        edges.chunk_by(|a, b| a == b).filter(|equal| equal.len() == 1).map(|equal| equal[0]).collect();
    let mut chains = Chains::new(places.len());
    boundary.iter().for_each(|[a, b]| chains.join(*a, *b));
    let mut holes: HashMap<u32, Sum> = HashMap::new();
    for [a, b] in &boundary {
        let (from, to) = (places[*a as usize], places[*b as usize]);
        let length = from.distance(to);
        let sum = holes
            .entry(chains.root(*a))
            .or_insert_with(|| Sum { first: 0.5 * (from + to), ..Sum::default() });
        sum.length += length;
        sum.edges += 1;
        sum.moment += length * 0.5 * (from + to);
    }
    let longest = holes.into_iter().max_by(|(a, x), (b, y)| x.length.total_cmp(&y.length).then(b.cmp(a)));
    let hole = longest.map(|(_, sum)| {
        let center = if sum.length > 0.0 { sum.moment / sum.length } else { sum.first };
        Hole {
            center: job.world_from_grid(center).as_vec3(),
            edge: job.world_from_grid(sum.first).as_vec3(),
            length: sum.length * f64::from(job.grid.cell_size),
            edges: sum.edges,
        }
    });
    (boundary.len() as u64, hole)
}

/// Edges of one hole, in cells.
#[derive(Default)]
struct Sum {
    length: f64,
    edges: u64,
    moment: DVec3,
    first: DVec3,
}

/// All places of corners in cells, and the edges of all triangles between their numbers, smaller number first.
fn edges(job: &Job<'_>) -> (Vec<DVec3>, Vec<[u32; 2]>) {
    let mut numbers: HashMap<[u64; 3], u32> = HashMap::new();
    let mut places = Vec::new();
    let mut edges = Vec::new();
    for (mesh, view) in job.model.meshes.iter().enumerate() {
        let own: Vec<u32> = view
            .triangles
            .positions
            .iter()
            .map(|position| {
                let place = job.placements[mesh].corner(position);
                // Adding zero makes one of -0 and 0.
                let key = (place + 0.0).to_array().map(f64::to_bits);
                *numbers.entry(key).or_insert_with(|| {
                    places.push(place);
                    places.len() as u32 - 1
                })
            })
            .collect();
        for (number, triangle) in view.triangles.indices.iter().enumerate() {
            if job.reach(mesh, number as u32).is_none() {
                continue;
            }
            let [a, b, c] = triangle.map(|i| own[i as usize]);
            if a != b && b != c && c != a {
                edges.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
            }
        }
    }
    (places, edges)
}

/// Sets of vertices that hang together.
struct Chains(Vec<u32>);

impl Chains {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn root(&mut self, vertex: u32) -> u32 {
        let mut at = vertex;
        while self.0[at as usize] != at {
            let above = self.0[self.0[at as usize] as usize];
            self.0[at as usize] = above;
            at = above;
        }
        at
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller number wins, so that the result does not depend on the order.
        self.0[a.max(b) as usize] = a.min(b);
    }
}
