//! The contract with a host: recording allocates nothing, submits nothing and survives a lost device; wrong bindings and
//! over-large grids are errors with names and numbers.
//!
//! Each test here opens a device of its own, since it counts or breaks what lives on it.

use libtest_mimic::Failed;
use lumivox::VolumeBuffer;
use lumivox::core::Grid;
use lumivox::glam::{UVec3, Vec3, Vec4};
use lumivox::gpu::{
    AdapterChoice, Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Texture, Tier, read_buffer,
    read_texture,
};
use lumivox::light::{IRRADIANCE_FORMAT, IndirectLight};
use lumivox::progressive::{CHANNELS, DirectLight, Progressive, SinglePass};
use lumivox::volume::NORMAL;
use lumivox::wgpu;

use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, views};
use crate::support::{SCALE, Shot, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("contract: 100 frames allocate nothing", frames_allocate_nothing),
    ("contract: recording submits nothing", recording_submits_nothing),
    ("contract: a destroyed device gives errors", destroyed_device),
    ("contract: a host's device gives the same picture", host_device),
    ("contract: a failure that the host reports stops recording", reported_failure),
    ("contract: binding errors name pass and resource", binding_errors),
    ("contract: an over-large grid is refused with numbers", large_grids),
];

/// Everything a host keeps, and a frame of all stages.
struct Host {
    gpu: Gpu,
    volume: VolumeBuffer,
    direct: DirectLight,
    progressive: Progressive,
    single: SinglePass,
    light: IndirectLight,
    shots: [Shot; 3],
    irradiance: Texture,
}

impl Host {
    fn new(gpu: Gpu) -> Result<Self, GpuError> {
        let volume = VolumeBuffer::new(&gpu, grid(), &CHANNELS)?;
        let [a, b, c] = views().map(|(_, view)| Shot::take(&gpu, view, SIZE, &[FLOOR, BALL, CHEST]));
        Ok(Self {
            direct: Progressive::direct_light(&gpu, &volume)?,
            progressive: Progressive::new(&gpu, &volume)?,
            single: SinglePass::new(&gpu, &volume)?,
            light: IndirectLight::new(&gpu, &volume)?,
            shots: [a?, b?, c?],
            irradiance: Texture::target(&gpu, "irradiance", SIZE.to_array(), IRRADIANCE_FORMAT)?,
            volume,
            gpu,
        })
    }

    fn open(tier: Tier) -> Result<Self, GpuError> {
        Self::new(Gpu::new_blocking(&AdapterChoice::default(), tier)?)
    }

    /// Two lamps and a camera, first by the single pass and then in two phases. An even number of turns of each, so that the
    /// volume ends on the side it began on.
    fn record(&mut self, e: &mut wgpu::CommandEncoder) -> Result<(), GpuError> {
        let (gpu, volume, direct) = (&self.gpu, &mut self.volume, &mut self.direct);
        let [one, two, camera] = &self.shots;
        self.single.record_begin(e, direct);
        self.single.record_light(gpu, e, [one, two].map(|lamp| &lamp.input), volume, direct)?;
        for shot in [one, camera] {
            self.single.record_camera(gpu, e, &shot.input, volume, direct)?;
        }
        for shot in [one, two, camera, camera] {
            self.progressive.record_cleanup(gpu, e, &shot.input, volume)?;
        }
        self.progressive.record_begin(e, direct);
        for lamp in [one, two] {
            self.progressive.record_light(gpu, e, [&lamp.input], volume, direct)?;
        }
        self.progressive.record_camera(gpu, e, &camera.input, volume, direct)?;
        self.progressive.record_end(gpu, e, &camera.input, volume, direct)?;
        self.light.record_transport(gpu, e, volume)?;
        self.light.record_seed(gpu, e, volume, direct)?;
        self.light.record_propagation(gpu, e, volume, 4)?;
        self.light.record_reconstruction(gpu, e, volume, &camera.input, &mut self.irradiance)
    }

    fn frame(&mut self) -> Result<(), GpuError> {
        for shot in &self.shots {
            shot.input.update(&self.gpu, &shot.view, SCALE);
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.record(&mut encoder)?;
        self.gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    fn pixels(&self) -> Result<Vec<u64>, GpuError> {
        read_texture(&self.gpu, &self.irradiance)
    }

    fn cells(&self) -> Result<Vec<Vec4>, Failed> {
        Ok(self.volume.read_back(&self.gpu)?.channel(NORMAL).ok_or("no normals")?.to_vec())
    }

    /// What wgpu itself counts: buffers, texture views, bind groups and textures, of which some backends count none.
    fn living(&self) -> Result<[isize; 4], GpuError> {
        self.gpu.wait()?;
        let hal = self.gpu.device.get_internal_counters().hal;
        Ok([hal.buffers.read(), hal.texture_views.read(), hal.bind_groups.read(), hal.textures.read()])
    }
}

fn frames_allocate_nothing(_: &Labs) -> Result<(), Failed> {
    for tier in [Tier::Core, Tier::Native] {
        let mut host = Host::open(tier)?;
        for _ in 0..2 {
            host.frame()?;
        }
        let (made, living) = (host.gpu.created_objects(), host.living()?);
        for _ in 0..100 {
            host.frame()?;
        }
        let after = host.living()?;
        eprintln!("{tier:?}: {made} objects made, living before {living:?}, after {after:?}");
        assert!(living[..3].iter().all(|n| *n > 0), "wgpu does not count: {living:?}");
        assert_eq!(host.gpu.created_objects(), made, "objects were made inside a frame");
        let grew = living.iter().zip(after).any(|(before, after)| after > *before);
        assert!(!grew, "wgpu's objects grew from {living:?} to {after:?}");
    }
    Ok(())
}

fn recording_submits_nothing(_: &Labs) -> Result<(), Failed> {
    let mut host = Host::open(Tier::Core)?;
    let mut encoder = host.gpu.device.create_command_encoder(&Default::default());
    host.record(&mut encoder)?;
    drop(encoder);
    host.gpu.wait()?;
    assert!(host.cells()?.iter().all(|v| *v == Vec4::ZERO), "cells without a submission");
    assert!(host.direct.read_back(&host.gpu)?.iter().all(|v| *v == [Vec4::ZERO; 3]), "light without one");
    assert!(host.pixels()?.iter().all(|p| *p == 0), "pixels without one");
    // The same frame, submitted, does all that.
    host.frame()?;
    assert!(host.cells()?.iter().any(|v| v.w > 0.0));
    assert!(host.pixels()?.iter().any(|p| *p != 0));
    Ok(())
}

fn destroyed_device(_: &Labs) -> Result<(), Failed> {
    let destroyed = || -> Result<Host, GpuError> {
        let mut host = Host::open(Tier::Core)?;
        host.frame()?;
        host.gpu.wait()?;
        host.gpu.device.destroy();
        Ok(host)
    };
    // Reading back is the first to notice.
    let host = destroyed()?;
    assert!(host.volume.read_back(&host.gpu).is_err(), "the volume can be read");
    assert!(host.pixels().is_err(), "the picture can be read");
    assert!(host.light.flux_under_way(&host.gpu).is_err(), "the flux can be read");

    // Or a frame is: until the device is polled, recording may quietly do nothing.
    let mut host = destroyed()?;
    eprintln!("the first frame after the loss: {:?}", host.frame());
    let waited = host.gpu.wait();
    assert!(matches!(waited, Err(GpuError::DeviceLost(_))), "waiting: {waited:?}");
    let recorded = host.frame();
    assert!(matches!(recorded, Err(GpuError::DeviceLost(_))), "recording: {recorded:?}");
    assert!(host.pixels().is_err(), "the picture can be read");
    Ok(())
}

fn reported_failure(_: &Labs) -> Result<(), Failed> {
    let mut host = Host::open(Tier::Core)?;
    host.frame()?;
    host.gpu.report_failure(GpuError::DeviceLost("the host says so".to_owned()));
    let error = host.frame().expect_err("recording goes on");
    assert!(error.to_string().contains("the host says so"), "{error}");
    Ok(())
}

fn host_device(_: &Labs) -> Result<(), Failed> {
    let (device, queue) = pollster::block_on(async {
        let adapter = Gpu::adapters().await.into_iter().next().ok_or("no adapter")?;
        adapter.request_device(&Default::default()).await.map_err(|e| e.to_string())
    })?;
    let mut host = Host::new(Gpu::from_device(device, queue, Tier::Core))?;
    let mut own = Host::open(Tier::Core)?;
    for _ in 0..2 {
        host.frame()?;
        own.frame()?;
    }
    let pixels = host.pixels()?;
    assert!(pixels.iter().any(|p| *p != 0), "the picture is black");
    assert!(pixels == own.pixels()?, "the host's device gives another picture");
    assert_eq!(host.gpu.tier(), Tier::Core);
    Ok(())
}

const DOUBLING: Shader = Shader {
    name: "test/doubling",
    parts: &["@group(0) @binding(0) var<storage, read> source: array<f32>;\n\
              @group(0) @binding(1) var<storage, read_write> sums: array<f32>;\n\
              @compute @workgroup_size(1)\n\
              fn main(@builtin(global_invocation_id) id: vec3u) { sums[id.x] += 2.0 * source[id.x]; }"],
};

fn binding_errors(_: &Labs) -> Result<(), Failed> {
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let pass = ComputePass::new(&gpu, &DOUBLING, &[]);
    let (a, mut b) = (Buffer::storage_with(&gpu, "a", &[1f32, 4.0])?, Buffer::storage(&gpu, "b", 8)?);
    let c = Buffer::storage(&gpu, "c", 8)?;
    let record = |bindings: Bindings<'_>| run(&gpu, |e| pass.record(&gpu, e, &bindings, [2, 1, 1]));
    let cases = [
        ("wrong name", record(Bindings::new().read("sauce", &a).write("sums", &mut b)), "source"),
        ("read where it writes", record(Bindings::new().read("source", &a).read("sums", &c)), "sums"),
        ("missing", record(Bindings::new().read("source", &a)), "sums"),
        (
            "too many",
            record(Bindings::new().read("source", &a).write("sums", &mut b).read("more", &c)),
            "sums",
        ),
    ];
    for (case, result, resource) in cases {
        let Err(error @ GpuError::Binding { .. }) = result else { panic!("{case}: {result:?}") };
        let text = error.to_string();
        assert!(text.contains("test/doubling") && text.contains(resource), "{case}: {text}");
    }
    let written = record(Bindings::new().write("source", &mut b).read("sums", &c));
    assert!(matches!(written, Err(GpuError::Binding { .. })), "written where it reads: {written:?}");
    record(Bindings::new().write("sums", &mut b).read("source", &a))?;
    assert_eq!(read_buffer::<f32>(&gpu, &b)?, [2.0, 8.0], "the right bindings, in any order");

    let mut wrong = VolumeBuffer::new(&gpu, grid(), &[NORMAL])?;
    let mut progressive = Progressive::new(&gpu, &wrong)?;
    let shot = Shot::take(&gpu, views()[0].1, SIZE, &[])?;
    let error = run(&gpu, |e| progressive.record_cleanup(&gpu, e, &shot.input, &mut wrong));
    let text = error.expect_err("a volume without albedo").to_string();
    assert!(text.contains("progressive/cleanup") && text.contains("albedo"), "{text}");
    let (mut single, mut direct) = (SinglePass::new(&gpu, &wrong)?, Progressive::direct_light(&gpu, &wrong)?);
    let error = run(&gpu, |e| single.record_camera(&gpu, e, &shot.input, &mut wrong, &mut direct));
    let text = error.expect_err("a volume without albedo").to_string();
    assert!(text.contains("progressive/single_pass") && text.contains("albedo"), "{text}");
    gpu.wait()?;
    Ok(())
}

fn large_grids(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let cube = |side| Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::splat(side) };
    let refused = |what: &str, result: Result<(), GpuError>, numbers: &[String]| {
        let error = result.expect_err(what);
        assert!(matches!(error, GpuError::TooLarge { .. }), "{what}: {error:?}");
        let text = error.to_string();
        assert!(numbers.iter().all(|n| text.contains(n)), "{what}: {text}");
    };
    let limit = 128u64 << 20;
    // One cell a side more than a channel, the light sums and the incident light may have.
    let volume = VolumeBuffer::new(gpu, cube(257), &[NORMAL]).map(|_| ());
    let needed = (257u64.pow(3) * 8).to_string();
    refused(
        "a volume",
        volume,
        &[needed, limit.to_string(), "257 x 257 x 257".into(), "256 x 256 x 256".into()],
    );
    let enormous = VolumeBuffer::new(gpu, cube(Grid::MAX_SIDE), &CHANNELS).map(|_| ());
    refused("2048 cells a side", enormous, &[(8u64 << 33).to_string(), "2048 x 2048 x 2048".into()]);

    let volume = VolumeBuffer::new(gpu, cube(141), &[NORMAL])?;
    let sums = Progressive::new(gpu, &volume).map(|_| ());
    refused("the sums", sums, &["141 x 141 x 141".into(), "137 x 137 x 137".into()]);
    let larger = VolumeBuffer::new(gpu, cube(178), &[NORMAL])?;
    let single = SinglePass::new(gpu, &larger).map(|_| ());
    refused("the single pass", single, &["178 x 178 x 178".into(), "177 x 177 x 177".into()]);
    let light = IndirectLight::new(gpu, &volume).map(|_| ());
    refused("the light", light, &["141 x 141 x 141".into(), "140 x 140 x 140".into()]);
    gpu.check()?;
    Ok(())
}
