//! Lumivox in a host: everything a renderer has to do to get indirect light, on this crate alone.
//!
//! The host's own pictures are stood in for by textures cleared to nothing, so the light that comes out is black; what
//! counts is the order of the calls. `cargo run -p lumivox --example host_frame` records three frames.

use lumivox::VolumeBuffer;
use lumivox::core::{Bounds, Grid, View};
use lumivox::glam::{UVec2, Vec2, Vec3};
use lumivox::gpu::{AdapterChoice, Gpu, Texture, Tier};
use lumivox::light::{IRRADIANCE_FORMAT, IndirectLight, LightSettings};
use lumivox::progressive::{CHANNELS, DirectLight, InjectionScale, Progressive, ViewInput, ViewTextures};
use lumivox::wgpu::{CommandEncoder, TextureFormat};

/// What lives as long as the scene.
struct Lighting {
    volume: VolumeBuffer,
    progressive: Progressive,
    direct: DirectLight,
    indirect: IndirectLight,
    irradiance: Texture,
}

impl Lighting {
    fn new(gpu: &Gpu, scene_bounds: &Bounds, picture: [u32; 2]) -> Result<Self, Box<dyn std::error::Error>> {
        let grid = Grid::fit_with_margin(scene_bounds, 32)?;
        let volume = VolumeBuffer::new(gpu, grid, &CHANNELS)?;
        let progressive = Progressive::new(gpu, &volume)?;
        let direct = Progressive::direct_light(gpu, &volume)?;
        let indirect = IndirectLight::new(gpu, &volume)?;
        indirect.update(gpu, &LightSettings::default());
        let irradiance = Texture::target(gpu, "irradiance", picture, IRRADIANCE_FORMAT)?;
        Ok(Self { volume, progressive, direct, indirect, irradiance })
    }

    /// Everything of one frame, after the host has recorded its G-buffer and its shadow map.
    fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        camera: &ViewInput,
        sun: &ViewInput,
    ) -> Result<(), lumivox::gpu::GpuError> {
        let Self { volume, progressive, direct, indirect, irradiance } = self;
        // Views to volume.
        progressive.record_cleanup(gpu, encoder, sun, volume)?;
        progressive.record_cleanup(gpu, encoder, camera, volume)?;
        progressive.record_begin(encoder, direct);
        progressive.record_light(gpu, encoder, [sun], volume, direct)?;
        progressive.record_camera(gpu, encoder, camera, volume, direct)?;
        progressive.record_end(gpu, encoder, camera, volume, direct)?;
        // Volume to light.
        indirect.record_transport(gpu, encoder, volume)?;
        indirect.record_seed(gpu, encoder, volume, direct)?;
        indirect.record_propagation(gpu, encoder, volume, 32)?;
        indirect.record_reconstruction(gpu, encoder, volume, camera, irradiance)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A host gives its own device: `Gpu::from_device(device, queue, Tier::Core)`.
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let bounds = Bounds::new(Vec3::ZERO, Vec3::new(8.0, 4.0, 6.0));
    let mut lighting = Lighting::new(&gpu, &bounds, [320, 180])?;
    let camera = ViewInput::new(&gpu, "camera", pictures(&gpu, [320, 180])?, UVec2::splat(256));
    let sun = ViewInput::new(&gpu, "sun", pictures(&gpu, [512, 512])?, UVec2::splat(256));
    let scale = InjectionScale {
        attribute_points: camera.point_count() + sun.point_count(),
        light_points: camera.point_count().max(sun.point_count()),
        radiance_max: 10.0,
    };
    for frame in 0..3 {
        let eye = Vec3::new(1.0 + frame as f32, 2.0, 5.0);
        let camera_view = View::perspective(eye, bounds.center(), Vec3::Y, 1.0, 320.0 / 180.0, 0.05, 20.0);
        let above = bounds.center() + 10.0 * Vec3::Y;
        let sun_view = View::orthographic(above, bounds.center(), Vec3::Z, Vec2::splat(10.0), 20.0);
        camera.update(&gpu, &camera_view, scale);
        sun.update(&gpu, &sun_view, scale);

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        // Here the host draws its G-buffer and its shadow map ...
        lighting.record(&gpu, &mut encoder, &camera, &sun)?;
        // ... and here it adds albedo / pi * lighting.irradiance to its picture.
        gpu.queue.submit([encoder.finish()]);
    }
    gpu.wait()?;
    Ok(())
}

/// The five pictures of a view, as the host would own them.
fn pictures(gpu: &Gpu, size: [u32; 2]) -> Result<ViewTextures, lumivox::gpu::GpuError> {
    let target = |name: &str, format| Texture::target(gpu, name, size, format);
    Ok(ViewTextures {
        depth: target("depth", TextureFormat::Depth32Float)?,
        normal: target("normal", TextureFormat::Rgba16Float)?,
        albedo: target("albedo", TextureFormat::Rgba8UnormSrgb)?,
        emission: target("emission", TextureFormat::Rgba16Float)?,
        radiance: target("radiance", TextureFormat::Rgba16Float)?,
    })
}
