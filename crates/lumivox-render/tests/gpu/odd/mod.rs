//! Odd scenes, lights and cameras: whatever they are, every number of every layer is finite, and the device goes on.

mod cameras;
mod energies;
mod lights;
mod shapes;

use glam::{UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, RendererError, Settings, VoxelSource};
use lumivox_scene::{Camera, Light, Scene, builtin};

use crate::Check;
use crate::scenes::small;

pub(crate) const TESTS: &[&[(&str, Check)]] =
    &[cameras::TESTS, energies::TESTS, lights::TESTS, shapes::TESTS];

/// As small as it gets with all stages at work.
fn tiny(voxels: VoxelSource) -> Settings {
    Settings {
        size: UVec2::splat(32),
        grid: 16,
        voxels,
        gi: GiMethod::Propagation,
        iterations: 8,
        shadow_size: 256,
        area_samples: 8,
        area_maps: 8,
        rsm_size: 64,
        points: 64,
        ..small()
    }
}

/// The Cornell box without its own light.
fn dark_box() -> Scene {
    Scene { lights: Vec::new(), ..builtin::cornell(0) }
}

fn box_camera() -> Camera {
    builtin::cornell(0).cameras[0].clone()
}

fn point(position: Vec3, intensity: f32) -> Light {
    Light::Point { position, intensity: Vec3::splat(intensity) }
}

/// What is wrong with the numbers of a scene, in words.
#[derive(Default)]
struct Faults(Vec<String>);

impl Faults {
    fn into_result(self) -> Result<(), Failed> {
        if self.0.is_empty() { Ok(()) } else { Err(self.0.join("\n").into()) }
    }

    /// Renders a scene from nothing, from views and from triangles.
    fn look_at(&mut self, gpu: &Gpu, what: &str, scene: &Scene, camera: &Camera) -> Result<(), Failed> {
        for (voxels, gi) in [
            (VoxelSource::Progressive, GiMethod::Propagation),
            (VoxelSource::Triangles, GiMethod::Propagation),
            (VoxelSource::Progressive, GiMethod::Gather),
            (VoxelSource::Triangles, GiMethod::Gather),
        ] {
            let what = format!("{what}, {voxels:?}, {gi:?}");
            let mut renderer = match Renderer::new(gpu, scene, Settings { gi, ..tiny(voxels) }) {
                Ok(renderer) => renderer,
                Err(error) => {
                    self.0.push(format!("{what}: refused: {error}"));
                    continue;
                }
            };
            renderer.set_camera(camera);
            self.look(gpu, &what, &mut renderer)?;
        }
        Ok(())
    }

    /// Two frames of a renderer, in all layers.
    fn look(&mut self, gpu: &Gpu, what: &str, renderer: &mut Renderer) -> Result<(), Failed> {
        renderer.frame(None)?;
        renderer.frame(None)?;
        self.check(gpu, what, renderer)
    }

    /// All numbers of a renderer as it is.
    fn check(&mut self, gpu: &Gpu, what: &str, renderer: &mut Renderer) -> Result<(), Failed> {
        let mut wrong = |part: &str, count: usize| {
            if count > 0 {
                self.0.push(format!("{what}: {count} numbers of {part} are not finite"));
            }
        };
        for layer in [
            Layer::Final,
            Layer::Direct,
            Layer::Indirect,
            Layer::Albedo,
            Layer::Normal,
            Layer::Depth,
            Layer::Voxels,
            Layer::Lobes,
            Layer::Glossy,
            Layer::Leaks,
        ] {
            renderer.set_layer(layer);
            renderer.settle(0, None)?;
            let pixels = renderer.read_picture()?;
            wrong(&format!("{layer:?}"), pixels.iter().filter(|p| !p.is_finite()).count());
        }
        renderer.set_layer(Layer::Final);
        let volume = renderer.volume().read_back(gpu)?;
        for name in volume.names() {
            let cells = volume.channel(name).unwrap_or_default();
            wrong(name, cells.iter().filter(|c| !c.is_finite()).count());
        }
        let cells = renderer.direct_light().read_back(gpu)?;
        wrong("direct light", cells.iter().flatten().filter(|c| !c.is_finite()).count());
        wrong("the flux", usize::from(!renderer.light_in_volume()?.is_finite()));
        Ok(gpu.check()?)
    }
}

/// The sentence that a scene is refused with.
fn refused(gpu: &Gpu, scene: &Scene) -> RendererError {
    let error = Renderer::new(gpu, scene, tiny(VoxelSource::Progressive)).expect_err("it is not refused");
    gpu.check().expect("a refusal is no failure of the device");
    error
}
