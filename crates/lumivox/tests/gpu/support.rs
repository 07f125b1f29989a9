//! Devices, volumes and views that tests share, and the frames made from them.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lumivox::VolumeBuffer;
use lumivox::core::{Grid, HostVolume, View};
use lumivox::glam::{UVec2, UVec3, Vec3, Vec4};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::light::IndirectLight;
use lumivox::progressive::{
    CHANNELS, CleanupRule, DirectLight, InjectionScale, Progressive, SinglePass, ViewInput,
};
use lumivox::wgpu;

use crate::picture::{Picture, Thing};

/// The largest frame here, two lamps and a camera, and the largest view.
pub(crate) const SCALE: InjectionScale =
    InjectionScale { attribute_points: 20_480, light_points: 16_384, radiance_max: 4.0 };

/// The stages for one grid size.
pub(crate) struct Stages {
    pub(crate) progressive: Progressive,
    pub(crate) by_center: Progressive,
    pub(crate) by_rays: Progressive,
    pub(crate) light: IndirectLight,
    /// By the papers' rule.
    pub(crate) single: SinglePass,
}

/// A device and the stages made on it so far.
pub(crate) struct Lab {
    pub(crate) gpu: Gpu,
    made: Mutex<Vec<(UVec3, Arc<Mutex<Stages>>)>>,
}

impl Lab {
    pub(crate) fn new(gpu: Gpu) -> Self {
        Self { gpu, made: Mutex::default() }
    }

    /// The stages for the volume's grid size.
    pub(crate) fn stages(&self, volume: &VolumeBuffer) -> Result<Arc<Mutex<Stages>>, GpuError> {
        let dims = volume.grid().dims;
        let mut made = locked(&self.made);
        if let Some((_, stages)) = made.iter().find(|(d, _)| *d == dims) {
            return Ok(stages.clone());
        }
        let stages = Arc::new(Mutex::new(Stages {
            progressive: Progressive::new(&self.gpu, volume)?,
            by_center: Progressive::with_rule(&self.gpu, volume, CleanupRule::Center)?,
            by_rays: Progressive::with_rule(&self.gpu, volume, CleanupRule::Rays)?,
            light: IndirectLight::new(&self.gpu, volume)?,
            single: SinglePass::with_rule(&self.gpu, volume, CleanupRule::Center)?,
        }));
        made.push((dims, stages.clone()));
        Ok(stages)
    }
}

/// One failed test must not fail those that share its stages.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Records, submits and waits.
pub(crate) fn run(
    gpu: &Gpu,
    record: impl FnOnce(&mut wgpu::CommandEncoder) -> Result<(), GpuError>,
) -> Result<(), GpuError> {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    record(&mut encoder)?;
    gpu.queue.submit([encoder.finish()]);
    gpu.wait()
}

/// A volume with its light, between frames.
pub(crate) struct World {
    pub(crate) volume: VolumeBuffer,
    pub(crate) light: DirectLight,
    stages: Arc<Mutex<Stages>>,
}

impl World {
    pub(crate) fn new(lab: &Lab, grid: Grid) -> Result<Self, GpuError> {
        let volume = VolumeBuffer::new(&lab.gpu, grid, &CHANNELS)?;
        let light = Progressive::direct_light(&lab.gpu, &volume)?;
        let stages = lab.stages(&volume)?;
        Ok(Self { volume, light, stages })
    }

    /// Cleanup by one view.
    pub(crate) fn clean(&mut self, gpu: &Gpu, shot: &Shot) -> Result<(), GpuError> {
        self.clean_by(gpu, CleanupRule::default(), shot)
    }

    /// Cleanup by one view with a rule.
    pub(crate) fn clean_by(&mut self, gpu: &Gpu, rule: CleanupRule, shot: &Shot) -> Result<(), GpuError> {
        let stages = &mut *locked(&self.stages);
        let progressive = match rule {
            CleanupRule::Center => &mut stages.by_center,
            CleanupRule::Footprint => &mut stages.progressive,
            CleanupRule::Rays => &mut stages.by_rays,
        };
        run(gpu, |e| progressive.record_cleanup(gpu, e, &shot.input, &mut self.volume))
    }

    /// Injection of a frame: lamps, then the camera.
    pub(crate) fn inject(
        &mut self,
        gpu: &Gpu,
        lamps: &[&Shot],
        camera: Option<&Shot>,
    ) -> Result<(), GpuError> {
        self.inject_with(gpu, |progressive, e, volume, light| {
            for lamp in lamps {
                progressive.record_light(gpu, e, [&lamp.input], volume, light)?;
            }
            if let Some(camera) = camera {
                progressive.record_camera(gpu, e, &camera.input, volume, light)?;
            }
            match lamps.first().copied().or(camera) {
                Some(any) => progressive.record_end(gpu, e, &any.input, volume, light),
                None => Ok(()),
            }
        })
    }

    /// Injection of a frame as the test records it, after its beginning.
    pub(crate) fn inject_with(
        &mut self,
        gpu: &Gpu,
        record: impl FnOnce(
            &mut Progressive,
            &mut wgpu::CommandEncoder,
            &mut VolumeBuffer,
            &mut DirectLight,
        ) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        let progressive = &mut locked(&self.stages).progressive;
        run(gpu, |e| {
            progressive.record_begin(e, &mut self.light);
            record(progressive, e, &mut self.volume, &mut self.light)
        })
    }

    /// The single pass of a frame as the test records it.
    pub(crate) fn single_pass(
        &mut self,
        gpu: &Gpu,
        record: impl FnOnce(
            &mut SinglePass,
            &mut wgpu::CommandEncoder,
            &mut VolumeBuffer,
            &mut DirectLight,
        ) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        let single = &mut locked(&self.stages).single;
        run(gpu, |e| record(single, e, &mut self.volume, &mut self.light))
    }

    /// Fills the volume and its light with random values, in half of the cells.
    pub(crate) fn scatter(&mut self, gpu: &Gpu, seed: u64) -> Result<(), GpuError> {
        let mut random = Random::new(seed);
        let mut channels = [const { Vec::new() }; 3];
        let mut light = Vec::new();
        for _ in 0..self.volume.grid().cell_count() {
            let occupied = if random.unit() < 0.5 { 0.0 } else { 1.0 };
            channels[0].push(occupied * (random.cube() - 0.5).extend(1.0));
            channels[1].push(occupied * random.cube().extend(0.0));
            channels[2].push(occupied * random.cube().extend(0.0));
            light.push([(); 3].map(|()| occupied * random.cube().extend(random.unit())));
        }
        self.light.upload(gpu, &light);
        CHANNELS.into_iter().zip(&channels).try_for_each(|(name, v)| self.volume.upload(gpu, name, v))
    }

    /// A channel's values.
    pub(crate) fn read(&self, gpu: &Gpu) -> Result<HostVolume, GpuError> {
        self.volume.read_back(gpu)
    }
}

/// The values of a channel that every volume here has.
pub(crate) fn channel<'v>(volume: &'v HostVolume, name: &str) -> &'v [Vec4] {
    volume.channel(name).expect("the channel was made")
}

/// A view, its pictures on both sides, and what the stages take.
pub(crate) struct Shot {
    pub(crate) view: View,
    pub(crate) picture: Picture,
    pub(crate) input: ViewInput,
}

impl Shot {
    pub(crate) fn of(gpu: &Gpu, view: View, picture: Picture, points: UVec2) -> Result<Self, GpuError> {
        let input = ViewInput::new(gpu, "test view", picture.upload(gpu)?, points);
        input.update(gpu, &view, SCALE);
        Ok(Self { view, picture, input })
    }

    /// One point a texel.
    pub(crate) fn take(gpu: &Gpu, view: View, size: UVec2, things: &[Thing]) -> Result<Self, GpuError> {
        Self::of(gpu, view, Picture::take(&view, size, things), size)
    }
}

/// Whether a stored half float is a mean of samples that were each rounded to a step: half a step, and one part in
/// 1024 for the conversion, which may truncate.
pub(crate) fn is_mean(stored: f32, mean: f64, step: f64) -> bool {
    let stored = f64::from(stored);
    (stored - mean).abs() <= 0.5 * step + mean.abs() / 1024.0 + 1e-7
}

/// Numbers that are the same on every machine.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Uniform in 0..1.
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Uniform in the unit cube.
    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }
}
