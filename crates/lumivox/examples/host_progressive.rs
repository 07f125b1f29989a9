//! A renderer of its own that adds progressive voxelization: its device, its shader and its textures stay what they are.
//!
//! `cargo run -p lumivox --example host_progressive` draws a box that moves over a floor and says what each frame did to the volume,
//! with its milliseconds by the device's clock. That of software drivers is wrong: there the host's own stands in, for the frame as a whole.
//! What concerns Lumivox stands in `Voxels` and is a page long; the rest is the foreign renderer.

use std::sync::mpsc;
use std::time::{Duration, Instant};

use lumivox::core::{Grid, LooksAlong, MatrixConventions, View};
use lumivox::glam::{Mat4, UVec2, UVec3, Vec3};
use lumivox::gpu::{Gpu, GpuError, Texture, Tier};
use lumivox::progressive::{
    AttributeChannel, AttributeKind, AttributeView, FrameClock, FrameDiagnostics, ProgressiveVoxelizer,
    VoxelizerSettings,
};
use lumivox::wgpu::{self, TextureFormat as F, TextureUsages, util::DeviceExt};

const SIZE: UVec2 = UVec2::new(320, 200);

/// Everything that the renderer keeps for its voxels.
struct Voxels {
    gpu: Gpu,
    volume: ProgressiveVoxelizer,
    camera: AttributeView,
}

impl Voxels {
    /// Takes the renderer's device and its G-buffer as they are.
    fn new(host: &Host) -> Result<Self, GpuError> {
        let gpu = Gpu::from_device(host.device.clone(), host.queue.clone(), Tier::Core);
        let grid =
            Grid { origin: Vec3::new(-4.0, -0.5, -4.0), cell_size: 0.125, dims: UVec3::new(64, 32, 64) };
        let channels = [
            AttributeChannel::new("normal", AttributeKind::Normal),
            AttributeChannel::new("albedo", AttributeKind::Color(1.0)),
        ];
        let mut volume = ProgressiveVoxelizer::new(&gpu, grid, &channels, VoxelizerSettings::default())?;
        volume.keep_diagnostics(&gpu, FrameClock::Timestamps);
        let [depth, normal, albedo] = [&host.depth, &host.normal, &host.albedo];
        let [depth, normal, albedo] = [depth, normal, albedo].map(|t| Texture::from_raw(&gpu, t.clone()));
        let camera = AttributeView::new(&gpu, "camera", depth, normal, vec![albedo], SIZE);
        Ok(Self { gpu, volume, camera })
    }

    /// Adds a frame's work to the renderer's own commands, after its G-buffer.
    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        camera: &Camera,
    ) -> Result<(), Box<dyn std::error::Error>> {
        // What the renderer's matrices mean is said here, once.
        let conventions = MatrixConventions {
            looks_along: LooksAlong::PositiveZ,
            reversed_depth: true,
            ..MatrixConventions::default()
        };
        let [eye_from_world, clip_from_eye] =
            [camera.view, camera.projection].map(|m| Mat4::from_cols_array_2d(&m));
        let view = View::from_matrices(eye_from_world, clip_from_eye, conventions)?;
        self.volume.follow(Vec3::new(camera.eye[0], 1.5, 0.0));
        self.volume.update(&self.gpu, &[]);
        self.camera.update(&self.gpu, &view, self.camera.point_count(), self.volume.frame());
        Ok(self.volume.record(&self.gpu, encoder, &[&self.camera])?)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let host = Host::new()?;
    let mut voxels = Voxels::new(&host)?;
    let (finished, times) = mpsc::channel();
    for frame in 0..8 {
        let camera = Camera::new([0.3 * frame as f32 - 1.0, 2.5, 5.0], 0.38);
        let mut encoder = host.device.create_command_encoder(&Default::default());
        host.draw(&mut encoder, &camera, [0.4 * frame as f32 - 1.4, 0.5, 0.0, 0.0]);
        voxels.record(&mut encoder, &camera)?;
        let (begun, finished) = (Instant::now(), finished.clone());
        host.queue.submit([encoder.finish()]);
        host.queue.on_submitted_work_done(move || _ = finished.send(begun.elapsed()));
        tell(&mut voxels, &times)?;
    }
    host.device.poll(wgpu::PollType::wait_indefinitely())?;
    Ok(tell(&mut voxels, &times)?)
}

/// What the frames did to the volume that are done by now; the last one usually is not.
fn tell(voxels: &mut Voxels, times: &mpsc::Receiver<Duration>) -> Result<(), GpuError> {
    while let Some(done) = voxels.volume.poll_diagnostics(&voxels.gpu)? {
        let FrameDiagnostics { frame, occupied, injected, cleaned, bytes, .. } = done;
        let whole = times.recv_timeout(Duration::from_secs(1)).unwrap_or_default();
        let time = done.milliseconds.map_or_else(
            || format!("{:.1} ms from the frame's submission to its end", 1e3 * whole.as_secs_f64()),
            |time| format!("{time:.2} ms"),
        );
        eprintln!(
            "frame {frame}: {occupied} cells occupied, {injected} injected, {cleaned} cleaned, {bytes} bytes, {time}"
        );
    }
    Ok(())
}

/// The renderer's camera, by its own matrices: columns, an eye space that looks along +z, and reversed depth without a far plane.
struct Camera {
    eye: [f32; 3],
    view: [[f32; 4]; 4],
    projection: [[f32; 4]; 4],
}

impl Camera {
    /// From a point along -z, and so many radians down.
    fn new(eye: [f32; 3], down: f32) -> Self {
        let (sin, cos) = down.sin_cos();
        let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, -sin, -cos]);
        let from_eye = |axis: [f32; 3]| -(0..3).map(|n| axis[n] * eye[n]).sum::<f32>();
        let column = |n: usize| [right[n], up[n], forward[n], 0.0];
        let moved = [from_eye(right), from_eye(up), from_eye(forward), 1.0];
        let (near, tall) = (0.1, 1.0 / 0.45_f32.tan());
        let wide = tall * SIZE.y as f32 / SIZE.x as f32;
        let projection =
            [[wide, 0.0, 0.0, 0.0], [0.0, tall, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, near, 0.0]];
        Self { eye, view: [column(0), column(1), column(2), moved], projection }
    }
}

/// A renderer that knows nothing of voxels: a floor and a box into a G-buffer.
struct Host {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::RenderPipeline,
    depth: wgpu::Texture,
    normal: wgpu::Texture,
    albedo: wgpu::Texture,
}

const SHADER: &str = "
struct Frame { clip_from_eye: mat4x4f, eye_from_world: mat4x4f, place: vec4f }
@group(0) @binding(0) var<uniform> frame: Frame;
struct Varying { @builtin(position) clip: vec4f, @location(0) normal: vec3f, @location(1) albedo: vec3f }

@vertex fn vertex(@builtin(vertex_index) n: u32, @builtin(instance_index) thing: u32) -> Varying {
    let corner = array(vec2f(-1, -1), vec2f(1, -1), vec2f(1, 1), vec2f(-1, -1), vec2f(1, 1), vec2f(-1, 1))[n % 6u];
    let face = n / 6u;
    var normal = vec3f(0.0);
    normal[face / 2u] = f32(face % 2u) * 2.0 - 1.0;
    let flat = vec3f(corner, 0.0);
    let point = array(normal + flat.zxy, normal + flat.yzx, normal + flat.xyz)[face / 2u];
    let is_box = thing == 1u;
    let half = select(vec3f(4.0, 0.1, 4.0), vec3f(0.5), is_box);
    let world = select(vec3f(0.0, -0.11, 0.0), frame.place.xyz, is_box) + half * point;
    let albedo = select(vec3f(0.6), vec3f(0.8, 0.2, 0.1), is_box);
    return Varying(frame.clip_from_eye * frame.eye_from_world * vec4f(world, 1.0), normal, albedo);
}
struct Pixel { @location(0) normal: vec4f, @location(1) albedo: vec4f }
@fragment fn fragment(v: Varying) -> Pixel {
    return Pixel(vec4f(v.normal, 0.0), vec4f(v.albedo, 1.0));
}";

impl Host {
    fn new() -> Result<Self, Box<dyn std::error::Error>> {
        let adapter = pollster::block_on(wgpu::Instance::default().request_adapter(&Default::default()))?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            ..Default::default()
        }))?;
        let texture = |format| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("G-buffer"),
                size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        };
        let source = wgpu::ShaderSource::Wgsl(SHADER.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: F::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                targets: &[Some(F::Rgba16Float.into()), Some(F::Rgba8Unorm.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let [depth, normal, albedo] = [F::Depth32Float, F::Rgba16Float, F::Rgba8Unorm].map(texture);
        Ok(Self { device, queue, pipeline, depth, normal, albedo })
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, camera: &Camera, place: [f32; 4]) {
        let numbers = [camera.projection.as_flattened(), camera.view.as_flattened(), &place].concat();
        let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        let frame = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: &bytes,
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() }],
        });
        let [depth, normal, albedo] =
            [&self.depth, &self.normal, &self.albedo].map(|t| t.create_view(&Default::default()));
        let color = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[color(&normal), color(&albedo)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..36, 0..2);
    }
}
