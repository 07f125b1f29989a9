//! What cannot be rendered is refused in words, and the device goes on.

use glam::Vec3;
use libtest_mimic::Failed;
use lumivox::gpu::{Gpu, GpuError};
use lumivox_render::{Renderer, RendererError, Settings};
use lumivox_scene::{Material, Mesh, Scene, builtin};

use crate::Check;
use crate::scenes::{Quad, add, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("a scene without triangles is refused", empty_scenes),
    ("grids that are too coarse or too fine are refused", bad_grids),
    ("a grid that does not fit the core tier is refused with the one that would", too_large),
];

fn refusal(gpu: &Gpu, scene: &Scene, grid: u32) -> RendererError {
    let refused = Renderer::new(gpu, scene, Settings { grid, ..small() });
    let error = refused.expect_err(&format!("a grid of {grid}"));
    gpu.check().expect("a refusal is no failure of the device");
    error
}

fn empty_scenes(gpu: &Gpu) -> Result<(), Failed> {
    let mut without_instance = Scene::default();
    add(&mut without_instance, Material::default(), &[Quad::level(Vec3::ZERO, 1.0)]);
    without_instance.instances.clear();
    let mut without_triangle = Scene::default();
    add(&mut without_triangle, Material::default(), &[Quad::level(Vec3::ZERO, 1.0)]);
    without_triangle.meshes[0] = Mesh::default();
    for scene in [Scene::default(), without_instance, without_triangle] {
        let error = refusal(gpu, &scene, 16);
        assert!(matches!(error, RendererError::EmptyScene), "{error}");
        assert_eq!(error.to_string(), "the scene has no triangles to render");
    }
    Ok(())
}

fn bad_grids(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    for grid in [0, 1, 2, 4000, u32::MAX] {
        let error = refusal(gpu, &scene, grid);
        assert!(matches!(error, RendererError::Grid(_)), "{grid}: {error}");
        assert!(error.to_string().contains("cells along its longest axis"), "{grid}: {error}");
    }
    Ok(())
}

fn too_large(gpu: &Gpu) -> Result<(), Failed> {
    let error = refusal(gpu, &builtin::cornell(0), 200);
    let RendererError::Gpu(GpuError::TooLarge { needed, limit, hint, .. }) = &error else {
        return Err(format!("unexpected: {error}").into());
    };
    assert!(needed > limit);
    assert!(hint.contains("200 x 200 x 200") && hint.contains("would fit"), "{error}");
    // The largest that the message names does fit.
    let side = hint.split(" x ").last().and_then(|end| end.split(' ').next()).unwrap_or_default();
    let side: u32 = side.parse()?;
    assert!((100..200).contains(&side), "{error}");
    refusal(gpu, &builtin::cornell(0), side + 1);
    Renderer::new(gpu, &builtin::cornell(0), Settings { grid: side, ..small() })?;
    Ok(())
}
