//! Shadows of leaves in a host: a slicemap of what is thin, in the light's view, beside the shadow map that the host has of what is
//! opaque.
//!
//! The host's own G-buffer is that of a floor. `cargo run -p lumivox --example host_leaf_shadows` records three frames, and says how many
//! cells are filled and what is left of the sun on the floor.

mod floor;

use half::f16;
use lumivox::core::View;
use lumivox::glam::{Mat4, UVec2, Vec2, Vec3};
use lumivox::gpu::{AdapterChoice, Gpu, GpuError, Texture, Tier, read_texture};
use lumivox::light::IRRADIANCE_FORMAT;
use lumivox::progressive::{InjectionScale, ViewInput, ViewTextures};
use lumivox::slicemap::{Slicemap, SlicemapSettings, Transmittance, TransmittanceSettings};
use lumivox::voxelize::{Mesh, MeshDescriptor, VertexView};
use lumivox::wgpu::{BufferDescriptor, BufferUsages, CommandEncoder, TextureFormat, VertexFormat};

use floor::{Floor, uploaded};

const SIZE: UVec2 = UVec2::new(320, 180);

/// What lives as long as the light.
struct LeafShadows {
    /// Leaves of two colours, each a kind of bits.
    map: Slicemap,
    pass: Transmittance,
    /// What is left of the light at each pixel.
    left: Texture,
}

impl LeafShadows {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let settings = SlicemapSettings { kinds: 2, ..SlicemapSettings::default() };
        Ok(Self {
            map: Slicemap::new(gpu, settings)?,
            pass: Transmittance::new(gpu, false)?,
            left: Texture::target(gpu, "left", SIZE.to_array(), IRRADIANCE_FORMAT)?,
        })
    }

    /// What a frame writes before it is recorded.
    fn update(&self, gpu: &Gpu, sigma: f32) {
        let (sun, reach) = (Vec3::new(0.3, -1.0, 0.2).normalize_or_zero(), 20.0);
        let view = View::orthographic_along(-0.5 * reach * sun, sun, Vec3::X, Vec2::splat(8.0), reach);
        self.map.set_view(gpu, &view, [0.0, reach]);
        let mut through = [Vec3::ONE; 4];
        through[0] = (1.0 - sigma) * Vec3::new(0.4, 1.0, 0.3);
        through[1] = (1.0 - sigma) * Vec3::new(1.0, 0.5, 0.2);
        self.pass.update(gpu, &TransmittanceSettings { through, bias: 0.02, ..Default::default() });
    }

    /// After the host has recorded its G-buffer.
    fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        leaves: [&Mesh; 2],
        camera: &ViewInput,
    ) -> Result<(), GpuError> {
        self.map.record(gpu, encoder, &[(leaves[0], 0), (leaves[1], 1)])?;
        self.pass.record(gpu, encoder, &self.map, camera, &mut self.left, false)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A host gives its own device: `Gpu::from_device(device, queue, Tier::Core)`.
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let mut shadows = LeafShadows::new(&gpu)?;
    let (green, brown) = (leaves(&gpu, 1.0)?, leaves(&gpu, 2.0)?);
    let target = |name, format| Texture::target(&gpu, name, SIZE.to_array(), format);
    let view = View::perspective(Vec3::new(6.0, 3.0, 6.0), Vec3::Y, Vec3::Y, 1.0, 320.0 / 180.0, 0.1, 50.0);
    let Floor { depth, is_floor } = Floor::new(&gpu, &view, SIZE)?;
    let up = [0.0, 1.0, 0.0, 0.0].map(f16::from_f32).repeat(is_floor.len());
    let textures = ViewTextures {
        depth,
        normal: uploaded(&gpu, SIZE, TextureFormat::Rgba16Float, lumivox::bytemuck::cast_slice(&up))?,
        albedo: target("albedo", TextureFormat::Rgba16Float)?,
        emission: target("emission", TextureFormat::Rgba16Float)?,
        radiance: target("radiance", TextureFormat::Rgba16Float)?,
    };
    let camera = ViewInput::new(&gpu, "camera", textures, SIZE);
    for frame in 0..3 {
        let scale = InjectionScale { attribute_points: 1, light_points: 1, radiance_max: 1.0 };
        camera.update(&gpu, &view, scale);
        // How much a leaf takes may change in every frame.
        shadows.update(&gpu, 0.2 + 0.1 * frame as f32);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        // Here the host draws its G-buffer and its shadow map without leaves ...
        shadows.record(&gpu, &mut encoder, [&green, &brown], &camera)?;
        // ... and here it multiplies the light by the shadow map's answer and by `shadows.left`.
        gpu.queue.submit([encoder.finish()]);
    }
    gpu.wait()?;
    let filled: u32 = shadows.map.read(&gpu)?.into_iter().map(u32::count_ones).sum();
    let left: Vec<[f16; 4]> = read_texture(&gpu, &shadows.left)?;
    let of_floor = left.iter().zip(&is_floor).filter(|(_, is_floor)| **is_floor).map(|(l, _)| l[1].to_f32());
    let least = of_floor.fold(1.0, f32::min);
    eprintln!(
        "{filled} cells of leaves; at least {:.0} % of the sun's green is left on the floor",
        100.0 * least
    );
    Ok(())
}

/// Two hundred leaves in a ball, each a triangle in a buffer that the host has anyway.
fn leaves(gpu: &Gpu, turn: f32) -> Result<Mesh, Box<dyn std::error::Error>> {
    let corners = [Vec3::new(-0.1, 0.0, -0.1), Vec3::new(0.1, 0.0, -0.1), Vec3::new(0.0, 0.0, 0.15)];
    let positions: Vec<[f32; 3]> = (0..200)
        .flat_map(|n| {
            let n = n as f32;
            let up = 1.0 - n / 100.0;
            let place =
                Vec3::new((2.4 * n).cos(), 0.0, (2.4 * n).sin()) * (1.0 - up * up).sqrt() + up * Vec3::Y;
            let turned =
                Mat4::from_translation(turn * place + 2.0 * Vec3::Y) * Mat4::from_rotation_z(n * turn);
            corners.map(|c| turned.transform_point3(c).to_array())
        })
        .collect();
    let bytes: &[u8] = lumivox::bytemuck::cast_slice(&positions);
    let buffer = gpu.device.create_buffer(&BufferDescriptor {
        label: Some("leaves"),
        size: bytes.len() as u64,
        usage: BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytes);
    let view = VertexView { buffer: &buffer, offset: 0, stride: 12, format: VertexFormat::Float32x3 };
    Ok(Mesh::new(gpu, &MeshDescriptor::new(view, positions.len() as u32))?)
}
