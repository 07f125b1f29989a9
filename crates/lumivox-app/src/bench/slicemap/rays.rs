//! True rays: all surfaces that the rays of a view meet, by triangles sorted into squares of its picture plane.

use glam::{DVec2, DVec3, DVec4, UVec2, Vec3};
use lumivox::core::View;
use lumivox_scene::{AlphaMode, Scene};

/// A surface in a ray's way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Metres along the view.
    pub(super) distance: f64,
    pub(super) faces_view: bool,
    pub(super) mesh: usize,
    pub(super) world: DVec3,
}

struct Corner {
    clip: DVec4,
    distance: f64,
    world: DVec3,
    uv: DVec2,
}

/// A scene as a view sees it.
pub(super) struct Rays<'s> {
    scene: &'s Scene,
    view: View,
    triangles: Vec<([Corner; 3], usize)>,
    /// Triangles of each square.
    squares: Vec<Vec<u32>>,
    side: u32,
}

impl<'s> Rays<'s> {
    /// For the instances of some meshes; what reaches behind the eye is left out.
    pub(super) fn new(scene: &'s Scene, view: View, side: u32, wanted: impl Fn(usize) -> bool) -> Self {
        let mut rays = Self { scene, view, triangles: Vec::new(), squares: Vec::new(), side };
        rays.squares.resize_with((side * side) as usize, Vec::new);
        let clip = view.clip_from_world.as_dmat4();
        let eye = view.eye_from_world.as_dmat4();
        for instance in scene.instances.iter().filter(|i| wanted(i.mesh)) {
            let mesh = &scene.meshes[instance.mesh];
            let place = instance.world_from_local.as_dmat4();
            for triangle in &mesh.indices {
                let corners = triangle.map(|i| {
                    let i = i as usize;
                    let world = place.transform_point3(DVec3::from(mesh.positions[i].map(f64::from)));
                    Corner {
                        clip: clip * world.extend(1.0),
                        distance: -eye.transform_point3(world).z,
                        world,
                        uv: DVec2::from(mesh.uvs[i].map(f64::from)),
                    }
                });
                if corners.iter().all(|c| c.clip.w > 1e-9) {
                    rays.add(corners, instance.mesh);
                }
            }
        }
        rays
    }

    fn add(&mut self, corners: [Corner; 3], mesh: usize) {
        let points = corners.each_ref().map(|c| c.clip.truncate().truncate() / c.clip.w);
        let square = |p: DVec2| (0.5 * (p + 1.0) * f64::from(self.side)).floor();
        let low = square(points[0].min(points[1]).min(points[2])).max(DVec2::ZERO);
        let high =
            square(points[0].max(points[1]).max(points[2])).min(DVec2::splat(f64::from(self.side) - 1.0));
        if low.cmpgt(high).any() {
            return;
        }
        let number = self.triangles.len() as u32;
        let (low, high) = (low.as_uvec2(), high.as_uvec2());
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                self.squares[(y * self.side + x) as usize].push(number);
            }
        }
        self.triangles.push((corners, mesh));
    }

    /// All that a ray through a point of the picture plane meets, in normalized device coordinates; the nearest first. Holes of masks are none.
    pub(super) fn through(&self, ndc: DVec2) -> Vec<Hit> {
        let square = (0.5 * (ndc + 1.0) * f64::from(self.side)).floor();
        if square.cmplt(DVec2::ZERO).any() || square.cmpge(DVec2::splat(f64::from(self.side))).any() {
            return Vec::new();
        }
        let square = square.as_uvec2();
        let found = self.squares[(square.y * self.side + square.x) as usize].iter();
        let mut hits: Vec<Hit> = found.filter_map(|&n| self.meet(&self.triangles[n as usize], ndc)).collect();
        hits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        hits
    }

    fn meet(&self, (corners, mesh): &([Corner; 3], usize), ndc: DVec2) -> Option<Hit> {
        let [a, b, c] = corners.each_ref().map(|c| DVec3::new(c.clip.x, c.clip.y, c.clip.w));
        let p = ndc.extend(1.0);
        let parts = DVec3::new(b.cross(c).dot(p), c.cross(a).dot(p), a.cross(b).dot(p));
        let is_inside = parts.cmpge(DVec3::ZERO).all() || parts.cmple(DVec3::ZERO).all();
        let sum = parts.element_sum();
        if !is_inside || sum == 0.0 {
            return None;
        }
        let weights = parts / sum;
        let mix = |of: fn(&Corner) -> DVec3| {
            weights.x * of(&corners[0]) + weights.y * of(&corners[1]) + weights.z * of(&corners[2])
        };
        let uv = mix(|c| c.uv.extend(c.distance));
        let hit = Hit {
            distance: uv.z,
            // The determinant is the area seen from the eye, anticlockwise for fronts.
            faces_view: a.cross(b).dot(c) > 0.0,
            mesh: *mesh,
            world: mix(|c| c.world),
        };
        (!self.is_hole(*mesh, uv.truncate())).then_some(hit)
    }

    fn is_hole(&self, mesh: usize, uv: DVec2) -> bool {
        let material = &self.scene.materials[self.scene.meshes[mesh].material];
        let AlphaMode::Mask { cutoff } = material.alpha else { return false };
        let Some(texture) = material.base_color_texture.and_then(|t| self.scene.textures.get(t)) else {
            return material.base_color.w < cutoff;
        };
        let size = UVec2::new(texture.width, texture.height).as_dvec2();
        let at = uv * size - 0.5;
        let (low, share) = (at.floor(), at - at.floor());
        let alpha = |dx: f64, dy: f64| {
            let texel = (low + DVec2::new(dx, dy)).rem_euclid(size).as_uvec2().min(size.as_uvec2() - 1);
            f64::from(texture.pixels[4 * (texel.y * texture.width + texel.x) as usize + 3]) / 255.0
        };
        let row = |dy: f64| alpha(0.0, dy) * (1.0 - share.x) + alpha(1.0, dy) * share.x;
        let found = row(0.0) * (1.0 - share.y) + row(1.0) * share.y;
        (found as f32) * material.base_color.w < cutoff
    }

    /// Where a point of the world lies in the picture plane, and its distance along the view.
    pub(super) fn place(&self, world: DVec3) -> (DVec2, f64) {
        let clip = self.view.clip_from_world.as_dmat4() * world.extend(1.0);
        (clip.truncate().truncate() / clip.w, -self.view.eye_from_world.as_dmat4().transform_point3(world).z)
    }
}

/// The middle of a pixel.
pub(super) fn ndc(pixel: UVec2, size: UVec2) -> DVec2 {
    let uv = (pixel.as_dvec2() + 0.5) / size.as_dvec2();
    DVec2::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y)
}

/// The metres of a ray between fronts and backs, by hits in order; nested things count once.
pub(super) fn inner_metres(hits: &[Hit]) -> f64 {
    let (mut depth, mut entered, mut sum) = (0i32, 0.0, 0.0);
    for hit in hits {
        if hit.faces_view {
            if depth == 0 {
                entered = hit.distance;
            }
            depth += 1;
        } else if depth > 0 {
            depth -= 1;
            if depth == 0 {
                sum += hit.distance - entered;
            }
        }
    }
    sum
}

/// A parallel view along a direction that holds a scene.
pub(super) fn along(scene: &Scene, direction: Vec3) -> View {
    let bounds = scene.bounds();
    let reach = bounds.size().length();
    let up = if direction.y.abs() > 0.9 { Vec3::X } else { Vec3::Y };
    let eye = bounds.center() - reach * direction;
    View::orthographic_along(eye, direction, up, glam::Vec2::splat(reach), 2.0 * reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_through_the_knot_meet_as_many_fronts_as_backs() {
        let scene = lumivox_scene::builtin::knot_glass(0);
        let camera = &scene.cameras[0];
        let view = View::perspective(camera.eye, camera.target, camera.up, camera.fov_y, 1.0, 0.1, 20.0);
        let rays = Rays::new(&scene, view, 16, |mesh| mesh == 0);
        let size = UVec2::splat(24);
        let mut thick = 0;
        for n in 0..size.element_product() {
            let hits = rays.through(ndc(UVec2::new(n % 24, n / 24), size));
            assert_eq!(hits.len(), 2 * hits.iter().filter(|h| h.faces_view).count());
            let metres = inner_metres(&hits);
            assert!((0.0..2.0).contains(&metres) && (metres > 0.0) != hits.is_empty());
            for hit in &hits {
                let (place, distance) = rays.place(hit.world);
                assert!(place.distance(ndc(UVec2::new(n % 24, n / 24), size)) < 1e-6);
                assert!((distance - hit.distance).abs() < 1e-6);
            }
            thick += usize::from(metres > 0.1);
        }
        assert!(thick > 60, "{thick}");
    }
}
