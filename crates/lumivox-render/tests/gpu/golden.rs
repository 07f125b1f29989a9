//! A few small pictures as they once were, opened and found right. `LUMIVOX_BLESS=1` writes them anew.

use std::path::PathBuf;

use glam::UVec2;
use image::RgbImage;
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Renderer, Settings, VoxelSource, tone};
use lumivox_scene::{Scene, builtin};

use crate::Check;
use crate::scenes::{settle, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("golden: the box, gathered", |gpu| holds(gpu, "box_gathered", &builtin::cornell(1), GiMethod::Gather)),
    ("golden: the box, propagated", |gpu| {
        holds(gpu, "box_propagated", &builtin::cornell(1), GiMethod::Propagation)
    }),
    ("golden: the test scene, gathered", |gpu| {
        holds(gpu, "test_gathered", &builtin::test(1), GiMethod::Gather)
    }),
];

/// Mean difference of channels, of 255: rounding differs between devices, and pixels on edges may show the other side.
const MEAN: f64 = 1.0;
/// Share of the pixels that may differ by more than `LARGE`.
const OUTLIERS: f64 = 0.01;
const LARGE: u8 = 12;

fn holds(gpu: &Gpu, name: &str, scene: &Scene, gi: GiMethod) -> Result<(), Failed> {
    let size = UVec2::new(96, 72);
    let settings = Settings { size, gi, grid: 32, voxels: VoxelSource::Triangles, ..small() };
    let mut renderer = Renderer::new(gpu, scene, settings)?;
    renderer.set_camera(&scene.cameras[0]);
    settle(&mut renderer)?;
    let bytes = renderer.read_picture()?.iter().flat_map(|p| tone::tone_mapped(*p, 0.0)).collect();
    let ours = RgbImage::from_raw(size.x, size.y, bytes).ok_or("a picture of another size")?;
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"));
    if std::env::var("LUMIVOX_BLESS").is_ok_and(|v| v == "1") {
        return Ok(ours.save(&path)?);
    }
    let golden = image::open(&path)?.into_rgb8();
    assert_eq!(ours.dimensions(), golden.dimensions());
    let pairs = ours.pixels().zip(golden.pixels());
    let differences: Vec<[u8; 3]> = pairs.map(|(a, b)| [0, 1, 2].map(|c| a[c].abs_diff(b[c]))).collect();
    let sum: f64 = differences.iter().flatten().map(|d| f64::from(*d)).sum();
    let mean = sum / (3 * differences.len()) as f64;
    let large = differences.iter().filter(|d| d.iter().any(|d| *d > LARGE)).count() as f64;
    let share = large / differences.len() as f64;
    assert!(
        mean <= MEAN && share <= OUTLIERS,
        "{name}: {mean:.2} of 255 on average, {share:.4} of the pixels differ"
    );
    Ok(())
}
