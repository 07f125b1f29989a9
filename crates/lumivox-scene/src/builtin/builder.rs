//! What the built-in scenes are made with: a [`Builder`] for one mesh and a [`SceneBuilder`] for the whole.

use glam::{Mat4, Quat, Vec2, Vec3};

use super::MAX_DETAIL;
use crate::{Camera, Clip, Instance, Light, Material, Mesh, NodeId, Scene, Texture, Transform};

/// Collects the triangles of one mesh. Surfaces are added with smooth or face normals as their shape asks for.
#[derive(Debug, Default)]
pub(super) struct Builder {
    pub(super) mesh: Mesh,
}

impl Builder {
    /// One vertex; returns its number.
    pub(super) fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2, color: Vec3) -> u32 {
        let m = &mut self.mesh;
        m.positions.push(position.to_array());
        m.normals.push(normal.normalize_or(Vec3::Y).to_array());
        m.uvs.push(uv.to_array());
        m.colors.push(color.extend(1.0).to_array());
        m.positions.len() as u32 - 1
    }

    /// A sheet of `steps` cells: `surface(s, t)` gives position and normal for `s, t` in 0..1, neighbours share vertices.
    /// Triangles are wound after the normals, whichever way `s` and `t` run.
    pub(super) fn sheet(&mut self, steps: [u32; 2], color: Vec3, surface: impl Fn(f32, f32) -> (Vec3, Vec3)) {
        let [n, m] = steps.map(|s| s.max(1));
        let first = self.mesh.positions.len() as u32;
        for j in 0..=m {
            for i in 0..=n {
                let (s, t) = (i as f32 / n as f32, j as f32 / m as f32);
                let (p, normal) = surface(s, t);
                self.vertex(p, normal, Vec2::new(s, t), color);
            }
        }
        for j in 0..m {
            for i in 0..n {
                let a = first + j * (n + 1) + i;
                let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
                self.triangle([a, b, c]);
                self.triangle([a, c, d]);
            }
        }
    }

    /// One triangle, wound so that its front is where its normals point.
    pub(super) fn triangle(&mut self, [a, b, c]: [u32; 3]) {
        let m = &self.mesh;
        let at = |i: u32| Vec3::from(m.positions[i as usize]);
        let normals: Vec3 = [a, b, c].iter().map(|&i| Vec3::from(m.normals[i as usize])).sum();
        let front = (at(b) - at(a)).cross(at(c) - at(a)).dot(normals) >= 0.0;
        self.mesh.indices.push(if front { [a, b, c] } else { [a, c, b] });
    }

    /// A flat parallelogram of `steps` cells with the normal `u x v`.
    pub(super) fn grid(&mut self, origin: Vec3, u: Vec3, v: Vec3, steps: [u32; 2], color: Vec3) {
        let normal = u.cross(v);
        self.sheet(steps, color, |s, t| (origin + s * u + t * v, normal));
    }

    /// A flat quadrilateral with corners in order around it, in `steps` cells; the normal is that of its first corner.
    pub(super) fn quad(&mut self, corners: [Vec3; 4], steps: [u32; 2], color: Vec3) {
        let [a, b, c, d] = corners;
        let normal = (b - a).cross(d - a);
        self.sheet(steps, color, |s, t| (a.lerp(b, s).lerp(d.lerp(c, s), t), normal));
    }

    /// A box turned about Y by `angle` radians, each face in `steps` x `steps` cells.
    pub(super) fn block(&mut self, center: Vec3, size: Vec3, angle: f32, steps: u32, color: Vec3) {
        let turn = Quat::from_rotation_y(angle);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for side in [axis, -axis] {
                let u = Vec3::new(axis.y, axis.z, axis.x);
                let v = side.cross(u);
                let corner = 0.5 * size * (side - u - v);
                self.grid(center + turn * corner, turn * (u * size), turn * (v * size), [steps; 2], color);
            }
        }
    }

    /// A box between two corners, not subdivided.
    pub(super) fn slab(&mut self, min: Vec3, max: Vec3, color: Vec3) {
        self.block(0.5 * (min + max), max - min, 0.0, 1, color);
    }

    /// A body turned about the vertical through `foot`: the `profile` lists `(radius, height)` from bottom to top.
    /// Edges of the profile are sharp where it bends by more than about 30 degrees.
    pub(super) fn lathe(&mut self, foot: Vec3, profile: &[Vec2], sides: u32, color: Vec3) {
        let slope = |i: usize| (profile[i + 1] - profile[i]).normalize_or(Vec2::Y);
        let last = profile.len() - 2;
        for i in 0..=last {
            let here = slope(i);
            // The tangent at an end: shared with the neighbour unless the edge between them is sharp.
            let joined = |other: Vec2| if here.dot(other) > 0.86 { here + other } else { here };
            let low = if i > 0 { joined(slope(i - 1)) } else { here };
            let high = if i < last { joined(slope(i + 1)) } else { here };
            let (a, b) = (profile[i], profile[i + 1]);
            self.sheet([sides, 1], color, |s, t| {
                // Downwards in angle, so that the outside is the front.
                let (sin, cos) = (-s * std::f32::consts::TAU).sin_cos();
                let around = |r: f32, y: f32| Vec3::new(r * cos, y, r * sin);
                let p = a.lerp(b, t);
                let tangent = low.lerp(high, t);
                (foot + around(p.x, p.y), around(tangent.y, -tangent.x))
            });
        }
    }
}

/// The entry for a detail level; levels beyond the finest are the finest.
pub(super) fn pick<T: Copy>(detail: u32, values: [T; 5]) -> T {
    values[detail.min(MAX_DETAIL) as usize]
}

/// Collects a scene; every mesh stands once, where its coordinates say.
#[derive(Debug, Default)]
pub(super) struct SceneBuilder {
    scene: Scene,
}

impl SceneBuilder {
    /// Adds a material; returns its index.
    pub(super) fn material(&mut self, material: Material) -> usize {
        self.scene.materials.push(material);
        self.scene.materials.len() - 1
    }

    /// Adds a texture; returns its index.
    pub(super) fn texture(&mut self, texture: Texture) -> usize {
        self.scene.textures.push(texture);
        self.scene.textures.len() - 1
    }

    /// The name of a material.
    pub(super) fn material_name(&self, material: usize) -> &str {
        self.scene.materials.get(material).map_or("", |m| m.name.as_str())
    }

    /// Adds a mesh with one instance.
    pub(super) fn add(&mut self, name: &str, builder: Builder, material: usize) {
        self.add_at(name, builder, material, &[Mat4::IDENTITY]);
    }

    /// Adds a mesh that stands in many places.
    pub(super) fn add_at(&mut self, name: &str, builder: Builder, material: usize, places: &[Mat4]) {
        let mesh = self.scene.meshes.len();
        self.scene.meshes.push(Mesh { name: name.to_owned(), material, ..builder.mesh });
        self.scene
            .instances
            .extend(places.iter().map(|&world_from_local| Instance { mesh, world_from_local }));
    }

    /// Adds a node below `parent`; see [`Animation`](crate::Animation).
    pub(super) fn node(&mut self, parent: Option<NodeId>, local: Transform) -> NodeId {
        self.scene.animation.add_node(parent, local)
    }

    /// Adds a mesh in a node's own axes, which moves with it.
    pub(super) fn hang(&mut self, name: &str, builder: Builder, material: usize, node: NodeId) {
        self.hang_all(name, builder, material, &[node]);
    }

    /// Adds a mesh that moves with many nodes, once with each.
    pub(super) fn hang_all(&mut self, name: &str, builder: Builder, material: usize, nodes: &[NodeId]) {
        let first = self.scene.instances.len();
        let places: Vec<Mat4> = nodes.iter().map(|&n| self.scene.animation.world_from_node(n)).collect();
        self.add_at(name, builder, material, &places);
        nodes.iter().enumerate().for_each(|(i, &node)| self.scene.hang_instance(first + i, node));
    }

    pub(super) fn light(&mut self, light: Light) {
        self.scene.lights.push(light);
    }

    /// Adds a light that is at rest where it says and moves with a node; returns its index.
    pub(super) fn hang_light(&mut self, light: Light, node: NodeId) -> usize {
        self.light(light);
        let index = self.scene.lights.len() - 1;
        self.scene.hang_light(index, node);
        index
    }

    pub(super) fn clip(&mut self, clip: Clip) {
        self.scene.animation.add_clip(clip);
    }

    pub(super) fn camera(&mut self, camera: Camera) {
        self.scene.cameras.push(camera);
    }

    pub(super) fn sky(&mut self, radiance: Vec3) {
        self.scene.sky = radiance;
    }

    /// The scene; if it moves, as it stands when its first clip begins.
    pub(super) fn finish(mut self) -> Scene {
        if !self.scene.animation.is_empty() {
            let pose = self.scene.pose(0, 0.0);
            self.scene.apply(&pose);
        }
        self.scene
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_are_wound_outwards_and_agree_with_their_normals() {
        let mut b = Builder::default();
        b.block(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0), 0.4, 2, Vec3::ONE);
        b.lathe(Vec3::ZERO, &[Vec2::new(1.0, -1.0), Vec2::new(2.0, 0.0), Vec2::new(1.0, 1.0)], 8, Vec3::ONE);
        for t in &b.mesh.indices {
            let [p, q, r] = t.map(|i| Vec3::from(b.mesh.positions[i as usize]));
            let n = (q - p).cross(r - p);
            assert!(n.dot(p + q + r) > 0.0);
            assert!(t.iter().all(|&i| n.dot(b.mesh.normals[i as usize].into()) > 0.0));
        }
    }
}
