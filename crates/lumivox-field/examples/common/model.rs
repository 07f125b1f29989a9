//! A scene file as one mesh.

use anyhow::Result;
use glam::Vec3;
use lumivox_core::TriangleView;
use lumivox_field::Mesh;

/// All triangles of a scene, where they stand.
pub(crate) struct Model {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
}

impl Model {
    /// Reads a file or a built-in scene.
    pub(crate) fn load(name: &str) -> Result<Self> {
        let scene = lumivox_scene::load(name)?;
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        for instance in &scene.instances {
            let Some(mesh) = scene.meshes.get(instance.mesh) else { continue };
            let first = positions.len() as u32;
            let place = |p: &[f32; 3]| instance.world_from_local.transform_point3(Vec3::from(*p)).to_array();
            positions.extend(mesh.positions.iter().map(place));
            indices.extend(mesh.indices.iter().map(|t| t.map(|i| first + i)));
        }
        Ok(Self { positions, indices })
    }

    /// Number of triangles.
    pub(crate) fn triangles(&self) -> usize {
        self.indices.len()
    }

    /// The mesh, with the normals of its faces.
    pub(crate) fn mesh(&self) -> Mesh<'_> {
        Mesh::new(TriangleView { positions: &self.positions, indices: &self.indices })
    }
}
