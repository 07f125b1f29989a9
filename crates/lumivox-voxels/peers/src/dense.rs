//! The plain way: a bit per cell of the whole box, each cell of a triangle's bounding box asked in turn, in f32, with the
//! plane and edge tests of Schwarz and Seidel (2010) set up once per triangle. One thread.

use glam::{UVec3, Vec2, Vec3};

/// Marks the cells of the conservative set; positions are in cells. Returns their number.
pub fn voxelize(positions: &[[f32; 3]], indices: &[[u32; 3]], dims: UVec3) -> usize {
    let [nx, ny, nz] = dims.to_array().map(|n| n as usize);
    let mut bits = vec![0u64; (nx * ny * nz).div_ceil(64)];
    for t in indices {
        let v = t.map(|i| Vec3::from(positions[i as usize]));
        let low = v[0].min(v[1]).min(v[2]).floor().max(Vec3::ZERO).as_uvec3();
        let high = v[0].max(v[1]).max(v[2]).floor().max(Vec3::ZERO).as_uvec3().min(dims - 1);
        let e = [v[1] - v[0], v[2] - v[1], v[0] - v[2]];
        let n = e[0].cross(e[1]);
        let critical = Vec3::select(n.cmpgt(Vec3::ZERO), Vec3::ONE, Vec3::ZERO);
        let (d1, d2) = (n.dot(critical - v[0]), n.dot(Vec3::ONE - critical - v[0]));
        let lines: [[(Vec2, f32); 3]; 3] = std::array::from_fn(|axis| {
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            let side = if n[axis] < 0.0 { -1.0 } else { 1.0 };
            std::array::from_fn(|i| {
                let normal = side * Vec2::new(-e[i][q], e[i][p]);
                let reach = normal.max(Vec2::ZERO).element_sum();
                (normal, reach - normal.dot(Vec2::new(v[i][p], v[i][q])))
            })
        });
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let cell = UVec3::new(x, y, z).as_vec3();
                    let d = n.dot(cell);
                    let overlaps = (d + d1) * (d + d2) <= 0.0
                        && lines.iter().enumerate().all(|(axis, lines)| {
                            let at = Vec2::new(cell[(axis + 1) % 3], cell[(axis + 2) % 3]);
                            lines.iter().all(|(normal, c)| normal.dot(at) + c >= 0.0)
                        });
                    if overlaps {
                        let index = x as usize + nx * (y as usize + ny * z as usize);
                        bits[index / 64] |= 1 << (index % 64);
                    }
                }
            }
        }
    }
    bits.iter().map(|word| word.count_ones() as usize).sum()
}
