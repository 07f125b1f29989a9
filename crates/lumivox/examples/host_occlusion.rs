//! Ambient occlusion and soft shadows in a host: what it has to do to darken its ambient light under rigid objects that move.
//!
//! A field is baked here from a cube; a real host loads it by `Field::load("cube.lvf")`. The host's own G-buffer is stood in for by textures
//! cleared to nothing. `cargo run -p lumivox --example host_occlusion` records three frames.

use std::ops::ControlFlow;

use lumivox::core::{TriangleView, View};
use lumivox::glam::{Mat4, UVec2, Vec3};
use lumivox::gpu::{AdapterChoice, Gpu, GpuError, Texture, Tier, Uniform};
use lumivox::progressive::InjectionScale;
use lumivox::visibility::{
    Fields, Objects, Occlusion, OcclusionSettings, Placement, Receiver, ShadowLight, ShadowSettings,
    SoftShadows,
};
use lumivox::wgpu::{CommandEncoder, TextureFormat};
use lumivox::wgsl::ViewUniform;
use lumivox_field::{Baker, Mesh, Settings};

const SIZE: UVec2 = UVec2::new(320, 180);

/// What lives as long as the scene.
struct Shading {
    fields: Fields,
    objects: Objects,
    occlusion: Occlusion,
    shadows: SoftShadows,
}

impl Shading {
    fn new(gpu: &Gpu) -> Result<Self, Box<dyn std::error::Error>> {
        let field = Baker::new(cube(), Settings { points: 1090, directions: 32, ..Settings::default() })?
            .bake(|_| ControlFlow::Continue(()))?;
        let packed = field.packed().ok_or("the field fits no texture")?;
        let fields = Fields::new(gpu, &[&packed])?;
        let objects = Objects::new(gpu, 64)?;
        let occlusion = Occlusion::new(gpu, SIZE, &objects, OcclusionSettings::default())?;
        let shadows = SoftShadows::new(gpu, SIZE, &objects, 1, ShadowSettings::default())?;
        Ok(Self { fields, objects, occlusion, shadows })
    }

    /// What a frame writes before it is recorded.
    fn update(&mut self, gpu: &Gpu, seconds: f32) -> Result<(), GpuError> {
        // Sixty-four cubes that fall and turn, one field for all.
        let cubes: Vec<_> = (0..64u32)
            .map(|n| {
                let corner = Vec3::new((n % 8) as f32, 8.0 - seconds, (n / 8) as f32);
                let turned = Mat4::from_rotation_y(seconds + n as f32);
                Placement::new(0, Mat4::from_translation(2.5 * corner) * turned, n)
            })
            .collect();
        self.objects.update(gpu, &self.fields, &cubes)?;
        self.occlusion.update(gpu, &self.objects);
        let lamp = ShadowLight::Ball { position: Vec3::new(9.0, 30.0, 9.0), radius: 1.0 };
        self.shadows.update(gpu, &self.objects, &[lamp]);
        Ok(())
    }

    /// After the host has recorded its G-buffer.
    fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        receiver: &Receiver<'_>,
    ) -> Result<(), GpuError> {
        self.occlusion.record(gpu, encoder, &self.fields, &self.objects, receiver)?;
        self.shadows.record(gpu, encoder, &self.fields, &self.objects, receiver)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A host gives its own device: `Gpu::from_device(device, queue, Tier::Core)`.
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let mut shading = Shading::new(&gpu)?;
    let depth = Texture::target(&gpu, "depth", SIZE.to_array(), TextureFormat::Depth32Float)?;
    let normal = Texture::target(&gpu, "normal", SIZE.to_array(), TextureFormat::Rgba16Float)?;
    let uniform = Uniform::new(&gpu, "view", &lumivox::bytemuck::Zeroable::zeroed());
    for frame in 0..3 {
        let eye = Vec3::new(30.0, 20.0, 30.0);
        let view = View::perspective(eye, Vec3::splat(9.0), Vec3::Y, 1.0, 320.0 / 180.0, 0.1, 100.0);
        let nothing = InjectionScale { attribute_points: 1, light_points: 1, radiance_max: 1.0 };
        uniform.write(&gpu, &ViewUniform::new(&view, SIZE, UVec2::ONE, nothing));
        shading.update(&gpu, 0.1 * frame as f32)?;

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        // Here the host draws its G-buffer ...
        let receiver = Receiver { depth: &depth, normal: &normal, uniform: &uniform };
        shading.record(&gpu, &mut encoder, &receiver)?;
        // ... and here it multiplies its ambient light by `shading.occlusion.factor()` and its lamp's by
        // `shading.shadows.factor(0)`.
        gpu.queue.submit([encoder.finish()]);
    }
    gpu.wait()?;
    Ok(())
}

/// A cube of 2 m.
fn cube() -> Mesh<'static> {
    const POSITIONS: [[f32; 3]; 8] = [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [1.0, -1.0, 1.0],
        [-1.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    const INDICES: [[u32; 3]; 12] = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    Mesh::new(TriangleView { positions: &POSITIONS, indices: &INDICES })
}
