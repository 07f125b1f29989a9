//! Walls, floors and stairs of upright boxes: closed by construction, whatever is added or cut out.

use glam::{Vec2, Vec3};

use super::builder::{Builder, SceneBuilder};

/// A solid out of boxes. Later boxes replace earlier ones where they overlap; a cut leaves air. Only the faces between
/// solid and air are made, all on one raster, so that neighbours share whole edges: no gaps, no faces in one another.
#[derive(Debug, Default)]
pub(super) struct Masonry {
    boxes: Vec<(Vec3, Vec3, Option<usize>)>,
}

impl Masonry {
    /// Fills a box with a material.
    pub(super) fn fill(&mut self, min: [f32; 3], max: [f32; 3], material: usize) {
        self.boxes.push((min.into(), max.into(), Some(material)));
    }

    /// Cuts a box out.
    pub(super) fn cut(&mut self, min: [f32; 3], max: [f32; 3]) {
        self.boxes.push((min.into(), max.into(), None));
    }

    /// Adds one mesh for each material, named `name, material`. Faces are cut into cells of at most `longest` metres
    /// and coloured by where they are.
    pub(super) fn finish(self, scene: &mut SceneBuilder, name: &str, longest: f32, tint: fn(Vec3) -> Vec3) {
        let lines = [0, 1, 2].map(|axis| self.raster(axis, longest));
        let [nx, ny, nz] = [0, 1, 2].map(|a| lines[a].len() - 1);
        let mut cells = vec![None; nx * ny * nz];
        let index = |c: [usize; 3]| (c[2] * ny + c[1]) * nx + c[0];
        for (min, max, material) in &self.boxes {
            let range = |axis: usize| {
                let line = &lines[axis];
                line.partition_point(|&v| v < min[axis])..line.partition_point(|&v| v < max[axis])
            };
            for k in range(2) {
                for j in range(1) {
                    for i in range(0) {
                        cells[index([i, j, k])] = *material;
                    }
                }
            }
        }
        let mut meshes: Vec<(usize, Builder)> = Vec::new();
        for c in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k]))) {
            let Some(material) = cells[index(c)] else { continue };
            for axis in 0..3 {
                for up in [false, true] {
                    let edge = if up { [nx, ny, nz][axis] - 1 } else { 0 };
                    let mut other = c;
                    if c[axis] != edge {
                        other[axis] = if up { c[axis] + 1 } else { c[axis] - 1 };
                        if cells[index(other)].is_some() {
                            continue;
                        }
                    }
                    let slot = meshes.iter().position(|(m, _)| *m == material).unwrap_or_else(|| {
                        meshes.push((material, Builder::default()));
                        meshes.len() - 1
                    });
                    face(&mut meshes[slot].1, &lines, c, axis, up, tint);
                }
            }
        }
        for (material, builder) in meshes {
            let name = format!("{name}, {}", scene.material_name(material));
            scene.add(&name, builder, material);
        }
    }

    /// Where the raster is cut across one axis: at every side of a box, and in between until cells are short enough.
    fn raster(&self, axis: usize, longest: f32) -> Vec<f32> {
        let mut sides: Vec<f32> =
            self.boxes.iter().flat_map(|(min, max, _)| [min[axis], max[axis]]).collect();
        sides.sort_by(f32::total_cmp);
        sides.dedup();
        let mut lines = Vec::new();
        for pair in sides.windows(2) {
            let parts = ((pair[1] - pair[0]) / longest).ceil().max(1.0);
            lines.extend((0..parts as u32).map(|i| pair[0] + (pair[1] - pair[0]) * i as f32 / parts));
        }
        lines.extend(sides.last());
        lines
    }
}

/// One side of a cell.
fn face(
    b: &mut Builder,
    lines: &[Vec<f32>; 3],
    cell: [usize; 3],
    axis: usize,
    up: bool,
    tint: fn(Vec3) -> Vec3,
) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut normal = Vec3::ZERO;
    normal[axis] = if up { 1.0 } else { -1.0 };
    let corner = |du: usize, dv: usize| {
        let mut p = Vec3::ZERO;
        p[axis] = lines[axis][cell[axis] + usize::from(up)];
        p[u] = lines[u][cell[u] + du];
        p[v] = lines[v][cell[v] + dv];
        p
    };
    let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(du, dv)| {
        let p = corner(du, dv);
        b.vertex(p, normal, Vec2::new(du as f32, dv as f32), tint(p))
    });
    b.triangle([corners[0], corners[1], corners[2]]);
    b.triangle([corners[0], corners[2], corners[3]]);
}

/// No tint.
pub(super) fn plain(_: Vec3) -> Vec3 {
    Vec3::ONE
}

/// A little darker towards the ground and in broad, soft clouds, as walls get outdoors.
pub(super) fn weathered(p: Vec3) -> Vec3 {
    let cloud = (0.9 * p.x + 0.5 * p.y).sin() * (0.7 * p.z - 0.4 * p.x + 1.1 * p.y).sin();
    let rise = (p.y / 2.5).clamp(0.0, 1.0);
    let value = 0.80 + 0.12 * rise + 0.08 * cloud;
    Vec3::new(value, value * (0.97 + 0.03 * rise), value * (0.93 + 0.07 * rise))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Material, builtin::checks};

    #[test]
    fn a_hollow_block_with_a_window_is_closed_and_has_its_volume() {
        for longest in [f32::INFINITY, 0.3] {
            let mut scene = SceneBuilder::default();
            let stone = scene.material(Material::matte("stone", Vec3::ONE));
            let wood = scene.material(Material::matte("wood", Vec3::ONE));
            let mut m = Masonry::default();
            m.fill([0.0; 3], [4.0, 3.0, 2.0], stone);
            m.cut([0.5; 3], [3.5, 2.5, 1.5]);
            m.fill([0.5; 3], [1.0, 2.5, 1.5], wood);
            m.cut([2.0, 1.0, -1.0], [3.0, 2.0, 1.0]);
            m.finish(&mut scene, "block", longest, plain);
            let scene = scene.finish();
            assert_eq!(
                scene.meshes.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(),
                ["block, stone", "block, wood"]
            );
            let triangles = checks::world_triangles(&scene, |_| true);
            assert_eq!(checks::open_edges(&triangles), 0);
            assert!((checks::volume(&triangles) - (24.0 - 6.0 + 1.0 - 0.5)).abs() < 1e-4);
        }
    }
}
