//! Meshes of every layout, and the contract: what does not fit is refused with words and numbers, and recording makes nothing.

use libtest_mimic::Failed;
use lumivox::core::Grid;
use lumivox::glam::{UVec3, Vec3, Vec4};
use lumivox::gpu::{AdapterChoice, Gpu, Tier};
use lumivox::volume::Format;
use lumivox::voxelize::{
    Channel, Coverage, IndexView, Mesh, MeshDescriptor, Options, Rule, SurfaceFunction, VertexView,
    VoxelizeError, Voxelizer,
};
use lumivox::wgpu::{self, IndexFormat, VertexFormat};

use super::soups::{Soup, buffer, scattered, unit_grid};
use crate::Labs;
use crate::support::run;

/// A strip of two quads, with a colour at each corner that every format holds.
const CORNERS: [Vec3; 6] = [
    Vec3::new(1.0, 1.5, 1.0),
    Vec3::new(4.0, 1.5, 1.0),
    Vec3::new(1.0, 3.5, 4.0),
    Vec3::new(4.0, 3.5, 4.0),
    Vec3::new(1.0, 6.5, 5.0),
    Vec3::new(4.0, 6.5, 5.0),
];
const INDICES: [u16; 12] = [0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4];

type Look = (Vec<bool>, Vec<Vec4>);

fn look(gpu: &Gpu, voxelizer: &mut Voxelizer, mesh: &Mesh) -> Result<Look, Failed> {
    let mut volume = voxelizer.volume(gpu)?;
    run(gpu, |e| voxelizer.record(gpu, e, &[mesh], &mut volume))?;
    let values = volume.read_back(gpu)?;
    Ok((voxelizer.read_occupancy(gpu)?, values.channel("albedo").ok_or("no channel")?.to_vec()))
}

pub(crate) fn layouts(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let channels = [Channel::albedo().format(Format::F32)];
    let mut voxelizer = Voxelizer::new(gpu, unit_grid(8, 8, 8), &channels, &Options::default())?;
    let plain: Vec<f32> = CORNERS.iter().flat_map(|c| c.to_array()).collect();
    let positions = buffer(gpu, &plain);
    let base = MeshDescriptor::new(
        VertexView { buffer: &positions, offset: 0, stride: 12, format: VertexFormat::Float32x3 },
        6,
    );
    // One index more at the front, so that 16-bit indices begin within a word.
    let shorts: Vec<u16> = std::iter::once(9).chain(INDICES).collect();
    let words: Vec<u32> = INDICES.iter().map(|i| u32::from(*i)).collect();
    let (shorts, words) = (buffer(gpu, &shorts), buffer(gpu, &words));
    let short = IndexView { buffer: &shorts, offset: 2, format: IndexFormat::Uint16, count: 12 };
    let word = IndexView { buffer: &words, offset: 0, format: IndexFormat::Uint32, count: 12 };
    // Colours of 0, 1/2 and 1 in bytes of 255 are not halves, so 0 and 1 alone.
    let colors: Vec<Vec4> =
        (0..6u32).map(|n| Vec4::new((n & 1) as f32, (n >> 1 & 1) as f32, (n >> 2) as f32, 1.0)).collect();
    let floats = buffer(gpu, &colors);
    let color = |buffer, stride, offset, format| Some(VertexView { buffer, offset, stride, format });
    let expected_mesh = Mesh::new(
        gpu,
        &MeshDescriptor {
            indices: Some(word),
            colors: color(&floats, 16, 0, VertexFormat::Float32x4),
            ..base
        },
    )?;
    let expected = look(gpu, &mut voxelizer, &expected_mesh)?;
    assert!(expected.0.iter().filter(|c| **c).count() > 20);

    let bytes: Vec<[u8; 4]> = colors.iter().map(|c| c.to_array().map(|v| (255.0 * v) as u8)).collect();
    let shorts16: Vec<[u16; 4]> = colors.iter().map(|c| c.to_array().map(|v| (65535.0 * v) as u16)).collect();
    let signed: Vec<[i8; 4]> = colors.iter().map(|c| c.to_array().map(|v| (127.0 * v) as i8)).collect();
    let halves: Vec<[u16; 4]> =
        colors.iter().map(|c| c.to_array().map(|v| if v > 0.0 { 0x3c00 } else { 0 })).collect();
    // Everything in one buffer, 40 bytes a vertex, after 8 bytes of something else.
    let mixed: Vec<u32> = [7, 7]
        .into_iter()
        .chain((0..6).flat_map(|n| {
            let mut vertex = CORNERS[n].to_array().map(f32::to_bits).to_vec();
            vertex.extend(bytes_of(&bytes[n]).chain(bytes_of(&shorts16[n])).chain(bytes_of(&signed[n])));
            vertex.extend(bytes_of(&halves[n]).chain([0]));
            vertex
        }))
        .collect();
    let mixed = buffer(gpu, &mixed);
    let view = |offset: u64, format| VertexView { buffer: &mixed, offset: 8 + offset, stride: 40, format };
    for (offset, format) in [
        (12, VertexFormat::Unorm8x4),
        (16, VertexFormat::Unorm16x4),
        (24, VertexFormat::Snorm8x4),
        (28, VertexFormat::Float16x4),
    ] {
        let descriptor = MeshDescriptor {
            positions: view(0, VertexFormat::Float32x3),
            indices: Some(short),
            colors: Some(view(offset, format)),
            ..base
        };
        let found = look(gpu, &mut voxelizer, &Mesh::new(gpu, &descriptor)?)?;
        assert!(found == expected, "{format:?}");
    }
    // Without indices, three vertices in a row.
    let soup: Vec<f32> = INDICES.iter().flat_map(|i| CORNERS[usize::from(*i)].to_array()).collect();
    let soup = buffer(gpu, &soup);
    let unindexed = VertexView { buffer: &soup, ..base.positions };
    let unindexed = Mesh::new(gpu, &MeshDescriptor::new(unindexed, 12))?;
    assert!(look(gpu, &mut voxelizer, &unindexed)?.0 == expected.0, "without indices");
    // The first triangles alone, and all again.
    let mut mesh = expected_mesh;
    mesh.set_triangle_count(gpu, 2);
    let half = look(gpu, &mut voxelizer, &mesh)?;
    assert!(half.0 != expected.0 && half.0.iter().zip(&expected.0).all(|(a, b)| !a || *b), "half");
    mesh.set_triangle_count(gpu, 99);
    assert!(look(gpu, &mut voxelizer, &mesh)? == expected, "all again");
    Ok(())
}

fn bytes_of<T: lumivox::bytemuck::NoUninit>(values: &[T; 4]) -> impl Iterator<Item = u32> + use<T> {
    let bytes: Vec<u8> = lumivox::bytemuck::cast_slice(values).to_vec();
    let words: Vec<u32> =
        bytes.chunks_exact(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect();
    words.into_iter()
}

pub(crate) fn refusals(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let positions = buffer(gpu, &[0f32; 36]);
    let vertices = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 144,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let good = VertexView { buffer: &positions, offset: 0, stride: 12, format: VertexFormat::Float32x3 };
    let refused = |view: VertexView<'_>, count: u32, words: &[&str]| {
        let error = Mesh::new(gpu, &MeshDescriptor::new(view, count)).expect_err("refused");
        let text = error.to_string();
        assert!(words.iter().all(|w| text.contains(w)), "{text}");
    };
    refused(VertexView { buffer: &vertices, ..good }, 12, &["positions", "STORAGE"]);
    refused(VertexView { offset: 2, ..good }, 3, &["multiples of 4"]);
    refused(VertexView { stride: 13, ..good }, 3, &["13", "multiples of 4"]);
    refused(VertexView { format: VertexFormat::Uint8x4, ..good }, 3, &["Uint8x4"]);
    refused(good, 13, &["156", "144"]);
    refused(VertexView { offset: u64::MAX - 3, ..good }, 13, &["bytes"]);
    let indices = IndexView { buffer: &positions, offset: 0, format: IndexFormat::Uint32, count: 37 };
    let error = Mesh::new(gpu, &MeshDescriptor { indices: Some(indices), ..MeshDescriptor::new(good, 12) });
    assert!(error.is_err_and(|e| e.to_string().contains("indices")));

    let make = |grid: Grid, channels: &[Channel]| {
        Voxelizer::new(gpu, grid, channels, &Options::default()).map(|_| ())
    };
    let cube = |side| Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::splat(side) };
    let text = |result: Result<(), VoxelizeError>| result.expect_err("refused").to_string();
    let large = text(make(cube(257), &[Channel::normal()]));
    assert!(large.contains("257 x 257 x 257") && large.contains("256 x 256 x 256"), "{large}");
    let large = text(make(cube(1025), &[]));
    assert!(large.contains("1025") && large.contains("1024 x 1024 x 1024"), "{large}");
    let twice = text(make(cube(8), &[Channel::albedo(), Channel::albedo()]));
    assert!(twice.contains("albedo") && twice.contains("name"), "{twice}");
    let flat = text(make(cube(8), &[Channel::albedo().range(1.0, 1.0)]));
    assert!(flat.contains("range"), "{flat}");
    let function = |text: &str| {
        let own = SurfaceFunction { name: "own".to_owned(), text: text.to_owned(), outputs: 1 };
        std::sync::Arc::new(own)
    };
    let own = function("fn own(point: SurfacePoint) -> vec4f { return vec4f(point.area); }");
    let many: Vec<Channel> = (0..9)
        .map(|n| Channel::function(&n.to_string(), 4, &own, 0).rule(Rule::Maximum).format(Format::F32))
        .collect();
    let bits = text(make(cube(8), &many));
    assert!(bits.contains("1152") && bits.contains("1024"), "{bits}");
    make(cube(8), &many[..8])?;
    let broken = function("fn own(point: SurfacePoint) -> vec4f { return vec4f(point.weight); }");
    let broken = text(make(cube(8), &[Channel::function("own", 1, &broken, 0)]));
    assert!(broken.contains("weight"), "{broken}");
    gpu.check()?;
    Ok(())
}

pub(crate) fn nothing_is_made(_: &Labs) -> Result<(), Failed> {
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let options = Options { coverage: Coverage::Thin, ..Options::default() };
    let channels = [Channel::normal(), Channel::albedo(), Channel::emission()];
    let mut voxelizer = Voxelizer::new(&gpu, unit_grid(16, 16, 16), &channels, &options)?;
    // A volume as light has it, whose state the voxelizer writes.
    let mut volume = lumivox::VolumeBuffer::new(&gpu, *voxelizer.grid(), &lumivox::progressive::CHANNELS)?;
    let soup: Soup = scattered(4, 200, 4.0, 16.0);
    let mut mesh = soup.mesh(&gpu)?;
    let (mut still, mut moving) = (voxelizer.layer(&gpu)?, voxelizer.layer(&gpu)?);
    let mut counts = Vec::new();
    for n in 0..20 {
        mesh.set_transform(&gpu, &lumivox::glam::Mat4::from_translation(Vec3::X * n as f32 * 0.1));
        run(&gpu, |e| {
            voxelizer.record(&gpu, e, &[&mesh], &mut volume)?;
            voxelizer.record_layer(&gpu, e, &[&mesh], &mut still)?;
            voxelizer.record_layer(&gpu, e, &[], &mut moving)?;
            voxelizer.record_merge(&gpu, e, &[&still, &moving], &mut volume)
        })?;
        counts.push(gpu.created_objects());
    }
    assert!(counts[1..].iter().all(|c| *c == counts[0]), "{counts:?}");
    let read = volume.read_back(&gpu)?;
    let normals = read.channel("normal").ok_or("no normals")?;
    let occupied = voxelizer.read_occupancy(&gpu)?;
    assert!(normals.iter().zip(&occupied).all(|(n, o)| n.w == f32::from(u8::from(*o))), "occupancy in w");

    // A volume over another grid, or of other channels, is no target.
    let mut other = lumivox::VolumeBuffer::new(&gpu, unit_grid(8, 8, 8), &lumivox::progressive::CHANNELS)?;
    let error = run(&gpu, |e| voxelizer.record(&gpu, e, &[], &mut other)).expect_err("another grid");
    assert!(error.to_string().contains("grid"), "{error}");
    let mut other = lumivox::VolumeBuffer::new(&gpu, *voxelizer.grid(), &["normal"])?;
    let error = run(&gpu, |e| voxelizer.record(&gpu, e, &[], &mut other)).expect_err("other channels");
    assert!(error.to_string().contains("albedo"), "{error}");
    Ok(())
}
