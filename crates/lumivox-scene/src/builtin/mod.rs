//! Scenes made by code. Each takes a detail level from 0 to [`MAX_DETAIL`] that sets its number of triangles and
//! nothing else: the shapes stay where they are.
//!
//! | name | what it shows | clip |
//! | --- | --- | --- |
//! | [`arena`](arena()) | a walled court outdoors | |
//! | [`atrium`](atrium()) | a two-storey colonnade about a sunlit court | `day` |
//! | [`cornell`](cornell()) | the box with a red and a green wall | |
//! | [`door`](door()) | a door that opens, a figure that walks behind it | `door` |
//! | [`falling`](falling()) | ten bodies that bounce on a floor | `fall` |
//! | [`furnace`](furnace()) | a box whose radiance is known | |
//! | [`knot_glass`](knot_glass()) | a closed knot for refraction | |
//! | [`room`](room()) | sun through windows, a staircase, a hall that only two bounces reach | |
//! | [`terrain`](terrain()) | open land with a palace, columns and trees | |
//! | [`test`](test()) | 48 triangles | |
//! | [`tree`](tree()) | 160 000 masked leaves | |
//! | [`tunnel`](tunnel()) | a tank drives through a tunnel with its lamp | `drive` |
//! | [`two_rooms`](two_rooms()) | a lit room and a dark one: leaks show | |

mod arena;
mod atrium;
mod bodies;
mod builder;
#[cfg(test)]
mod checks;
mod cornell;
mod door;
mod falling;
mod furnace;
mod knot_glass;
mod masonry;
mod room;
mod terrain;
mod test_scene;
mod tree;
mod tunnel;
mod two_rooms;

pub use arena::arena;
pub use atrium::{atrium, atrium_camera_path};
pub use cornell::cornell;
pub use door::door;
pub use falling::falling;
pub use furnace::furnace;
pub use knot_glass::knot_glass;
pub use room::room;
pub use terrain::terrain;
pub use test_scene::test;
pub use tree::tree;
pub use tunnel::tunnel;
pub use two_rooms::two_rooms;

use crate::{Scene, SceneError};

/// The scenes that `builtin:NAME` knows.
pub const NAMES: &[&str] = &[
    "arena",
    "atrium",
    "cornell",
    "door",
    "falling",
    "furnace",
    "knot_glass",
    "room",
    "terrain",
    "test",
    "tree",
    "tunnel",
    "two_rooms",
];

/// The finest detail level; larger numbers mean the same.
pub const MAX_DETAIL: u32 = 4;

/// The detail level of `builtin:NAME`.
pub const DEFAULT_DETAIL: u32 = 2;

/// The scene of `NAME` or `NAME:DETAIL`.
///
/// # Errors
/// If the name or the detail level is unknown.
pub fn by_name(name: &str) -> Result<Scene, SceneError> {
    let (name, detail) = match name.split_once(':') {
        Some((name, given)) => (name, Some(given)),
        None => (name, None),
    };
    let make = match name {
        "arena" => arena,
        "atrium" => atrium,
        "cornell" => cornell,
        "door" => door,
        "falling" => falling,
        "furnace" => furnace,
        "knot_glass" => knot_glass,
        "room" => room,
        "terrain" => terrain,
        "test" => test,
        "tree" => tree,
        "tunnel" => tunnel,
        "two_rooms" => two_rooms::by_name,
        _ => return Err(SceneError::UnknownBuiltin { name: name.to_owned() }),
    };
    match detail {
        None => Ok(make(DEFAULT_DETAIL)),
        Some(given) => match given.parse() {
            Ok(detail) if detail <= MAX_DETAIL => Ok(make(detail)),
            _ => Err(SceneError::BadDetail { name: name.to_owned(), given: given.to_owned() }),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn every_name_makes_a_sound_scene_that_grows_with_detail() {
        for name in NAMES {
            let mut last = 0;
            for detail in 0..=MAX_DETAIL {
                let scene = by_name(&format!("{name}:{detail}")).unwrap();
                let count = scene.triangle_count();
                assert!(count > last, "{name}:{detail} has {count} triangles, one level down {last}");
                last = count;
                // Coarse cloth has folds of two faces, whose shared normals fit neither well.
                check_sound(name, &scene, if detail < 2 { -0.3 } else { 0.0 });
            }
            assert_eq!(
                by_name(name).unwrap().triangle_count(),
                by_name(&format!("{name}:2")).unwrap().triangle_count()
            );
        }
    }

    fn check_sound(name: &str, scene: &Scene, steepest: f32) {
        assert!(!scene.cameras.is_empty(), "{name}");
        assert_eq!(scene.report, crate::ImportReport::default());
        for mesh in &scene.meshes {
            let count = mesh.positions.len();
            assert_eq!([mesh.normals.len(), mesh.uvs.len(), mesh.colors.len()], [count; 3]);
            assert!(mesh.positions.iter().flatten().all(|v| v.is_finite()), "{name} {}", mesh.name);
            assert!(mesh.normals.iter().all(|&n| Vec3::from(n).is_normalized()), "{name} {}", mesh.name);
            assert!(mesh.indices.iter().flatten().all(|&i| (i as usize) < count));
            assert!(mesh.material < scene.materials.len());
            for t in &mesh.indices {
                let [a, b, c] = t.map(|i| Vec3::from(mesh.positions[i as usize]));
                // Renderers turn the normal to the side they see, and know the side from the winding.
                let face = (b - a).cross(c - a).normalize_or_zero();
                let least =
                    t.map(|i| face.dot(mesh.normals[i as usize].into())).into_iter().fold(1.0, f32::min);
                assert!(face == Vec3::ZERO || least > steepest, "{name} {}: {least} at {a}", mesh.name);
            }
        }
        for m in &scene.materials {
            assert!(m.base_color.min_element() >= 0.0 && m.base_color.max_element() <= 1.0);
        }
        for c in &scene.cameras {
            assert!((c.target - c.eye).cross(c.up).length() > 1e-3, "{name}: camera looks along its up");
            assert!(scene.bounds().size().max_element() > 1.0);
        }
    }

    #[test]
    fn cameras_keep_clear_of_surfaces_and_albedos_are_plausible() {
        for name in NAMES {
            let scene = by_name(&format!("{name}:0")).unwrap();
            let triangles = checks::world_triangles(&scene, |_| true);
            for camera in &scene.cameras {
                for way in checks::directions(200) {
                    let free = checks::hit(&triangles, camera.eye, way);
                    assert!(free.is_none_or(|d| d > 0.19), "{name}, {}: {free:?} along {way}", camera.name);
                }
            }
            assert!(scene.meshes.iter().all(|m| !m.name.is_empty()), "{name}");
            for m in &scene.materials {
                assert!(!m.name.is_empty(), "{name}");
                // The one that is meant for glass is clear, textures carry their own colour; the atrium's cloths are deeper.
                let known = ["glass", "leaves"].contains(&m.name.as_str()) || *name == "atrium";
                let albedo = m.base_color.truncate();
                assert!(
                    known || albedo.min_element() >= 0.05 && albedo.max_element() <= 0.9,
                    "{name}, {}",
                    m.name
                );
            }
        }
    }

    #[test]
    fn wrong_names_and_details_say_what_is_known() {
        let text = by_name("palace").unwrap_err().to_string();
        assert_eq!(
            text,
            "there is no built-in scene 'palace'; known are arena, atrium, cornell, door, falling, furnace, \
             knot_glass, room, terrain, test, tree, tunnel, two_rooms"
        );
        for bad in ["cornell:5", "cornell:-1", "cornell:", "cornell:two", "cornell:1:1"] {
            assert!(by_name(bad).unwrap_err().to_string().contains("from 0 to 4"), "{bad}");
        }
    }
}
