//! What leaves leave of the sun at the places that a picture shows, counted by rays.

use glam::{DVec2, DVec3, UVec2, Vec3};
use lumivox::core::View;
use lumivox_render::lights;
use lumivox_scene::{AlphaMode, Camera, Light, Scene};

use super::rays::{Rays, along};

/// A leaf is not its own shade, metres.
const OWN: f64 = 2e-3;

/// Leaves before each pixel's place, as far as no wood is.
pub(super) struct Counted {
    /// Along the ray through the place; none for the sky and for what wood shades.
    pub(super) through: Vec<Option<u32>>,
    /// Along the ray in the middle of the place's column, up to a column's width before it: what a slicemap with a slice for each leaf
    /// would hold.
    pub(super) in_columns: Vec<u32>,
}

/// For places that a picture shows, and a map of so many columns a side.
pub(super) fn counted(
    scene: &Scene,
    camera: &Camera,
    sun: Vec3,
    (places, size): (&[Option<DVec3>], UVec2),
    columns: u32,
) -> Counted {
    let is_leaf = |mesh: usize| scene.materials[scene.meshes[mesh].material].alpha != AlphaMode::Opaque;
    let count = |rays: &Rays<'_>, at: DVec2, end: f64| {
        let hits = rays.through(at);
        let before = hits.iter().take_while(|h| h.distance < end);
        before.fold(
            (0, 0),
            |(leaves, wood), hit| {
                if is_leaf(hit.mesh) { (leaves + 1, wood) } else { (leaves, wood + 1) }
            },
        )
    };
    let whole = Rays::new(scene, along(scene, sun), 1024, |_| true);
    let through = |place: &Option<DVec3>| {
        let (at, distance) = whole.place((*place)?);
        let (leaves, wood) = count(&whole, at, distance - OWN);
        (wood == 0).then_some(leaves)
    };
    let view = map_view(scene, camera, sun, size, columns);
    let width = 2.0 / (f64::from(view.clip_from_world.row(0).truncate().length()) * f64::from(columns));
    let map = Rays::new(scene, view, 1024, is_leaf);
    let in_column = |place: &Option<DVec3>| {
        let Some(place) = place else { return 0 };
        let (at, distance) = map.place(*place);
        let column = (0.5 * (at + 1.0) * f64::from(columns)).floor() + 0.5;
        count(&map, 2.0 * column / f64::from(columns) - 1.0, distance - width).0
    };
    Counted {
        through: places.iter().map(through).collect(),
        in_columns: places.iter().map(in_column).collect(),
    }
}

/// The view of the sun's maps.
fn map_view(scene: &Scene, camera: &Camera, sun: Vec3, size: UVec2, columns: u32) -> View {
    let bounds = scene.bounds();
    let aspect = size.x as f32 / size.y as f32;
    let far = 2.0 * bounds.size().length() + camera.eye.distance(camera.target);
    let seen = View::perspective(camera.eye, camera.target, camera.up, camera.fov_y, aspect, 0.01, far);
    let light = Light::Directional { direction: sun, irradiance: Vec3::ONE };
    let receivers = lights::visible_part(&seen, &bounds);
    let views = lights::light_samples(&light, 1)
        .first()
        .map(|sample| lights::light_views(sample, &bounds, &receivers, columns));
    views.into_iter().flatten().next().unwrap_or_else(|| along(scene, sun))
}
