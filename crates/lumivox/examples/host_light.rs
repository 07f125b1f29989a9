//! Indirect light in a renderer of its own: any shader of it, forward-shaded or not, asks an irradiance volume.
//!
//! The host has voxels of a room with a glowing ceiling, a pipeline with a shader of its own, and a picture. Which way the light goes is one
//! line: `cargo run -p lumivox --example host_light -- gather` or `propagation`.

use lumivox::core::{Bounds, Grid};
use lumivox::gather::{GatherSettings, GatheredLight};
use lumivox::glam::{Vec3, Vec4};
use lumivox::gpu::{AdapterChoice, Gpu, Texture, Tier, read_texture};
use lumivox::irradiance::{IrradianceSource, IrradianceVolume, irradiance_wgsl, layout_entries};
use lumivox::light::IndirectLight;
use lumivox::progressive::{CHANNELS, Progressive};
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};
use lumivox::{VolumeBuffer, wgpu};

/// The host's shader: a wall at x = 0.3 m, 4 m wide and high, lit by nothing but indirect light.
const HOST: &str = "
@vertex fn vertex(@builtin(vertex_index) n: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u(n & 1u, n >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}
@fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let p = vec3f(0.3, 4.0 - at.y / 16.0, at.x / 16.0);
    return vec4f(0.7 / 3.14159 * lumivox_irradiance(p, vec3f(1.0, 0.0, 0.0)), 1.0);
}";
const SIDE: u32 = 64;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// The voxels that the host has: a hollow room, red on the left, whose ceiling glows.
fn fill(gpu: &Gpu, volume: &mut VolumeBuffer) -> Result<(), lumivox::gpu::GpuError> {
    let grid = *volume.grid();
    let count = grid.cell_count() as usize;
    let [mut normal, mut albedo, mut emission] = std::array::from_fn(|_| vec![Vec4::ZERO; count]);
    let last = grid.dims - 1;
    for cell in grid.cells() {
        let Some(axis) = (0..3).find(|&a| cell[a] == 0 || cell[a] == last[a]) else { continue };
        let inward = if cell[axis] == 0 { Vec3::AXES[axis] } else { -Vec3::AXES[axis] };
        let n = grid.index(cell);
        // Occupancy is the fourth number: less than 1 lets a part of the light of propagation through.
        normal[n] = inward.extend(1.0);
        albedo[n] = if cell.z == 0 { Vec4::new(0.7, 0.1, 0.1, 0.0) } else { Vec4::splat(0.7) };
        emission[n] = if cell.y == last.y { Vec4::ONE } else { Vec4::ZERO };
    }
    for (channel, values) in [(NORMAL, &normal), (ALBEDO, &albedo), (EMISSION, &emission)] {
        volume.upload(gpu, channel, values)?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A host gives its own device: `Gpu::from_device(device, queue, Tier::Core)`.
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let bounds = Bounds::new(Vec3::ZERO, Vec3::splat(4.0));
    let mut volume = VolumeBuffer::new(&gpu, Grid::fit(&bounds, 16)?, &CHANNELS)?;
    fill(&gpu, &mut volume)?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());

    // Light of the volume, one way or the other ...
    let source: Box<dyn IrradianceSource> = if std::env::args().nth(1).as_deref() == Some("propagation") {
        let mut light = IndirectLight::new(&gpu, &volume)?.with_free_space(&gpu);
        let direct = Progressive::direct_light(&gpu, &volume)?;
        light.record_transport(&gpu, &mut encoder, &volume)?;
        light.record_seed(&gpu, &mut encoder, &volume, &direct)?;
        light.record_propagation(&gpu, &mut encoder, &volume, 64)?;
        Box::new(light)
    } else {
        let mut light = GatheredLight::new(&gpu, &volume, GatherSettings::default())?;
        light.record_surfels(&gpu, &mut encoder, &volume)?;
        light.record_trace(&gpu, &mut encoder, &volume)?;
        light.record_bounces(&gpu, &mut encoder, &volume, 8)?;
        Box::new(light)
    };
    // ... into textures that any shader of the host asks.
    let mut irradiance = IrradianceVolume::new(&gpu, volume.grid(), 2)?;
    source.record_irradiance_volume(&gpu, &mut encoder, &volume, &mut irradiance, (64, 0, 1))?;

    let device = &gpu.device;
    let visibility = wgpu::ShaderStages::FRAGMENT;
    let group_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("host"),
        entries: &layout_entries(0, visibility),
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("host"),
        layout: &group_layout,
        entries: &irradiance.bind_group_entries(0),
    });
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("host"),
        source: wgpu::ShaderSource::Wgsl((irradiance_wgsl(0, 0) + HOST).into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("host"),
        bind_group_layouts: &[Some(&group_layout)],
        immediate_size: 0,
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("host"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(FORMAT.into())],
        }),
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        multiview_mask: None,
        cache: None,
    });
    let picture = Texture::target(&gpu, "host", [SIDE; 2], FORMAT)?;
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &picture.view,
                depth_slice: None,
                resolve_target: None,
                ops: Default::default(),
            })],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    gpu.queue.submit([encoder.finish()]);

    let pixels: Vec<[f32; 4]> = read_texture(&gpu, &picture)?;
    let at = |x: u32, y: u32| pixels[(x + SIDE * y) as usize];
    for (what, p) in
        [("under the ceiling", (32, 8)), ("by the red wall", (4, 32)), ("above the floor", (32, 58))]
    {
        let [r, g, b, _] = at(p.0, p.1);
        eprintln!("{what}: {r:.3} {g:.3} {b:.3} W/(m2 sr)");
    }
    Ok(())
}
