//! Light in free space: what it is, and that every stage of a foreign shader gets the same of it.

use std::f32::consts::PI;

use libtest_mimic::Failed;
use lumivox::gather::GatherSettings;
use lumivox::glam::{UVec3, Vec3, Vec4};
use lumivox::gpu::{Buffer, Gpu, GpuError, Texture, read_buffer, read_texture};
use lumivox::irradiance::{IrradianceSource, IrradianceVolume, irradiance_wgsl, layout_entries};
use lumivox::wgpu::util::DeviceExt;
use lumivox::{bytemuck, wgpu};

use crate::cells::Cells;
use crate::gather::{Room, filled};
use crate::support::{Random, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("irradiance: in a furnace it is the same everywhere and from all sides", furnace),
    ("irradiance: walls of other colours are where they are", colors),
    ("irradiance: a thin wall keeps a dark room dark", wall),
    ("irradiance: a slice at a time comes to the same", slices),
    ("irradiance: compute, vertex and fragment stages are told the same", stages),
];

const RAYS: u32 = 512;

/// Fills a volume of light over a room.
fn lit(gpu: &Gpu, room: &Room, spacing: u32) -> Result<IrradianceVolume, GpuError> {
    let mut lattice = IrradianceVolume::new(gpu, room.volume.grid(), spacing)?;
    run(gpu, |e| room.light.record_irradiance_volume(gpu, e, &room.volume, &mut lattice, (RAYS, 0, 1)))?;
    Ok(lattice)
}

/// A question: a point, and the way that a surface there faces.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Question {
    p: Vec4,
    n: Vec4,
}

pub(crate) fn question(p: Vec3, n: Vec3) -> Question {
    Question { p: p.extend(0.0), n: n.extend(0.0) }
}

/// What the shader is asked for.
pub(crate) const ON_SURFACE: &str = "lumivox_irradiance(q.p.xyz, q.n.xyz)";
pub(crate) const IN_SPACE: &str = "lumivox_irradiance_at(q.p.xyz, q.n.xyz)";
pub(crate) const ALL_AROUND: &str = "lumivox_mean_radiance(q.p.xyz)";

/// A foreign shader: its own resources first, ours behind them in the same group.
fn host_shader(gpu: &Gpu, call: &str, own: &str) -> wgpu::ShaderModule {
    let source = format!(
        "{}\nstruct Question {{ p: vec4f, n: vec4f }}\nfn told(q: Question) -> vec4f {{ return vec4f({call}, 1.0); }}\n{own}",
        irradiance_wgsl(0, 3)
    );
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("host"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

fn storage_entry(
    binding: u32,
    read_only: bool,
    visibility: wgpu::ShaderStages,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

/// The layout and the bind group of a host that reads questions (0), and writes answers (1) if it has room for them.
fn bound(
    gpu: &Gpu,
    lattice: &IrradianceVolume,
    visibility: wgpu::ShaderStages,
    buffers: &[(&wgpu::Buffer, bool)],
) -> (wgpu::PipelineLayout, wgpu::BindGroup) {
    let own = buffers.iter().zip(0..).map(|((_, read_only), n)| storage_entry(n, *read_only, visibility));
    let entries: Vec<_> = own.chain(layout_entries(3, visibility)).collect();
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("host"),
        entries: &entries,
    });
    let own = buffers
        .iter()
        .zip(0..)
        .map(|((buffer, _), binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
    let entries: Vec<_> = own.chain(lattice.bind_group_entries(3)).collect();
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("host"),
        layout: &layout,
        entries: &entries,
    });
    let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("host"),
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    (pipeline_layout, group)
}

fn question_buffer(gpu: &Gpu, questions: &[Question]) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("questions"),
        contents: bytemuck::cast_slice(questions),
        usage: wgpu::BufferUsages::STORAGE,
    })
}

/// Answers from a compute stage.
pub(crate) fn ask(
    gpu: &Gpu,
    lattice: &IrradianceVolume,
    call: &str,
    questions: &[Question],
) -> Result<Vec<Vec3>, GpuError> {
    let module = host_shader(
        gpu,
        call,
        "@group(0) @binding(0) var<storage, read> questions: array<Question>;
        @group(0) @binding(1) var<storage, read_write> answers: array<vec4f>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {
            if id.x < arrayLength(&questions) { answers[id.x] = told(questions[id.x]); }
        }",
    );
    let asked = question_buffer(gpu, questions);
    let answers = Buffer::storage(gpu, "answers", 16 * questions.len() as u64)?;
    let (layout, group) =
        bound(gpu, lattice, wgpu::ShaderStages::COMPUTE, &[(&asked, true), (&answers.raw, false)]);
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("host"),
        layout: Some(&layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    run(gpu, |e| {
        let mut pass = e.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((questions.len() as u32).div_ceil(64), 1, 1);
        Ok(())
    })?;
    let found: Vec<[f32; 4]> = read_buffer(gpu, &answers)?;
    Ok(found.into_iter().map(|a| Vec4::from(a).truncate()).collect())
}

/// Answers from a vertex or a fragment stage: a point of one pixel for each question.
fn draw(
    gpu: &Gpu,
    lattice: &IrradianceVolume,
    call: &str,
    questions: &[Question],
    in_vertex: bool,
) -> Result<Vec<Vec3>, GpuError> {
    let (early, late) =
        if in_vertex { ("told(questions[n])", "v.told") } else { ("vec4f(0.0)", "told(questions[v.n])") };
    let count = questions.len() as u32;
    let module = host_shader(
        gpu,
        call,
        &format!(
            "@group(0) @binding(0) var<storage, read> questions: array<Question>;
            struct V {{ @builtin(position) at: vec4f, @location(0) @interpolate(flat) told: vec4f, @location(1) @interpolate(flat) n: u32 }}
            @vertex fn vertex(@builtin(vertex_index) n: u32) -> V {{
                return V(vec4f((2.0 * f32(n) + 1.0) / f32({count}) - 1.0, 0.0, 0.0, 1.0), {early}, n);
            }}
            @fragment fn fragment(v: V) -> @location(0) vec4f {{ return {late}; }}"
        ),
    );
    let asked = question_buffer(gpu, questions);
    let (layout, group) = bound(gpu, lattice, wgpu::ShaderStages::VERTEX_FRAGMENT, &[(&asked, true)]);
    let format = wgpu::TextureFormat::Rgba32Float;
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("host"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::PointList,
            ..Default::default()
        },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let target = Texture::target(gpu, "answers", [count, 1], format)?;
    run(gpu, |e| {
        let mut pass = e.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..count, 0..1);
        Ok(())
    })?;
    let found: Vec<[f32; 4]> = read_texture(gpu, &target)?;
    Ok(found.into_iter().map(|a| Vec4::from(a).truncate()).collect())
}

fn furnace(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(16);
    cells.room(1, 14, 0.5, 1.0);
    let mut room = Room::new(gpu, &cells, GatherSettings::default())?;
    room.frame(gpu, 40)?;
    for spacing in [1, 2, 4] {
        let lattice = lit(gpu, &room, spacing)?;
        let mut random = Random::new(3);
        // Nearer than a spacing to the walls, at 2 and 14, points of the lattice outside come in.
        let (low, size) = (2.0 + spacing as f32, 12.0 - 2.0 * spacing as f32);
        let asked: Vec<_> = (0..256)
            .map(|_| {
                question(Vec3::splat(low) + size * random.cube(), (random.cube() - 0.5).normalize_or_zero())
            })
            .collect();
        let irradiance = ask(gpu, &lattice, IN_SPACE, &asked)?;
        let mean = ask(gpu, &lattice, ALL_AROUND, &asked)?;
        let off = |found: &[Vec3], expected: f32| {
            found.iter().map(|e| (e.x / expected - 1.0).abs()).fold(0.0, f32::max)
        };
        let worst = (off(&irradiance, 2.0 * PI), off(&mean, 2.0));
        eprintln!("furnace, spacing {spacing}: {worst:?} off at most");
        assert!(worst.0 < 0.01 && worst.1 < 0.005, "spacing {spacing}: {worst:?}");
    }
    Ok(())
}

/// A black box in which three walls shine, each in another colour: the bands of each are known by integration.
fn colors(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(16);
    cells.room(1, 14, 0.0, 0.0);
    let shining = [(0, 1, Vec3::X), (1, 14, Vec3::Y), (2, 14, Vec3::Z)];
    for cell in cells.grid.cells().collect::<Vec<_>>() {
        let inner = (0..3).filter(|&a| cell[a] > 1 && cell[a] < 14).count() == 2;
        for (axis, place, color) in shining {
            if inner && cell[axis] == place {
                let index = cells.grid.index(cell);
                cells.emission[index] = color.extend(0.0);
            }
        }
    }
    let mut room = Room::new(gpu, &cells, GatherSettings::default())?;
    room.frame(gpu, 2)?;
    let lattice = lit(gpu, &room, 1)?;
    let p = Vec3::new(4.5, 9.5, 6.5);
    // Which wall a ray from p meets first; walls are at 2 and 14.
    let wall = |d: Vec3| {
        let reach = |a: usize| if d[a] > 0.0 { (14.0 - p[a]) / d[a] } else { (2.0 - p[a]) / d[a] };
        let axis = (0..3).min_by(|&a, &b| reach(a).total_cmp(&reach(b))).unwrap_or(0);
        shining.iter().position(|&(a, place, _)| a == axis && (place == 14) == (d[axis] > 0.0))
    };
    let (mut constant, mut first) = ([0.0f32; 3], [Vec3::ZERO; 3]);
    let count = 200_000;
    for n in 0..count {
        let y = 1.0 - (2.0 * n as f32 + 1.0) / count as f32;
        let (sin, cos) = (2.0 * PI * (f64::from(n) * 0.618_033_988_749_895).fract() as f32).sin_cos();
        let d = Vec3::new((1.0 - y * y).sqrt() * cos, y, (1.0 - y * y).sqrt() * sin);
        if let Some(color) = wall(d) {
            constant[color] += 1.0 / count as f32;
            first[color] += d / count as f32;
        }
    }
    for n in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::ONE.normalize_or_zero()]
    {
        let found = ask(gpu, &lattice, IN_SPACE, &[question(p, n)])?[0];
        // Of radiance 1 over a part of all directions: pi times that part, and 2 pi times their mean direction.
        let expected =
            Vec3::from_array([0, 1, 2].map(|c| (PI * constant[c] + 2.0 * PI * first[c].dot(n)).max(0.0)));
        assert!((found - expected).abs().max_element() < 0.03, "{n}: {found} for {expected}");
    }
    Ok(())
}

/// Two rooms side by side, parted by a wall a quarter of a cell thick; one of them shines.
fn wall(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let side = 64;
    let is_wall = |p: UVec3| {
        let shell = p.min_element() == 4 || p.max_element() == side - 5;
        let inside = p.min_element() >= 4 && p.max_element() <= side - 5;
        inside && (shell || p.x == 33)
    };
    let (mut cells, bits) = filled(16, 0.5, is_wall);
    for cell in cells.grid.cells().collect::<Vec<_>>() {
        let index = cells.grid.index(cell);
        // The far wall of the room on the left.
        if cell.x == 1 && cells.occupied(index) {
            cells.emission[index] = Vec4::ONE;
        }
    }
    let mut room = Room::new(gpu, &cells, GatherSettings::default())?;
    room.light.upload_subcells(gpu, &bits)?;
    room.frame(gpu, 20)?;
    for spacing in [1, 2] {
        let lattice = lit(gpu, &room, spacing)?;
        let on_wall = |x: f32, n: Vec3| {
            let places =
                (0..16).map(|k| Vec3::new(x, 4.0 + 2.0 * (k % 4) as f32, 4.0 + 2.0 * (k / 4) as f32));
            let asked: Vec<_> = places.map(|p| question(p, n)).collect();
            let found = ask(gpu, &lattice, ON_SURFACE, &asked)?;
            Ok::<_, GpuError>(
                found.iter().map(|e| e.x).fold((f32::MAX, 0.0f32), |(l, h), e| (l.min(e), h.max(e))),
            )
        };
        let (lit, dark) = (on_wall(33.0 / 4.0, Vec3::NEG_X)?, on_wall(34.0 / 4.0, Vec3::X)?);
        eprintln!("wall, spacing {spacing}: {lit:?} before it, {dark:?} behind it");
        assert!(lit.0 > 0.1 && dark.1 < 1e-4 * lit.0, "spacing {spacing}: {lit:?}, {dark:?}");
    }
    Ok(())
}

fn slices(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(16);
    cells.room(1, 14, 0.5, 1.0);
    let mut room = Room::new(gpu, &cells, GatherSettings::default())?;
    room.frame(gpu, 4)?;
    let whole = lit(gpu, &room, 2)?;
    let mut sliced = IrradianceVolume::new(gpu, room.volume.grid(), 2)?;
    for slice in 0..5 {
        run(gpu, |e| {
            room.light.record_irradiance_volume(gpu, e, &room.volume, &mut sliced, (RAYS, slice, 5))
        })?;
    }
    let mut random = Random::new(9);
    let asked: Vec<_> = (0..128).map(|_| question(16.0 * random.cube(), Vec3::Y)).collect();
    let (once, parts) = (ask(gpu, &whole, IN_SPACE, &asked)?, ask(gpu, &sliced, IN_SPACE, &asked)?);
    assert!(once.iter().any(|e| e.x > 1.0));
    assert_eq!(once, parts);
    Ok(())
}

fn stages(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = Cells::new(16);
    cells.room(1, 14, 0.3, 0.0);
    let lamp = cells.grid.index(UVec3::new(1, 5, 9));
    cells.emission[lamp] = Vec4::new(4.0, 2.0, 1.0, 0.0);
    let mut room = Room::new(gpu, &cells, GatherSettings::default())?;
    room.frame(gpu, 4)?;
    let lattice = lit(gpu, &room, 2)?;
    let mut random = Random::new(11);
    let asked: Vec<_> = (0..200)
        .map(|_| question(Vec3::splat(2.0) + 12.0 * random.cube(), (random.cube() - 0.5).normalize_or_zero()))
        .collect();
    for call in [ON_SURFACE, IN_SPACE, ALL_AROUND] {
        let computed = ask(gpu, &lattice, call, &asked)?;
        assert!(computed.iter().filter(|e| e.min_element() > 1e-3).count() > 50, "{call}: there is light");
        for in_vertex in [true, false] {
            let drawn = draw(gpu, &lattice, call, &asked, in_vertex)?;
            for (a, b) in computed.iter().zip(&drawn) {
                assert!(
                    (*a - *b).abs().max_element() <= 1e-5 + 1e-4 * a.max_element(),
                    "{call}: {a} and {b}"
                );
            }
        }
    }
    Ok(())
}
