//! Glass in a host: a ball of frosted glass drawn over the host's finished picture of all that is opaque.
//!
//! The host's picture is stood in for by textures cleared to nothing. `cargo run -p lumivox --example host_glass` records three frames,
//! and says how thick the ball is in its middle.

use lumivox::core::{TriangleView, View, open_edges};
use lumivox::glam::{UVec2, Vec3};
use lumivox::gpu::{AdapterChoice, Gpu, GpuError, Texture, Tier, Uniform};
use lumivox::progressive::InjectionScale;
use lumivox::refraction::{Backdrop, Glass, PICTURE_FORMAT, Pyramid, Refraction, RefractionSettings};
use lumivox::voxelize::{IndexView, Mesh, MeshDescriptor, VertexView};
use lumivox::wgpu::{self, BufferUsages, CommandEncoder, IndexFormat, TextureFormat, VertexFormat};
use lumivox::wgsl::ViewUniform;

const SIZE: UVec2 = UVec2::new(320, 180);

/// What lives as long as the scene.
struct GlassBall {
    refraction: Refraction,
    environment: Pyramid,
    ball: Mesh,
    /// The picture with glass in it.
    picture: Texture,
}

impl GlassBall {
    fn new(gpu: &Gpu) -> Result<Self, Box<dyn std::error::Error>> {
        // A sky that is bright above, all around in 16 x 8 pixels.
        let sky: Vec<Vec3> =
            (0..16 * 8).map(|n| Vec3::new(0.5, 0.7, 1.0) * (1.2 - 0.1 * (n / 16) as f32)).collect();
        Ok(Self {
            refraction: Refraction::new(
                gpu,
                RefractionSettings { kinds: 1, ..RefractionSettings::new(SIZE) },
            )?,
            environment: Pyramid::environment(gpu, UVec2::new(16, 8), &sky)?,
            ball: ball(gpu)?,
            picture: Texture::target(gpu, "picture", SIZE.to_array(), PICTURE_FORMAT)?,
        })
    }

    /// What a frame writes before it is recorded: everything may change.
    fn update(&mut self, gpu: &Gpu, view: &View, seconds: f32) {
        self.refraction.set_view(gpu, view, [0.1, 20.0]);
        let glass = Glass { through: Vec3::new(0.6, 0.9, 0.8), frost: 0.1 * seconds, ..Glass::default() };
        self.refraction.set_glass(gpu, &[glass]);
    }

    /// After the host has recorded its picture.
    fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        backdrop: &Backdrop<'_>,
    ) -> Result<(), GpuError> {
        let Self { refraction, environment, ball, picture } = self;
        refraction.record(gpu, encoder, &[(&*ball, 0)], backdrop, environment, picture)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A host gives its own device: `Gpu::from_device(device, queue, Tier::Core)`.
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let mut glass = GlassBall::new(&gpu)?;
    let depth = Texture::target(&gpu, "depth", SIZE.to_array(), TextureFormat::Depth32Float)?;
    let opaque = Texture::target(&gpu, "opaque", SIZE.to_array(), PICTURE_FORMAT)?;
    let uniform = Uniform::new(&gpu, "view", &lumivox::bytemuck::Zeroable::zeroed());
    for frame in 0..3 {
        let eye = Vec3::new(0.5 * frame as f32, 1.0, 5.0);
        let view = View::perspective(eye, Vec3::ZERO, Vec3::Y, 0.8, 320.0 / 180.0, 0.1, 100.0);
        let nothing = InjectionScale { attribute_points: 1, light_points: 1, radiance_max: 1.0 };
        uniform.write(&gpu, &ViewUniform::new(&view, SIZE, UVec2::ONE, nothing));
        glass.update(&gpu, &view, frame as f32);

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        // Here the host draws its picture; this only says that nothing is near.
        clear(&mut encoder, &depth);
        let backdrop = Backdrop { uniform: &uniform, depth: &depth, picture: &opaque };
        glass.record(&gpu, &mut encoder, &backdrop)?;
        // From here on the host shows `glass.picture`.
        gpu.queue.submit([encoder.finish()]);
    }
    let metres = glass.refraction.thickness().read(&gpu)?;
    let middle = metres[(SIZE.x / 2 + SIZE.x * (SIZE.y / 2)) as usize][0];
    eprintln!("the ball is {middle:.2} m thick in its middle");
    Ok(())
}

fn clear(encoder: &mut CommandEncoder, depth: &Texture) {
    let far = wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("opaque"),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth.view,
            depth_ops: Some(far),
            stencil_ops: None,
        }),
        ..Default::default()
    });
}

/// A closed ball of 2 m in buffers that the host has anyway.
fn ball(gpu: &Gpu) -> Result<Mesh, Box<dyn std::error::Error>> {
    const ROWS: u32 = 24;
    const COLUMNS: u32 = 48;
    let point = |row: u32, column: u32| {
        let down = std::f32::consts::PI * row as f32 / ROWS as f32;
        let around = std::f32::consts::TAU * (column % COLUMNS) as f32 / COLUMNS as f32;
        // The poles are one point each, whatever the column.
        let out = if row == 0 || row == ROWS { 0.0 } else { down.sin() };
        [out * around.cos() + 0.0, down.cos(), out * around.sin() + 0.0]
    };
    let positions: Vec<[f32; 3]> =
        (0..=ROWS).flat_map(|row| (0..COLUMNS).map(move |column| point(row, column))).collect();
    let number = |row: u32, column: u32| row * COLUMNS + column % COLUMNS;
    let indices: Vec<[u32; 3]> = (0..ROWS)
        .flat_map(|row| {
            (0..COLUMNS).flat_map(move |column| {
                let [a, b] = [number(row, column), number(row, column + 1)];
                let [c, d] = [number(row + 1, column), number(row + 1, column + 1)];
                [[a, b, c], [b, d, c]]
            })
        })
        .collect();
    // What is not closed has no thickness; a host would make such glass thin.
    let open = open_edges(&TriangleView { positions: &positions, indices: &indices });
    if open > 0 {
        return Err(format!("{open} edges of the ball are open").into());
    }
    let upload = |bytes: &[u8]| {
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("ball"),
            size: bytes.len() as u64,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let vertices = upload(lumivox::bytemuck::cast_slice(&positions));
    let triangles = upload(lumivox::bytemuck::cast_slice(&indices));
    let view = VertexView { buffer: &vertices, offset: 0, stride: 12, format: VertexFormat::Float32x3 };
    let indices = IndexView {
        buffer: &triangles,
        offset: 0,
        format: IndexFormat::Uint32,
        count: 3 * indices.len() as u32,
    };
    // On a ball around the origin positions are normals.
    let descriptor = MeshDescriptor {
        indices: Some(indices),
        normals: Some(view),
        ..MeshDescriptor::new(view, positions.len() as u32)
    };
    Ok(Mesh::new(gpu, &descriptor)?)
}
