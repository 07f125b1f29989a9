//! The furnace: a closed box that glows and reflects alike everywhere, whose light is known in closed form; how near gathered light
//! comes, and in how many frames.

use anyhow::Result;
use glam::{UVec2, Vec3, Vec4};
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::builtin;

use crate::bench::report::{Report, Row};

/// Reflectances of the walls.
const ALBEDOS: [f32; 5] = [0.2, 0.5, 0.8, 0.9, 0.95];
/// A frame that changes a pixel by less than this part is the last.
const SETTLED: f32 = 1e-4;
const MAX_FRAMES: u32 = 400;

pub(super) fn run(gpu: &Gpu, report: &mut Report) -> Result<()> {
    report.head("The furnace");
    let settings = Settings {
        size: UVec2::splat(64),
        grid: 32,
        gi: GiMethod::Gather,
        voxels: VoxelSource::Triangles,
        layer: Layer::Final,
        ..Settings::default()
    };
    report.say(&format!(
        "A closed box, 32 cells, {} bounces a frame from the dark: its radiance over `emission / (1 - albedo)`, pixel by pixel, and the frames \
         until no pixel changes by more than {SETTLED} of it.",
        settings.bounces,
    ));
    let mut lines = Vec::new();
    for albedo in ALBEDOS {
        let mut scene = builtin::furnace(0);
        for material in &mut scene.materials {
            material.base_color = Vec4::new(albedo, albedo, albedo, 1.0);
        }
        let expected = scene.materials[0].emission / (1.0 - albedo);
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        renderer.set_camera(&scene.cameras[0]);
        let mut before = vec![Vec3::ZERO; settings.size.element_product() as usize];
        let mut frames = 0;
        while frames < MAX_FRAMES {
            renderer.frame(None)?;
            frames += 1;
            let now = renderer.read_picture()?;
            let change =
                now.iter().zip(&before).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
            before = now;
            if change < SETTLED * expected.x {
                break;
            }
        }
        let ratios = || before.iter().map(|p| p.x / expected.x);
        let mean = ratios().map(f64::from).sum::<f64>() / before.len() as f64;
        let (least, most) = (ratios().fold(f32::INFINITY, f32::min), ratios().fold(0.0, f32::max));
        for (metric, value) in [("mean of the closed form", mean), ("frames", f64::from(frames))] {
            report.push(Row {
                figure: "Furnace",
                case: format!("albedo {albedo}"),
                metric: metric.to_owned(),
                value,
                unit: "",
                paper: None,
                note: String::new(),
            });
        }
        let numbers = [mean, f64::from(least), f64::from(most)].map(|r| format!("{r:.4}"));
        lines.push([albedo.to_string()].into_iter().chain(numbers).chain([frames.to_string()]).collect());
    }
    report.table(&["albedo", "mean", "least", "most", "frames"].map(str::to_owned), &lines);
    Ok(())
}
