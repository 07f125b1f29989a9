//! The colours that flat triangles have all over, and the triangles of each.

use std::collections::HashMap;
use std::ops::Range;

use crate::coverage::Coverage;
use crate::job::Job;
use crate::model::MaterialOf;
use crate::surface::{Face, has_flat_normals};

/// Where a mesh has fewer triangles of a colour than this, its triangles are better left in their order.
const FEWEST: usize = 64;

/// All colours, and which triangles have them.
#[derive(Debug, Default)]
pub(crate) struct Colors {
    /// The values of each colour in all channels, as [`Face::shade_flat`] makes them.
    values: Vec<Vec<[i64; 4]>>,
    meshes: Vec<OfMesh>,
}

/// The colours of one mesh.
#[derive(Debug)]
enum OfMesh {
    One(u32),
    /// Triangles in the order of their colours, and the colour of each range of these.
    Sorted(Vec<u32>, Vec<(u32, Range<u32>)>),
}

impl Colors {
    /// The colours of a job; none if not all triangles have one colour and one normal each, or are to be looked at
    /// otherwise.
    pub(crate) fn of(job: &Job<'_>) -> Option<Self> {
        if job.coverage == Coverage::Sampled || !job.takes_flat {
            return None;
        }
        let mut colors = Self::default();
        let mut known = HashMap::new();
        for mesh in 0..job.model.meshes.len() {
            if job.asked.normal && !has_flat_normals(&job.model.meshes[mesh]) {
                return None;
            }
            let found = colors.of_mesh(job, mesh, &mut known)?;
            colors.meshes.push(found);
        }
        Some(colors)
    }

    fn of_mesh(
        &mut self,
        job: &Job<'_>,
        mesh: usize,
        known: &mut HashMap<Vec<[i64; 4]>, u32>,
    ) -> Option<OfMesh> {
        let mut color_of = |material: usize| {
            let mut values = vec![[0; 4]; job.channels.len()];
            Face::plain(job, mesh, material)?.shade_flat(job.channels, &mut values);
            let new = known.len() as u32;
            let number = *known.entry(values.clone()).or_insert(new);
            if number == new {
                self.values.push(values);
            }
            Some(number)
        };
        let materials = match job.model.meshes[mesh].material {
            MaterialOf::Mesh(material) => return color_of(material).map(OfMesh::One),
            MaterialOf::Triangle(materials) => materials,
        };
        let mut of_material: HashMap<u32, u32> = HashMap::new();
        let mut of_triangle = Vec::with_capacity(materials.len());
        for &material in materials {
            let color = match of_material.get(&material) {
                Some(&color) => color,
                None => {
                    let color = color_of(material as usize)?;
                    of_material.insert(material, color);
                    color
                }
            };
            of_triangle.push(color);
        }
        let mut order: Vec<u32> = (0..materials.len() as u32).collect();
        order.sort_by_key(|&n| of_triangle[n as usize]);
        let mut runs = Vec::new();
        let mut start = 0;
        for same in order.chunk_by(|&a, &b| of_triangle[a as usize] == of_triangle[b as usize]) {
            let end = start + same.len() as u32;
            runs.push((of_triangle[same[0] as usize], start..end));
            start = end;
        }
        match runs[..] {
            [] => Some(OfMesh::One(0)),
            [(color, _)] => Some(OfMesh::One(color)),
            _ => (materials.len() >= FEWEST * runs.len()).then_some(OfMesh::Sorted(order, runs)),
        }
    }

    /// The values of each colour.
    pub(crate) fn values(&self) -> &[Vec<[i64; 4]>] {
        &self.values
    }

    /// Ranges of the `count` triangles of a mesh, in the order of [`Self::order`], with their colours.
    pub(crate) fn runs(&self, mesh: usize, count: u32) -> Vec<(u32, Range<u32>)> {
        match &self.meshes[mesh] {
            OfMesh::One(color) => vec![(*color, 0..count)],
            OfMesh::Sorted(_, runs) => runs.clone(),
        }
    }

    /// The order of a mesh's triangles; none if it is their own.
    pub(crate) fn order(&self, mesh: usize) -> Option<&[u32]> {
        match &self.meshes[mesh] {
            OfMesh::One(_) => None,
            OfMesh::Sorted(order, _) => Some(order),
        }
    }
}
