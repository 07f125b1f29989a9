//! Nested windows that follow a viewer over a floor that never ends: fine cells near by, coarser ones around them.
//!
//! `cargo run -p lumivox --example host_cascade` goes forward for some frames and asks the cascade, in a shader of the host's own, what
//! there is on the floor at some distances from the viewer: before, beside and behind, where no camera looks any more.

mod floor;

use floor::{Floor, uploaded};
use lumivox::core::{Grid, View};
use lumivox::glam::{UVec2, UVec3, Vec3, Vec4};
use lumivox::gpu::{AdapterChoice, Gpu, GpuError, Tier, read_buffer};
use lumivox::gpu::{Bindings, Buffer, ComputePass, Shader};
use lumivox::progressive::{
    AttributeChannel, AttributeKind, AttributeView, CASCADE_QUERIES, Cascade, FrameClock, VoxelizerSettings,
};
use lumivox::wgpu::TextureFormat;

const SIZE: UVec2 = UVec2::new(256, 192);

/// What the host asks: the level whose cell is at each point, whether something is there, and how much there is around it.
const ASK: Shader = Shader {
    name: "host/ask",
    parts: &[
        CASCADE_QUERIES,
        "
@group(0) @binding(4) var<storage, read> points: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> answers: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&points) { return; }
    let cell = lumivox_cascade_find(points[id.x].xyz);
    let around = lumivox_cascade_smooth(points[id.x].xyz, 0u);
    answers[id.x] = vec4f(f32(cell.level), select(0.0, 1.0, cell.is_occupied), around.coverage, 0.0);
}",
    ],
};

fn main() -> Result<(), GpuError> {
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    // Three levels of 32 x 8 x 32 cells: 4, 8 and 16 m wide. A fourth would take as much memory again, and see 32 m.
    let finest = Grid { origin: Vec3::new(0.0, -0.06, 0.0), cell_size: 0.125, dims: UVec3::new(32, 8, 32) };
    let channels = [AttributeChannel::new("normal", AttributeKind::Normal)];
    let settings = VoxelizerSettings { bricks: 512, bricks_in_view: 512, ..VoxelizerSettings::default() };
    let mut cascade = Cascade::new(&gpu, finest, 3, &channels, settings)?;
    cascade.keep_diagnostics(&gpu, FrameClock::Timestamps);
    let ask = ComputePass::new(&gpu, &ASK, &[]);
    for frame in 0..12 {
        let viewer = Vec3::new(0.0, 0.4, -0.5 * frame as f32);
        let eye = viewer + Vec3::new(0.0, 1.2, 0.0);
        let view = View::perspective(eye, eye + Vec3::new(0.0, -0.5, -1.0), Vec3::Y, 1.2, 1.33, 0.1, 40.0);
        let camera = picture(&gpu, &view)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        cascade.record_frame(&gpu, &mut encoder, viewer, &[], &[(&camera, &view)])?;
        gpu.queue.submit([encoder.finish()]);
        while let Some(levels) = cascade.poll_diagnostics(&gpu)? {
            let counts: Vec<_> =
                levels.iter().map(|l| format!("{} cells, {} new", l.occupied, l.new)).collect();
            eprintln!("frame {}: {}", levels[0].frame, counts.join("; "));
        }
        if frame == 11 {
            look_around(&gpu, &ask, &cascade, viewer)?;
        }
    }
    Ok(())
}

/// The host's picture of the floor: its depth, and normals where it is. A host that draws keeps its view and its textures from frame to frame.
fn picture(gpu: &Gpu, view: &View) -> Result<AttributeView, GpuError> {
    let Floor { depth, is_floor } = Floor::new(gpu, view, SIZE)?;
    let up: Vec<[i8; 4]> = is_floor.iter().map(|is| if *is { [0, 127, 0, 0] } else { [0; 4] }).collect();
    let normal = uploaded(gpu, SIZE, TextureFormat::Rgba8Snorm, lumivox::bytemuck::cast_slice(&up))?;
    Ok(AttributeView::new(gpu, "camera", depth, normal, Vec::new(), SIZE))
}

/// Asks along a line on the floor from behind the viewer to far before it.
fn look_around(gpu: &Gpu, ask: &ComputePass, cascade: &Cascade, viewer: Vec3) -> Result<(), GpuError> {
    let ways = [-9.0, -5.0, -3.0, -1.5, 1.5, 3.0, 5.0, 9.0];
    let points = ways.map(|ahead| Vec4::new(0.03, -0.005, viewer.z - ahead, 0.0));
    let asked = Buffer::storage_with(gpu, "host/points", &points)?;
    let mut answers = Buffer::storage(gpu, "host/answers", size_of_val(&points) as u64)?;
    let [table, headers, values] = cascade.buffers();
    let bindings = Bindings::new()
        .read("lumivox_cascade", cascade.uniform())
        .read("lumivox_cascade_table", table)
        .read("lumivox_cascade_headers", headers)
        .read("lumivox_cascade_values", values)
        .read("points", &asked)
        .write("answers", &mut answers);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    ask.record(gpu, &mut encoder, &bindings, [1, 1, 1])?;
    gpu.queue.submit([encoder.finish()]);
    for (ahead, answer) in ways.iter().zip(read_buffer::<Vec4>(gpu, &answers)?) {
        let what = match (answer.x as usize, answer.y) {
            (level, _) if level == cascade.levels().len() => "outside of all windows".to_owned(),
            (level, 1.0) => format!("floor, in level {level}; coverage {:.2}", answer.z),
            (level, _) => format!("nothing, in level {level}"),
        };
        eprintln!("{ahead:5.1} m ahead: {what}");
    }
    Ok(())
}
