//! Cameras where none should be.

use glam::{UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, builtin};

use super::{Faults, tiny};
use crate::Check;

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("odd cameras: inside walls, on them, along them, far away, without direction", odd_cameras),
    ("odd cameras: a face seen along its plane puts nothing before the eye", edge_on),
];

/// The eye lies in the plane of the door frame's inner face. At this size a corner's rounding makes a pixel of it, which had the depth of
/// 0.66 m; the nearest thing is 1.75 m away.
fn edge_on(gpu: &Gpu) -> Result<(), Failed> {
    let size = UVec2::new(240, 135);
    let scene = builtin::door(builtin::DEFAULT_DETAIL);
    let settings =
        Settings { size, layer: Layer::Depth, gi: GiMethod::Off, ..tiny(VoxelSource::Progressive) };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(scene.cameras.first().ok_or("a camera")?);
    renderer.frame(None)?;
    let picture = renderer.read_picture()?;
    let nearest = picture.iter().map(|p| p.x).fold(f32::INFINITY, f32::min);
    if nearest < 1.7 {
        return Err(format!("something is {nearest} m before the eye").into());
    }
    Ok(())
}

fn odd_cameras(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    let (middle, x, y, z) = (Vec3::Y, Vec3::X, Vec3::Y, Vec3::Z);
    let in_block = Vec3::new(0.33, 0.3, 0.3);
    let mut faults = Faults::default();
    for voxels in [VoxelSource::Progressive, VoxelSource::SinglePass, VoxelSource::Triangles] {
        let mut renderer = Renderer::new(gpu, &scene, tiny(voxels))?;
        for (what, eye, target, degrees) in [
            ("inside a solid block", in_block, middle, 60.0),
            ("exactly on a wall, looking in", -x + y, middle, 60.0),
            ("exactly on a wall, looking out", -x + y, -2.0 * x + y, 60.0),
            ("exactly on a wall, looking along", -x + y, -x + y + z, 60.0),
            ("exactly in a corner", -x - z, middle, 90.0),
            ("exactly in a corner, along an edge", -x - z, -x - z + y, 90.0),
            ("at a light", 1.96 * y, Vec3::ZERO, 60.0),
            ("straight down", 1.5 * y, Vec3::ZERO, 60.0),
            ("a million metres away", 1e6 * z + y, middle, 60.0),
            ("a million metres away with a narrow view", 1e6 * z + y, middle, 1e-4),
            ("1e15 metres away", 1e15 * z + y, middle, 1.0),
            ("1e30 metres away", 1e30 * z + y, middle, 1.0),
            ("a nanometre before its target", middle, middle + 1e-9 * x, 60.0),
            ("at its own target", middle + 2.0 * z, middle + 2.0 * z, 60.0),
            ("the widest", middle + 3.0 * z, middle, 179.9),
            ("the narrowest", middle + 3.0 * z, middle, 1e-6),
        ] {
            renderer.set_camera(&Camera::look(what, eye, target, degrees));
            faults.look(gpu, &format!("{what}, {voxels:?}"), &mut renderer)?;
        }
        for (what, up) in [("up along the view", -z), ("no up", Vec3::ZERO)] {
            renderer.set_camera(&Camera { up, ..Camera::look(what, middle + 3.0 * z, middle, 60.0) });
            faults.look(gpu, &format!("{what}, {voxels:?}"), &mut renderer)?;
            renderer.show_voxels(&Camera { up, ..Camera::look(what, in_block, middle, 60.0) }, 1.0)?;
        }
    }
    faults.into_result()
}
