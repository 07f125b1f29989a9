//! A scene's slicemap in the columns of a camera, in memory: for looking at and for exports.

use glam::Vec2;
use lumivox::core::{Bounds, Projection, View};
use lumivox::gpu::Gpu;
use lumivox::slicemap::{HostSlicemap, Slicemap, SlicemapSettings};
use lumivox::voxelize::Mesh;
use lumivox_scene::{Camera, Scene};

use crate::gpu_scene::GpuScene;
use crate::renderer::RendererError;

/// All cells that a camera's columns have of a scene, holes of masks left out. A parallel view shows at the camera's target what the
/// perspective one does, and slices what lies before the camera. Waits.
///
/// # Errors
/// An empty scene, and settings that do not fit the device.
pub fn camera_slicemap(
    gpu: &Gpu,
    scene: &Scene,
    (camera, projection): (&Camera, Projection),
    settings: SlicemapSettings,
) -> Result<HostSlicemap, RendererError> {
    let bounds: Bounds = scene.bounds();
    if scene.triangle_count() == 0 || bounds.is_empty() {
        return Err(RendererError::EmptyScene);
    }
    let mut map = Slicemap::new(gpu, settings)?;
    let nothing = Scene::default();
    let (uploaded, textures) = GpuScene::new(gpu, scene, &nothing, false)?;
    let meshes = uploaded.voxel_meshes(gpu, [scene, &nothing], &textures)?;
    let aspect = settings.size.x as f32 / settings.size.y.max(1) as f32;
    let reach = bounds.size().length().max(1e-6);
    let far = 1.01 * bounds.corners().iter().map(|c| c.distance(camera.eye)).fold(reach * 1e-3, f32::max);
    let near = 5e-4 * reach;
    let far = far.max(2.0 * near);
    let Camera { eye, target, up, fov_y, .. } = *camera;
    let view = match projection {
        Projection::Perspective => View::perspective(eye, target, up, fov_y, aspect, near, far),
        Projection::Orthographic => {
            let height = 2.0 * eye.distance(target) * (0.5 * fov_y).tan();
            View::orthographic(eye, target, up, height * Vec2::new(aspect, 1.0), far)
        }
    };
    let along = |c: &glam::Vec3| -view.eye_from_world.transform_point3(*c).z;
    let nearest = bounds.corners().iter().map(along).fold(far, f32::min).max(near);
    let farthest = bounds.corners().iter().map(along).fold(near, f32::max).max(1.001 * nearest);
    let range = [nearest, farthest];
    map.set_view(gpu, &view, range);
    let sliced: Vec<(&Mesh, u32)> = meshes.iter().map(|mesh| (mesh, 0)).collect();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    map.record(gpu, &mut encoder, &sliced)?;
    gpu.queue.submit([encoder.finish()]);
    Ok(map.read_host(gpu, &view, range)?)
}
