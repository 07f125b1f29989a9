//! The shapes that a scene file can state itself.

use glam::{Mat4, Quat, Vec4};

use super::format::BoxEntry;
use super::{amount, vector};
use crate::Mesh;

pub(super) fn quad(corners: &[[f32; 3]; 4]) -> Result<Mesh, String> {
    for c in corners {
        vector(*c, "quad")?;
    }
    let mut mesh = Mesh::flat("quad", corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], 0);
    let uvs = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    mesh.uvs = [0, 1, 2, 0, 2, 3].map(|i: usize| uvs[i]).to_vec();
    Ok(mesh)
}

pub(super) fn cuboid(entry: &BoxEntry) -> Result<Mesh, String> {
    let center = vector(entry.center, "center")?;
    let size = amount(entry.size, "size")?;
    let turn = vector([0.0, entry.rot_y_deg, 0.0], "rot_y_deg")?.y.to_radians();
    let turned = Mat4::from_rotation_translation(Quat::from_rotation_y(turn), center);
    let corner = |i: u32| {
        let side = Vec4::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32, 0.0) - 0.5;
        turned.transform_point3(side.truncate() * size).to_array()
    };
    // Counterclockwise from outside: -x, +x, -y, +y, -z, +z.
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Ok(Mesh::flat("box", (0..8).map(corner).collect(), triangles, 0))
}
