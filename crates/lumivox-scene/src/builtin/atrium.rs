//! stub
use crate::{Camera, Scene};
use glam::Vec3;
/// stub
pub fn atrium(detail: u32) -> Scene {
    let mut s = super::cornell(detail);
    s.cameras.push(atrium_camera_path(0.0));
    s
}
/// stub
pub fn atrium_camera_path(t: f32) -> Camera {
    Camera::look("walk", Vec3::new(-9.0 + 10.0 * t, 1.7, -4.5), Vec3::new(9.0, 2.0, -4.0), 60.0)
}
