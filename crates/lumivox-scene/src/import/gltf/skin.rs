//! Skins, and the meshes that they and morph targets deform.

use std::collections::HashMap;
use std::ops::Range;

use glam::Mat4;

use super::accessor::Reader;
use super::node::Tree;
use super::primitive::{Budget, RawPrimitive};
use crate::animation::deform::{Binding, Body, MorphTarget, Skin};
use crate::mesh::{Mesh, Shading, check_limit};
use crate::{ImportReport, Limits, Scene, SceneError};

/// What may deform a mesh of the scene, one entry per vertex of that mesh.
#[derive(Clone, Debug)]
pub(super) struct Deform {
    flat: bool,
    targets: Vec<MorphTarget>,
    ends: Vec<u32>,
    influences: Vec<(u32, f32)>,
    /// The largest joint number among them.
    last_joint: u32,
}

/// Cleans a primitive, and keeps what deforms it in step with its vertices.
pub(super) fn finish(
    primitive: RawPrimitive,
    shading: Shading,
    report: &mut ImportReport,
) -> (Mesh, Option<Deform>) {
    let RawPrimitive { raw, targets, influences } = primitive;
    let flat = shading != Shading::Smooth && raw.normals.is_empty();
    let deforms = !raw.origins.is_empty();
    let (mesh, origins) = raw.into_mesh_and_origins(shading, report);
    if !deforms {
        return (mesh, None);
    }
    let pick = |list: Vec<[f32; 3]>| -> Vec<[f32; 3]> {
        if list.is_empty() { list } else { origins.iter().map(|&o| list[o as usize]).collect() }
    };
    let targets = targets
        .into_iter()
        .map(|t| MorphTarget { positions: pick(t.positions), normals: pick(t.normals) })
        .collect();
    let (mut ends, mut flattened) = (Vec::new(), Vec::new());
    if !influences.is_empty() {
        for &o in &origins {
            flattened.extend_from_slice(influences.of(o));
            ends.push(flattened.len() as u32);
        }
    }
    let last_joint = flattened.iter().map(|(j, _)| *j).max().unwrap_or(0);
    (mesh, Some(Deform { flat, targets, ends, influences: flattened, last_joint }))
}

/// The meshes of the file.
#[derive(Default)]
pub(super) struct Shapes {
    /// For each glTF mesh those of the scene's meshes that are its primitives.
    pub(super) ranges: Vec<Range<usize>>,
    /// For each of the scene's meshes what may deform it.
    pub(super) deforms: Vec<Option<Deform>>,
}

impl Shapes {
    /// The number of morph targets of a glTF mesh.
    pub(super) fn target_count(&self, mesh: usize) -> usize {
        let range = self.ranges.get(mesh).cloned().unwrap_or_default();
        self.deforms[range].iter().flatten().map(|d| d.targets.len()).max().unwrap_or(0)
    }
}

/// Hands out the scene's meshes to nodes, so that each is that of one body or of bodiless instances.
pub(super) struct Wardrobe<'a> {
    deforms: &'a [Option<Deform>],
    /// Whether the mesh as read is given to a node already.
    taken: Vec<bool>,
    plain: HashMap<usize, usize>,
    skinned: HashMap<(usize, usize), usize>,
}

impl<'a> Wardrobe<'a> {
    pub(super) fn new(shapes: &'a Shapes) -> Self {
        let (deforms, taken) = (shapes.deforms.as_slice(), vec![false; shapes.deforms.len()]);
        Self { deforms, taken, plain: HashMap::new(), skinned: HashMap::new() }
    }

    /// Whether a mesh needs a body of its own on a node with or without a skin.
    pub(super) fn deforms(&self, mesh: usize, skin: Option<usize>) -> bool {
        let deform = self.deforms[mesh].as_ref();
        deform.is_some_and(|d| !d.targets.is_empty() || (skin.is_some() && !d.ends.is_empty()))
    }

    /// The mesh for a node that leaves it as it is.
    pub(super) fn plain(
        &mut self,
        mesh: usize,
        scene: &mut Scene,
        budget: &mut Budget,
    ) -> Result<usize, SceneError> {
        if let Some(known) = self.plain.get(&mesh) {
            return Ok(*known);
        }
        let own = self.own(mesh, scene, budget)?;
        self.plain.insert(mesh, own);
        Ok(own)
    }

    /// The mesh for a node that deforms it, and whether joints say where it is. `skin` indexes the animation's skins.
    pub(super) fn body(
        &mut self,
        mesh: usize,
        skin: Option<usize>,
        node: usize,
        weights: Vec<f32>,
        scene: &mut Scene,
        budget: &mut Budget,
    ) -> Result<(usize, bool), SceneError> {
        let Some(deform) = &self.deforms[mesh] else { return Ok((self.plain(mesh, scene, budget)?, false)) };
        let skin = skin.filter(|_| !deform.ends.is_empty());
        // Without targets the node has no say in the shape.
        let key = skin.filter(|_| deform.targets.is_empty()).map(|s| (mesh, s));
        if let Some(known) = key.and_then(|k| self.skinned.get(&k)) {
            return Ok((*known, true));
        }
        // Nodes may share what deforms them, but each has its own work.
        let work = scene.meshes[mesh].positions.len() * deform.targets.len() + deform.influences.len();
        budget.add_extra((work + weights.len()) as u64)?;
        let own = self.own(mesh, scene, budget)?;
        if let Some(key) = key {
            self.skinned.insert(key, own);
        }
        let binding = skin.map(|skin| Binding {
            skin,
            ends: deform.ends.clone(),
            influences: deform.influences.clone(),
        });
        let Mesh { positions, normals, .. } = &scene.meshes[own];
        scene.animation.bodies.push(Body {
            mesh: own,
            node,
            positions: positions.clone(),
            normals: normals.clone(),
            flat: deform.flat,
            targets: deform.targets.clone(),
            weights,
            binding,
        });
        Ok((own, skin.is_some()))
    }

    /// The largest joint number that a mesh uses.
    pub(super) fn last_joint(&self, mesh: usize) -> u32 {
        self.deforms[mesh].as_ref().map_or(0, |d| d.last_joint)
    }

    fn own(&mut self, mesh: usize, scene: &mut Scene, budget: &mut Budget) -> Result<usize, SceneError> {
        if !std::mem::replace(&mut self.taken[mesh], true) {
            return Ok(mesh);
        }
        let copy = scene.meshes[mesh].clone();
        budget.add(copy.positions.len() as u64, copy.indices.len() as u64)?;
        scene.meshes.push(copy);
        budget.check_counts(scene.meshes.len(), 0)?;
        Ok(scene.meshes.len() - 1)
    }
}

/// Reads the skins; for each of the file's its number in the animation, or `None` for one that cannot be used.
pub(super) fn read(
    reader: &Reader,
    tree: &Tree,
    limits: &Limits,
    scene: &mut Scene,
) -> Result<Vec<Option<usize>>, SceneError> {
    let mut numbers = Vec::with_capacity(reader.root.skins.len());
    for (i, skin) in reader.root.skins.iter().enumerate() {
        let joints: Option<Vec<usize>> =
            skin.joints.iter().map(|j| tree.ids.get(j.value()).copied().flatten().map(|id| id.0)).collect();
        let matrices = match skin.inverse_bind_matrices {
            None => vec![Mat4::IDENTITY; skin.joints.len()],
            Some(accessor) => {
                let count = reader.count(accessor.value())?;
                check_limit(reader.source.name(), "the number of bind matrices", count, limits.nodes)?;
                reader.matrices(accessor.value())?.iter().map(Mat4::from_cols_array).collect()
            }
        };
        let why = match &joints {
            None => "one of its joints is not in the scene",
            Some(joints) if joints.is_empty() => "it has no joints",
            Some(joints) if matrices.len() < joints.len() => "it has fewer bind matrices than joints",
            Some(_) if !matrices.iter().all(|m| m.is_finite()) => "a bind matrix is not finite",
            Some(_) => "",
        };
        if let (Some(joints), true) = (joints, why.is_empty()) {
            let joint_from_mesh = matrices.into_iter().take(joints.len()).collect();
            scene.animation.skins.push(Skin { joints, joint_from_mesh });
            numbers.push(Some(scene.animation.skins.len() - 1));
        } else {
            scene.report.warn(format!("skin {i} is left out: {why}"));
            numbers.push(None);
        }
    }
    Ok(numbers)
}
