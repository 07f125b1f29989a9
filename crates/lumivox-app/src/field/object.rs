//! Meshes as the baker takes them.

use lumivox_core::TriangleView;
use lumivox_field::Mesh;
use lumivox_scene::Scene;

/// The triangles of a rigid object.
#[derive(Clone, Debug, Default)]
pub(crate) struct Object {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
}

impl Object {
    /// All instances of a scene where they stand.
    pub(crate) fn whole(scene: &Scene) -> Self {
        let mut object = Self::default();
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            let world = instance.world_from_local;
            let turned = glam::Mat3::from_mat4(world).inverse().transpose();
            let first = object.positions.len() as u32;
            let place = |p: &[f32; 3]| world.transform_point3((*p).into()).to_array();
            let turn = |n: &[f32; 3]| (turned * glam::Vec3::from(*n)).normalize_or_zero().to_array();
            object.positions.extend(mesh.positions.iter().map(place));
            object.normals.extend(mesh.normals.iter().map(turn));
            object.indices.extend(mesh.indices.iter().map(|t| t.map(|i| i + first)));
        }
        object
    }

    /// One mesh in its own space.
    pub(crate) fn of_mesh(mesh: &lumivox_scene::Mesh) -> Self {
        let (positions, normals, indices) =
            (mesh.positions.clone(), mesh.normals.clone(), mesh.indices.clone());
        Self { positions, normals, indices }
    }

    /// The same as a mesh of a scene.
    pub(crate) fn scene_mesh(&self, name: &str, material: usize) -> lumivox_scene::Mesh {
        let Self { positions, normals, indices } = self.clone();
        let count = positions.len();
        lumivox_scene::Mesh {
            name: name.to_owned(),
            positions,
            normals,
            uvs: vec![[0.0; 2]; count],
            colors: vec![[1.0; 4]; count],
            indices,
            material,
        }
    }

    /// Number of triangles.
    pub(crate) fn triangles(&self) -> usize {
        self.indices.len()
    }

    /// The mesh that is baked.
    pub(crate) fn mesh(&self) -> Mesh<'_> {
        let triangles = TriangleView { positions: &self.positions, indices: &self.indices };
        Mesh { triangles, normals: Some(&self.normals) }
    }
}
