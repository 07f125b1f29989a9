//! Channels of light: shadows, and what leaves surfaces.

use libtest_mimic::Failed;
use lumivox::core::{View, sh};
use lumivox::glam::{Vec2, Vec3, Vec4};
use lumivox::gpu::{Texture, TextureOptions};
use lumivox::volume::Format;
use lumivox::voxelize::{
    Channel, Coverage, LightChannels, Material, Mesh, MeshDescriptor, Options, VoxelLight, Voxelizer,
};
use lumivox::wgpu::{self, TextureFormat, TextureUsages};

use super::soups::{Soup, unit_grid};
use crate::Labs;
use crate::support::run;

/// A floor under a roof over half of it, lit from above: the roof's shadow map is drawn by hand.
pub(crate) fn shadows(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let quad = |y: f32, to: f32| {
        let corner = |x, z| Vec3::new(x, y, z);
        [
            [corner(0.0, 0.0), corner(0.0, 8.0), corner(to, 8.0)],
            [corner(0.0, 0.0), corner(to, 8.0), corner(to, 0.0)],
        ]
    };
    let soup = Soup::of([quad(1.5, 8.0), quad(6.5, 4.0)].concat());
    let color = Vec3::new(0.5, 0.25, 1.0);
    let material = Material { base_color: color.extend(1.0), ..Material::default() };
    let mesh = soup.described(gpu, |d| Mesh::new(gpu, &MeshDescriptor { material, ..d }))?;

    // Parallel light from y = 8 down, over x and z from 0 to 8.
    let center = Vec3::new(4.0, 8.0, 4.0);
    let view = View::orthographic(center, center - Vec3::Y, Vec3::Z, Vec2::splat(8.0), 8.0);
    let depth_of = |p: Vec3| view.clip_from_world.project_point3(p);
    let size = 32u32;
    let options = TextureOptions {
        size: [size, size],
        format: TextureFormat::Depth32Float,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_DST,
        mips: 1,
    };
    let map = Texture::new(gpu, "shadow map", options)?;
    paint_depth(gpu, &map, |x, y| {
        let ndc = Vec3::new((x as f32 + 0.5) / 16.0 - 1.0, 1.0 - (y as f32 + 0.5) / 16.0, 0.0);
        let world = view.world_from_clip().project_point3(ndc);
        let height = if world.x < 4.0 { 6.5 } else { 1.5 };
        depth_of(Vec3::new(world.x, height, world.z)).z
    })?;
    let lights = LightChannels::new(gpu, map);
    let irradiance = Vec3::new(2.0, 3.0, 4.0);
    lights.set(
        gpu,
        &[VoxelLight {
            clip_from_world: view.clip_from_world,
            position: -Vec3::Y,
            is_directional: 1,
            color: irradiance,
            bias: 0.05,
            tile: Vec4::new(0.0, 0.0, 1.0, 1.0),
        }],
    );
    let mut channels = vec![Channel::normal(), lights.radiance(4.0), lights.sh_mono(4.0)];
    channels.extend(lights.sh_rgb(4.0));
    let channels: Vec<_> = channels.into_iter().map(|c| c.format(Format::F32)).collect();
    let grid = unit_grid(8, 8, 8);
    let options = Options { coverage: Coverage::Thin, ..Options::default() };
    let mut voxelizer = Voxelizer::new(gpu, grid, &channels, &options)?;
    let mut volume = voxelizer.volume(gpu)?;
    let unbound = run(gpu, |e| voxelizer.record(gpu, e, &[&mesh], &mut volume));
    assert!(unbound.is_err_and(|e| e.to_string().contains("bind")), "recorded without its lights");
    voxelizer.bind(gpu, &lights.bindings())?;
    run(gpu, |e| voxelizer.record(gpu, e, &[&mesh], &mut volume))?;

    let values = volume.read_back(gpu)?;
    let value = |name: &str, cell| values.channel(name).map(|v| v[grid.index(cell)]).ok_or("no channel");
    let mut counts = [0; 3];
    for cell in grid.cells().filter(|c| c.y == 1 || (c.y == 6 && c.x < 4)) {
        let is_lit = cell.y == 6 || cell.x >= 4;
        counts[usize::from(cell.y == 6) + usize::from(is_lit)] += 1;
        let radiance = if is_lit { color * irradiance / std::f32::consts::PI } else { Vec3::ZERO };
        let found = value("light", cell)?.truncate();
        assert!((found - radiance).abs().max_element() < 1e-3, "{cell}: {found}, not {radiance}");
        let normal = value("normal", cell)?.truncate();
        assert!((normal.y.abs() - 1.0).abs() < 1e-4, "{cell}: {normal}");
        let lobe = sh::cosine_lobe(normal);
        for (name, radiance) in [
            ("sh", radiance.element_sum() / 3.0),
            ("sh_r", radiance.x),
            ("sh_g", radiance.y),
            ("sh_b", radiance.z),
        ] {
            let found = value(name, cell)?;
            assert!((found - radiance * lobe).abs().max_element() < 1e-3, "{cell} {name}: {found}");
        }
    }
    assert_eq!(counts, [32, 32, 32], "shadow, floor in the light, roof");
    Ok(())
}

/// Depth textures cannot be written from memory, so they are drawn.
fn paint_depth(
    gpu: &lumivox::gpu::Gpu,
    map: &Texture,
    depth: impl Fn(u32, u32) -> f32,
) -> Result<(), Failed> {
    let [width, height] = map.size();
    let source = "struct V { @builtin(position) p: vec4f }
        @group(0) @binding(0) var<storage, read> depths: array<f32>;
        @vertex fn vertex(@builtin(vertex_index) i: u32) -> V {
            return V(vec4f(vec2f(vec2u(i & 1u, i >> 1u)) * 4.0 - 1.0, 0.0, 1.0));
        }
        @fragment fn fragment(v: V) -> @builtin(frag_depth) f32 {
            return depths[u32(v.p.x) + 32u * u32(v.p.y)];
        }";
    let depths: Vec<f32> = (0..width * height).map(|n| depth(n % width, n / width)).collect();
    let depths = super::soups::buffer(gpu, &depths);
    let device = &gpu.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: depths.as_entire_binding() }],
    });
    run(gpu, |e| {
        let mut pass = e.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &map.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        Ok(())
    })?;
    Ok(())
}
