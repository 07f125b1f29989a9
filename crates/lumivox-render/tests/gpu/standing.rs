//! What stands still from triangles, and what moves from views.

use glam::{UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Scene, builtin};

use crate::Check;
use crate::moving::sliding_block;
use crate::scenes::{occupied, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("what stands still is there before a view has seen it, and stays", stays),
    ("what stands still lights as triangles do", lights),
    ("what begins to move stands still no more", begins_to_move),
];

/// A camera that sees nothing.
fn upwards() -> Camera {
    Camera::look("up", Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 9.0, 0.1), 50.0)
}

fn settings(voxels: VoxelSource) -> Settings {
    Settings { voxels, gi: GiMethod::Propagation, clip: Some(0), ..small() }
}

fn stays(gpu: &Gpu) -> Result<(), Failed> {
    let scene = sliding_block();
    let dark = Scene { lights: Vec::new(), ..scene };
    let mut renderer = Renderer::new(gpu, &dark, settings(VoxelSource::Hybrid))?;
    renderer.set_camera(&upwards());
    renderer.frame(None)?;
    let first = occupied(gpu, &renderer)?;
    let grid = *renderer.volume().grid();
    let level: Vec<bool> = grid.cells().map(|c| grid.center(c).y.abs() < 0.75 * grid.cell_size).collect();
    let count = first.iter().filter(|o| **o).count();
    // The block moves, and no view sees it.
    assert!(count > 200 && first.iter().zip(&level).all(|(o, level)| !o || *level), "{count} cells");
    for seconds in [0.2, 0.6] {
        renderer.set_pose(&dark.pose(0, seconds));
        renderer.frame(None)?;
        assert!(occupied(gpu, &renderer)? == first, "nothing is seen, and the volume changes");
    }
    // Seen from above, the block comes and the floor stays.
    renderer.set_camera(&Camera::look("above", Vec3::new(0.0, 9.0, 0.2), Vec3::ZERO, 50.0));
    renderer.frame(None)?;
    let seen = occupied(gpu, &renderer)?;
    assert!(first.iter().zip(&seen).all(|(first, seen)| *seen || !first), "a view has cleared the floor");
    assert!(seen.iter().filter(|o| **o).count() > count + 4, "the block is not seen");
    Ok(())
}

/// In the Cornell box after one frame, gathered light of what a camera has not seen.
fn lights(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    let mut pictures = Vec::new();
    for voxels in [VoxelSource::Triangles, VoxelSource::Hybrid, VoxelSource::Progressive] {
        let settings = Settings {
            size: UVec2::new(64, 64),
            gi: GiMethod::Gather,
            layer: Layer::Indirect,
            voxels,
            clip: None,
            ..small()
        };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        renderer.set_camera(&scene.cameras[0]);
        renderer.frame(None)?;
        pictures.push(renderer.read_picture()?);
    }
    let mean = pictures[0].iter().map(|p| p.element_sum()).sum::<f32>();
    let [hybrid, views] = [1, 2].map(|n| {
        let off = pictures[0].iter().zip(&pictures[n]).map(|(a, b)| (*a - *b).abs().element_sum());
        off.sum::<f32>() / mean
    });
    eprintln!("beside triangles: hybrid {hybrid:.3}, views alone {views:.3}");
    assert!(mean > 0.0 && hybrid < 0.5 * views && hybrid < 0.1, "hybrid {hybrid}, views alone {views}");
    Ok(())
}

/// Without a clip nobody knows that the block will move: its cells are taken out when it does, and views clear them.
fn begins_to_move(gpu: &Gpu) -> Result<(), Failed> {
    let scene = sliding_block();
    let mut renderer = Renderer::new(gpu, &scene, Settings { clip: None, ..settings(VoxelSource::Hybrid) })?;
    renderer.set_camera(&Camera::look("above", Vec3::new(0.0, 9.0, 0.2), Vec3::ZERO, 50.0));
    let grid = *renderer.volume().grid();
    let cells_at = |renderer: &Renderer, x: f32| -> Result<usize, Failed> {
        let cells = occupied(gpu, renderer)?;
        let near = |c: Vec3| (c.x - x).abs() < 0.6 && c.z.abs() < 0.6 && c.y > 0.5 && c.y < 1.3;
        Ok(grid.cells().filter(|c| near(grid.center(*c)) && cells[grid.index(*c)]).count())
    };
    renderer.frame(None)?;
    assert!(cells_at(&renderer, 0.0)? > 4, "the block is not there");
    renderer.set_pose(&scene.pose(0, 1.0));
    for _ in 0..2 {
        renderer.frame(None)?;
    }
    assert_eq!(cells_at(&renderer, 0.0)?, 0, "the block has left its cells behind");
    assert!(cells_at(&renderer, 1.5)? > 4, "the block is not where it went");
    Ok(())
}
